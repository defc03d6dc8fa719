//! How well the camera of a reference is known, if its base is exact.

use crate::calibrate::{observations, own_covariance};
use touchline_core::camera::PtzCamera;
use touchline_core::field::FieldModel;
use touchline_core::solve::{ClickResidual, Observation, Uncertainty};
use touchline_documents::document::{Frame, SolutionSource};
use touchline_vision::relocalize::{Label, Misfit};

/// What is known of a reference's camera by its clicks; by what is stored of its own evidence where
/// it was not solved from clicks.
pub(super) fn label_of(frame: &Frame, field: Option<&FieldModel>, camera: &PtzCamera) -> Label {
    let source = frame.source();
    let by_clicks = || {
        let clicks = observations(frame, field?).ok()?;
        let used: Vec<Observation> = clicks.into_iter().filter(|click| !click.check).collect();
        let uncertainty = Uncertainty::of(camera, &used, None).ok()?;
        Some(Label {
            covariance: uncertainty.clicks,
            misfit: misfit(camera, &used, &uncertainty),
        })
    };
    let is_by_clicks = matches!(
        source,
        None | Some(SolutionSource::Clicks | SolutionSource::Import)
    );
    let known = if is_by_clicks { by_clicks() } else { None };
    // What the base's uncertainty adds is the same for all references, and added elsewhere.
    known.unwrap_or_else(|| Label {
        covariance: own_covariance(frame, camera, field),
        misfit: None,
    })
}

/// How well the clicks of a label fit its camera; none where the camera does not show one of them.
fn misfit(camera: &PtzCamera, clicks: &[Observation], uncertainty: &Uncertainty) -> Option<Misfit> {
    let squared = |click: &Observation| {
        Some((ClickResidual::of(camera, click).distance_px()? / click.sigma_px).powi(2))
    };
    let chi_squared = clicks.iter().map(squared).sum::<Option<f64>>()?;
    let surplus = clicks
        .iter()
        .map(Observation::equations)
        .sum::<usize>()
        .checked_sub(3)?;
    Some(Misfit {
        chi_squared,
        expected: surplus as f64 + uncertainty.base_misfit(camera, clicks),
    })
}
