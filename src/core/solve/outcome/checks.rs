//! The warnings about a solved frame that the user should check, with numbers.

use super::covariance::{OverlayPoint, corners};
use crate::camera::PtzCamera;
use crate::geometry::{ImagePoint, ImageSize, Vec2, thousands};
use crate::solve::observations::observation::landmark_observations;
use crate::solve::priors::prior::SAME_FIT;
use crate::solve::{
    CornerSigma, FrameSolution, Observation, SolveContext, Uncertainty, Warning, WarningCode,
};

/// A worst corner with a larger 1-σ gives a warning, px at 1920 px width.
const WARN_CORNER_SIGMA_PX: f64 = 7.0;

/// The distance of two points from which on they make a good pair, px at 1920 px width.
const GOOD_SEPARATION_PX: f64 = 800.0;

/// A remedy is suggested if it reduces the worst corner's 1-σ to less than this fraction.
const WORTHWHILE: f64 = 0.9;

/// The suggested point near a corner lies this fraction of the way from the corner to the principal
/// point.
const TOWARDS_MIDDLE: f64 = 0.15;

/// Beyond this many sigmas either the check click or the solution is wrong; 0.2 % of correct clicks
/// exceed it.
const MAX_CHECK_Z: f64 = 3.5;

/// A click whose distance is more than this many times the expected one contradicts the others.
const MAX_CLICK_SIGMAS: f64 = 5.0;

/// The warnings of a solution, the most serious first.
pub(in crate::solve) fn warnings(
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
    found.extend(uncertain_corner(camera, used, solution, context));
    found
}

/// Check clicks whose errors exceed what click noise and the uncertainty of the prediction explain.
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

/// A click that the camera cannot see, or the click that the others contradict most, or the one or
/// two clicks that the prior or the base contradicts.
fn contradiction(solution: &FrameSolution) -> Option<Warning> {
    let unseen = solution
        .residuals
        .iter()
        .rfind(|residual| residual.offset_px.is_none());
    if let Some(unseen) = unseen {
        let number = unseen.click + 1;
        return Some(Warning {
            code: WarningCode::Contradiction,
            message: format!("Point {number} shows something behind the camera. Check its name."),
            clicks: vec![unseen.click],
        });
    }

    // An uncertain base makes larger residuals normal: scale σ by the expected χ² per surplus
    // equation.
    let usual = (solution.expected_chi_squared / solution.redundancy.max(1) as f64)
        .max(1.0)
        .sqrt();

    // The residuals of so few clicks do not show which of them is wrong: blame both. A single click
    // has surplus equations only with a prior, so it is the prior that it contradicts.
    if !solution.residuals_are_evidence() {
        let misfit = solution.misfit()?;
        let farthest_px = solution.farthest_px();
        let message = if solution.residuals.len() == 1 {
            format!(
                "The point contradicts the expected camera by {farthest_px:.1} px, {misfit:.1} \
                 times what is usual. Check its name, or the base."
            )
        } else {
            format!(
                "The two points contradict the camera base by {farthest_px:.1} px, {misfit:.1} \
                 times what is usual. Check their names, or the base."
            )
        };
        return (misfit > MAX_CLICK_SIGMAS).then(|| Warning {
            code: WarningCode::Contradiction,
            message,
            clicks: solution
                .residuals
                .iter()
                .map(|residual| residual.click)
                .collect(),
        });
    }

    // Otherwise the click with the largest residual in its own σ is the suspect.
    let (sigmas, distance, worst) = solution
        .residuals
        .iter()
        .filter_map(|residual| {
            let distance = residual.distance_px()?;
            Some((
                distance / (residual.sigma_px * usual),
                distance,
                residual.click,
            ))
        })
        .max_by(|a, b| a.0.total_cmp(&b.0))?;
    let number = worst + 1;
    (sigmas > MAX_CLICK_SIGMAS).then(|| Warning {
        code: WarningCode::Contradiction,
        message: format!(
            "Point {number} is {distance:.1} px off, {sigmas:.0} times what is usual. Check its name and place."
        ),
        clicks: vec![worst],
    })
}

/// A camera below the pitch.
fn underground(camera: &PtzCamera) -> Option<Warning> {
    let height_m = camera.base().position_m.z;
    (height_m <= 0.0).then(|| Warning {
        code: WarningCode::Implausible,
        message: format!(
            "The camera stands {:.1} m below the pitch. Check its height.",
            height_m.abs()
        ),
        clicks: Vec::new(),
    })
}

/// A solution outside the ranges of this camera, or unusual under its motion prior.
fn implausible(solution: &FrameSolution, context: &SolveContext) -> Option<Warning> {
    let (ptz, ranges) = (solution.ptz, &context.ranges);
    let what = if !ranges.pan.contains(ptz.pan) {
        format!("pan {:.1} (usual {:.1})", ptz.pan, ranges.pan)
    } else if !ranges.tilt.contains(&ptz.tilt) {
        format!(
            "tilt {:.1} (usual {:.1} to {:.1})",
            ptz.tilt,
            ranges.tilt.start(),
            ranges.tilt.end()
        )
    } else if !ranges.focal_px.contains(&ptz.focal_px) {
        let [focal, from, upto] = [
            ptz.focal_px,
            *ranges.focal_px.start(),
            *ranges.focal_px.end(),
        ]
        .map(format_rounded);
        format!("focal length {focal} px (usual {from} to {upto})")
    } else {
        return context.motion.warning(&ptz, &solution.slack());
    };
    let message =
        format!("Unusual camera: {what}. Check the names of the points, or the camera base.");
    Some(Warning {
        code: WarningCode::Implausible,
        message,
        clicks: Vec::new(),
    })
}

/// A second plausible camera that fits the clicks as well.
fn two_roots(solution: &FrameSolution, context: &SolveContext) -> Option<Warning> {
    // As for a contradiction, an uncertain base makes a larger difference of χ² normal.
    let slack =
        SAME_FIT * (solution.expected_chi_squared / solution.redundancy.max(1) as f64).max(1.0);
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
    // Cameras of nearly the same focal length differ in their directions: these are named.
    let message = if (one / two).ln().abs() > 0.02 {
        let (low, high) = (format_rounded(one.min(two)), format_rounded(one.max(two)));
        format!(
            "Two focal lengths fit: {low} and {high} px. Using {}, {why}.",
            format_rounded(one)
        )
    } else {
        format!(
            "Two directions fit: pan {:.1} and {:.1}. Using {:.1}, {why}. Another point decides.",
            solution.ptz.pan, other.ptz.pan, solution.ptz.pan
        )
    };
    Some(Warning {
        code: WarningCode::TwoRoots,
        message,
        clicks: Vec::new(),
    })
}

/// A worst corner that is uncertain, with the cause: the base, points close together, or a corner
/// far from all points, tested in this order. A remedy is suggested only if its predicted gain is
/// worth it.
fn uncertain_corner(
    camera: &PtzCamera,
    used: &[Observation],
    solution: &FrameSolution,
    context: &SolveContext,
) -> Option<Warning> {
    let scale = context.image_size.scale_from_1920();
    if solution.worst_corner_sigma_px <= WARN_CORNER_SIGMA_PX * scale {
        return None;
    }
    let worst = solution
        .uncertainty
        .worst_corner(camera, context.image_size)?;

    // Case 1, the base: further clicks in this frame gain little.
    if worst.is_from_base() {
        return Some(Warning {
            code: WarningCode::BaseUncertain,
            message: describe_uncertain_base(&worst),
            clicks: Vec::new(),
        });
    }
    // Nothing is predicted of a corner of which nothing is known; the verdict says that.
    let corner_px = solution.corner_sigma_px_if_known()?;
    // Advice is about landmarks: frames of lines alone, or of one landmark, get none.
    let separation_px = solution.separation_px?;
    let one_more = OneMoreClick::new(camera, solution, context.image_size);
    let worthwhile_px = WORTHWHILE * corner_px;

    // Case 2, points close together: they leave the focal length uncertain. Try a further point at
    // a good distance from their centre, in the best direction inside the frame.
    if separation_px < GOOD_SEPARATION_PX * scale {
        let focal_percent = 100.0 * solution.sigma_focal_px() / solution.ptz.focal_px;
        let cost = format!(
            "Points {separation_px:.0} px apart: focal ±{focal_percent:.1} %, worst corner ±{} px.",
            short(corner_px)
        );
        let sum = landmark_observations(used).fold(Vec2::zeros(), |sum, click| {
            sum + click.image.offset_from(ImagePoint::default())
        });
        let count = landmark_observations(used).count();
        let middle = ImagePoint::default().translate(sum / count as f64);
        let distance_px = GOOD_SEPARATION_PX * scale;
        let better = one_more
            .best_corner_at_distance(middle, distance_px)
            .filter(|better_px| *better_px < worthwhile_px);
        let way_out = better.map_or_else(String::new, |better| {
            format!(
                " A point at {distance_px:.0} px would give ±{}.",
                short(better)
            )
        });
        let clicks = landmark_observations(used)
            .map(|observation| observation.click)
            .collect();
        return Some(Warning {
            code: WarningCode::Separation,
            message: cost + &way_out,
            clicks,
        });
    }

    // Case 3, extrapolation: the points lie apart, but far from the corner. Try a point near it.
    let nearest_px = used
        .iter()
        .map(|observation| observation.image.distance_px(worst.corner))
        .min_by(f64::total_cmp)?;
    let cost = format!(
        "The worst corner is ±{} px: it lies {nearest_px:.0} px from the nearest point.",
        short(corner_px)
    );
    let inwards = worst
        .corner
        .translate((camera.base().principal_point.offset_from(worst.corner)) * TOWARDS_MIDDLE);
    let better = one_more
        .corner_with_click_at(inwards)
        .filter(|better_px| *better_px < worthwhile_px);
    let way_out = better.map_or_else(String::new, |better| {
        format!(" A point near that corner would give ±{}.", short(better))
    });
    Some(Warning {
        code: WarningCode::Extrapolation,
        message: cost + &way_out,
        clicks: Vec::new(),
    })
}

/// The message if most of the worst corner's uncertainty comes from the base.
fn describe_uncertain_base(worst: &CornerSigma) -> String {
    format!(
        "The base is uncertain: ±{} of the ±{} px at the worst corner come from it. Points in more wide frames help.",
        short(worst.base_px),
        short(worst.sigma_px())
    )
}

/// Predicts the effect of one more landmark click on the worst corner. The click is assumed as
/// noisy as the noisiest existing one.
struct OneMoreClick<'a> {
    camera: &'a PtzCamera,
    uncertainty: &'a Uncertainty,
    image_size: ImageSize,
    /// The overlay points of the frame's corners.
    corners: [Option<OverlayPoint>; 4],
    sigma_px: f64,
}

impl<'a> OneMoreClick<'a> {
    fn new(camera: &'a PtzCamera, solution: &'a FrameSolution, image_size: ImageSize) -> Self {
        let sigma_px = solution
            .residuals
            .iter()
            .map(|residual| residual.sigma_px)
            .fold(0.0, f64::max);
        let corners = corners(camera, image_size);
        Self {
            camera,
            uncertainty: &solution.uncertainty,
            image_size,
            corners,
            sigma_px,
        }
    }

    /// The worst-corner sigma with the click at a pixel, px.
    fn corner_with_click_at(&self, pixel: ImagePoint) -> Option<f64> {
        Some(
            self.uncertainty
                .with_click_at(self.camera, pixel, self.sigma_px)?
                .worst_sigma_px(&self.corners),
        )
    }

    /// The smallest such sigma with the click at a distance from a pixel, within the frame.
    fn best_corner_at_distance(&self, from: ImagePoint, distance_px: f64) -> Option<f64> {
        const DIRECTIONS: u32 = 16;
        (0..DIRECTIONS)
            .map(|direction| f64::from(direction) / f64::from(DIRECTIONS) * std::f64::consts::TAU)
            .map(|angle| from.translate(Vec2::new(angle.cos(), angle.sin()) * distance_px))
            .filter(|pixel| self.image_size.contains(*pixel))
            .filter_map(|pixel| self.corner_with_click_at(pixel))
            .min_by(f64::total_cmp)
    }
}

/// A positive number, rounded: "2,410".
fn format_rounded(value: f64) -> String {
    thousands(value.round() as usize)
}

/// A sigma to two significant digits: "14", "3.6".
fn short(value: f64) -> String {
    if value >= 10.0 {
        format!("{value:.0}")
    } else {
        format!("{value:.1}")
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::camera::BaseSigma;
    use crate::geometry::{Angle, Mat3, Vec3};
    use crate::solve::{PtzPrior, solve_frame};
    use crate::testing::{SIZE, TestBase, base_at};
    use nalgebra::SMatrix;

    /// A camera whose base is known to these metres in each direction.
    fn camera(sigma_m: f64) -> PtzCamera {
        let mut base = base_at([0.0, -60.0, 18.0], SIZE);
        base.sigma = BaseSigma {
            position_m: Vec3::repeat(sigma_m),
            rotation: Vec3::zeros(),
            ..BaseSigma::default()
        };
        base.aim(0.0, -14.0, 2000.0)
    }

    /// The solution from points on the ground where the camera shows these pixels.
    fn solved(camera: &PtzCamera, pixels: &[[f64; 2]], sigma_px: f64) -> FrameSolution {
        let observe = |(click, pixel): (usize, &[f64; 2])| {
            let pixel = ImagePoint::from(*pixel);
            let at = camera.plane_from_image(pixel, 0.0).unwrap();
            Observation::from_point(at, pixel, sigma_px, click)
        };
        let observations: Vec<Observation> = pixels.iter().enumerate().map(observe).collect();
        solve_frame(camera.base(), &observations, &SolveContext::new(SIZE)).unwrap()
    }

    /// The solution from a single click, with a prior that knows the camera nearly exactly.
    fn solved_near(camera: &PtzCamera, click: Observation) -> FrameSolution {
        let prior = PtzPrior {
            ptz: camera.ptz(),
            sigma_pan: Angle::from_degrees(0.01),
            sigma_tilt: Angle::from_degrees(0.01),
            sigma_focal_share: 1e-3,
            by_base: SMatrix::zeros(),
        };
        let context = SolveContext {
            prior: Some(prior),
            ..SolveContext::new(SIZE)
        };
        solve_frame(camera.base(), &[click], &context).unwrap()
    }

    fn only_warning(solution: &FrameSolution) -> &Warning {
        assert_eq!(solution.warnings.len(), 1, "{:?}", solution.warnings);
        &solution.warnings[0]
    }

    #[test]
    fn the_parts_of_the_worst_corner_add_up() {
        let camera = camera(0.5);
        let solution = solved(&camera, &[[400.0, 500.0], [1500.0, 800.0]], 2.0);
        let worst = solution.uncertainty.worst_corner(&camera, SIZE).unwrap();
        assert!(
            (worst.sigma_px() - solution.worst_corner_sigma_px).abs() < 1e-6,
            "{worst:?}"
        );
        assert!(worst.clicks_px > 0.5 && worst.base_px > 0.5);
        let exact = solved(&self::camera(0.0), &[[400.0, 500.0], [1500.0, 800.0]], 2.0);
        let of_exact = exact
            .uncertainty
            .worst_corner(&self::camera(0.0), SIZE)
            .unwrap();
        assert!(of_exact.base_px == 0.0 && !of_exact.is_from_base());
    }

    #[test]
    fn the_dominating_cause_is_named() {
        let apart = [[300.0, 400.0], [1600.0, 800.0]];
        let uncertain = solved(&camera(3.0), &apart, 0.5);
        assert_eq!(only_warning(&uncertain).code, WarningCode::BaseUncertain);
        assert!(
            uncertain.warnings[0]
                .message
                .starts_with("The base is uncertain: ±"),
            "{:?}",
            uncertain.warnings
        );
        let close = solved(&camera(0.0), &[[900.0, 500.0], [1000.0, 560.0]], 2.0);
        assert_eq!(only_warning(&close).code, WarningCode::Separation);
        assert!(
            close.warnings[0].message.contains("would give ±"),
            "{:?}",
            close.warnings
        );
        // Far apart, but both on the left and noisy.
        let left = solved(&camera(0.0), &[[60.0, 250.0], [120.0, 1060.0]], 8.0);
        assert_eq!(only_warning(&left).code, WarningCode::Extrapolation);
        assert!(
            left.warnings[0].message.contains("from the nearest point"),
            "{:?}",
            left.warnings
        );
        let fine = solved(&camera(0.0), &apart, 0.5);
        assert!(fine.warnings.is_empty(), "{:?}", fine.warnings);
    }

    #[test]
    fn a_corner_of_which_nothing_is_known_gets_no_figure() {
        let camera = camera(0.0);
        let mut solution = solved(&camera, &[[900.0, 500.0], [1000.0, 560.0]], 2.0);
        assert_eq!(only_warning(&solution).code, WarningCode::Separation);
        let stated_px = format!("±{:.1} px", solution.worst_corner_sigma_px);
        assert_eq!(solution.describe_corner(), stated_px);
        solution.uncertainty.clicks = Mat3::repeat(f64::NAN);
        solution.worst_corner_sigma_px = solution.uncertainty.worst_corner_sigma_px(&camera, SIZE);
        assert_eq!(solution.corner_sigma_px_if_known(), None);
        assert_eq!(solution.describe_corner(), "unknown");
        let context = SolveContext::new(SIZE);
        assert_eq!(uncertain_corner(&camera, &[], &solution, &context), None);
    }

    #[test]
    fn a_single_point_contradicts_the_prior() {
        let camera = camera(0.0);
        let at = camera
            .plane_from_image(ImagePoint::new(900.0, 600.0), 0.0)
            .unwrap();
        let click = Observation::from_point(at, ImagePoint::new(1000.0, 600.0), 2.0, 0);
        let solution = solved_near(&camera, click);
        let warning = &solution.warnings[0];
        assert!(
            warning
                .message
                .starts_with("The point contradicts the expected camera by"),
            "{warning}"
        );
        assert_eq!(warning.clicks, [0]);
    }

    #[test]
    fn a_point_that_the_camera_cannot_see_is_named_even_if_the_prior_explains_all() {
        let camera = camera(0.0);
        let behind = Vec3::new(0.0, -150.0, 0.0);
        let click = Observation::from_point(behind, ImagePoint::new(900.0, 600.0), 2.0, 4);
        let solution = solved_near(&camera, click);
        let warning = &solution.warnings[0];
        assert_eq!(
            warning.message,
            "Point 5 shows something behind the camera. Check its name."
        );
        assert_eq!(warning.clicks, [4]);
    }

    #[test]
    fn advice_is_given_only_where_it_gains() {
        for sigma_px in [0.5, 2.0, 6.0] {
            for pixels in [
                [[900.0, 500.0], [1000.0, 560.0]],
                [[60.0, 250.0], [120.0, 1060.0]],
            ] {
                let solution = solved(&camera(0.4), &pixels, sigma_px);
                for warning in &solution.warnings {
                    let Some((_, better)) = warning.message.split_once("would give ±") else {
                        continue;
                    };
                    let better: f64 = better.trim_end_matches('.').parse().unwrap();
                    assert!(
                        better < 0.95 * solution.worst_corner_sigma_px,
                        "{}",
                        warning.message
                    );
                }
            }
        }
    }
}
