//! The base of a document's camera from the clicks of its frames: the document's side of the estimate.

use super::{CameraId, Document, FrameStatus, SolutionWarning, observations};
use crate::field::{FieldError, Symmetry};
use crate::solve::base::{BaseError, BaseEstimate, BaseOptions, FrameClicks, estimate_base};
use crate::solve::{ObservationError, WarningCode};
use std::path::Path;
use thiserror::Error;

/// The parameter of a field that holds its crown.
const CROWN: &str = "crown_m";

/// Why a camera's base cannot be estimated.
#[derive(Clone, Debug, PartialEq, Error)]
pub enum CameraEstimateError {
    /// The document has no such camera.
    #[error("camera {camera:?} is not in the document")]
    UnknownCamera {
        /// The name asked for.
        camera: String,
    },
    /// The field is not valid.
    #[error(transparent)]
    Field(#[from] FieldError),
    /// A click names something that the field lacks.
    #[error("{frame}: {error}")]
    Observation {
        /// The frame's name.
        frame: String,
        /// What is wrong with the click.
        error: ObservationError,
    },
    /// The clicks give no base.
    #[error(transparent)]
    Base(#[from] BaseError),
}

/// The base of one camera, estimated, and the frames it came from. Nothing in the document has changed yet.
#[derive(Clone, Debug, PartialEq)]
pub struct CameraEstimate {
    /// The camera.
    pub camera: CameraId,
    /// The frames that took part, as indices into the document's; the estimate counts them in this order.
    pub frames: Vec<usize>,
    /// What was found.
    pub estimate: BaseEstimate,
}

/// Estimates a camera's base from its frames with clicks: all but the rejected ones and those of another size.
///
/// # Errors
/// The camera is unknown, its field or a click is not valid, or the clicks give no base.
pub fn estimate_camera(
    document: &Document,
    camera: &CameraId,
    folder: &Path,
    options: &BaseOptions,
) -> Result<CameraEstimate, CameraEstimateError> {
    let known = document
        .camera(camera)
        .ok_or_else(|| CameraEstimateError::UnknownCamera { camera: camera.as_str().to_owned() })?;
    let field = known.field.as_ref().unwrap_or(&document.field).model(folder)?;
    let (mut frames, mut clicks) = (Vec::new(), Vec::new());
    for (index, frame) in document.frames.iter().enumerate() {
        let takes_part = frame.camera == *camera
            && frame.status != FrameStatus::Rejected
            && frame.image_size == known.image_size
            && frame.clicks.iter().any(|click| click.target.is_some());
        if takes_part {
            let observations = observations(frame, &field)
                .map_err(|error| CameraEstimateError::Observation { frame: frame.name(), error })?;
            frames.push(index);
            clicks.push(FrameClicks { observations, start: None });
        }
    }
    let previous = known.base();
    let estimate = estimate_base(&field, &clicks, known.image_size, known.principal_point, previous.as_ref(), options)?;
    Ok(CameraEstimate { camera: camera.clone(), frames, estimate })
}

impl CameraEstimate {
    /// Writes the base with its lens and sigma into the camera, and the crown into its field. Frames keep what they have:
    /// solve them anew.
    pub fn apply(&self, document: &mut Document) {
        let alone = document.cameras.len() == 1;
        let own_field = document.camera(&self.camera).and_then(|camera| camera.field.clone());
        // Another camera may stand at another venue: where there are several, each keeps its own field.
        let mut field = own_field.clone().unwrap_or_else(|| document.field.clone());
        let before = field.params.get(CROWN).copied().unwrap_or(0.0);
        if before != self.estimate.crown_m {
            field.params.insert(CROWN.to_owned(), self.estimate.crown_m);
            if own_field.is_none() && alone {
                document.field = field;
            } else if let Some(camera) = document.camera_mut(&self.camera) {
                camera.field = Some(field);
            }
        }
        if let Some(camera) = document.camera_mut(&self.camera) {
            camera.set_base(&self.estimate.base);
        }
    }

    /// Marks the clicks that disagree and the frames named from the wrong side in the frames' solutions; to be called after
    /// they have been solved with the new base.
    pub fn mark_disputes(&self, document: &mut Document) {
        for disputed in &self.estimate.disputed {
            let frame = &mut document.frames[self.frames[disputed.frame]];
            let named = frame
                .clicks
                .get(disputed.click)
                .and_then(|click| click.target.as_ref())
                .map(|target| target.as_str().to_owned());
            let Some(solution) = &mut frame.solution else { continue };
            solution.disputed.push(disputed.click);
            if let (Some((better, distance_px)), Some(named)) = (&disputed.fits_better, named)
                && let Some(error_px) = disputed.error_px
            {
                let message = format!(
                    "Point {} is {error_px:.0} px off as {named}, {distance_px:.1} px as {better}. Rename it?",
                    disputed.click + 1
                );
                let clicks = vec![disputed.click];
                let warning = SolutionWarning::new(WarningCode::WrongLine.as_str(), message);
                solution.warnings.push(SolutionWarning { clicks, ..warning });
            }
        }
        for mirrored in &self.estimate.mirrored {
            let frame = &mut document.frames[self.frames[mirrored.frame]];
            if let Some(solution) = &mut frame.solution {
                let message = mirrored_message(mirrored.symmetry, mirrored.median_px, mirrored.median_mirrored_px);
                solution.warnings.push(SolutionWarning::new(WarningCode::Mirrored.as_str(), message));
            }
        }
    }
}

/// What a person reads about a frame named from the wrong side.
#[must_use]
pub fn mirrored_message(symmetry: Symmetry, median_px: f64, median_mirrored_px: f64) -> String {
    let what = match symmetry {
        Symmetry::MirrorX => "left and right",
        Symmetry::MirrorY => "near and far",
        Symmetry::Turn180 => "left and right, near and far",
    };
    format!(
        "The names look mirrored: {median_px:.0} px off as named, {median_mirrored_px:.1} px with {what} exchanged. \
         Exchange them?"
    )
}
