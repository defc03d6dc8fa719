//! The uncertainty of a reference's camera, if the base is exact.

use crate::calibrate::{observations, own_covariance};
use touchline_core::camera::PtzCamera;
use touchline_core::field::FieldModel;
use touchline_core::solve::{ClickResidual, Observation, Uncertainty};
use touchline_documents::document::{Frame, SolutionSource};
use touchline_vision::relocalize::{Label, Misfit};

/// The label of a reference: covariance and misfit from its clicks. If it was solved in another way
/// than from clicks or by an import, or if its clicks do not determine a camera, the covariance
/// that is stored with it.
pub(super) fn label_of(frame: &Frame, field: Option<&FieldModel>, camera: &PtzCamera) -> Label {
    let source = frame.source();
    // Clicks give the misfit besides, which shows whether a label is worse than its covariance
    // says.
    let is_by_clicks = matches!(
        source,
        None | Some(SolutionSource::Clicks | SolutionSource::Points | SolutionSource::Import)
    );
    let known = field
        .filter(|_| is_by_clicks)
        .and_then(|field| label_by_clicks(frame, field, camera));
    // The uncertainty of the base is common to all references and is added later.
    known.unwrap_or_else(|| Label {
        covariance: own_covariance(frame, camera, field),
        misfit: None,
    })
}

/// The label by the clicks of a reference; none if they do not determine a camera.
fn label_by_clicks(frame: &Frame, field: &FieldModel, camera: &PtzCamera) -> Option<Label> {
    let clicks = observations(frame, field).ok()?;
    let used: Vec<Observation> = clicks.into_iter().filter(|click| !click.check).collect();
    let uncertainty = Uncertainty::from_observations(camera, &used, None).ok()?;
    Some(Label {
        covariance: uncertainty.clicks,
        misfit: misfit(camera, &used, &uncertainty),
    })
}

/// The misfit of the clicks to the camera: χ², and its expected value, which is the number of
/// equations minus three parameters, plus the part from the base. None if the camera does not show
/// one of the clicks, or there are fewer equations than parameters.
fn misfit(camera: &PtzCamera, clicks: &[Observation], uncertainty: &Uncertainty) -> Option<Misfit> {
    let chi_squared = clicks
        .iter()
        .map(|click| {
            let distance_px = ClickResidual::from_observation(camera, click).distance_px()?;
            Some((distance_px / click.sigma_px).powi(2))
        })
        .sum::<Option<f64>>()?;
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
