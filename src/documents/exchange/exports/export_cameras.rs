//! Export of cameras to a foreign format: chooses frames, measures losses, writes the files in
//! memory and reads them back.

use super::choose::{NOT_SOLVED, is_chosen, nothing, other_proportions, refuse_same_names};
use super::exported::Exported;
use super::loss::{crown_off_px, farthest_landmark, loss_between};
use super::stage::{in_stage, in_world};
use crate::document::{
    Camera, Click, Document, DocumentAt, Fields, Frame, Ground, SolutionSource, Stage,
};
use crate::exchange::cameras::camera_format::{CameraFormat, WriteContext};
use crate::exchange::cameras::frame_camera::{FrameCamera, FrameProjection, Pinhole, Record};
use crate::exchange::cameras::held::refuse_mixed_sequence;
use crate::exchange::cameras::into_document::camera_of;
use crate::exchange::cameras::picture_size::has_same_proportions;
use crate::exchange::error::ExchangeError;
use crate::exchange::files::Files;
use crate::exchange::format::Format;
use crate::exchange::format_options::{Direction, FormatOption};
use crate::exchange::options::ExportOptions;
use crate::exchange::rate::Rate;
use std::collections::BTreeMap;
use std::sync::Arc;
use touchline_core::field::FieldModel;
use touchline_core::geometry::{ImagePoint, ImageSize, pluralise};

/// A solved frame as exchange formats store it; none where it is not solved.
fn frame_camera(
    document: &Document,
    frame: &Frame,
    size: Option<ImageSize>,
    ground: Option<Ground>,
) -> Option<FrameCamera> {
    let camera = document.ptz_camera(frame)?;
    // Whatever is in px belongs to a picture of one width: at another one it scales with it, σ and
    // residuals, too. Angles and coefficients of the lens stay.
    let scale = size.map_or(1.0, |size| {
        f64::from(size.width) / f64::from(frame.image_size.width)
    });
    let solution = frame.solution.as_ref();
    let variances = solution
        .and_then(|solution| solution.covariance)
        .map(|covariance| covariance.diagonal());
    Some(FrameCamera {
        labels_name: frame.labels_name.clone(),
        image: frame.image.clone(),
        camera: Some(frame.camera.as_str().to_owned()),
        video: frame.video.as_ref().map(|video| video.path.clone()),
        frame_index: frame.video_frame_index(),
        pts_s: frame.video.as_ref().and_then(|video| video.pts_s),
        record: Record {
            status: frame.status,
            source: solution.and_then(|solution| solution.source),
            ptz: Some(camera.ptz()),
            // A damaged document may state a negative variance.
            sigma: variances.map(|v| {
                [
                    v.x.max(0.0).sqrt(),
                    v.y.max(0.0).sqrt(),
                    v.z.max(0.0).sqrt() * scale,
                ]
            }),
            worst_corner_sigma_px: solution
                .and_then(|solution| solution.worst_corner_sigma_px)
                .map(|sigma_px| sigma_px * scale),
            rms_px: solution
                .and_then(|solution| solution.rms_px)
                .map(|rms_px| rms_px * scale),
            confidence: solution.and_then(|solution| solution.confidence),
            ground,
            clicks: frame
                .clicks
                .iter()
                .filter_map(|click| landmark_click(click, scale))
                .collect(),
        },
        ..FrameCamera::new(
            &frame.name(),
            Some(size.unwrap_or(frame.image_size)),
            FrameProjection::Camera(Pinhole::from_ptz_camera(&camera).scale_by(scale)),
        )
    })
}

/// The name and the place (px of the scaled picture) of a click on a landmark. None for a click on
/// a line, and for one that the solve does not use.
fn landmark_click(click: &Click, scale: f64) -> Option<(String, ImagePoint)> {
    let target = click
        .target
        .as_ref()
        .filter(|target| target.line().is_none() && !click.check)?;
    Some((
        target.as_str().to_owned(),
        ImagePoint::new(click.image.x * scale, click.image.y * scale),
    ))
}

/// Stores in each frame the rate of its video.
fn note_rates(frames: &mut [FrameCamera]) {
    let mut of_videos: BTreeMap<&str, Vec<&FrameCamera>> = BTreeMap::new();
    for frame in &*frames {
        if let Some(video) = &frame.video {
            of_videos.entry(video.as_str()).or_default().push(frame);
        }
    }
    let rates: BTreeMap<String, Option<Rate>> = of_videos
        .into_iter()
        .map(|(video, frames)| (video.to_owned(), rate_of(&frames)))
        .collect();
    for frame in frames {
        frame.rate = frame.video.as_ref().and_then(|video| *rates.get(video)?);
    }
}

/// The rate of all frames; none where it is not known or they differ.
fn common_rate(frames: &[FrameCamera]) -> Option<Rate> {
    let first = frames.first()?.rate?;
    frames
        .iter()
        .all(|frame| frame.rate == Some(first))
        .then_some(first)
}

/// The frame rate of a video, from the numbers and times of its frames, if it is a usual one.
fn rate_of(frames: &[&FrameCamera]) -> Option<Rate> {
    // The first and the last frame, because a long base averages the rounding of the times, which
    // some containers store in steps of 1/1000 s. A video of changing rate has no usual one; then
    // there is none.
    let times: Vec<(u64, f64)> = frames
        .iter()
        .filter_map(|frame| Some((frame.frame_index?, frame.pts_s?)))
        .collect();
    let &(first_index, first_s) = times.iter().min_by_key(|(index, _)| *index)?;
    let &(last_index, last_s) = times.iter().max_by_key(|(index, _)| *index)?;
    let (first_index, last_index) = (first_index as f64, last_index as f64);
    if first_index == last_index {
        // A single frame gives the rate of a video that begins at time zero.
        return Rate::nearest(last_index / last_s);
    }
    Rate::nearest((last_index - first_index) / (last_s - first_s))
}

/// The cameras of a document in a format, verified by reading them back.
///
/// # Errors
/// There is nothing to export, two frames would have one name, or the files do not read back as
/// they were meant.
pub fn export_cameras(
    at: DocumentAt<'_>,
    format: Format,
    camera_format: &dyn CameraFormat,
    options: &ExportOptions,
) -> Result<Exported, ExchangeError> {
    let document = at.document;
    let fields = Fields::from_document(at)?;
    // Chosen frames that cannot be written are left out with a reason each: an export of the others
    // is worth more than none.
    let mut left_out = Vec::new();
    let mut chosen: Vec<FrameCamera> = Vec::new();
    let mut of_field: Option<Arc<FieldModel>> = None;
    // From all frames, because the neighbours of those that are chosen say how speeds come out.
    let mut grounds = match format {
        Format::Csv => at.ground_of_frames()?,
        _ => Vec::new(),
    };
    grounds.resize(document.frames.len(), None);
    for (frame, ground) in document
        .frames
        .iter()
        .zip(grounds)
        .filter(|(frame, _)| is_chosen(frame, &options.frames))
    {
        let Some(camera) = frame_camera(document, frame, options.size, ground) else {
            left_out.push((frame.name(), NOT_SOLVED.to_owned()));
            continue;
        };
        // A camera is rescaled by one factor, so that the proportions must agree.
        if let Some(size) = options.size
            && !has_same_proportions(size, frame.image_size)
        {
            left_out.push((frame.name(), other_proportions(frame.image_size)));
            continue;
        }
        // A file is of one field: its landmarks verify it, and formats state its size once.
        let field = fields.for_frame(document, frame);
        if of_field.as_ref().is_some_and(|known| **known != **field) {
            left_out.push((
                frame.name(),
                "it shows a different field from the frames before it; choose a camera".to_owned(),
            ));
            continue;
        }
        of_field.get_or_insert_with(|| Arc::clone(field));
        chosen.push(camera);
    }
    let Some(field) = of_field else {
        return Err(nothing(format, &left_out));
    };
    if let Some(sequence) = camera_format.sequence() {
        refuse_mixed_sequence(&chosen, format, sequence)?;
    }
    note_rates(&mut chosen);
    // What the options leave open, the document may state of its cameras; only what they have in
    // common counts, because a file has one sensor.
    let options = &ExportOptions {
        sensor_width_mm: options
            .sensor_width_mm
            .or_else(|| common_value(document, &chosen, |camera| camera.sensor_width_mm)),
        ..options.clone()
    };
    let context = WriteContext {
        options,
        field: &field,
        rate: options.rate.or_else(|| common_rate(&chosen)),
    };
    // The frames as the format can store them. They are what the files are compared with: the
    // difference to `chosen` is the loss, which is no error.
    let mut held = Vec::with_capacity(chosen.len());
    for (index, frame) in chosen.iter().enumerate() {
        let kept = camera_format.hold(frame, index, &context);
        held.push(kept.map_err(|why| ExchangeError::CannotHold {
            frame: frame.name.clone(),
            format,
            why,
        })?);
    }
    // Files are read back by name, and two frames of one name would overwrite each other.
    let names = held.iter().zip(&chosen);
    refuse_same_names(names.map(|(kept, frame)| (kept.name.as_str(), frame.name.as_str())))?;
    // Tracks are written in the axes of a studio's stage and read back into the field's, so that
    // the comparison covers this conversion.
    let wanted = options
        .stage
        .clone()
        .or_else(|| common_value(document, &chosen, |camera| camera.stage.clone()));
    let stage = wanted
        .as_ref()
        .filter(|_| format.takes(FormatOption::StageOrigin, Direction::Export));
    let files = match stage {
        Some(stage) => {
            let staged: Vec<FrameCamera> =
                held.iter().map(|frame| in_stage(frame, stage)).collect();
            camera_format.write(&staged, &context)?
        }
        None => camera_format.write(&held, &context)?,
    };
    let proof = Proof {
        format,
        of: camera_format,
        stage,
    };
    // Before anything reaches the disk: a file that reads back otherwise is a fault of this
    // program.
    let worst_px = if format.is_proved() {
        proof.worst_px(&files, &held, &context)?
    } else {
        0.0
    };
    let mut notes = camera_format.notes(&held, &context);
    notes.extend(stage.map(stage_note));
    notes.extend(interpolation_note(&held));
    notes.extend(crown_note(&chosen, &field));
    if let Some(size) = document.field.assumed_size() {
        notes.push(format!(
            "the field's size of {size} is assumed, not confirmed"
        ));
    }
    Ok(Exported {
        format,
        frames: held.len(),
        left_out,
        loss: loss_between(&chosen, &held, &field),
        notes,
        worst_px,
        in_takes: false,
        dataset: None,
        files,
    })
}

/// A value that the document states equally for the cameras of all these frames.
fn common_value<T: PartialEq>(
    document: &Document,
    frames: &[FrameCamera],
    of: impl Fn(&Camera) -> Option<T>,
) -> Option<T> {
    // Frames without a statement count as a different value: the first `?` is of no frame at all,
    // the second of a first frame without one.
    let mut stated = frames
        .iter()
        .map(|frame| of(document.camera(&frame.camera.as_deref()?.into())?));
    let first = stated.next()??;
    stated
        .all(|other| other.as_ref() == Some(&first))
        .then_some(first)
}

/// The note about the error of readers that assume flat ground.
fn crown_note(frames: &[FrameCamera], field: &FieldModel) -> Option<String> {
    let crown_m = field.crown_m;
    (crown_m != 0.0).then(|| {
        let off_px = crown_off_px(frames, field);
        format!(
            "not held: the crown of {crown_m:.2} m; on flat ground points of the field are up to {off_px:.1} px away"
        )
    })
}

/// The note about the axes of a track.
fn stage_note(stage: &Stage) -> String {
    let Stage {
        origin_m,
        heading_deg,
        ..
    } = stage;
    format!(
        "it is in the axes of the stage: origin at ({}, {}, {}) m of the field, heading \
         {heading_deg}°",
        origin_m.x, origin_m.y, origin_m.z
    )
}

/// The note about frames with interpolated cameras, so that they are not mistaken for labels.
fn interpolation_note(frames: &[FrameCamera]) -> Option<String> {
    let numbers: Vec<u64> = frames
        .iter()
        .filter(|frame| frame.record.source == Some(SolutionSource::Interpolated))
        .filter_map(|frame| frame.frame_index)
        .collect();
    let (first, last) = (numbers.first()?, numbers.last()?);
    Some(format!(
        "interpolated: {}, the first {first}, the last {last}",
        pluralise(numbers.len(), "frame")
    ))
}

/// The verification of an export.
struct Proof<'a> {
    format: Format,
    of: &'a dyn CameraFormat,
    /// The stage in whose axes it is written.
    stage: Option<&'a Stage>,
}

impl Proof<'_> {
    /// Reads the files back, as frames and as a document, and compares every landmark. Returns the
    /// largest distance, px.
    fn worst_px(
        &self,
        files: &Files,
        held: &[FrameCamera],
        context: &WriteContext<'_>,
    ) -> Result<f64, ExchangeError> {
        let Proof { of, stage, .. } = *self;
        // With the options that a careful user would give: size, zoom and sensor of this export.
        let reading = of.reading(held, context.options);
        let mut read = of.read(files, &reading)?;
        if let Some(stage) = stage {
            read = read.iter().map(|frame| in_world(frame, stage)).collect();
        }
        // Keep only one copy of each frame: a long video has many.
        let is_complete = read.len() == held.len();
        let mut by_name: BTreeMap<String, FrameCamera> = read
            .into_iter()
            .map(|frame| (frame.name.clone(), frame))
            .collect();
        // First, frame by frame as the file states them.
        let mut worst_px = 0.0_f64;
        let mut views = Vec::with_capacity(held.len());
        for kept in held {
            let again = by_name
                .remove(&kept.name)
                .filter(|again| is_complete && again.unreadable.is_none())
                .ok_or_else(|| self.reads_back_otherwise(kept))?;
            worst_px = worst_px.max(self.compare(kept, &again, context.field)?);
            if let (Some(size), FrameProjection::Camera(_) | FrameProjection::Lens(_)) =
                (kept.size, &again.shown)
                && let Ok(view) = camera_of(&again, size)
            {
                views.push((again, size, view));
            }
        }
        // Also verify the document made of them: there frames share a base and keep only pan, tilt
        // and focal length. Formats of homographies give no views and no document; others have a
        // view for each frame, so that both lists run in step.
        let document = of.document(reading.field, &views);
        if let Some(first) = held
            .first()
            .filter(|_| document.frames.len() != views.len())
        {
            return Err(self.reads_back_otherwise(first));
        }
        drop(views);
        for (kept, frame) in held.iter().zip(&document.frames) {
            if matches!(kept.shown, FrameProjection::Lens(_)) {
                continue;
            }
            let camera = document
                .ptz_camera(frame)
                .map(|camera| FrameProjection::Camera(Pinhole::from_ptz_camera(&camera)));
            let again = FrameCamera {
                shown: camera.ok_or_else(|| self.reads_back_otherwise(kept))?,
                ..kept.clone()
            };
            worst_px = worst_px.max(self.compare(kept, &again, context.field)?);
        }
        Ok(worst_px)
    }

    /// Compares a frame with what was read back of it. Returns the largest distance of a landmark,
    /// px.
    fn compare(
        &self,
        kept: &FrameCamera,
        again: &FrameCamera,
        field: &FieldModel,
    ) -> Result<f64, ExchangeError> {
        // Without a pose no landmark can be compared: the numbers of the lens are, exactly, because
        // formats with such frames keep all digits.
        if let (FrameProjection::Lens(before), lens) = (&kept.shown, again.shown)
            && lens != FrameProjection::Lens(*before)
        {
            return Err(self.reads_back_otherwise(kept));
        }
        let (what, off_px) = farthest_landmark(kept, again, field);
        let allowed_px = self.of.resolution_px(kept);
        // Written so that NaN is an error, too.
        if !(off_px <= allowed_px) {
            return Err(ExchangeError::ReadsBackElsewhere {
                frame: kept.name.clone(),
                format: self.format,
                what,
                off_px,
                allowed_px,
            });
        }
        Ok(off_px)
    }

    /// The error that a frame is not what was written.
    fn reads_back_otherwise(&self, kept: &FrameCamera) -> ExchangeError {
        ExchangeError::ReadsBackOtherwise {
            frame: kept.name.clone(),
            format: self.format,
        }
    }
}
