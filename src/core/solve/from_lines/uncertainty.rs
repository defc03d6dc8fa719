//! How far the camera of one picture is to be trusted.
//!
//! People's scatter about a line is measured from the residuals of the picture itself, together
//! with the usual one, which counts as [`USUAL_FREEDOM`] degrees of freedom. Points that the robust
//! loss weighs less are less certain by that weight. The covariance of the shared parameters is the
//! inverse of their normal equations after elimination of pan, tilt and focal length, the priors
//! included; that of pan, tilt and focal length given the shared parameters follows as for any
//! frame ([`Uncertainty`]). So a narrow view, which determines distance and focal length only
//! together, states tens of metres for the position and little for the overlay.

use super::fit::{PictureFit, PictureState};
use super::priors::FocalPrior;
use super::{CameraFromLines, FINAL_LOSS, FromLinesError, FromLinesOptions, LinePicture};
use crate::camera::{BaseSigma, CameraBase, Ptz, PtzCamera};
use crate::geometry::Angle;
use crate::solve::base::CrownModel;
use crate::solve::{Loss, Observation, PtzPrior, Uncertainty};
use nalgebra::SMatrix;

/// The usual scatter of drawn points as a multiple of the stated one.
const USUAL_SCATTER: f64 = 1.0;

/// The degrees of freedom that the usual scatter counts for.
const USUAL_FREEDOM: f64 = 6.0;

/// Equations that the camera's own parameters use up: position, rotation and focal length.
const PARAMETERS: f64 = 7.0;

/// The ratio of the points' scatter to the stated one, from their weighted squares.
fn scatter(observations: &[Observation], camera: &PtzCamera) -> f64 {
    let (mut squares, mut equations) = (0.0, 0.0);
    for observation in observations {
        if let Some((z_squared, weight)) = weigh(observation, camera) {
            squares += weight * z_squared;
            equations += observation.equations() as f64;
        }
    }
    let freedom = (equations - PARAMETERS).max(0.0);
    let variance =
        (USUAL_FREEDOM * USUAL_SCATTER * USUAL_SCATTER + squares) / (USUAL_FREEDOM + freedom);
    variance.sqrt()
}

/// The squared distance of an observation, sigmas², and the weight that the fit gives it; none
/// where its shape has no image.
fn weigh(observation: &Observation, camera: &PtzCamera) -> Option<(f64, f64)> {
    let z_squared = (observation.distance_px(camera)? / observation.sigma_px).powi(2);
    Some((z_squared, FINAL_LOSS.of(z_squared).1))
}

/// The camera of a fitted state with its uncertainty. `observations` are those of the fit, on the
/// ground with the fitted crown.
pub(super) fn state_uncertainty(
    picture: &LinePicture<'_>,
    observations: &[Observation],
    state: &PictureState,
    options: &FromLinesOptions,
) -> Result<CameraFromLines, FromLinesError> {
    let camera = state.camera();
    let scatter = scatter(observations, &camera);
    let weighted = observations.iter().filter_map(|observation| {
        let (_, weight) = weigh(observation, &camera)?;
        Some(Observation {
            sigma_px: observation.sigma_px * scatter / weight.sqrt(),
            ..*observation
        })
    });
    let weighted: Vec<Observation> = weighted.collect();

    // The crown counts as unknown within its prior even where the fit takes the field's.
    let crown = if picture.field.may_be_crowned() {
        CrownModel::Free
    } else {
        CrownModel::Fixed(picture.field.crown_m)
    };
    let fit = PictureFit::new(
        picture,
        &weighted,
        state,
        crown,
        &options.priors,
        Loss::Squared,
    );
    let covariance = fit.covariance(state).ok_or(FromLinesError::NoFit {
        median_px: f64::INFINITY,
    })?;

    // Return to the pan gauge: the rotation that it takes out of the base is added to the pan.
    let (base, added) = state.shared.base.in_pan_gauge();
    let base = CameraBase {
        sigma: BaseSigma::from_covariance(&covariance, state.shared.crown.width_m),
        ..base
    };
    let ptz = Ptz {
        pan: (state.ptz.pan + added).wrapped(),
        ..state.ptz
    };
    let camera = PtzCamera::new(base, ptz);
    let focal = options.priors.focal(picture.image_size.width);
    let uncertainty = Uncertainty::of(&camera, &weighted, Some(&prior_of_focal(&focal, ptz)))
        .map_err(|_| FromLinesError::NoFit {
            median_px: f64::INFINITY,
        })?;
    Ok(CameraFromLines {
        base,
        ptz,
        crown_m: state.shared.crown.height_m,
        uncertainty,
        scatter,
        identity: None,
    })
}

/// The prior of the focal length as one of pan, tilt and focal length about a camera.
fn prior_of_focal(focal: &FocalPrior, ptz: Ptz) -> PtzPrior {
    PtzPrior {
        ptz,
        sigma_pan: Angle::from_radians(f64::INFINITY),
        sigma_tilt: Angle::from_radians(f64::INFINITY),
        sigma_focal_share: focal.sigma_log,
        by_base: SMatrix::zeros(),
    }
}
