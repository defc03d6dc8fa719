//! What a person should look at before trusting a solved frame, in words with numbers.

use super::context::SAME_FIT;
use super::covariance::corners;
use super::{FrameSolution, Observation, SolveContext, Warning, WarningCode};
use crate::camera::PtzCamera;
use crate::geometry::{ImagePoint, Vec2, thousands};

/// From this 1-σ at the worst corner on, the points' separation is worth a warning, px at 1920 px width.
const WARN_CORNER_SIGMA_PX: f64 = 7.0;

/// A second point this far away makes a good pair, px at 1920 px width.
const GOOD_SEPARATION_PX: f64 = 800.0;

/// A check click beyond this many sigmas is wrong, or the solution is (of right ones 0.2 % are).
const MAX_CHECK_Z: f64 = 3.5;

/// A click this many times farther off than expected contradicts the others.
const MAX_CLICK_SIGMAS: f64 = 5.0;

/// The warnings of a solution, the most serious first.
pub(super) fn warnings(
    camera: &PtzCamera,
    used: &[Observation],
    solution: &FrameSolution,
    context: &SolveContext,
) -> Vec<Warning> {
    let mut found = Vec::new();
    found.extend(failed_checks(solution));
    found.extend(contradiction(solution));
    found.extend(underground(camera));
    found.extend(implausible(solution, context));
    found.extend(two_roots(solution, context));
    found.extend(separation(camera, used, solution, context));
    found
}

/// Held-out clicks that are farther off than click noise and prediction explain.
fn failed_checks(solution: &FrameSolution) -> impl Iterator<Item = Warning> {
    solution.checks.iter().filter_map(|check| {
        let number = check.click + 1;
        let message = match (check.error_px, check.z_score) {
            (Some(error_px), Some(z)) if z > MAX_CHECK_Z => {
                format!(
                    "Check point {number} is {error_px:.1} px off, {z:.1} times what is expected. Look at its name."
                )
            }
            (Some(_), Some(_)) => return None,
            _ => format!("Check point {number} shows something that this camera cannot see. Look at its name."),
        };
        Some(Warning { code: WarningCode::CheckFailed, message, clicks: vec![check.click] })
    })
}

/// Clicks that the others (or, with two, the base) contradict.
fn contradiction(solution: &FrameSolution) -> Option<Warning> {
    let usual = (solution.expected_chi_squared / solution.redundancy.max(1) as f64).max(1.0).sqrt();
    if !solution.residuals_are_evidence() {
        let misfit = solution.misfit()?;
        return (misfit > MAX_CLICK_SIGMAS).then(|| Warning {
            code: WarningCode::Contradiction,
            message: format!(
                "The two points contradict the camera base by {:.1} px, {misfit:.1} times what is usual. Check their \
                 names, or the base.",
                solution.rms_px
            ),
            clicks: solution.residuals.iter().map(|residual| residual.click).collect(),
        });
    }
    let sigmas = |residual: &super::ClickResidual| {
        residual.distance_px().map_or(f64::INFINITY, |distance| distance / (residual.sigma_px * usual))
    };
    let worst = solution.residuals.iter().max_by(|a, b| sigmas(a).total_cmp(&sigmas(b)))?;
    let number = worst.click + 1;
    let message = match worst.distance_px() {
        None => format!("Point {number} shows something behind the camera. Check its name."),
        Some(distance) if sigmas(worst) > MAX_CLICK_SIGMAS => format!(
            "Point {number} is {distance:.1} px off, {:.0} times what is usual. Check its name and place.",
            sigmas(worst)
        ),
        Some(_) => return None,
    };
    Some(Warning { code: WarningCode::Contradiction, message, clicks: vec![worst.click] })
}

/// A camera that sees the pitch from below.
fn underground(camera: &PtzCamera) -> Option<Warning> {
    let height_m = camera.base().position_m.z;
    (height_m <= 0.0).then(|| Warning {
        code: WarningCode::Implausible,
        message: format!("Implausible: the camera stands {:.1} m below the pitch. Check its height.", -height_m),
        clicks: Vec::new(),
    })
}

/// A solution outside of what this camera can do, or usually does.
fn implausible(solution: &FrameSolution, context: &SolveContext) -> Option<Warning> {
    let (ptz, ranges) = (solution.ptz, &context.ranges);
    let what = if !ranges.pan.contains(ptz.pan) {
        format!("pan {:.1} (usual {:.1})", ptz.pan, ranges.pan)
    } else if !ranges.tilt.contains(&ptz.tilt) {
        format!("tilt {:.1} (usual {:.1} to {:.1})", ptz.tilt, ranges.tilt.start(), ranges.tilt.end())
    } else if !ranges.focal_px.contains(&ptz.focal_px) {
        let [focal, from, upto] = [ptz.focal_px, *ranges.focal_px.start(), *ranges.focal_px.end()].map(rounded);
        format!("focal length {focal} px (usual {from} to {upto})")
    } else {
        return context.motion.warning(&ptz, &solution.slack());
    };
    let message = format!("Implausible: {what}. Check the names of the points, or the camera base.");
    Some(Warning { code: WarningCode::Implausible, message, clicks: Vec::new() })
}

/// Another plausible camera fits the clicks as well.
fn two_roots(solution: &FrameSolution, context: &SolveContext) -> Option<Warning> {
    let slack = SAME_FIT * (solution.expected_chi_squared / solution.redundancy.max(1) as f64).max(1.0);
    let other = solution
        .alternatives
        .iter()
        .find(|other| other.plausible && other.chi_squared <= solution.chi_squared + slack)?;
    let (one, two) = (solution.ptz.focal_px, other.ptz.focal_px);
    let why = if context.start.is_some() {
        "as before"
    } else if context.neighbours.is_empty() {
        "which fits better"
    } else {
        "as neighbours do"
    };
    let message = if (one / two).ln().abs() > 0.02 {
        let (low, high) = (rounded(one.min(two)), rounded(one.max(two)));
        format!("Two focal lengths fit: {low} and {high} px. Using {}, {why}.", rounded(one))
    } else {
        format!(
            "Two directions fit: pan {:.1} and {:.1}. Using {:.1}, {why}. Another point decides.",
            solution.ptz.pan, other.ptz.pan, solution.ptz.pan
        )
    };
    Some(Warning { code: WarningCode::TwoRoots, message, clicks: Vec::new() })
}

/// Landmarks so close together that a far corner is uncertain; what it costs and what a far point would give.
fn separation(
    camera: &PtzCamera,
    used: &[Observation],
    solution: &FrameSolution,
    context: &SolveContext,
) -> Option<Warning> {
    let scale = context.image_size.scale_from_1920();
    let separation_px = solution.separation_px?;
    let corner = solution.worst_corner_sigma_px;
    if corner <= WARN_CORNER_SIGMA_PX * scale || separation_px >= GOOD_SEPARATION_PX * scale {
        return None;
    }
    let landmarks = || used.iter().filter(|observation| observation.shape.point().is_some());
    let focal_percent = 100.0 * solution.sigma_focal_px() / solution.ptz.focal_px;
    let cost =
        format!("Points {separation_px:.0} px apart: focal ±{focal_percent:.1} %, worst corner ±{} px.", short(corner));
    let middle = landmarks().fold(Vec2::zeros(), |sum, click| sum + click.image.offset_from(ImagePoint::default()))
        / landmarks().count() as f64;
    let middle = ImagePoint::default().moved(middle);
    let distance_px = GOOD_SEPARATION_PX * scale;
    let better = best_corner_with_click_at(camera, solution, context, middle, distance_px);
    let way_out = better
        .map_or_else(String::new, |better| format!(" A point at {distance_px:.0} px would give ±{}.", short(better)));
    Some(Warning {
        code: WarningCode::Separation,
        message: cost + &way_out,
        clicks: landmarks().map(|observation| observation.click).collect(),
    })
}

/// The smallest worst-corner sigma that one more landmark click gives, at a distance from a pixel within the frame.
fn best_corner_with_click_at(
    camera: &PtzCamera,
    solution: &FrameSolution,
    context: &SolveContext,
    from: ImagePoint,
    distance_px: f64,
) -> Option<f64> {
    const DIRECTIONS: u32 = 16;
    let sigma_px = solution.residuals.iter().map(|residual| residual.sigma_px).fold(0.0, f64::max);
    let corners = corners(camera, context.image_size);
    (0..DIRECTIONS)
        .map(|direction| f64::from(direction) / f64::from(DIRECTIONS) * std::f64::consts::TAU)
        .map(|angle| from.moved(Vec2::new(angle.cos(), angle.sin()) * distance_px))
        .filter(|pixel| context.image_size.contains(*pixel))
        .filter_map(|pixel| solution.uncertainty.with_click_at(camera, pixel, sigma_px))
        .map(|better| better.worst_sigma_px(&corners))
        .min_by(f64::total_cmp)
}

/// A positive number, rounded: "2,410".
fn rounded(value: f64) -> String {
    thousands(value.round() as usize)
}

/// A sigma in as few digits as it deserves: "14", "3.6".
fn short(value: f64) -> String {
    if value >= 10.0 { format!("{value:.0}") } else { format!("{value:.1}") }
}
