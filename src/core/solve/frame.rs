//! One frame: its clicks and a known base give pan, tilt and focal length.

use super::refine::{refine, squared_sigmas};
use super::{
    Candidate, CheckResult, ClickResidual, FrameSolution, Loss, Observation, PtzPrior, PtzStep,
    SolveContext, SolveError, Uncertainty,
};
use crate::camera::{CameraBase, Ptz, PtzCamera};
use crate::geometry::{Angle, ImageSize, keep_distinct};
use crate::solve::initial_cameras::focal_sweep::is_upright;
use crate::solve::initial_cameras::starts::{camera_distance, find_starts, scan_starts};
use crate::solve::initial_cameras::two_point::MIN_RAY_ANGLE_DEG;
use crate::solve::observations::observation::landmark_observations;
use crate::solve::observations::shape::ShapeJacobian;
use crate::solve::outcome::checks;
use crate::solve::priors::prior::SAME_FIT;
use nalgebra::{Matrix2, SMatrix};
use std::cmp::Ordering;

/// Candidates nearer to each other than this (see [`camera_distance`]) are merged.
const SAME_CAMERA: f64 = 1e-4;

/// A landmark nearer to the camera than this indicates a wrong base, m.
const MIN_DISTANCE_M: f64 = 0.1;

/// Solves one frame: closed forms on the clicks, refinement on all of them, covariance, checks and
/// warnings.
///
/// Observations with `check` set are not used for the solution; their errors are reported.
/// `context` may include the cameras of neighbouring frames, which decide between candidates.
///
/// # Errors
/// The clicks do not determine the camera, contradict each other so that no camera fits, or are not
/// valid pixels. Each case has its own variant with its numbers.
pub fn solve_frame(
    base: &CameraBase,
    observations: &[Observation],
    context: &SolveContext,
) -> Result<FrameSolution, SolveError> {
    let used: Vec<Observation> = observations
        .iter()
        .filter(|observation| !observation.check)
        .copied()
        .collect();
    validate(base, &used, context)?;
    let candidates = candidates(base, &used, context)?;
    let (chosen, others) = choose(candidates, context).ok_or(SolveError::NoFit {
        observations: used.len(),
    })?;
    let camera = PtzCamera::new(*base, chosen.ptz);

    // Weight the observations as the robust loss did, and count the equations of those that have an
    // image. Those without one gave no gradient either.
    let residuals: Vec<ClickResidual> = used
        .iter()
        .map(|observation| ClickResidual::from_observation(&camera, observation))
        .collect();
    let seen: Vec<Observation> = used
        .iter()
        .zip(&residuals)
        .filter_map(|(seen, residual)| as_weighted(seen, residual, context.loss))
        .collect();
    let prior_equations = if context.prior.is_some() { 3 } else { 0 };
    let equations = prior_equations + seen.iter().map(Observation::equations).sum::<usize>();
    if equations < 3 {
        let unseen = residuals
            .iter()
            .find(|residual| residual.offset_px.is_none());
        return Err(match unseen {
            Some(residual) => SolveError::BehindCamera {
                click: residual.click,
            },
            None => SolveError::TooFewObservations { equations },
        });
    }

    // Three equations determine pan, tilt and focal length; the surplus is what χ² is compared
    // with. An uncertain base adds to the expected χ².
    let uncertainty = Uncertainty::from_observations(&camera, &seen, context.prior.as_ref())?;
    let mut solution = FrameSolution {
        ptz: chosen.ptz,
        lens: camera.lens(),
        covariance: uncertainty.ptz_covariance_deg(),
        rms_px: chosen.rms_px,
        redundancy: equations - 3,
        chi_squared: chosen.chi_squared,
        expected_chi_squared: (equations - 3) as f64 + uncertainty.base_misfit(&camera, &seen),
        residuals,
        alternatives: others,
        worst_corner_sigma_px: uncertainty.worst_corner_sigma_px(&camera, context.image_size),
        separation_px: separation_px(&used),
        checks: observations
            .iter()
            .filter(|observation| observation.check)
            .map(|observation| check(&camera, &uncertainty, observation))
            .collect(),
        uncertainty,
        warnings: Vec::new(),
        identity: None,
    };
    solution.warnings = checks::warnings(&camera, &used, &solution, context);
    Ok(solution)
}

/// An observation with the weight w that the robust loss gave it in the solve: its σ is divided by
/// √w, so that the covariance is not computed from clicks that hardly took part. None where its
/// shape has no image.
fn as_weighted(
    observation: &Observation,
    residual: &ClickResidual,
    loss: Loss,
) -> Option<Observation> {
    let (_, weight) = loss.evaluate(squared_sigmas(
        Some(residual.distance_px()?),
        observation.sigma_px,
    ));
    Some(Observation {
        sigma_px: observation.sigma_px / weight.sqrt(),
        ..*observation
    })
}

/// The best camera for valid clicks; none if fewer than three equations are given or nothing fits.
pub(super) fn best_fit(
    base: &CameraBase,
    used: &[Observation],
    context: &SolveContext,
) -> Option<Candidate> {
    let equations: usize = used.iter().map(Observation::equations).sum();
    let fits = if equations >= 3 {
        candidates(base, used, context).ok()?
    } else {
        return None;
    };
    Some(choose(fits, context)?.0)
}

/// The camera that refinement reaches from one start, for valid clicks; none if it is upside down
/// or not finite.
pub(super) fn fit_from(
    base: &CameraBase,
    start: Ptz,
    used: &[Observation],
    context: &SolveContext,
) -> Option<Candidate> {
    Some(refine_start(base, start, used, context)?.candidate)
}

/// Checks the input: finite values, clicks inside the frame, landmarks away from and in front of
/// the camera, enough equations.
fn validate(
    base: &CameraBase,
    used: &[Observation],
    context: &SolveContext,
) -> Result<(), SolveError> {
    if !base.is_finite() {
        return Err(SolveError::BaseNotFinite);
    }
    // The order is that of the remedies: a click that is no pixel first, then names that contradict
    // the base, then what is missing.
    let ImageSize { width, height } = context.image_size;
    for observation in used {
        let (click, image) = (observation.click, observation.image);
        let finite_sigma = observation.sigma_px > 0.0 && observation.sigma_px.is_finite();
        if !(image.is_finite() && finite_sigma && observation.shape.is_finite()) {
            return Err(SolveError::NotFinite { click });
        }
        if !context.image_size.contains(image) {
            return Err(SolveError::OutsideFrame {
                click,
                x: image.x,
                y: image.y,
                width,
                height,
            });
        }
        if let Some(at) = observation.shape.point() {
            let distance_m = (at - base.position_m).norm();
            if !(distance_m > MIN_DISTANCE_M) {
                return Err(SolveError::AtCamera { click, distance_m });
            }
        }
    }
    if let Some(click) = behind_the_other(base, used) {
        return Err(SolveError::BehindCamera { click });
    }
    let equations: usize = used.iter().map(Observation::equations).sum();
    if equations + if context.prior.is_some() { 3 } else { 0 } < 3 || used.is_empty() {
        return Err(SolveError::TooFewObservations { equations });
    }
    Ok(())
}

/// If the only clicks are two landmarks more than a right angle apart, the one farther from the
/// base's viewing direction. No picture of a sports camera shows both.
fn behind_the_other(base: &CameraBase, used: &[Observation]) -> Option<usize> {
    let [one, two] = used else { return None };
    let [ray_one, ray_two] = [one.shape.point()?, two.shape.point()?]
        .map(|at| base.base_from_world_point(at).normalize());
    // The two-point solve reports opposite rays as an error of their own.
    let opposite = ray_one.cross(&ray_two).norm().asin().to_degrees() < MIN_RAY_ANGLE_DEG;
    // z of `base` is the direction of pan and tilt zero.
    (ray_one.dot(&ray_two) < 0.0 && !opposite).then_some(if ray_one.z < ray_two.z {
        one.click
    } else {
        two.click
    })
}

/// A refined start with its robust cost.
struct Fit {
    cost: f64,
    candidate: Candidate,
}

/// Refines every start and merges duplicates; the best fit comes first.
///
/// Two landmarks alone may allow two focal lengths (see `two_point.rs`). If refinement leads both
/// to one camera, the root farther from it stays a candidate at its own focal length, with pan and
/// tilt refined: the user can still choose it.
fn candidates(
    base: &CameraBase,
    used: &[Observation],
    context: &SolveContext,
) -> Result<Vec<Fit>, SolveError> {
    let starts = find_starts(base, used, context)?;
    let mut found: Vec<Fit> = starts
        .iter()
        .filter_map(|start| refine_start(base, *start, used, context))
        .collect();
    found.sort_by(|a, b| a.cost.total_cmp(&b.cost));
    // Near the fold of the lens a pair may have a camera that cannot be reached from a pinhole
    // root.
    if found.first().is_none_or(|best| best.cost > SAME_FIT)
        && used.len() == 2
        && context.prior.is_none()
    {
        found.extend(
            scan_starts(base, used)
                .into_iter()
                .filter_map(|start| refine_start(base, start, used, context)),
        );
        found.sort_by(|a, b| a.cost.total_cmp(&b.cost));
    }
    let mut found = merge_duplicates(found);

    // Both roots led to one camera: restore the other one.
    if let ([one, two], [kept]) = (starts.as_slice(), found.as_slice())
        && used.len() == 2
        && context.prior.is_none()
    {
        let apart = |root: &Ptz| (root.focal_px / kept.candidate.ptz.focal_px).ln().abs();
        let lost = if apart(one) > apart(two) { *one } else { *two };
        if apart(&lost) > SAME_CAMERA {
            // Its cost is that of the clicks: at its own focal length the prior adds nothing.
            let refined = refine(base, lost, used, context.loss, Some(&focal_held(lost)));
            found.extend(fit(base, refined.ptz, refined.cost, used, context));
        }
    }
    Ok(found)
}

/// The fits, the best first, without those of a camera that a better one has.
fn merge_duplicates(fits: Vec<Fit>) -> Vec<Fit> {
    // Each is compared with all before it: fits of two cameras may alternate in the order of their
    // costs, which differ by rounding alone.
    let most = fits.len();
    keep_distinct(fits, most, |one, other| {
        camera_distance(&one.candidate.ptz, &other.candidate.ptz) >= SAME_CAMERA
    })
}

/// The fit that refinement reaches from a start; none if it is upside down or not finite.
fn refine_start(
    base: &CameraBase,
    start: Ptz,
    used: &[Observation],
    context: &SolveContext,
) -> Option<Fit> {
    let refined = refine(base, start, used, context.loss, context.prior.as_ref());
    fit(base, refined.ptz, refined.cost, used, context)
}

/// A prior that fixes the focal length and leaves pan and tilt free.
fn focal_held(ptz: Ptz) -> PtzPrior {
    let free = Angle::from_degrees(1e6);
    PtzPrior {
        ptz,
        sigma_pan: free,
        sigma_tilt: free,
        sigma_focal_share: 1e-9,
        by_base: SMatrix::zeros(),
    }
}

/// Evaluates a camera on the clicks; none if it is upside down (|tilt| > 90°) or not finite.
fn fit(
    base: &CameraBase,
    ptz: Ptz,
    cost: f64,
    used: &[Observation],
    context: &SolveContext,
) -> Option<Fit> {
    if !is_upright(&ptz) {
        return None;
    }
    // A click without an image counts with a large constant in χ², so that a camera that hides it
    // does not look better; it has no distance for the mean in px.
    let camera = PtzCamera::new(*base, ptz);
    let (mut squares, mut seen, mut chi_squared) = (0.0, 0u32, 0.0);
    for observation in used {
        let distance_px = observation.distance_px(&camera);
        chi_squared += squared_sigmas(distance_px, observation.sigma_px);
        if let Some(distance_px) = distance_px {
            squares += distance_px * distance_px;
            seen += 1;
        }
    }
    let rms_px = (squares / f64::from(seen.max(1))).sqrt();
    let candidate = Candidate {
        ptz,
        rms_px,
        chi_squared,
        plausible: context.ranges.contains(&ptz),
    };
    Some(Fit { cost, candidate })
}

/// Chooses among candidates, and returns the others, best first. Plausible candidates come before
/// implausible ones, better fits before worse ones. Among those whose costs differ by at most
/// [`SAME_FIT`], the one nearest to the start is chosen; without a start the most usual one under
/// the motion prior, then the one nearest to the neighbouring frames.
fn choose(mut fits: Vec<Fit>, context: &SolveContext) -> Option<(Candidate, Vec<Candidate>)> {
    // `false` comes first; the sort is stable, so the order by cost remains within both groups.
    fits.sort_by_key(|fit| !fit.candidate.plausible);
    let first = fits.first()?;
    let (plausible, best_cost) = (first.candidate.plausible, first.cost);
    let as_good = fits
        .iter()
        .take_while(|fit| fit.candidate.plausible == plausible && fit.cost <= best_cost + SAME_FIT)
        .count();
    // The first of equals is the best fit.
    let deviations: Vec<Deviation> = fits[..as_good]
        .iter()
        .map(|fit| Deviation::new(&fit.candidate.ptz, context))
        .collect();
    let chosen = (0..as_good)
        .min_by(|&a, &b| deviations[a].total_cmp(&deviations[b]))
        .unwrap_or(0);
    let chosen = fits.remove(chosen).candidate;
    Some((chosen, fits.into_iter().map(|fit| fit.candidate).collect()))
}

/// How far a camera is from what is known beside the clicks.
struct Deviation {
    /// χ² under the motion prior; 0 where a start is known.
    surprise: f64,
    /// The distance from the expected camera ([`camera_distance`]); 0 where none is expected.
    distance: f64,
}

impl Deviation {
    fn new(ptz: &Ptz, context: &SolveContext) -> Self {
        let surprise = match context.start {
            Some(_) => 0.0,
            None => context.motion.surprise(ptz, &PtzStep::ZERO),
        };
        let distance = context
            .expected_ptz()
            .map_or(0.0, |expected| camera_distance(ptz, &expected));
        Self { surprise, distance }
    }

    /// The order by surprise, then by distance.
    fn total_cmp(&self, other: &Self) -> Ordering {
        self.surprise
            .total_cmp(&other.surprise)
            .then_with(|| self.distance.total_cmp(&other.distance))
    }
}

/// The error of a held-out click, and its Mahalanobis distance under the sum of click noise and the
/// overlay's covariance at the nearest point of its shape.
fn check(camera: &PtzCamera, uncertainty: &Uncertainty, observation: &Observation) -> CheckResult {
    // The nearest point of a curve moves along it with the camera, which does not change the
    // distance to first order: the covariance across the curve is that of this one point.
    let here = observation.shape.jacobian(camera, observation.image);
    let found = here.and_then(|here| {
        let overlay = uncertainty.overlay_at_world(camera, here.nearest_in_world)?;
        let z_score = z_score(&here, &overlay, observation.sigma_px)?;
        Some((here.value_px.norm(), z_score))
    });
    let (error_px, z_score) = found.unzip();
    CheckResult {
        click: observation.click,
        error_px,
        z_score,
    }
}

/// The Mahalanobis distance of a click from its shape, given the covariance of the overlay (px²)
/// and the 1-σ of the click; none if the sum of both is singular.
fn z_score(here: &ShapeJacobian, overlay: &Matrix2<f64>, sigma_px: f64) -> Option<f64> {
    let noise = Matrix2::identity() * (sigma_px * sigma_px);
    let covariance = here.by_image * overlay * here.by_image.transpose() + noise;
    Some(
        here.value_px
            .dot(&(covariance.try_inverse()? * here.value_px))
            .sqrt(),
    )
}

/// The largest distance between two landmark clicks, px.
fn separation_px(used: &[Observation]) -> Option<f64> {
    let pairs = landmark_observations(used)
        .enumerate()
        .flat_map(|(i, one)| {
            landmark_observations(used)
                .skip(i + 1)
                .map(move |two| one.image.distance_px(two.image))
        });
    pairs.max_by(f64::total_cmp)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn fit_at(cost: f64, pan_deg: f64) -> Fit {
        let candidate = Candidate {
            ptz: Ptz::from_degrees(pan_deg, -10.0, 2000.0),
            rms_px: 0.0,
            chi_squared: cost,
            plausible: true,
        };
        Fit { cost, candidate }
    }

    #[test]
    fn a_duplicate_is_merged_wherever_it_comes_in_the_order() {
        let fits = vec![fit_at(1.0, 5.0), fit_at(1.1, 20.0), fit_at(1.2, 5.0)];
        let costs: Vec<f64> = merge_duplicates(fits).iter().map(|fit| fit.cost).collect();
        assert_eq!(costs, [1.0, 1.1]);
    }
}
