//! One frame: its clicks and a known base give pan, tilt and focal length.

use super::line::line_residual;
use super::refine::{distance_px, refine, squared_sigmas};
use super::starts::{camera_distance, starts};
use super::{
    Candidate, CheckResult, ClickResidual, FrameSolution, Observation, SolveContext, SolveError, Target, Uncertainty,
    checks,
};
use crate::camera::{CameraBase, PtzCamera};
use crate::geometry::ImageSize;
use nalgebra::Matrix2;

/// Two candidates whose χ² differ by less than this (times its expectation) cannot be told apart by the clicks.
pub(super) const SAME_FIT: f64 = 9.0;

/// Candidates nearer to each other than this (see [`camera_distance`]) are one.
const SAME_CAMERA: f64 = 1e-4;

/// A landmark this near to the camera is a mistake in the base, m.
const MIN_DISTANCE_M: f64 = 0.1;

/// Solves one frame: closed forms on the clicks, refinement on all of them, covariance, checks and warnings.
///
/// Observations with `check` set take no part; their errors are reported. `context` may hold what is known of the
/// neighbouring frames; it chooses between candidates.
///
/// # Errors
/// The clicks do not determine the camera, contradict each other beyond solving, or are no valid pixels; each case is named
/// with its numbers.
pub fn solve_frame(
    base: &CameraBase,
    observations: &[Observation],
    context: &SolveContext,
) -> Result<FrameSolution, SolveError> {
    let used: Vec<Observation> = observations.iter().filter(|observation| !observation.check).copied().collect();
    validate(base, &used, context)?;
    let candidates = candidates(base, &used, context)?;
    let (chosen, others) = choose(candidates, context).ok_or(SolveError::NoFit { observations: used.len() })?;
    let camera = PtzCamera::new(*base, chosen.ptz);
    let residuals: Vec<ClickResidual> = used.iter().map(|observation| residual(&camera, observation)).collect();
    let seen: Vec<Observation> = used
        .iter()
        .zip(&residuals)
        .filter(|(_, residual)| residual.offset_px.is_some())
        .map(|(observation, _)| *observation)
        .collect();
    let prior_equations = if context.prior.is_some() { 3 } else { 0 };
    let equations = prior_equations + seen.iter().map(|observation| observation.target.equations()).sum::<usize>();
    if equations < 3 {
        let unseen = residuals.iter().find(|residual| residual.offset_px.is_none());
        return Err(match unseen {
            Some(residual) => SolveError::BehindCamera { click: residual.click },
            None => SolveError::TooFewObservations { equations },
        });
    }
    let uncertainty = Uncertainty::of(&camera, &seen, context.prior.as_ref())?;
    let mut solution = FrameSolution {
        ptz: chosen.ptz,
        k1: camera.k1(),
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
    };
    solution.warnings = checks::warnings(&camera, &used, &solution, context);
    Ok(solution)
}

/// What must hold before anything is computed.
fn validate(base: &CameraBase, used: &[Observation], context: &SolveContext) -> Result<(), SolveError> {
    if !base.is_finite() {
        return Err(SolveError::BaseNotFinite);
    }
    let ImageSize { width, height } = context.image_size;
    for observation in used {
        let (click, image) = (observation.click, observation.image);
        let finite_target = match observation.target {
            Target::Landmark(at) => at.iter().all(|x| x.is_finite()),
            Target::Line(curve) => curve.at(0.5).at.iter().all(|x| x.is_finite()),
        };
        if !(image.is_finite() && observation.sigma_px > 0.0 && observation.sigma_px.is_finite() && finite_target) {
            return Err(SolveError::NotFinite { click });
        }
        if !context.image_size.contains(image) {
            return Err(SolveError::OutsideFrame { click, x: image.x, y: image.y, width, height });
        }
        if let Target::Landmark(at) = observation.target {
            let distance_m = (at - base.position_m).norm();
            if !(distance_m > MIN_DISTANCE_M) {
                return Err(SolveError::AtCamera { click, distance_m });
            }
        }
    }
    let equations: usize = used.iter().map(|observation| observation.target.equations()).sum();
    if equations + if context.prior.is_some() { 3 } else { 0 } < 3 || used.is_empty() {
        return Err(SolveError::TooFewObservations { equations });
    }
    Ok(())
}

/// A refined start with what it minimised.
struct Fit {
    cost: f64,
    candidate: Candidate,
}

/// Refines every start; duplicates merged, best fit first.
fn candidates(base: &CameraBase, used: &[Observation], context: &SolveContext) -> Result<Vec<Fit>, SolveError> {
    let mut found: Vec<Fit> = Vec::new();
    for start in starts(base, used, context)? {
        let refined = refine(base, start, used.iter(), context.loss, context.prior.as_ref());
        let ptz = refined.ptz;
        if !ptz.is_finite()
            || ptz.tilt.abs().degrees() > 90.0
            || found.iter().any(|other| camera_distance(&other.candidate.ptz, &ptz) < SAME_CAMERA)
        {
            continue;
        }
        let camera = PtzCamera::new(*base, ptz);
        let (mut squares, mut seen, mut chi_squared) = (0.0, 0u32, 0.0);
        for observation in used {
            let distance_px = distance_px(&camera, observation);
            chi_squared += squared_sigmas(distance_px, observation.sigma_px);
            if let Some(distance_px) = distance_px {
                squares += distance_px * distance_px;
                seen += 1;
            }
        }
        let rms_px = (squares / f64::from(seen.max(1))).sqrt();
        let plausible = context.ranges.contains(&ptz);
        found.push(Fit { cost: refined.cost, candidate: Candidate { ptz, rms_px, chi_squared, plausible } });
    }
    found.sort_by(|a, b| a.cost.total_cmp(&b.cost));
    Ok(found)
}

/// Chooses among candidates: plausible before implausible, the better fit before the worse; where the clicks cannot tell,
/// the one nearest to the start or to the neighbouring frames. Gives the others, best first.
fn choose(mut fits: Vec<Fit>, context: &SolveContext) -> Option<(Candidate, Vec<Candidate>)> {
    fits.sort_by_key(|fit| !fit.candidate.plausible);
    let first = fits.first()?;
    let (plausible, best_cost) = (first.candidate.plausible, first.cost);
    let as_good =
        fits.iter().take_while(|fit| fit.candidate.plausible == plausible && fit.cost <= best_cost + SAME_FIT).count();
    let chosen = context.expected().map_or(0, |expected| {
        let distance = |fit: &Fit| camera_distance(&fit.candidate.ptz, &expected);
        (0..as_good).min_by(|&a, &b| distance(&fits[a]).total_cmp(&distance(&fits[b]))).unwrap_or(0)
    });
    let chosen = fits.remove(chosen).candidate;
    Some((chosen, fits.into_iter().map(|fit| fit.candidate).collect()))
}

/// Where a click lies as seen from what it shows.
fn residual(camera: &PtzCamera, observation: &Observation) -> ClickResidual {
    let offset_px = match observation.target {
        Target::Landmark(at) => {
            camera.image_from_world(at).ok().map(|projected| observation.image.offset_from(projected))
        }
        Target::Line(curve) => line_residual(camera, &curve, observation.image).map(|here| here.offset_px),
    };
    ClickResidual { click: observation.click, offset_px, sigma_px: observation.sigma_px }
}

/// A held-out click against what the solution predicts for it.
fn check(camera: &PtzCamera, uncertainty: &Uncertainty, observation: &Observation) -> CheckResult {
    let noise = observation.sigma_px * observation.sigma_px;
    let found = match observation.target {
        Target::Landmark(at) => camera.image_from_world(at).ok().and_then(|projected| {
            let offset = observation.image.offset_from(projected);
            let covariance = uncertainty.overlay_at_world(camera, at)? + Matrix2::identity() * noise;
            Some((offset.norm(), offset.dot(&(covariance.try_inverse()? * offset)).sqrt()))
        }),
        Target::Line(curve) => line_residual(camera, &curve, observation.image).and_then(|here| {
            let covariance = uncertainty.overlay_at_world(camera, here.nearest_in_world)?;
            let across = here.across;
            let variance = across.dot(&(covariance * across)) + noise;
            Some((here.distance_px.abs(), here.distance_px.abs() / variance.sqrt()))
        }),
    };
    let (error_px, z_score) = found.unzip();
    CheckResult { click: observation.click, error_px, z_score }
}

/// The largest distance between two landmark clicks, px.
fn separation_px(used: &[Observation]) -> Option<f64> {
    let landmarks = || used.iter().filter(|observation| matches!(observation.target, Target::Landmark(_)));
    let pairs = landmarks()
        .enumerate()
        .flat_map(|(i, one)| landmarks().skip(i + 1).map(move |two| one.image.distance_px(two.image)));
    pairs.max_by(f64::total_cmp)
}
