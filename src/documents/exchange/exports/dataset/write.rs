//! Writes a dataset into a temporary folder beside the target, which is renamed at the end.

use super::super::choose::first_left_out;
use super::card::{Card, card};
use super::field_lines::fields_json;
use super::frames_table::frames_table;
use super::old_dataset::{DOCUMENT, MANIFEST, OldDataset};
use super::options::{DatasetOptions, Pictures};
use super::pictures::{Folder, encode_picture};
use super::plan::{DatasetDone, DatasetPlan, PlannedFrame, Source, count_by_split, other_size};
use super::split::Split;
use super::templates::with_templates;
use super::undistorted::{undistort_document, undistort_picture};
use crate::document::{
    Camera, Document, DocumentAt, Frame, FrameId, Shot, ShotEnd, document_from_bytes,
    document_to_string, resolve_path,
};
use crate::exchange::error::ExchangeError;
use crate::exchange::files::{base_name, cannot_write};
use std::collections::BTreeMap;
use std::path::{Path, PathBuf};
use touchline_assets::DATASET_LOADER;
use touchline_core::files::{
    folder_of, follow_link, refuse_other_files, replace_folder, temporary_folder_in,
};
use touchline_core::progress::{Progress, Share};
use touchline_vision::media::{Picture, ReadFrames, sha256_of_file, video_file_id};

/// The files that every dataset has.
const ALWAYS_WRITTEN: [&str; 7] = [
    DOCUMENT,
    MANIFEST,
    "README.md",
    "frames.csv",
    "fields.json",
    "schema.json",
    "touchline_dataset.py",
];

/// Writes a dataset as it was planned. A step of `progress` counts pictures.
///
/// # Errors
/// `folder` is not a dataset, or it is one and `force` was not given, or it contains files that the
/// program did not write; it was cancelled; a file cannot be written. In these cases nothing is
/// left behind, and the previous contents are unchanged.
pub fn write_dataset(
    at: DocumentAt<'_>,
    plan: &DatasetPlan,
    options: &DatasetOptions,
    reader: &mut dyn ReadFrames,
    folder: &Path,
    force: bool,
    progress: &Progress<'_, Share>,
) -> Result<DatasetDone, ExchangeError> {
    let folder = &follow_link(folder);
    let old = OldDataset::read(folder, force)?;
    // Check before the work; the final contents are checked again.
    let pictures = plan.picture_names();
    refuse_other_files(folder, &|name, path| {
        ALWAYS_WRITTEN.contains(&name) || pictures.contains(name) || old.wrote(name, path)
    })?;
    let temporary =
        temporary_folder_in(folder_of(folder)).map_err(|source| cannot_write(folder, source))?;
    // Pictures first, because a frame of which they cannot be read is not in the documents and
    // tables that follow. A break returns early; the temporary folder is then deleted.
    let mut files = Folder::new(temporary.path(), folder);
    let of = plan.pictures();
    let mut written = Written {
        of_frame: BTreeMap::new(),
        left_out: plan.left_out.clone(),
        pictures: 0,
        videos: BTreeMap::new(),
    };
    for frame in &plan.frames {
        written.add(at, frame, options, reader, &mut files)?;
        if progress.report(Share::new(written.pictures, of)).is_break() {
            return Err(ExchangeError::Stopped);
        }
    }
    // The frames that the dataset has in the end, in the order of the plan.
    let kept: Vec<&PlannedFrame> = plan
        .frames
        .iter()
        .filter(|frame| written.of_frame.contains_key(&frame.id))
        .collect();
    if kept.is_empty() {
        let why = first_left_out(&written.left_out).unwrap_or_default();
        return Err(ExchangeError::EmptyDataset { why });
    }
    let (document, templates) = with_templates(at)?;
    for (name, bytes) in &templates {
        files.write(name, bytes)?;
    }
    let mut original = document.into_dataset();
    original.state_ground(at.ground_of_frames()?);
    let chosen = chosen(&original, &written.of_frame);
    // Templates are copies in the dataset, and their paths start from its folder. So the fields of
    // `chosen` can be loaded from there alone, and their paths are not relocated.
    let in_dataset = temporary.path();
    let dataset = if options.pictures == Pictures::Left {
        let relocated = chosen.clone().relocate(at.folder, &resolve_path(folder));
        with_fields_of(relocated, &chosen)
    } else {
        with_pictures(&chosen, &kept, &written, |frame, hashes| {
            Some((frame.picture.as_deref()?, hashes.picture.as_deref()?))
        })
    };
    write_document(&mut files, DOCUMENT, &dataset)?;
    if options.undistorted {
        // The document of the undistorted pictures; templates are one folder up.
        let plain = with_pictures(
            &undistort_document(&chosen),
            &kept,
            &written,
            |frame, hashes| {
                Some((
                    frame.undistorted.as_deref()?.strip_prefix("undistorted/")?,
                    hashes.undistorted.as_deref()?,
                ))
            },
        );
        write_document(
            &mut files,
            "undistorted/dataset.json",
            &templates_above(plain),
        )?;
    }
    // `chosen` has the original paths of videos and folders, which name the matches.
    let rows = kept.iter().filter_map(|planned| {
        let of_dataset: &Frame = dataset.frames.by_id(&planned.id)?;
        Some((*planned, of_dataset, &**chosen.frames.by_id(&planned.id)?))
    });
    files.write(
        "frames.csv",
        frames_table(&rows.collect::<Vec<_>>()).as_bytes(),
    )?;
    for split in Split::ALL
        .into_iter()
        .filter(|_| options.splitting.is_some())
    {
        let of_split = kept.iter().filter(|frame| frame.split == Some(split));
        let names = of_split.filter_map(|frame| {
            Some(format!(
                "{}\n",
                dataset.frames.by_id(&frame.id)?.image.as_deref()?
            ))
        });
        files.write(
            &format!("splits/{split}.txt"),
            names.collect::<String>().as_bytes(),
        )?;
    }
    let done = DatasetDone {
        frames: kept.len(),
        pictures: written.pictures,
        counts: count_by_split(kept.iter().copied()),
        left_out: written.left_out,
    };
    let card = card(&Card {
        dataset: dataset.at(at.folder),
        original: chosen.at(in_dataset),
        frames: &kept,
        options,
        done: &done,
    })?;
    files.write("README.md", card.as_bytes())?;
    files.write(
        "fields.json",
        fields_json(chosen.at(in_dataset))?.as_bytes(),
    )?;
    files.write("schema.json", crate::document::SCHEMA.as_bytes())?;
    files.write("touchline_dataset.py", DATASET_LOADER.as_bytes())?;
    // The manifest is of all files before it, so that it is written last. Then the folder gets its
    // name.
    let manifest = files.manifest();
    files.write(MANIFEST, manifest.as_bytes())?;
    let names = files.into_names();
    replace_folder(temporary, folder, &|name, path| {
        names.contains(name) || old.wrote(name, path)
    })?;
    Ok(done)
}

/// The hashes of a frame's pictures.
#[derive(Default)]
struct Hashes {
    picture: Option<String>,
    undistorted: Option<String>,
}

/// What has been written so far.
struct Written {
    of_frame: BTreeMap<FrameId, Hashes>,
    left_out: Vec<(String, String)>,
    pictures: usize,
    /// What the videos on the disk are recognised by.
    videos: BTreeMap<PathBuf, Option<String>>,
}

impl Written {
    /// Writes the pictures of a frame; if one cannot be read, the frame is left out.
    fn add(
        &mut self,
        at: DocumentAt<'_>,
        planned: &PlannedFrame,
        options: &DatasetOptions,
        reader: &mut dyn ReadFrames,
        files: &mut Folder<'_>,
    ) -> Result<(), ExchangeError> {
        let Some(frame) = at.document.frames.by_id(&planned.id) else {
            return Ok(());
        };
        if self.is_of_other_video(frame, at.folder) {
            let why =
                "its video is not the one that was labelled; put that one back, or label it anew";
            self.left_out.push((planned.name.clone(), why.to_owned()));
            return Ok(());
        }
        match write_pictures(at, planned, frame, options, reader, files)? {
            Ok(hashes) => {
                self.pictures += planned.num_pictures();
                self.of_frame.insert(planned.id.clone(), hashes);
            }
            Err(why) => self.left_out.push((planned.name.clone(), why)),
        }
        Ok(())
    }

    /// Whether a frame has its picture from a video that was replaced by another one.
    fn is_of_other_video(&mut self, frame: &Frame, folder: &Path) -> bool {
        let Some(video) = frame.video.as_ref().filter(|_| frame.image.is_none()) else {
            return false;
        };
        let path = video.file_path(folder);
        let found = self.videos.entry(path);
        let found = found.or_insert_with_key(|path| video_file_id(path).ok());
        video.is_of_other_file(found.as_deref())
    }
}

/// Writes the pictures of a frame, or returns why they cannot be read.
fn write_pictures(
    at: DocumentAt<'_>,
    planned: &PlannedFrame,
    frame: &Frame,
    options: &DatasetOptions,
    reader: &mut dyn ReadFrames,
    files: &mut Folder<'_>,
) -> Result<Result<Hashes, String>, ExchangeError> {
    const CHANGED: &str = "its picture changed since it was labelled";
    let mut hashes = Hashes::default();
    let is_copied = matches!(
        (&planned.picture, &planned.source),
        (Some(_), Source::File(_))
    );
    // The hash of a copied file is compared after copying; here only other pictures are checked.
    if !is_copied && has_changed(at, frame) {
        return Ok(Err(CHANGED.to_owned()));
    }
    let is_decoded = matches!(
        (&planned.picture, &planned.source),
        (Some(_), Source::Decoded(_))
    );
    // Decoded once for both pictures. A file that is copied is decoded only for the undistorted
    // one.
    let mut pixels = None;
    if is_decoded || planned.undistorted.is_some() {
        match read(planned, frame, reader) {
            Ok(picture) => pixels = Some(picture),
            Err(why) => return Ok(Err(why)),
        }
    }
    match (&planned.picture, &planned.source, &pixels) {
        (Some(name), Source::File(path), _) => {
            let taken = files.take_over(name, path, options.pictures == Pictures::Linked);
            let hash = match taken {
                Err(error @ ExchangeError::Read { .. }) => return Ok(Err(error.to_string())),
                taken => taken?,
            };
            if states_other(frame, &hash) {
                files.remove(name)?;
                return Ok(Err(CHANGED.to_owned()));
            }
            hashes.picture = Some(hash);
        }
        (Some(name), Source::Decoded(_), Some(pixels)) => {
            hashes.picture = Some(files.write(
                name,
                &encode_picture(pixels, options.picture_format.image_format())?,
            )?);
        }
        _ => {}
    }
    if let (Some(name), Some(pixels), Some(camera)) =
        (&planned.undistorted, &pixels, at.document.ptz_camera(frame))
    {
        let straight = undistort_picture(pixels, &camera)?;
        hashes.undistorted = Some(files.write(
            name,
            &encode_picture(&straight, options.picture_format.image_format())?,
        )?);
    }
    Ok(Ok(hashes))
}

/// Whether the image file of a frame exists and is not the one that was labelled.
fn has_changed(at: DocumentAt<'_>, frame: &Frame) -> bool {
    let Some(path) = frame
        .image_path(at.folder)
        .filter(|path| frame.sha256.is_some() && path.is_file())
    else {
        return false;
    };
    sha256_of_file(&path).is_ok_and(|hash| states_other(frame, &hash))
}

/// Whether a frame states another SHA-256.
fn states_other(frame: &Frame, hash: &str) -> bool {
    frame
        .sha256
        .as_deref()
        .is_some_and(|stated| !stated.eq_ignore_ascii_case(hash))
}

/// The pixels of a frame, if they can be read and have the stated size.
fn read(
    planned: &PlannedFrame,
    frame: &Frame,
    reader: &mut dyn ReadFrames,
) -> Result<Picture, String> {
    let picture = reader
        .read(&planned.source.frame_ref())
        .map_err(|error| error.to_string())?;
    if picture.size() == frame.image_size {
        Ok(picture)
    } else {
        Err(other_size(frame, picture.size()))
    }
}

/// The document of some frames, with the cameras and shots that they need.
fn chosen(document: &Document, frames: &BTreeMap<FrameId, Hashes>) -> Document {
    // Cameras and shots of frames that are not in the dataset would refer to nothing.
    let mut chosen = document.clone();
    chosen.frames.retain(|frame| frames.contains_key(&frame.id));
    chosen
        .cameras
        .retain(|camera| chosen.frames.iter().any(|frame| frame.camera == camera.id));
    // A plain number refers to the first video of the document.
    let keeps_first_video = chosen.frames.first_video() == document.frames.first_video();
    chosen.shots.retain(|shot: &Shot| {
        [&shot.from, &shot.to].into_iter().all(|end| match end {
            ShotEnd::Frame(id) => frames.contains_key(id),
            ShotEnd::VideoFrame(_) => keeps_first_video,
        })
    });
    chosen
}

/// The document with the pictures of a dataset and their hashes; frames without a picture are
/// removed.
fn with_pictures<'a>(
    document: &Document,
    frames: &[&'a PlannedFrame],
    written: &'a Written,
    picture_of: impl Fn(&'a PlannedFrame, &'a Hashes) -> Option<(&'a str, &'a str)>,
) -> Document {
    let mut document = document.clone();
    let pictures: BTreeMap<&FrameId, (&str, &str)> = frames
        .iter()
        .filter_map(|frame| {
            Some((
                &frame.id,
                picture_of(frame, written.of_frame.get(&frame.id)?)?,
            ))
        })
        .collect();
    document
        .frames
        .retain(|frame| pictures.contains_key(&frame.id));
    for frame in &mut document.frames {
        if let Some((picture, hash)) = pictures.get(&frame.id) {
            (frame.image, frame.sha256) = (Some((*picture).to_owned()), Some((*hash).to_owned()));
        }
        if let Some(video) = &mut frame.video {
            // The location of the video on this machine is useless to others.
            video.path = base_name(&video.path).to_owned();
        }
    }
    document
}

/// The document with the fields of another one, which has the same cameras.
fn with_fields_of(mut document: Document, other: &Document) -> Document {
    document.field.clone_from(&other.field);
    for (camera, of_other) in document.cameras.iter_mut().zip(&other.cameras) {
        let camera: &mut Camera = camera;
        camera.field.clone_from(&of_other.field);
    }
    document
}

/// The document of a subfolder of a dataset: its own templates are one folder up.
fn templates_above(mut document: Document) -> Document {
    for field in document.fields_mut().filter(|field| field.is_file()) {
        field.template = format!("../{}", field.template);
    }
    document
}

/// Writes a document and verifies it by reading it back.
fn write_document(
    files: &mut Folder<'_>,
    name: &str,
    document: &Document,
) -> Result<(), ExchangeError> {
    let text = document_to_string(document)?;
    // The text is compared, not the values: what the reader drops or rounds shows there.
    let again =
        document_from_bytes(text.as_bytes()).map_err(|source| ExchangeError::NoDocument {
            file: name.to_owned(),
            source,
        })?;
    if again.frames.len() != document.frames.len() || document_to_string(&again)? != text {
        let frame = name.to_owned();
        return Err(ExchangeError::ReadsBackOtherwise {
            frame,
            format: crate::exchange::Format::Json,
        });
    }
    files.write(name, text.as_bytes()).map(drop)
}

#[cfg(test)]
mod tests {
    use super::super::plan_dataset;
    use super::*;
    use crate::exchange::tests::awkward;
    use std::fs;
    use std::ops::ControlFlow;
    use touchline_assets::FIELDS;
    use touchline_vision::media::{FrameRef, MediaError};

    /// The reader of a dataset without pictures.
    struct NoFrames;

    impl ReadFrames for NoFrames {
        fn read(&mut self, frame: &FrameRef) -> Result<Picture, MediaError> {
            panic!("{frame:?} is read")
        }
    }

    #[test]
    fn a_template_of_the_users_own_is_found_in_the_dataset() {
        let place = tempfile::tempdir().unwrap();
        let (project, set) = (place.path().join("project"), place.path().join("set"));
        fs::create_dir(&project).unwrap();
        fs::write(project.join("mine.json"), FIELDS[0].1).unwrap();
        let mut document = awkward();
        document.field.template = "mine.json".to_owned();
        let options = DatasetOptions {
            pictures: Pictures::Left,
            ..DatasetOptions::default()
        };
        let plan = plan_dataset(document.at(&project), &options).unwrap();
        let progress = Progress::new(|_: Share| ControlFlow::Continue(()));
        let done = write_dataset(
            document.at(&project),
            &plan,
            &options,
            &mut NoFrames,
            &set,
            false,
            &progress,
        )
        .unwrap();
        assert_eq!(done.frames, 12);
        let dataset = document_from_bytes(&fs::read(set.join(DOCUMENT)).unwrap()).unwrap();
        assert_eq!(dataset.field.template, "fields/mine.json");
        assert_eq!(dataset.field.model(&set).unwrap().length_m, 100.0);
        let image = dataset.frames[0].image.as_deref();
        assert_eq!(image, Some("../project/images/0001.jpg"));
    }
}
