//! Training samples from references, and the forest that is trained on them.

use super::burnt_in::{leave_out_burnt_in, with_found_masks};
use super::label::label_of;
use crate::proposals::{
    FoundMask, FrameFeatures, FramePictures, FrameWithFeatures, PictureError, Resolution,
    TrainingSample,
};
use std::ops::ControlFlow;
use std::path::Path;
use std::sync::Arc;
use thiserror::Error;
use touchline_core::camera::PtzCamera;
use touchline_core::field::FieldModel;
use touchline_core::progress::Progress;
use touchline_documents::document::{
    CameraId, Document, Extra, Fields, Frame, Frames, WriteError, document_to_string,
};
use touchline_vision::features::{FeatureOptions, Features};
use touchline_vision::media::ReadFrames;
use touchline_vision::relocalize::{
    CameraForest, ForestModel, Label, Reference, Samples, SeenRange, Stopped, TrainOptions,
    TrainProgress, adjust_labels, train,
};

/// Why a reference gives no training sample.
#[derive(Clone, Debug, PartialEq, Eq, Error)]
#[non_exhaustive]
pub enum TrainingSampleError {
    /// It names a camera that the document lacks.
    #[error("camera {camera:?} is not in the document")]
    UnknownCamera {
        /// The camera's name.
        camera: String,
    },
    /// The base of its camera is unknown.
    #[error("camera {camera:?} has no position or base rotation")]
    NoBase {
        /// The camera's name.
        camera: String,
    },
    /// It has no camera pose.
    #[error("this reference has no `ptz`; run `touchline solve` first")]
    Unsolved,
    /// Its image file has changed since it was labelled.
    #[error("the image changed since it was labelled: the label is kept but not used for training")]
    Changed,
    /// Its picture or features are not available.
    #[error(transparent)]
    Picture(#[from] PictureError),
}

/// Options of learning a forest.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct LearnOptions {
    /// Feature extraction.
    pub features: FeatureOptions,
    /// Training.
    pub train: TrainOptions,
}

/// Why there is no forest.
#[derive(Debug, Error)]
#[non_exhaustive]
pub enum LearnError {
    /// Training ended without a forest.
    #[error(transparent)]
    Stopped(#[from] Stopped),
    /// The cameras cannot be serialised.
    #[error(transparent)]
    Document(#[from] WriteError),
}

/// The training samples of a document's references.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct ReferenceSamples {
    /// The samples, in the order of the references.
    pub training_samples: Vec<TrainingSample>,
    /// Indices of the references that give no sample, and why.
    pub failed: Vec<(usize, TrainingSampleError)>,
    /// Graphics burnt into their pictures; features in them are left out.
    pub burnt_in: Vec<FoundMask>,
}

/// What is known of a reference while its features are extracted.
enum SampleInProgress {
    /// Its coarse features; the fine ones follow.
    Coarse(Arc<Features>),
    /// Its sample, or why it gives none.
    Done(Box<Result<TrainingSample, TrainingSampleError>>),
}

impl SampleInProgress {
    fn is_coarse(&self) -> bool {
        matches!(self, Self::Coarse(_))
    }

    fn coarse(self) -> Option<Arc<Features>> {
        match self {
            Self::Coarse(features) => Some(features),
            Self::Done(..) => None,
        }
    }

    fn sample(self) -> Option<Result<TrainingSample, TrainingSampleError>> {
        match self {
            Self::Coarse(_) => None,
            Self::Done(sample) => Some(*sample),
        }
    }
}

/// Extracts the features of references, coarse and fine, and computes their rays, in parallel. Each
/// reference is a step of progress. None if `progress` cancelled it.
pub fn study(
    pictures: &FramePictures<'_>,
    reader: &mut dyn ReadFrames,
    training_frames: &[usize],
    progress: &Progress<'_, ()>,
) -> Option<ReferenceSamples> {
    let document = pictures.document;
    // If the field is not valid, the uncertainties of labels are those of four clicks.
    let fields = Fields::from_document(document.at(pictures.folder)).ok();
    let looks = pictures.each_coarse_to_fine(
        reader,
        training_frames,
        |look| study_look(document, fields.as_ref(), look, progress),
        SampleInProgress::is_coarse,
    )?;
    let mut studied = ReferenceSamples::default();
    // Each is done, in the order of the frames.
    let samples = looks.into_iter().filter_map(SampleInProgress::sample);
    for (&index, sample) in training_frames.iter().zip(samples) {
        match sample {
            Ok(sample) => studied.training_samples.push(sample),
            Err(error) => studied.failed.push((index, error)),
        }
    }
    studied.burnt_in = leave_out_burnt_in(pictures.document, &mut studied.training_samples);
    Some(studied)
}

/// Studies one reference: keeps its coarse features, or makes its training sample once it has the
/// fine ones.
fn study_look(
    document: &Document,
    fields: Option<&Fields>,
    look: FrameWithFeatures<'_, SampleInProgress>,
    progress: &Progress<'_, ()>,
) -> ControlFlow<(), SampleInProgress> {
    let (index, frame) = (look.index, look.frame);
    let found = match look.found {
        Ok(found) if found.resolution == Resolution::Coarse => {
            progress.check()?;
            return ControlFlow::Continue(SampleInProgress::Coarse(found.features));
        }
        found => found,
    };
    let field = fields.map(|fields| &**fields.for_frame(document, frame));
    let coarse = look.earlier.and_then(SampleInProgress::coarse);
    // Errors are results of single references here: the others are trained on all the same.
    let sample = found
        .map_err(TrainingSampleError::from)
        .and_then(|fine| training_sample(document, field, (index, frame), &fine, coarse));
    progress.report(())?;
    ControlFlow::Continue(SampleInProgress::Done(Box::new(sample)))
}

/// The training sample of a reference, or why it gives none.
fn training_sample(
    document: &Document,
    field: Option<&FieldModel>,
    (index, frame): (usize, &Frame),
    fine: &FrameFeatures,
    coarse: Option<Arc<Features>>,
) -> Result<TrainingSample, TrainingSampleError> {
    let camera = document
        .camera_of(frame)
        .ok_or_else(|| TrainingSampleError::UnknownCamera {
            camera: frame.camera.as_str().to_owned(),
        })?;
    if camera.base().is_none() {
        return Err(TrainingSampleError::NoBase {
            camera: frame.camera.as_str().to_owned(),
        });
    }
    let pointed = camera
        .ptz_camera(frame)
        .ok_or(TrainingSampleError::Unsolved)?;
    // Rays of the old picture's label do not belong to the features of the new picture.
    if fine.changed {
        return Err(TrainingSampleError::Changed);
    }
    let label = label_of(frame, field, &pointed);
    Ok(TrainingSample::new(
        (index, frame),
        &pointed,
        label,
        Arc::clone(&fine.features),
        coarse,
    ))
}

/// Trains a forest for each camera that has references, in the document's order.
///
/// # Errors
/// There are no samples, `progress` cancelled it, or the document's cameras cannot be serialised.
pub fn learn(
    document: &Document,
    studied: &ReferenceSamples,
    options: &LearnOptions,
    progress: &Progress<'_, TrainProgress>,
) -> Result<ForestModel, LearnError> {
    let training_samples = &studied.training_samples;
    let mut cameras = Vec::new();
    for camera in &document.cameras {
        // A forest per camera, from the samples with a known pose.
        let of_camera = training_samples
            .iter()
            .filter(|sample| sample.camera == camera.id);
        let of_camera = of_camera.filter_map(|sample| {
            let frame = document.frames.get(sample.frame)?;
            Some((sample, document.ptz_camera(frame)?))
        });
        cameras.extend(learn_camera(
            &camera.id,
            of_camera,
            &options.train,
            progress,
        )?);
    }
    if cameras.is_empty() {
        return Err(Stopped::NoSamples {
            frames: training_samples.len(),
        }
        .into());
    }
    let document = with_found_masks(without_frames(document), &studied.burnt_in);
    Ok(ForestModel {
        document: document_to_string(&document)?,
        features: options.features,
        cameras,
    })
}

/// The forest of one camera, trained on references after their labels are adjusted to each other
/// ([`adjust_labels`]). None without samples.
///
/// # Errors
/// `progress` cancelled it, or there are too many samples.
fn learn_camera<'a>(
    camera: &CameraId,
    training_samples: impl Iterator<Item = (&'a TrainingSample, PtzCamera)>,
    options: &TrainOptions,
    progress: &Progress<'_, TrainProgress>,
) -> Result<Option<CameraForest>, Stopped> {
    let (training_samples, cameras): (Vec<&TrainingSample>, Vec<PtzCamera>) = training_samples
        .filter(|(sample, _)| !sample.fine.rays.is_empty())
        .unzip();
    // Adjust the labels to each other, by the features that references have in common.
    let references: Vec<Reference> = training_samples
        .iter()
        .zip(&cameras)
        .map(|(sample, camera)| Reference {
            features: &sample.fine.features,
            camera: *camera,
        })
        .collect();
    let labels: Vec<Label> = training_samples.iter().map(|sample| sample.label).collect();
    // Rays are computed with the adjusted cameras. The covariances of these go into the model,
    // because the answers of the forest inherit the errors of the labels.
    let (mut samples, mut seen, mut known) = (Samples::new(), Vec::new(), Vec::new());
    for ((sample, camera), (ptz, covariance)) in training_samples
        .iter()
        .zip(&cameras)
        .zip(adjust_labels(&references, &labels))
    {
        sample.add_as_taken_by(&PtzCamera::new(*camera.base(), ptz), &mut samples);
        seen.push(ptz);
        known.push(covariance);
    }
    let Some(seen) = SeenRange::from_cameras(&seen) else {
        return Ok(None);
    };
    let seen = seen.with_labels(known);
    let forest = train(&samples, options, progress)?;
    Ok(Some(CameraForest {
        camera: camera.as_str().to_owned(),
        seen,
        forest,
    }))
}

/// The document without its frames. Of a user's template only the file name is kept, because a
/// forest must not contain paths of the user's disk.
fn without_frames(document: &Document) -> Document {
    let mut kept = Document {
        frames: Frames::new(),
        extra: Extra::new(),
        ..document.clone()
    };
    for field in kept.fields_mut() {
        if field.is_file()
            && let Some(name) = Path::new(&field.template).file_name()
        {
            field.template = name.to_string_lossy().into_owned();
        }
    }
    kept
}
