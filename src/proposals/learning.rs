//! What references teach, and the forest of it.

use super::burnt_in::{leave_out_burnt_in, with_found_masks};
use super::{FoundMask, FrameFeatures, FramePictures, Lesson, PictureError};
use crate::document::{CameraId, Document, Frame, Frames, WriteError, document_to_string};
use crate::features::FeatureOptions;
use crate::media::ReadFrames;
use crate::relocalize::{CameraForest, ForestModel, Samples, SeenRange, Stopped, TrainOptions, TrainProgress, train};
use std::ops::ControlFlow;
use std::path::Path;
use std::sync::Arc;
use thiserror::Error;

/// Why a reference teaches nothing.
#[derive(Clone, Debug, PartialEq, Eq, Error)]
#[non_exhaustive]
pub enum LessonError {
    /// It names a camera that the document lacks.
    #[error("camera {camera:?} is not in the document")]
    UnknownCamera {
        /// The camera's name.
        camera: String,
    },
    /// Where its camera stands is not known.
    #[error("camera {camera:?} has no position or base rotation")]
    NoBase {
        /// The camera's name.
        camera: String,
    },
    /// Nobody solved it.
    #[error("this reference has no `ptz`; run `touchline solve` first")]
    Unsolved,
    /// Its image file is another one by now.
    #[error("the image changed since it was labelled: the label is kept but does not teach")]
    Changed,
    /// Its picture or features cannot be had.
    #[error(transparent)]
    Picture(#[from] PictureError),
}

/// How a forest is learnt.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct LearnOptions {
    /// How features are looked for.
    pub features: FeatureOptions,
    /// How the forest is trained.
    pub train: TrainOptions,
}

/// Why there is no forest.
#[derive(Debug, Error)]
#[non_exhaustive]
pub enum LearnError {
    /// Training ended without one.
    #[error(transparent)]
    Stopped(#[from] Stopped),
    /// The cameras cannot be written down.
    #[error(transparent)]
    Document(#[from] WriteError),
}

/// What the references of a document teach.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Studied {
    /// What they teach, in their order.
    pub lessons: Vec<Lesson>,
    /// Those that teach nothing, by their places, and why.
    pub failed: Vec<(usize, LessonError)>,
    /// Graphics that are burnt into their pictures; what lies in them does not teach.
    pub burnt_in: Vec<FoundMask>,
}

/// Finds out what references teach, in parallel. `progress` is called after each, from any thread, and may end it: none
/// then.
pub fn study(
    pictures: &FramePictures<'_>,
    reader: &mut dyn ReadFrames,
    teachers: &[usize],
    progress: &(dyn Fn() -> ControlFlow<()> + Sync),
) -> Option<Studied> {
    let lessons = pictures.each(reader, teachers, |index, frame, found| {
        let lesson = found.map_err(LessonError::from).and_then(|found| lesson(pictures.document, index, frame, &found));
        progress()?;
        ControlFlow::Continue((index, lesson))
    })?;
    let mut studied = Studied::default();
    for (index, lesson) in lessons {
        match lesson {
            Ok(lesson) => studied.lessons.push(lesson),
            Err(error) => studied.failed.push((index, error)),
        }
    }
    studied.burnt_in = leave_out_burnt_in(pictures.document, &mut studied.lessons);
    Some(studied)
}

fn lesson(document: &Document, index: usize, frame: &Frame, found: &FrameFeatures) -> Result<Lesson, LessonError> {
    let name = || frame.camera.as_str().to_owned();
    let camera = document.camera_of(frame).ok_or_else(|| LessonError::UnknownCamera { camera: name() })?;
    camera.base().ok_or_else(|| LessonError::NoBase { camera: name() })?;
    let pointed = camera.pointed(frame).ok_or(LessonError::Unsolved)?;
    if found.changed {
        return Err(LessonError::Changed);
    }
    let features = Arc::clone(&found.features);
    let rays = features.keypoints.iter().map(|keypoint| pointed.ray_from_image(keypoint.point));
    // Beyond the fold of a lens a point shows no ray.
    let taught = (0..).zip(rays).filter_map(|(feature, ray)| Some((feature, ray.ok()?))).collect();
    Ok(Lesson { frame: index, camera: frame.camera.clone(), ptz: pointed.ptz(), features, taught })
}

/// The forests of what references teach, one for each camera that has any, in the document's order. `progress` is called
/// now and then from any thread, camera after camera, and may end it.
///
/// # Errors
/// Nothing was taught, `progress` ended it, or the document's cameras cannot be written down.
pub fn learn(
    document: &Document,
    studied: &Studied,
    options: &LearnOptions,
    progress: &(dyn Fn(TrainProgress) -> ControlFlow<()> + Sync),
) -> Result<ForestModel, LearnError> {
    let lessons = &studied.lessons;
    let mut cameras = Vec::new();
    for camera in &document.cameras {
        let of_camera = lessons.iter().filter(|lesson| lesson.camera == camera.id);
        cameras.extend(learn_camera(&camera.id, of_camera, &options.train, progress)?);
    }
    if cameras.is_empty() {
        return Err(Stopped::NoSamples { frames: lessons.len() }.into());
    }
    let document = with_found_masks(without_frames(document), &studied.burnt_in);
    Ok(ForestModel { document: document_to_string(&document)?, features: options.features, cameras })
}

/// The forest of one camera; none where nothing was taught.
///
/// # Errors
/// `progress` ended it, or there are too many samples.
fn learn_camera<'a>(
    camera: &CameraId,
    lessons: impl Iterator<Item = &'a Lesson>,
    options: &TrainOptions,
    progress: &(dyn Fn(TrainProgress) -> ControlFlow<()> + Sync),
) -> Result<Option<CameraForest>, Stopped> {
    let (mut samples, mut seen) = (Samples::new(), Vec::new());
    for lesson in lessons.filter(|lesson| !lesson.taught.is_empty()) {
        lesson.add_to(&mut samples);
        seen.push(lesson.ptz);
    }
    let Some(seen) = SeenRange::of(&seen) else { return Ok(None) };
    let forest = train(&samples, options, progress)?;
    Ok(Some(CameraForest { camera: camera.as_str().to_owned(), seen, forest }))
}

/// The document's field and cameras. A template of the user's own is kept by its file name: a forest holds no
/// paths.
fn without_frames(document: &Document) -> Document {
    let mut kept = Document { frames: Frames::new(), extra: crate::document::Extra::new(), ..document.clone() };
    let of_cameras = kept.cameras.iter_mut().filter_map(|camera| camera.field.is_some().then(|| &mut **camera));
    for field in of_cameras.filter_map(|camera| camera.field.as_mut()).chain([&mut kept.field]) {
        if field.is_file()
            && let Some(name) = Path::new(&field.template).file_name()
        {
            field.template = name.to_string_lossy().into_owned();
        }
    }
    kept
}
