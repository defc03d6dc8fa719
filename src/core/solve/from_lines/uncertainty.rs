//! How far the camera of one picture is to be trusted.
//!
//! People's scatter about a line is measured from the residuals of the picture itself, together
//! with the usual one, which counts as [`USUAL_FREEDOM`] degrees of freedom. Points that the robust
//! loss weighs less are less certain by that weight. All points of a line share its displacement,
//! which does not average out over them. The covariance of the shared parameters is the
//! inverse of their normal equations after elimination of pan, tilt and focal length, the priors
//! included; that of pan, tilt and focal length given the shared parameters follows as for any
//! frame ([`Uncertainty`]). So a narrow view, which determines distance and focal length only
//! together, states tens of metres for the position and little for the overlay.

use super::fit::{PictureFit, PictureState};
use super::hypotheses::FINAL_LOSS;
use super::priors::FocalPrior;
use super::{CameraFromLines, FromLinesError, FromLinesOptions, LinePicture};
use crate::camera::{BaseSigma, CameraBase, Ptz, PtzCamera};
use crate::field::{Curve, FieldModel};
use crate::geometry::{Angle, Vec2};
use crate::solve::{Loss, Observation, ObservedShape, PtzPrior, Uncertainty};
use nalgebra::SMatrix;

/// The usual scatter of drawn points as a multiple of the stated one.
const USUAL_SCATTER: f64 = 1.0;

/// The degrees of freedom that the usual scatter counts for.
const USUAL_FREEDOM: f64 = 6.0;

/// How far a line as drawn is from where the field's model has it, 1-σ across it, as a fraction of
/// the field's width: 9 cm on a soccer pitch. People draw one edge of the paint or the other,
/// pitches are not painted to the centimetre, and few are of exactly the stated size.
const LINE_DISPLACEMENT: f64 = 0.09 / 68.0;

/// Equations that the camera's parameters use up: position, rotation and focal length, and about
/// two for lens and principal point.
const PARAMETERS: f64 = 9.0;

/// The ratio of the points' scatter to the stated one, from their weighted squares.
fn scatter(observations: &[Observation], camera: &PtzCamera) -> f64 {
    let (mut squares, mut equations) = (0.0, 0.0);
    for observation in observations {
        if let Some((z_squared, weight)) = weigh(observation, camera) {
            squares += weight * z_squared;
            equations += observation.equations() as f64;
        }
    }
    // The mean of both variances, each with its degrees of freedom as its weight: few points leave
    // the usual scatter, many replace it.
    let freedom = (equations - PARAMETERS).max(0.0);
    let variance =
        (USUAL_FREEDOM * USUAL_SCATTER * USUAL_SCATTER + squares) / (USUAL_FREEDOM + freedom);
    variance.sqrt()
}

/// The squared distance of an observation, sigmas², and the weight that the fit gives it; none
/// where its shape has no image.
fn weigh(observation: &Observation, camera: &PtzCamera) -> Option<(f64, f64)> {
    let z_squared = (observation.distance_px(camera)? / observation.sigma_px).powi(2);
    Some((z_squared, FINAL_LOSS.evaluate(z_squared).1))
}

/// How much a displacement of its line moves an observation, 1-σ, px; none where its shape has no
/// image.
fn displacement_px(
    field: &FieldModel,
    camera: &PtzCamera,
    observation: &Observation,
) -> Option<f64> {
    let here = observation.shape.jacobian(camera, observation.image)?;
    // A point's image moves in two directions: this is the mean of both.
    let by_ground = here.by_world.fixed_columns::<2>(0).norm();
    let directions = observation.equations() as f64;
    Some(LINE_DISPLACEMENT * field.width_m * by_ground / directions.sqrt())
}

/// How many points share the displacement of an observation's line, for each direction in which the
/// line can be displaced.
fn points_together(observation: &Observation, observations: &[Observation]) -> f64 {
    let on_line = observations
        .iter()
        .filter(|other| other.shape == observation.shape);
    let count = on_line.count() as f64;
    // A circle can be displaced in two directions, of which a point sees one: half of the points
    // share each.
    match observation.shape {
        ObservedShape::Curve(curve) if matches!(curve.nominal(), Curve::Arc { .. }) => {
            (0.5 * count).max(1.0)
        }
        _ => count,
    }
}

impl CameraFromLines {
    /// 1-σ of the distance of a drawn point from the overlay of its line or landmark, px: by the
    /// camera, by the line's place on this field, and by the scatter of drawing. None where it has
    /// no image.
    pub fn distance_sigma_px(&self, field: &FieldModel, observation: &Observation) -> Option<f64> {
        let camera = self.camera();
        let here = observation.shape.jacobian(&camera, observation.image)?;
        let overlay = self
            .uncertainty
            .overlay_at_world(&camera, here.nearest_in_world)?;
        // The overlay's variance counts in the direction in which the distance is measured. A point
        // exactly on its line has none; any direction will do.
        let offset = observation.shape.offset_px(&camera, observation.image)?;
        let across = offset.try_normalize(1e-9).unwrap_or(Vec2::new(1.0, 0.0));
        let by_camera = across.dot(&(overlay * across)).max(0.0).sqrt();
        let displaced = displacement_px(field, &camera, observation)?;
        Some(
            by_camera
                .hypot(displaced)
                .hypot(self.scatter * observation.sigma_px),
        )
    }
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
        let scattered_px = observation.sigma_px * scatter / weight.sqrt();
        // What the points of one line have in common does not average out over them.
        let together = points_together(observation, observations);
        // n points with the variance n d² each average to d².
        let displaced_px = displacement_px(picture.field, &camera, observation)? * together.sqrt();
        Some(Observation {
            sigma_px: scattered_px.hypot(displaced_px),
            ..*observation
        })
    });
    let weighted: Vec<Observation> = weighted.collect();

    // The crown counts as unknown within its prior even where the fit takes the field's.
    let stated = FromLinesOptions {
        fits_crown: picture.field.may_be_crowned(),
        ..*options
    };
    let fit = PictureFit::new(picture, &weighted, state, &stated, Loss::Squared);
    let covariance = fit.covariance(state).ok_or(FromLinesError::Undetermined)?;

    // Return to the pan gauge: the rotation that it takes out of the base is added to the pan.
    let (base, added) = state.shared.base.in_pan_gauge();
    let base = CameraBase {
        sigma: BaseSigma::from_covariance(&covariance, state.shared.crown.width_m),
        ..base
    };
    let ptz = Ptz {
        pan: (state.ptz.pan + added).wrap(),
        ..state.ptz
    };
    let camera = PtzCamera::new(base, ptz);
    let focal = options.priors.focal(picture.image_size);
    let uncertainty =
        Uncertainty::from_observations(&camera, &weighted, Some(&prior_of_focal(&focal, ptz)))
            .map_err(|_| FromLinesError::Undetermined)?;
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
