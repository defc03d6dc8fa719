//! How well the camera of a reference is known, if its base is exact.

use crate::calibrate::observations;
use crate::camera::PtzCamera;
use crate::document::{Frame, SolutionSource};
use crate::field::FieldModel;
use crate::geometry::Mat3;
use crate::relocalize::usual_label;
use crate::solve::{Observation, Uncertainty};

/// Covariance of (pan rad, tilt rad, focal px) of a reference's camera by its clicks; by the stored covariance where it was not
/// solved from clicks; else as four clicks tell it.
pub(super) fn label_covariance(frame: &Frame, field: Option<&FieldModel>, camera: &PtzCamera) -> Mat3 {
    let source = frame.solution.as_ref().and_then(|solution| solution.source);
    let by_clicks = || {
        let clicks = observations(frame, field?).ok()?;
        let used: Vec<Observation> = clicks.into_iter().filter(|click| !click.check).collect();
        Uncertainty::of(camera, &used, None).ok().map(|uncertainty| uncertainty.clicks)
    };
    // What the base's uncertainty adds is the same for all references, and told apart.
    let stored = || {
        let covariance = frame.solution.as_ref()?.covariance?;
        Some(Uncertainty::of_stored(camera, &covariance, frame.image_size)?.clicks)
    };
    let known = match source {
        None | Some(SolutionSource::Clicks | SolutionSource::Import) => by_clicks().or_else(stored),
        Some(_) => stored().or_else(by_clicks),
    };
    known.unwrap_or_else(|| usual_label(camera, frame.image_size))
}
