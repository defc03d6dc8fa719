//! From a frame's clicks to its camera: collects what a document contributes to a solve.

use super::from_proposal::inform;
use crate::calibrate::FrameLookup;
use thiserror::Error;
use touchline_core::camera::{Ptz, PtzCamera};
use touchline_core::field::{FieldModel, LandmarkId};
use touchline_core::geometry::{ImageSize, mean};
use touchline_core::solve::{
    FrameSolution, Observation, ObservationError, SolveContext, SolveError, check_identity,
    solve_frame,
};
use touchline_documents::document::{Document, Frame, FrameStatus, Target};

/// Maximum number of solved neighbours that a solve gets.
const NEIGHBOURS: usize = 4;

/// Why a frame's clicks give no camera.
#[derive(Clone, Debug, PartialEq, Error)]
#[non_exhaustive]
pub enum CalibrationError {
    /// The frame's camera is not in the document.
    #[error("camera {camera:?} is not in the document")]
    UnknownCamera {
        /// The camera's name.
        camera: String,
    },
    /// The position and base rotation of the camera are not known yet.
    #[error(
        "camera {camera:?} has no position or base rotation: estimate them from clicks on a few wide frames, or load a camera (F2)"
    )]
    NoBase {
        /// The camera's name.
        camera: String,
    },
    /// A click names a landmark or line that the field does not have.
    #[error(transparent)]
    Observation(#[from] ObservationError),
    /// The clicks do not determine a camera.
    #[error(transparent)]
    Solve(#[from] SolveError),
}

/// The named clicks of a frame as observations; check clicks are held out.
///
/// # Errors
/// A click names a landmark or line that the field lacks.
pub fn observations(
    frame: &Frame,
    field: &FieldModel,
) -> Result<Vec<Observation>, ObservationError> {
    frame
        .clicks
        .iter()
        .enumerate()
        // A click that has no name yet gives no equation. The index stays that of the click in the
        // frame, by which residuals and warnings refer to it.
        .filter_map(|(index, click)| click.target.as_ref().map(|target| (index, click, target)))
        .map(|(index, click, target)| {
            let observation = match target {
                Target::Landmark(id) => Observation::from_landmark(
                    field,
                    id.as_str(),
                    click.image,
                    frame.image_size,
                    index,
                ),
                Target::Line(id) => {
                    Observation::from_line(field, id.as_str(), click.image, frame.image_size, index)
                }
            }?;
            // A click that was aligned to paint has another σ, and so has a point of a model.
            let observation = match (target, click.own_sigma_px()) {
                (Target::Landmark(id), Some(sigma_px)) => {
                    with_own_noise(observation, field, id, frame.image_size, sigma_px)
                }
                (Target::Line(_), Some(sigma_px)) => Observation {
                    sigma_px,
                    ..observation
                },
                _ => observation,
            };
            Ok(if click.check {
                observation.hold_out()
            } else {
                observation
            })
        })
        .collect()
}

/// Root mean square distance of clicks from what a camera projects, px; check clicks and those that
/// it does not show do not count. None without any.
pub(in crate::calibrate) fn rms_of_clicks_px(
    clicks: &[Observation],
    camera: &PtzCamera,
) -> Option<f64> {
    let used = clicks.iter().filter(|click| !click.check);
    let squares: Vec<f64> = used
        .filter_map(|click| click.distance_px(camera))
        .map(|off_px| off_px * off_px)
        .collect();
    mean(&squares).map(f64::sqrt)
}

/// The observation of a click that was aligned to paint or given by a model. Its variance has two
/// parts: of the alignment or the model, in place of the annotator's click noise, and of the
/// landmark's position on the real field, which no click avoids.
fn with_own_noise(
    observation: Observation,
    field: &FieldModel,
    landmark: &LandmarkId,
    size: ImageSize,
    sigma_px: f64,
) -> Observation {
    let place_px = field
        .landmark(landmark.as_str())
        .map_or(0.0, |landmark| landmark.place_sigma_px);
    Observation {
        sigma_px: sigma_px.hypot(place_px * size.scale_from_1920()),
        ..observation
    }
}

/// Solves the camera of a frame from its clicks and its camera's base, with a proposal as prior if
/// there are too few clicks. `index` is the frame's index in the document (`frame` may be an edited
/// copy). Where the clicks fit several cameras, the neighbouring frames and the `lookup` of the
/// document decide. Warnings that suggest better names come first.
///
/// # Errors
/// The camera is unknown or has no base, a click names something that the field lacks, or the
/// clicks give no camera.
pub fn calibrate(
    document: &Document,
    lookup: &FrameLookup,
    frame: &Frame,
    field: &FieldModel,
    index: usize,
) -> Result<FrameSolution, CalibrationError> {
    let camera = document
        .camera_of(frame)
        .ok_or_else(|| CalibrationError::UnknownCamera {
            camera: frame.camera.as_str().to_owned(),
        })?;
    // With the frame's own lens, if it states one.
    let base = camera
        .base_for(frame)
        .ok_or_else(|| CalibrationError::NoBase {
            camera: frame.camera.as_str().to_owned(),
        })?;
    let observations = observations(frame, field)?;
    // What decides between several cameras that fit the clicks: the neighbours and the usual
    // motion.
    let mut context = SolveContext {
        neighbours: solved_neighbours(document, index),
        motion: lookup.prior(index),
        ..SolveContext::new(frame.image_size)
    };
    if let Some(proposed) = frame.proposed_camera() {
        inform(&mut context, &base, &proposed, &observations);
    }
    let solution = solve_frame(&base, &observations, &context)?;
    if context.prior.is_some() {
        // With a prior there are too few clicks to contradict each other's names.
        return Ok(solution);
    }
    // Whether other names for the clicks would fit better.
    let finding = check_identity(&base, field, &observations, &solution, &context);
    Ok(solution.with_identity(finding))
}

/// Pan, tilt and focal length of at most four solved frames of the same camera and shot, nearest
/// first. Rejected frames do not count.
pub fn solved_neighbours(document: &Document, index: usize) -> Vec<Ptz> {
    /// Frames farther away are not used: in that time a camera can go anywhere.
    const MAX_FRAMES_APART: usize = 50;
    let Some(frame) = document.frames.get(index) else {
        return Vec::new();
    };
    let mut found = Vec::with_capacity(NEIGHBOURS);
    for distance in 1..=MAX_FRAMES_APART {
        // By growing distance in the document, the earlier frame first.
        let both = [index.checked_sub(distance), index.checked_add(distance)];
        for other in both
            .into_iter()
            .flatten()
            .filter_map(|other| document.frames.get(other))
        {
            if other.camera == frame.camera
                && other.clip == frame.clip
                && other.status != FrameStatus::Rejected
                && let Some(ptz) = other.ptz.as_ref().filter(|_| other.vouches())
            {
                found.push(ptz.ptz());
                if found.len() == NEIGHBOURS {
                    return found;
                }
            }
        }
    }
    found
}

#[cfg(test)]
mod tests {
    use super::*;
    use touchline_documents::testing::{new_frame, ptz_at, soccer_document};

    #[test]
    fn a_rejected_frame_is_no_neighbour() {
        let mut document = soccer_document();
        for pan_deg in [0.0, 1.0, 2.0] {
            let mut frame = new_frame("1.jpg", ImageSize::new(64, 36));
            frame.ptz = ptz_at(pan_deg, -9.0, 90.0);
            document.frames.push(frame.into());
        }
        assert_eq!(solved_neighbours(&document, 1).len(), 2);
        document.frames[0].status = FrameStatus::Rejected;
        assert_eq!(solved_neighbours(&document, 1).len(), 1);
    }
}
