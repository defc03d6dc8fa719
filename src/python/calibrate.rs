//! Cameras of whole videos: without a click, from known frames to their neighbours, onto the paint.

use crate::camera::PyCamera;
use crate::document::{PyDocument, video_frame};
use crate::errors::{Error, NoCamera, failure};
use crate::field::{PyField, field_or_usual};
use crate::images::{DecodedFrames, picture};
use crate::progress::{self, Steps};
use crate::results::{PySolution, Report};
use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;
use std::collections::BTreeMap;
use std::num::NonZeroUsize;
use std::ops::{ControlFlow, RangeInclusive};
use std::path::{Path, PathBuf};
use std::sync::{Arc, Mutex, PoisonError};
use touchline_calibration::autocalibrate::AutocalibrationProgress;
use touchline_calibration::calibrate::{ClipProgress, TrackClipOptions, clips};
use touchline_calibration::pipelines::{
    LabelMatchError, LearningProgress, MatchEvent, MatchLabels, MatchOptions, TrackingEvent,
    TrackingOptions, label_match, track_clips,
};
use touchline_core::camera::PtzCamera;
use touchline_core::field::FieldError;
use touchline_core::progress::{Progress, Share};
use touchline_documents::document::{Camera, CameraId, Document, FieldSpec, document_from_frames};
use touchline_vision::media::{
    CachedReader, CountProgress, FrameReader, FrameSource, KEPT_BYTES, ReadFrames,
};
use touchline_vision::paint::{GroundPicture, SnapOptions};

/// How many frames the camera may be found from, as `touchline calibrate --look-at`.
const SAMPLED: RangeInclusive<usize> = 3..=300;

/// Finds the camera of a video or of a folder of pictures without a click, as
/// `touchline calibrate`: where it stands, its lens, and each frame's pan, tilt and focal length
/// as suggestions.
///
/// `frames`: a path, or a sequence of pictures (height, width, 3), uint8, red first, or blue with
/// `bgr`, which are read by their index when they are needed; they are the frames of one video that
/// `name` names in the document. `params`: parameters of the field, the size of which is then taken
/// as known. `look_at`: the camera is found from this many frames at most. `found_only`: answer
/// only those.
///
/// Raises `NoCamera` where the pictures do not decide. The document is saved by `save`.
#[pyfunction]
#[pyo3(signature = (
    frames, field = "soccer", params = None, *, look_at = 40, found_only = false, bgr = false,
    name = "video.mp4", progress = None
))]
#[allow(clippy::too_many_arguments, reason = "they are named in Python")]
pub fn calibrate(
    frames: &Bound<'_, PyAny>,
    field: &str,
    params: Option<BTreeMap<String, f64>>,
    look_at: usize,
    found_only: bool,
    bgr: bool,
    name: &str,
    progress: Option<&Bound<'_, PyAny>>,
) -> PyResult<PyDocument> {
    let py = frames.py();
    if !SAMPLED.contains(&look_at) {
        return Err(PyValueError::new_err(
            "look_at: 3 to 300 frames are possible",
        ));
    }
    let field = FieldSpec::with_params(field, params.unwrap_or_default()).with_absolute_path()?;
    // Built only to find mistakes in the parameters before the pictures are read.
    field.model(Path::new("")).map_err(failure)?;
    let options = MatchOptions {
        sampled_frames: look_at,
        label_the_rest: !found_only,
        // Frames that Python decodes are read when they are needed, and these need few.
        find_shots: !found_only,
        work: None,
        venues: Vec::new(),
    };
    let folder = std::path::absolute(".")?;
    // Texts and paths are sequences in Python, too, so that a path is tried first.
    let (mut document, decoded) = if let Ok(path) = frames.extract::<PathBuf>() {
        let made = progress::run(py, progress, |steps| {
            document_of_path(&path, &folder, field, steps)
        })?;
        (made.map_err(failure)?, None)
    } else {
        let decoded = DecodedFrames::new(frames.clone().unbind(), bgr);
        (
            document_of_sequence(frames, &decoded, field, name)?,
            Some(decoded),
        )
    };
    let Some(camera) = document.cameras.first().map(|camera| camera.id.clone()) else {
        return Err(Error::new_err("not one image can be read"));
    };
    // The reader moves into the work; what it raised is read after it.
    let raised = decoded.as_ref().map(|decoded| Arc::clone(&decoded.raised));
    let (labels, document) = progress::run(py, progress, |steps| {
        let labels = label(&mut document, &folder, &camera, decoded, &options, steps);
        (labels, document)
    })?;
    // An exception of the caller's sequence ends the work by a cancellation. It says more than the
    // result of the cancelled work.
    if let Some(raised) = raised {
        raised.raise()?;
    }
    match labels.map_err(failure)? {
        MatchLabels::Labelled(_) => Ok(PyDocument::new(document, folder, None)),
        MatchLabels::NoCamera(why) => Err(NoCamera::new_err(why.describe(&document))),
    }
}

/// Labels a match. Its pictures are read from their files or decoded by Python; what Python raises
/// ends the work.
fn label(
    document: &mut Document,
    folder: &Path,
    camera: &CameraId,
    decoded: Option<DecodedFrames>,
    options: &MatchOptions,
    steps: &Steps,
) -> Result<MatchLabels, LabelMatchError> {
    let raised = decoded.as_ref().map(|decoded| Arc::clone(&decoded.raised));
    let events = Progress::new(|event| {
        // A frame that cannot be read is only left out by the library. Here all others would fail
        // alike.
        if raised.as_ref().is_some_and(|raised| raised.is_some()) {
            return ControlFlow::Break(());
        }
        show_match(steps, &event)
    });
    let mut reader: Box<dyn ReadFrames> = match decoded {
        // Pictures of files stay in memory for the steps that read them again. Whether those of a
        // sequence do is the caller's choice.
        Some(decoded) => Box::new(decoded),
        None => Box::new(CachedReader::new(FrameReader::new(), KEPT_BYTES)),
    };
    label_match(document, folder, camera, &mut *reader, options, &events)
}

/// A document of a video or of a folder's images.
fn document_of_path(
    path: &Path,
    folder: &Path,
    field: FieldSpec,
    steps: &Steps,
) -> Result<Document, String> {
    // Counting the frames of a video states no total, so that only a cancellation is passed on.
    let counting = Progress::new(|_: CountProgress| steps.check());
    let source =
        FrameSource::open_with_progress(path, &counting).map_err(|error| error.to_string())?;
    if source.is_empty() {
        return Err(format!("{} holds no image", path.display()));
    }
    let making = steps.count(source.len());
    let made = document_from_frames(&source, folder, field, NonZeroUsize::MIN, &making);
    for (image, error) in &made.left_out {
        steps.note(format!("{image}: {error}"));
    }
    Ok(made.document)
}

/// A document of the frames that Python decodes.
fn document_of_sequence(
    frames: &Bound<'_, PyAny>,
    decoded: &DecodedFrames,
    field: FieldSpec,
    name: &str,
) -> PyResult<Document> {
    let count = frames
        .len()
        .map_err(|_| PyValueError::new_err("frames: a path or a sequence of pictures is needed"))?;
    if count == 0 {
        return Err(Error::new_err("frames: there is no picture"));
    }
    // The first frame is decoded for its size, and so that a wrong sequence fails at once.
    let size = decoded.frame(frames.py(), 0)?.size();
    let camera = Camera::new(CameraId::from("main"), size);
    let mut document = Document::new(field);
    let frames = (0..count).map(|index| video_frame(name, index, &camera.id, size).into());
    document.frames.extend(frames);
    document.cameras.push(camera.into());
    Ok(document)
}

/// Shows an event of labelling a match as the share of its step.
fn show_match(steps: &Steps, event: &MatchEvent) -> ControlFlow<()> {
    match event {
        MatchEvent::Searching(at) => match share_of_search(at) {
            Some(Share { done, of }) => steps.report(done, of),
            None => steps.check(),
        },
        MatchEvent::Learning(LearningProgress::Features { done, of })
        | MatchEvent::Asking { done, of } => steps.report(*done, *of),
        MatchEvent::Learning(LearningProgress::Training(at)) => steps.report(at.placed, at.total),
        MatchEvent::Tracking(event) => show_tracking(steps, event),
        MatchEvent::Unreadable { frame, error } => {
            steps.note(format!("{frame}: {error}"));
            steps.check()
        }
        // Other events have no share to show, but they are places where the work can stop.
        _ => steps.check(),
    }
}

/// How far a step of the search for a camera is, where it says so.
const fn share_of_search(at: &AutocalibrationProgress) -> Option<Share> {
    match *at {
        AutocalibrationProgress::Looking { done, of }
        | AutocalibrationProgress::Tying { done, of }
        | AutocalibrationProgress::Trying { done, of, .. }
        | AutocalibrationProgress::Adjusting { done, of }
        | AutocalibrationProgress::Sizing { done, of }
        | AutocalibrationProgress::Snapping { done, of } => Some(Share { done, of }),
        AutocalibrationProgress::Matched { .. }
        | AutocalibrationProgress::Gathering
        | AutocalibrationProgress::Refining => None,
    }
}

/// Shows an event of tracking as the share of its step.
fn show_tracking(steps: &Steps, event: &TrackingEvent) -> ControlFlow<()> {
    match event {
        TrackingEvent::Progress(
            ClipProgress::Following(done, of) | ClipProgress::Painting(done, of),
        ) => steps.report(*done, *of),
        _ => steps.check(),
    }
}

/// Carries the cameras of solved frames to their neighbours, one adjustment a shot, as
/// `touchline track`. Frames that get a camera become suggestions; those that were to get one and
/// did not are in `failed` of the report.
///
/// `frames`: the first and the last number of the frames to be tracked. `smooth`: smooth the
/// motion.
/// `progress(done, of)` as in `solve`.
#[pyfunction]
#[pyo3(signature = (document, *, smooth = false, frames = None, progress = None))]
pub fn track(
    document: &Bound<'_, PyDocument>,
    smooth: bool,
    frames: Option<(usize, usize)>,
    progress: Option<&Bound<'_, PyAny>>,
) -> PyResult<Report> {
    let within = frames.map(|(first, last)| first..=last);
    if within.as_ref().is_some_and(RangeInclusive::is_empty) {
        return Err(PyValueError::new_err(
            "frames: the first number must not be greater than the last",
        ));
    }
    let clip = TrackClipOptions {
        smooth,
        ..TrackClipOptions::default()
    };
    let options = TrackingOptions {
        clip,
        ..TrackingOptions::default()
    };
    // The work changes a copy, and the document gets it at the end: an exception or Ctrl-C leaves
    // the document as it was. Python may read the document meanwhile, from another thread or the
    // caller's function, but must not at the moment of the exchange: `try_borrow_mut` then raises.
    let (mut tracked, folder) = document.try_borrow()?.copy();
    let found = progress::run(document.py(), progress, |steps| {
        let report = track_all(&mut tracked, &folder, within.as_ref(), &options, steps);
        report.map(|report| (tracked, report))
    })?;
    let (tracked, report) = found.map_err(failure)?;
    document.try_borrow_mut()?.document = tracked;
    Ok(report)
}

/// Tracks the clips of a document; one that cannot be tracked becomes a note.
fn track_all(
    document: &mut Document,
    folder: &Path,
    within: Option<&RangeInclusive<usize>>,
    options: &TrackingOptions,
    steps: &Steps,
) -> Result<Report, FieldError> {
    let notes = Mutex::new(Vec::new());
    let events = Progress::new(|event: TrackingEvent| {
        if let TrackingEvent::Failed(_, error) = &event {
            let mut notes = notes.lock().unwrap_or_else(PoisonError::into_inner);
            notes.push(error.to_string());
        }
        show_tracking(steps, &event)
    });
    let clips = clips(document.at(folder), within);
    let mut reader = CachedReader::new(FrameReader::new(), KEPT_BYTES);
    let found = track_clips(
        document,
        folder,
        &clips,
        &mut reader,
        options,
        &mut Vec::new(),
        &events,
    )?;
    drop(events);
    let mut report = Report {
        solved: found.tracked,
        notes: notes.into_inner().unwrap_or_else(PoisonError::into_inner),
        ..Report::default()
    };
    // Frames that tracking was to reach and that have no camera now. Those that people decided on
    // stay as they are whatever the tracking gives.
    for of_clip in clips.iter().flat_map(|clip| &clip.frames) {
        let frame = of_clip.place.and_then(|place| document.frames.get(place));
        if let Some(frame) = frame.filter(|frame| frame.is_open() && frame.ptz.is_none()) {
            report.fail(frame, "tracking did not reach it");
        }
    }
    // Each frame is of one clip, so that it is counted once at most.
    report.passed = document.frames.len() - report.solved - report.failed.len();
    Ok(report)
}

/// Pulls a camera onto the painted lines of its picture: (height, width, 3), uint8, red first, or
/// blue with `bgr`.
///
/// Raises `Error` where the paint does not decide, with the reason. `reach_px`: how far the paint
/// may lie from where the camera puts it, px at 1920 px width.
#[pyfunction]
#[pyo3(signature = (image, camera, field = None, *, reach_px = 48.0, bgr = false))]
pub fn snap(
    image: &Bound<'_, PyAny>,
    camera: &Bound<'_, PyCamera>,
    field: Option<&PyField>,
    reach_px: f64,
    bgr: bool,
) -> PyResult<PySolution> {
    let (picture, field) = (picture(image, bgr)?, field_or_usual(field)?);
    if !(4.0..=400.0).contains(&reach_px) {
        return Err(PyValueError::new_err(
            "reach_px: the reach is a number of px from 4 to 400",
        ));
    }
    let PyCamera {
        camera: start,
        image_size,
    } = camera.get();
    // The focal length is in px of the camera's pictures. On another size it would be wrong.
    if picture.size() != *image_size {
        let (is, wanted) = (picture.size(), image_size);
        return Err(PyValueError::new_err(format!(
            "image: {} × {} px, but the camera's pictures have {} × {} px; scale the picture",
            is.width, is.height, wanted.width, wanted.height
        )));
    }
    let options = SnapOptions {
        reach_px,
        ..SnapOptions::default()
    };
    let on_paint = progress::run(image.py(), None, |_| {
        // No masks: a single picture comes without a document.
        let ground = GroundPicture::new(&picture, &[]);
        touchline_vision::paint::snap(&ground, &field, start.base(), start.ptz(), &[], &options)
    })?;
    let on_paint = on_paint.map_err(failure)?;
    let found = PtzCamera::new(*start.base(), on_paint.ptz);
    Ok(PySolution::without_clicks(
        PyCamera::new(&found, *image_size),
        on_paint.uncertainty.ptz_covariance_deg(),
        on_paint.rms_px,
        on_paint
            .uncertainty
            .worst_corner_sigma_px(&found, *image_size),
    ))
}
