//! How well the camera of a reference is known, if its base is exact.

use crate::calibrate::observations;
use crate::camera::PtzCamera;
use crate::document::{Frame, SolutionSource};
use crate::field::FieldModel;
use crate::relocalize::{Label, Misfit, usual_label};
use crate::solve::{ClickResidual, Observation, Uncertainty};

/// What is known of a reference's camera by its clicks; by the stored covariance where it was not solved from clicks; else as four
/// clicks tell it.
pub(super) fn label_of(frame: &Frame, field: Option<&FieldModel>, camera: &PtzCamera) -> Label {
    let source = frame.solution.as_ref().and_then(|solution| solution.source);
    let by_clicks = || {
        let clicks = observations(frame, field?).ok()?;
        let used: Vec<Observation> = clicks.into_iter().filter(|click| !click.check).collect();
        let uncertainty = Uncertainty::of(camera, &used, None).ok()?;
        Some(Label { covariance: uncertainty.clicks, misfit: misfit(camera, &used, &uncertainty) })
    };
    // What the base's uncertainty adds is the same for all references, and told apart.
    let stored = || {
        let covariance = frame.solution.as_ref()?.covariance?;
        let covariance = Uncertainty::of_stored(camera, &covariance, frame.image_size)?.clicks;
        Some(Label { covariance, misfit: None })
    };
    let known = match source {
        None | Some(SolutionSource::Clicks | SolutionSource::Import) => by_clicks().or_else(stored),
        Some(_) => stored().or_else(by_clicks),
    };
    known.unwrap_or_else(|| Label { covariance: usual_label(camera, frame.image_size), misfit: None })
}

/// How well the clicks of a label fit its camera; none where the camera does not show one of them.
fn misfit(camera: &PtzCamera, clicks: &[Observation], uncertainty: &Uncertainty) -> Option<Misfit> {
    let squared =
        |click: &Observation| Some((ClickResidual::of(camera, click).distance_px()? / click.sigma_px).powi(2));
    let chi_squared = clicks.iter().map(squared).sum::<Option<f64>>()?;
    let surplus = clicks.iter().map(Observation::equations).sum::<usize>().checked_sub(3)?;
    Some(Misfit { chi_squared, expected: surplus as f64 + uncertainty.base_misfit(camera, clicks) })
}
