//! The plan of a dataset, made before anything is written, and what became of it.

use super::super::choose::{first_left_out, is_chosen, off_paint_note};
use super::label_origin::LabelOrigin;
use super::names::picture_name;
use super::options::{DatasetOptions, Pictures};
use super::outside::OwnPlaces;
use super::split::{Split, split};
use crate::document::{DocumentAt, Frame, FrameId, FrameStatus};
use crate::exchange::error::ExchangeError;
use std::collections::{BTreeMap, BTreeSet};
use std::path::{Path, PathBuf};
use touchline_core::geometry::{ImageSize, pluralise};
use touchline_vision::media::{FrameRef, image_size};

/// The contents of a dataset to be written.
#[derive(Clone, Debug, PartialEq)]
pub struct DatasetPlan {
    /// The frames in the document's order.
    pub frames: Vec<PlannedFrame>,
    /// Chosen frames that are left out, by name, with the reason.
    pub left_out: Vec<(String, String)>,
    /// The estimated size of the pictures, bytes.
    pub picture_bytes: u64,
    /// Notes for the user.
    pub notes: Vec<String>,
}

/// A frame of a dataset.
#[derive(Clone, Debug, PartialEq)]
pub struct PlannedFrame {
    /// Its id in the document.
    pub id: FrameId,
    /// Its split; none if the dataset is not split.
    pub split: Option<Split>,
    /// The origin of its label.
    pub origin: LabelOrigin,
    /// Its picture within the dataset, with `/` between the parts; none if pictures are not copied.
    pub picture: Option<String>,
    /// Its picture without lens distortion, if the options ask for that and its camera is known.
    pub undistorted: Option<String>,
    /// Its name in messages.
    pub name: String,
    /// The source of its pixels.
    pub(super) source: Source,
}

/// The contents of the written dataset.
#[derive(Clone, Debug, PartialEq)]
pub struct DatasetDone {
    /// The number of frames.
    pub frames: usize,
    /// The number of pictures.
    pub pictures: usize,
    /// The number of frames of each split.
    pub counts: [usize; 3],
    /// Chosen frames that are not in it, by name, with the reason.
    pub left_out: Vec<(String, String)>,
}

/// The source of a picture.
#[derive(Clone, Debug, PartialEq)]
pub(super) enum Source {
    /// A file that is copied or linked.
    File(PathBuf),
    /// A frame that is decoded.
    Decoded(FrameRef),
}

impl PlannedFrame {
    /// Whether the dataset gets a picture of it.
    const fn takes_picture(&self) -> bool {
        self.picture.is_some() || self.undistorted.is_some()
    }

    /// How many pictures of it the dataset gets.
    pub(super) fn num_pictures(&self) -> usize {
        usize::from(self.picture.is_some()) + usize::from(self.undistorted.is_some())
    }
}

impl Source {
    /// The image file or the video.
    fn file(&self) -> &Path {
        match self {
            Self::File(path) => path,
            Self::Decoded(FrameRef::Image(path) | FrameRef::Video { path, .. }) => path,
        }
    }

    /// The frame that is decoded for further pictures.
    pub fn frame_ref(&self) -> FrameRef {
        match self {
            Self::File(path) => FrameRef::image(path.as_path()),
            Self::Decoded(frame) => frame.clone(),
        }
    }
}

impl DatasetPlan {
    /// How many frames each split holds, in order; without splits the first holds all.
    pub fn counts(&self) -> [usize; 3] {
        count_by_split(self.frames.iter())
    }

    /// How many frames have a label of each origin.
    pub fn origins(&self) -> BTreeMap<LabelOrigin, usize> {
        let mut counts = BTreeMap::new();
        for frame in &self.frames {
            *counts.entry(frame.origin).or_default() += 1;
        }
        counts
    }

    /// The names of all pictures.
    pub(super) fn picture_names(&self) -> BTreeSet<&str> {
        let names = self
            .frames
            .iter()
            .flat_map(|frame| [&frame.picture, &frame.undistorted]);
        names.flatten().map(String::as_str).collect()
    }

    /// The number of pictures that are written.
    pub fn pictures(&self) -> usize {
        self.frames.iter().map(PlannedFrame::num_pictures).sum()
    }
}

/// How many frames each split has, in order. A frame without a split counts for the first.
pub(super) fn count_by_split<'a>(frames: impl Iterator<Item = &'a PlannedFrame>) -> [usize; 3] {
    let mut counts = [0; 3];
    for frame in frames {
        counts[frame.split.unwrap_or(Split::Train) as usize] += 1;
    }
    counts
}

/// Plans a dataset: its frames, the names of their pictures, and its size.
///
/// # Errors
/// No frame is left, or two pictures would have one name.
pub fn plan_dataset(
    at: DocumentAt<'_>,
    options: &DatasetOptions,
) -> Result<DatasetPlan, ExchangeError> {
    let mut left_out = Vec::new();
    let mut frames: Vec<(&Frame, PlannedFrame)> = Vec::new();
    let mut bytes = 0.0;
    let own_places = OwnPlaces::from_project(at.folder);
    for frame in at
        .document
        .frames
        .iter()
        .filter(|frame| is_chosen(frame, &options.frames))
    {
        match plan_frame(at, frame, options) {
            Ok((planned, _))
                if !options.outside
                    && planned.takes_picture()
                    && !own_places.hold(planned.source.file()) =>
            {
                let file = planned.source.file().display();
                left_out.push((
                    frame.name(),
                    format!("its picture {file} lies outside of the project; --outside-pictures takes it too"),
                ));
            }
            Ok((planned, size)) => {
                bytes += size;
                frames.push((frame, planned));
            }
            Err(why) => left_out.push((frame.name(), why)),
        }
    }
    if frames.is_empty() {
        let why = first_left_out(&left_out)
            .unwrap_or_else(|| "none has the requested status, camera and confidence".to_owned());
        return Err(ExchangeError::EmptyDataset { why });
    }
    if let Some(splitting) = options.splitting {
        let of: Vec<&Frame> = frames.iter().map(|(frame, _)| *frame).collect();
        // A folder for each split, below that of the pictures.
        for ((_, planned), part) in frames.iter_mut().zip(split(&of, splitting)) {
            planned.split = Some(part);
            for name in [&mut planned.picture, &mut planned.undistorted]
                .into_iter()
                .flatten()
            {
                *name = format!("{part}/{name}");
            }
        }
    }
    // Undistorted pictures lie below a folder of their own, which is a dataset in itself.
    for (_, planned) in &mut frames {
        planned.picture = planned
            .picture
            .as_ref()
            .map(|name| format!("images/{name}"));
        planned.undistorted = planned
            .undistorted
            .as_ref()
            .map(|name| format!("undistorted/images/{name}"));
    }
    refuse_same_names(&frames)?;
    let frames: Vec<PlannedFrame> = frames.into_iter().map(|(_, planned)| planned).collect();
    let mut plan = DatasetPlan {
        frames,
        left_out,
        picture_bytes: bytes as u64,
        notes: Vec::new(),
    };
    plan.notes = notes(at, &plan, options);
    Ok(plan)
}

/// The plan of a frame, and the estimated size of its pictures, bytes.
fn plan_frame(
    at: DocumentAt<'_>,
    frame: &Frame,
    options: &DatasetOptions,
) -> Result<(PlannedFrame, f64), String> {
    let origin = LabelOrigin::from_frame(frame).ok_or("it has neither clicks nor a camera")?;
    let source = source_of(at, frame, options)?;
    let has_camera = at.document.ptz_camera(frame).is_some();
    let area = f64::from(frame.image_size.width) * f64::from(frame.image_size.height);
    // The size of a picture that is made anew is a guess from its area; that of a copied file is
    // known.
    let decoded = area * options.picture_format.bytes_per_px();
    let mut bytes = 0.0;
    let is_left = options.pictures == Pictures::Left;
    // The name is needed for undistorted pictures even where the others stay where they are.
    let named = picture_name(frame, options.pictures, options.picture_format);
    let picture = if is_left { None } else { Some(named.clone()?) };
    if !is_left {
        bytes += match &source {
            Source::File(path) => {
                std::fs::metadata(path).map_or(0.0, |metadata| metadata.len() as f64)
            }
            Source::Decoded(_) => decoded,
        };
    }
    let undistorted = if options.undistorted && has_camera {
        bytes += decoded;
        Some(
            std::path::Path::new(&named?)
                .with_extension(options.picture_format.ending())
                .to_string_lossy()
                .into_owned(),
        )
    } else {
        None
    };
    let name = frame.name();
    Ok((
        PlannedFrame {
            id: frame.id.clone(),
            split: None,
            origin,
            picture,
            undistorted,
            name,
            source,
        },
        bytes,
    ))
}

/// The source of a frame's pixels, if it exists and has the stated size.
fn source_of(
    at: DocumentAt<'_>,
    frame: &Frame,
    options: &DatasetOptions,
) -> Result<Source, String> {
    let picture = frame.picture_source(at.folder).ok_or("it has no picture");
    // Extracted pictures are decoded from the video where there is one, else from the image file.
    // Otherwise an image file is taken as it is, and a video only where there is none.
    let source = match (&frame.video, options.pictures) {
        (Some(video), Pictures::Extracted) => {
            let index =
                usize::try_from(video.frame_index).map_err(|_| "its number is too large")?;
            Source::Decoded(FrameRef::video(video.file_path(at.folder), index))
        }
        (_, Pictures::Extracted) => Source::Decoded(picture?),
        _ => match picture? {
            FrameRef::Image(path) => Source::File(path.to_path_buf()),
            video @ FrameRef::Video { .. } => Source::Decoded(video),
        },
    };
    let needs_picture = options.pictures != Pictures::Left || options.undistorted;
    // Sizes and files are checked before anything is written: the labels are in px of the stated
    // size. The size of a video shows when it is decoded.
    match source.frame_ref() {
        _ if !needs_picture => {}
        FrameRef::Image(path) => {
            let found = image_size(&path).map_err(|error| error.to_string())?;
            if found != frame.image_size {
                return Err(other_size(frame, found));
            }
        }
        FrameRef::Video { path, .. } if !path.is_file() => {
            return Err(format!("its video {} is not there", path.display()));
        }
        FrameRef::Video { .. } => {}
    }
    Ok(source)
}

/// The message about a picture whose size differs from the document's.
pub(super) fn other_size(frame: &Frame, found: ImageSize) -> String {
    let stated = frame.image_size;
    format!(
        "its picture is {} × {} px, the document says {} × {}",
        found.width, found.height, stated.width, stated.height
    )
}

fn refuse_same_names(frames: &[(&Frame, PlannedFrame)]) -> Result<(), ExchangeError> {
    let mut seen: BTreeMap<String, String> = BTreeMap::new();
    for (frame, planned) in frames {
        for name in [&planned.picture, &planned.undistorted]
            .into_iter()
            .flatten()
        {
            // Two names that differ only in case are one file on many systems.
            if let Some(first) = seen.insert(name.to_lowercase(), frame.name()) {
                return Err(ExchangeError::SameName {
                    name: name.clone(),
                    first,
                    second: frame.name(),
                });
            }
        }
    }
    Ok(())
}

fn notes(at: DocumentAt<'_>, plan: &DatasetPlan, options: &DatasetOptions) -> Vec<String> {
    let mut notes = Vec::new();
    if let Some(size) = at.document.field.assumed_size() {
        notes.push(format!(
            "the field's size of {size} is assumed, not confirmed"
        ));
    }
    if let Some(splitting) = options.splitting {
        let counts = plan.counts();
        let empty: Vec<&str> = Split::ALL
            .into_iter()
            .filter(|split| splitting.shares[*split as usize] > 0 && counts[*split as usize] == 0)
            .map(Into::into)
            .collect();
        if !empty.is_empty() {
            let by = splitting.by;
            notes.push(format!(
                "too few groups to split (--split-by {by}): none is left for {}",
                empty.join(", ")
            ));
        }
    }
    let planned = plan
        .frames
        .iter()
        .filter_map(|frame| Some(&**at.document.frames.by_id(&frame.id)?));
    notes.extend(off_paint_note(planned));
    let own_places = OwnPlaces::from_project(at.folder);
    let outside = plan
        .frames
        .iter()
        .filter(|frame| frame.takes_picture() && !own_places.hold(frame.source.file()));
    let outside: Vec<String> = outside
        .map(|frame| frame.source.file().display().to_string())
        .collect();
    if let Some(first) = outside.first() {
        notes.push(format!(
            "{} from outside of the project, the first is {first}",
            pluralise(outside.len(), "picture")
        ));
    }
    let count = plan
        .frames
        .iter()
        .filter(|planned| {
            let frame = at.document.frames.by_id(&planned.id);
            frame.is_some_and(|frame| is_unreviewed(frame, planned.origin))
        })
        .count();
    if count > 0 {
        notes.push(format!(
            "{} with a camera that has not been reviewed",
            pluralise(count, "frame")
        ));
    }
    let left_distorted = plan
        .frames
        .iter()
        .filter(|frame| frame.undistorted.is_none())
        .count();
    if options.undistorted && left_distorted > 0 {
        notes.push(format!(
            "{} without a camera and so without an undistorted picture",
            pluralise(left_distorted, "frame")
        ));
    }
    notes
}

/// Whether a frame has a camera that no person clicked or accepted.
fn is_unreviewed(frame: &Frame, origin: LabelOrigin) -> bool {
    match frame.status {
        FrameStatus::Reference => false,
        FrameStatus::Suggested => frame.ptz.is_some(),
        _ => matches!(
            origin,
            LabelOrigin::Tracked | LabelOrigin::Suggested | LabelOrigin::Interpolated
        ),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::document::{Solution, SolutionSource};
    use crate::exchange::tests::reference;

    #[test]
    fn a_suggestion_of_any_source_is_not_reviewed_and_a_reference_is() {
        let mut frame = (*reference().frames[0]).clone();
        for source in [
            SolutionSource::Markings,
            SolutionSource::Import,
            SolutionSource::Interpolated,
        ] {
            frame.solution = Some(Solution {
                source: Some(source),
                ..Solution::default()
            });
            let origin = LabelOrigin::from_frame(&frame).unwrap();
            frame.status = FrameStatus::Suggested;
            assert!(is_unreviewed(&frame, origin), "{origin}");
            frame.status = FrameStatus::Reference;
            assert!(!is_unreviewed(&frame, origin), "{origin}");
        }
    }
}
