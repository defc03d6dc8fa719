//! Whether the lines of a picture determine a camera, before one is looked for.

use super::FromLinesError;
use crate::field::Curve;
use crate::geometry::Vec3;
use crate::solve::Observation;
use crate::solve::observations::drawn_line::DrawnLine;
use crate::solve::observations::observation::landmark_observations;

/// Unknowns that the lines have to determine: position, rotation, focal length.
const NEEDED_EQUATIONS: usize = 7;

/// Equations of a conic: a circle with more points gives no more.
const CONIC_EQUATIONS: usize = 5;

/// Whether all numbers are finite and the lines give enough equations.
///
/// # Errors
/// What is missing.
pub(super) fn check_observations(used: &[Observation]) -> Result<(), FromLinesError> {
    if let Some(bad) = used.iter().find(|observation| !is_finite(observation)) {
        return Err(FromLinesError::NotFinite { click: bad.click });
    }
    // Counting equations is necessary, not sufficient; what it lets through and still leaves open
    // ends as `Undetermined` where the covariance is computed.
    let lines = DrawnLine::group(used);
    let landmarks = landmark_observations(used).count();
    let equations = 2 * landmarks + lines.iter().map(line_equations).sum::<usize>();
    if equations < NEEDED_EQUATIONS {
        return Err(FromLinesError::TooFewLines {
            lines: lines.len() + landmarks,
            equations,
            needed: NEEDED_EQUATIONS,
        });
    }
    if landmarks == 0 && are_parallel(&lines) {
        return Err(FromLinesError::Parallel { lines: lines.len() });
    }
    Ok(())
}

/// Whether pixel, sigma and shape are finite, and the sigma positive.
fn is_finite(observation: &Observation) -> bool {
    let Observation {
        image,
        sigma_px,
        shape,
        ..
    } = observation;
    image.is_finite() && sigma_px.is_finite() && *sigma_px > 0.0 && shape.is_finite()
}

/// How many equations the points of a line give.
fn line_equations(line: &DrawnLine) -> usize {
    // A straight line in the picture has two parameters, a conic five; further points repeat them.
    match line.curve.nominal() {
        Curve::Segment { .. } => line.distinct_points(2),
        Curve::Arc { .. } => line.distinct_points(CONIC_EQUATIONS),
    }
}

/// Whether all lines are straight and parallel to each other: along them the camera could be moved
/// without a change in the picture.
fn are_parallel(lines: &[DrawnLine]) -> bool {
    /// The sine below which directions are parallel.
    const PARALLEL: f64 = 1e-3;
    // One circle or arc makes this none: it shows where along the lines the camera stands.
    let directions: Option<Vec<Vec3>> = lines
        .iter()
        .map(|line| line.segment().map(|[from, to]| (to - from).normalize()))
        .collect();
    let Some([first, others @ ..]) = directions.as_deref() else {
        return false;
    };
    others
        .iter()
        .all(|other| first.cross(other).norm() < PARALLEL)
}
