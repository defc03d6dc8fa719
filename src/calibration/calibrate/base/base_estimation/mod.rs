//! From a document's clicks to the base of one of its cameras, and back into the document.

mod estimated_base;
mod landmark_fit;
mod misnamed;
#[cfg(test)]
mod tests;
mod with_size;

use super::own_cameras::cameras_from_lines;
use crate::calibrate::base_readiness::LANDMARKS_ALONE;
use crate::calibrate::{OpenSize, observations};
pub use estimated_base::EstimatedBase;
pub use landmark_fit::LandmarkFit;
pub use misnamed::Misnamed;
pub(crate) use misnamed::rename_clicks;
use thiserror::Error;
use touchline_core::camera::{CameraBase, PtzCamera, StatedLens};
use touchline_core::field::{FieldError, FieldModel, Symmetry};
use touchline_core::geometry::{ImagePoint, ImageSize};
use touchline_core::progress::Progress;
use touchline_core::solve::ObservationError;
use touchline_core::solve::base::{
    AdjustOptions, BaseError, BaseEstimate, BaseModel, BaseOptions, BaseProgress, CameraClicks,
    CrownModel, FrameClicks, LensModel, MirroredFrame, adjust_base, estimate_base, start_base,
};
use touchline_documents::document::{Camera, CameraId, Document, DocumentAt, Frame};

/// Why a base cannot be estimated.
#[derive(Clone, Debug, PartialEq, Error)]
#[non_exhaustive]
pub enum BaseEstimationError {
    /// The camera is not in the document.
    #[error("camera {camera:?} is not in the document")]
    UnknownCamera {
        /// The camera's name.
        camera: String,
    },
    /// The field is not valid.
    #[error(transparent)]
    Field(#[from] FieldError),
    /// A click names a landmark or line that the field does not have.
    #[error("{frame}: {source}")]
    Observation {
        /// The frame's name.
        frame: String,
        /// The error of the name.
        source: ObservationError,
    },
    /// The clicks do not determine a base.
    #[error(transparent)]
    Base(#[from] BaseError),
    /// They do once their names are read for other sides.
    #[error("{0}; rename them, then they give a base")]
    Misnamed(Misnamed),
}

/// The input for estimating the base of a camera: its frames with their clicks.
#[derive(Clone, Debug)]
pub struct BaseProblem {
    /// The camera.
    pub camera: CameraId,
    /// The field that it shows.
    pub field: FieldModel,
    /// Indices in the document of the frames that take part.
    pub frames: Vec<usize>,
    /// Their clicks, in the same order.
    pub clicks: Vec<FrameClicks>,
    pub(in crate::calibrate) image_size: ImageSize,
    pub(in crate::calibrate) principal_point: ImagePoint,
    /// What is open of the field's size.
    pub(in crate::calibrate) open_size: OpenSize,
    /// The lens as the document states it.
    pub(super) lens: StatedLens,
    pub(super) previous: Option<CameraBase>,
}

impl BaseProblem {
    /// Gathers the clicks of a camera's frames, except rejected frames and those excluded from the
    /// base. `folder` is the document's.
    ///
    /// # Errors
    /// The document lacks the camera, its field is not valid, or a click names something that the
    /// field lacks.
    pub fn from_document(
        document: DocumentAt<'_>,
        camera: &CameraId,
    ) -> Result<Self, BaseEstimationError> {
        Self::gather(document, camera, |_| false)
    }

    /// The same, with solved frames that have no clicks: their paint may contribute.
    ///
    /// # Errors
    /// Those of [`Self::from_document`].
    pub(super) fn with_solved(
        document: DocumentAt<'_>,
        camera: &CameraId,
    ) -> Result<Self, BaseEstimationError> {
        Self::gather(document, camera, |frame| frame.ptz.is_some())
    }

    /// Frames of a camera, by their indices in the document, without any clicks.
    pub(crate) fn without_clicks(
        camera: &Camera,
        (field, open_size): (FieldModel, OpenSize),
        base: &CameraBase,
        frames: Vec<usize>,
    ) -> Self {
        let clicks = frames
            .iter()
            .map(|_| FrameClicks {
                observations: Vec::new(),
                start: None,
            })
            .collect();
        Self {
            camera: camera.id.clone(),
            field,
            open_size,
            frames,
            clicks,
            image_size: camera.image_size,
            principal_point: base.principal_point,
            lens: camera.stated_lens(),
            previous: Some(*base),
        }
    }

    /// Gathers the frames with clicks, and those without clicks that satisfy `is_wanted`.
    fn gather(
        document: DocumentAt<'_>,
        camera: &CameraId,
        is_wanted: impl Fn(&Frame) -> bool,
    ) -> Result<Self, BaseEstimationError> {
        let known = document
            .camera(camera)
            .ok_or_else(|| BaseEstimationError::UnknownCamera {
                camera: camera.as_str().to_owned(),
            })?;
        let spec = document.field_of_camera(camera);
        let field = document.model_of(spec)?;
        let open_size = OpenSize::of(document, spec, &field)?;
        let (mut frames, mut clicks) = (Vec::new(), Vec::new());
        for (index, frame) in document.frames.iter().enumerate() {
            // Frames of another picture size cannot share the camera's lens and principal point. A
            // wrong name in a frame that takes no part does no harm.
            if frame.camera != *camera
                || frame.image_size != known.image_size
                || !frame.is_used_for_base()
            {
                continue;
            }
            let observations =
                observations(frame, &field).map_err(|source| BaseEstimationError::Observation {
                    frame: frame.name(),
                    source,
                })?;
            // Check clicks alone contribute nothing to a base.
            let has_clicks = observations.iter().any(|observation| !observation.check);
            if has_clicks || is_wanted(frame) {
                frames.push(index);
                clicks.push(FrameClicks {
                    observations,
                    start: None,
                });
            }
        }
        Ok(Self {
            camera: camera.clone(),
            field,
            open_size,
            frames,
            clicks,
            image_size: known.image_size,
            principal_point: known.principal_point,
            lens: known.stated_lens(),
            previous: known.base(),
        })
    }

    /// Number of clicks that take part.
    pub fn click_count(&self) -> usize {
        self.clicks
            .iter()
            .flat_map(|frame| &frame.observations)
            .filter(|observation| !observation.check)
            .count()
    }

    /// Estimates the base. `document` is the one that the clicks were gathered from.
    ///
    /// # Errors
    /// The clicks give no base, also because they are named for the wrong sides, or it was
    /// cancelled.
    pub fn estimate(
        &self,
        document: &Document,
        options: &BaseOptions,
        progress: &Progress<'_, BaseProgress>,
    ) -> Result<EstimatedBase, BaseEstimationError> {
        let found = self.estimate_as_named(document, options, progress);
        match self.find_misnaming(document, found.as_ref(), options) {
            Some(names) => Err(BaseEstimationError::Misnamed(names)),
            None => found.map(|mut found| {
                self.state_open_size(&self.clicks, &mut found.estimate);
                found
            }),
        }
    }

    fn estimate_as_named(
        &self,
        document: &Document,
        options: &BaseOptions,
        progress: &Progress<'_, BaseProgress>,
    ) -> Result<EstimatedBase, BaseEstimationError> {
        let has_landmarks = self
            .frames
            .iter()
            .any(|index| document.frames[*index].landmark_clicks() >= LANDMARKS_ALONE);
        // Frames without landmarks enough may have cameras by their lines, from which to start.
        let own_cameras = if has_landmarks {
            Vec::new()
        } else {
            cameras_from_lines(&self.field, &self.clicks, self.image_size, self.lens)
        };
        let clicks = CameraClicks {
            own_cameras: &own_cameras,
            ..self.camera_clicks()
        };
        let options = options.clone().with_lens(&self.lens, self.image_size);
        let estimate = estimate_base(&clicks, self.previous.as_ref(), &options, progress)?;
        Ok(self.estimated_base(document, estimate))
    }

    /// The clicks as the input of an adjustment.
    pub(super) fn camera_clicks(&self) -> CameraClicks<'_> {
        CameraClicks {
            field: &self.field,
            frames: &self.clicks,
            image_size: self.image_size,
            principal_point: self.principal_point,
            pixel_aspect: self.lens.pixel_aspect.unwrap_or(1.0),
            own_cameras: &[],
        }
    }

    /// An estimate from these frames, with the document's frame indices.
    pub(super) fn estimated_base(
        &self,
        document: &Document,
        mut estimate: BaseEstimate,
    ) -> EstimatedBase {
        // The estimator counts the frames that take part, readers count those of the document.
        for disputed in &mut estimate.disputed {
            disputed.frame = self.frames[disputed.frame];
        }
        for mirrored in &mut estimate.mirrored {
            mirrored.frame = self.frames[mirrored.frame];
        }
        let disputed = estimate.disputed.iter().map(|disputed| disputed.frame);
        let mirrored = estimate.mirrored.iter().map(|mirrored| mirrored.frame);
        let doubted_clicks = disputed
            .chain(mirrored)
            .filter_map(|index| Some((index, document.frames.get(index)?.clicks.clone())))
            .collect();
        let landmarks = self.landmark_fits(document, &estimate);
        let (camera, frames) = (self.camera.clone(), self.frames.clone());
        EstimatedBase {
            camera,
            frames,
            estimate,
            landmarks,
            sizes: Vec::new(),
            on_paint: None,
            doubted_clicks,
        }
    }
}

/// The camera that a frame's own clicks determine without a known base, from four or more landmarks
/// on the ground, or else from lines and landmarks with as many equations; none if they do not.
///
/// A homography gives position, rotation and focal length. They are refined with a pinhole lens and
/// the field's crown: one frame does not determine a lens. A camera from lines has the usual places
/// of cameras as a prior instead of a known principal point and lens.
pub fn camera_alone(document: &Document, frame: &Frame, field: &FieldModel) -> Option<PtzCamera> {
    let camera = document.camera_of(frame)?;
    let frames = [FrameClicks {
        observations: observations(frame, field).ok()?,
        start: None,
    }];
    if frame.landmark_clicks() < LANDMARKS_ALONE {
        let lens = document.stated_lens(frame);
        return cameras_from_lines(field, &frames, frame.image_size, lens).pop();
    }
    let (image_size, principal_point) = (frame.image_size, camera.principal_point);
    let clicks = CameraClicks {
        field,
        frames: &frames,
        image_size,
        principal_point,
        pixel_aspect: camera.pixel_aspect,
        own_cameras: &[],
    };
    // The linear start, then the nonlinear refinement of position, rotation, pan, tilt and focal
    // length.
    let start = start_base(&clicks).ok()?;
    let crown = CrownModel::Fixed(field.crown_m);
    let model = BaseModel {
        lens: LensModel::Pinhole,
        crown,
        principal_point: None,
    };
    let options = AdjustOptions::default();
    let adjusted = adjust_base(&clicks, &start.base, &start.ptz, &model, &options);
    Some(PtzCamera::new(adjusted.base, (*adjusted.ptz.first()?)?))
}

/// Describes the residuals of a frame with mirrored names.
pub fn describe_mirrored(mirrored: &MirroredFrame) -> String {
    let exchanged = match mirrored.symmetry {
        Symmetry::MirrorX => "left and right",
        Symmetry::MirrorY => "near and far",
        Symmetry::Turn180 => "left and right, near and far",
    };
    format!(
        "{:.0} px off as named, {:.1} px with {exchanged} exchanged",
        mirrored.median_px, mirrored.median_mirrored_px
    )
}
