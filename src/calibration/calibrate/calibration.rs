//! From a frame's clicks to its camera: the document's side of the solve.

use super::FrameLookup;
use super::from_proposal::inform;
use thiserror::Error;
use touchline_core::camera::Ptz;
use touchline_core::field::{FieldModel, LandmarkId};
use touchline_core::geometry::ImageSize;
use touchline_core::solve::{
    FrameSolution, Observation, ObservationError, SolveContext, SolveError, check_identity,
    solve_frame,
};
use touchline_documents::document::{Document, Frame, Target};

/// How many solved neighbours tell a solve where the camera has just been.
const NEIGHBOURS: usize = 4;

/// Why a frame's clicks give no camera.
#[derive(Clone, Debug, PartialEq, Error)]
#[non_exhaustive]
pub enum CalibrationError {
    /// The frame names a camera that the document lacks.
    #[error("camera {camera:?} is not in the document")]
    UnknownCamera {
        /// The frame's camera.
        camera: String,
    },
    /// Position and base rotation are not known yet.
    #[error(
        "camera {camera:?} has no position or base rotation: estimate them from clicks on a few wide frames, or load a camera (F2)"
    )]
    NoBase {
        /// The frame's camera.
        camera: String,
    },
    /// A click names something that the field lacks.
    #[error(transparent)]
    Observation(#[from] ObservationError),
    /// The clicks do not give a camera.
    #[error(transparent)]
    Solve(#[from] SolveError),
}

/// The named clicks of a frame as observations, check clicks held out.
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
        .filter_map(|(index, click)| click.target.as_ref().map(|target| (index, click, target)))
        .map(|(index, click, target)| {
            let observation = match target {
                Target::Landmark(id) => Observation::of_landmark(
                    field,
                    id.as_str(),
                    click.image,
                    frame.image_size,
                    index,
                ),
                Target::Line(id) => {
                    Observation::of_line(field, id.as_str(), click.image, frame.image_size, index)
                }
            }?;
            let observation = match (target, click.snapped_sigma_px) {
                (Target::Landmark(id), Some(sigma_px)) => {
                    of_snapped(observation, field, id, frame.image_size, sigma_px)
                }
                _ => observation,
            };
            Ok(if click.check {
                observation.held_out()
            } else {
                observation
            })
        })
        .collect()
}

/// A click that was moved onto the paint: what is left of its noise is how well the paint was
/// found, and that the place itself is not quite where the rules put it.
fn of_snapped(
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

/// The camera of a frame from its clicks and its camera's base, and where they are too few from
/// what was proposed. `index` is its place in the document (`frame` may be a changed copy): the
/// frames around it, and with `lookup` all others of the document, decide where its clicks cannot.
/// Names that fit better come first among its warnings.
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
    let base = camera
        .base_for(frame)
        .ok_or_else(|| CalibrationError::NoBase {
            camera: frame.camera.as_str().to_owned(),
        })?;
    let observations = observations(frame, field)?;
    let mut context = SolveContext {
        neighbours: solved_neighbours(document, index),
        motion: lookup.prior(index),
        ..SolveContext::new(frame.image_size)
    };
    if let Some(proposed) = frame.proposed() {
        inform(&mut context, &base, &proposed, &observations);
    }
    let solution = solve_frame(&base, &observations, &context)?;
    if context.prior.is_some() {
        // Too few clicks to say anything about each other.
        return Ok(solution);
    }
    let finding = check_identity(&base, field, &observations, &solution, &context);
    Ok(solution.with_identity(finding))
}

/// Where the camera was in the nearest solved frames of the same camera and shot, nearest first.
#[must_use]
pub fn solved_neighbours(document: &Document, index: usize) -> Vec<Ptz> {
    /// Farther away a camera has had time to go anywhere.
    const WITHIN: usize = 50;
    let Some(frame) = document.frames.get(index) else {
        return Vec::new();
    };
    let mut found = Vec::with_capacity(NEIGHBOURS);
    for distance in 1..=WITHIN {
        let both = [index.checked_sub(distance), index.checked_add(distance)];
        for other in both
            .into_iter()
            .flatten()
            .filter_map(|other| document.frames.get(other))
        {
            if other.camera == frame.camera
                && other.clip == frame.clip
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
