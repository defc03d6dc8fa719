//! Where refinement starts: every camera that some of a frame's clicks determine by themselves.

use super::one_point::pan_tilt_from_one_point;
use super::refine::{cost, refine};
use super::two_point::{
    MIN_RAY_ANGLE_DEG, MIN_SEPARATION_PX, OneOrTwo, TwoPointError, scan_two_points, solve_two_points,
};
use super::{Loss, Observation, PtzRanges, SolveContext, SolveError};
use crate::camera::{CameraBase, FocalCurve, Ptz, PtzCamera};
use crate::geometry::{Angle, ImagePoint, Vec3};

/// Pairs of landmarks tried at most, the best separated first.
const MAX_PAIRS: usize = 48;

/// Starts that are refined at most.
const MAX_STARTS: usize = 4;

/// Starts nearer to each other than this (see [`camera_distance`]) lead to one solution.
const DISTINCT: f64 = 0.05;

/// Scores starts: far-off clicks hardly count, so one wrong name does not hide the others.
const SCORE_LOSS: Loss = Loss::Cauchy { c: 5.0 };

/// A landmark click.
#[derive(Clone, Copy)]
struct LandmarkClick {
    at: Vec3,
    image: ImagePoint,
    click: usize,
}

/// The starts worth refining, best first; at least one.
///
/// # Errors
/// No start exists, with the reason.
pub(super) fn starts(
    base: &CameraBase,
    observations: &[Observation],
    context: &SolveContext,
) -> Result<Vec<Ptz>, SolveError> {
    let landmarks: Vec<LandmarkClick> = observations
        .iter()
        .filter_map(|observation| {
            let Observation { image, click, .. } = *observation;
            Some(LandmarkClick { at: observation.shape.point()?, image, click })
        })
        .collect();
    let known =
        context.prior.iter().map(|prior| prior.ptz).chain(context.start).chain(context.neighbours.iter().copied());
    let mut found: Vec<Ptz> = match landmarks.as_slice() {
        [one, two] => {
            // With nothing else to compare by there is nothing to rank.
            let roots = pair_starts(base, *one, *two);
            if observations.len() == 2 && context.prior.is_none() {
                return Ok(roots?.iter().collect());
            }
            roots.map(|roots| roots.iter().collect()).unwrap_or_default()
        }
        [] | [_] => known.clone().take(3).collect(),
        many => {
            let starts = all_pair_starts(base, many)?;
            if starts.is_empty() { known.clone().take(3).collect() } else { starts }
        }
    };
    match landmarks.as_slice() {
        [] => found.extend(grid_starts(base, observations, context)),
        [one] => found.extend(focal_sweep(base, *one, observations, context)),
        _ => {}
    }
    if found.is_empty() {
        found.extend(known.take(3));
    }
    if found.is_empty() {
        return Err(match landmarks.as_slice() {
            [one, two, ..] => pair_starts(base, *one, *two).err(),
            _ => None,
        }
        .unwrap_or(SolveError::NoFit { observations: observations.len() }));
    }
    Ok(best_distinct(base, found, observations))
}

/// The closed forms on one pair, with its clicks named in the error.
fn pair_starts(base: &CameraBase, one: LandmarkClick, two: LandmarkClick) -> Result<OneOrTwo<Ptz>, SolveError> {
    let clicks = [one.click, two.click];
    solve_two_points(base, [one.at, two.at], [one.image, two.image]).map_err(|error| match error {
        TwoPointError::PointsTooClose { separation_px } => {
            SolveError::PointsTooClose { separation_px, needed_px: MIN_SEPARATION_PX }
        }
        TwoPointError::SameRay { angle_deg } => {
            SolveError::SameRay { clicks, angle_deg, needed_deg: MIN_RAY_ANGLE_DEG }
        }
        TwoPointError::NoRealRoot { separation_px, angle_deg } => {
            SolveError::NoRealRoot { clicks, separation_px, angle_deg }
        }
    })
}

/// All cameras that a pair of landmarks has, those included that no pinhole leads to; none for other clicks, or where the
/// lens has no fold.
pub(super) fn scanned_starts(base: &CameraBase, used: &[Observation]) -> Vec<Ptz> {
    let [one, two] = used else { return Vec::new() };
    match (one.shape.point(), two.shape.point()) {
        (Some(first), Some(second)) if base.distortion != FocalCurve::NONE => {
            scan_two_points(base, [first, second], [one.image, two.image])
        }
        _ => Vec::new(),
    }
}

/// The closed forms on the best-separated pairs; the error of the best-separated one if none has a solution and all
/// clicks lie on one spot or ray.
fn all_pair_starts(base: &CameraBase, landmarks: &[LandmarkClick]) -> Result<Vec<Ptz>, SolveError> {
    let mut pairs: Vec<(f64, LandmarkClick, LandmarkClick)> = Vec::new();
    for (index, one) in landmarks.iter().enumerate() {
        pairs.extend(landmarks[index + 1..].iter().map(|two| (one.image.distance_px(two.image), *one, *two)));
    }
    pairs.sort_by(|a, b| b.0.total_cmp(&a.0));
    pairs.truncate(MAX_PAIRS);
    let mut found = Vec::with_capacity(pairs.len());
    let mut first_error = None;
    for (_, one, two) in pairs {
        match pair_starts(base, one, two) {
            Ok(roots) => found.extend(roots.iter()),
            Err(error) => _ = first_error.get_or_insert(error),
        }
    }
    match first_error {
        Some(error) if found.is_empty() => Err(error),
        _ => Ok(found),
    }
}

/// One landmark: for each focal length the camera that shows it where it was clicked.
fn focal_sweep(
    base: &CameraBase,
    landmark: LandmarkClick,
    observations: &[Observation],
    context: &SolveContext,
) -> Vec<Ptz> {
    let mut scored = Vec::new();
    for focal_px in log_steps(context, 48) {
        if let Ok(ptz) = pan_tilt_from_one_point(base, focal_px, landmark.at, landmark.image) {
            scored.push((cost(&PtzCamera::new(*base, ptz), observations, SCORE_LOSS), ptz));
        }
    }
    // Every dip of the sweep is the start of one solution.
    (0..scored.len())
        .filter(|&i| {
            (i == 0 || scored[i - 1].0 >= scored[i].0) && (i + 1 == scored.len() || scored[i + 1].0 >= scored[i].0)
        })
        .map(|i| scored[i].1)
        .collect()
}

/// No landmark: a coarse grid over what this camera does, the best cells refined by a few steps each.
fn grid_starts(base: &CameraBase, observations: &[Observation], context: &SolveContext) -> Vec<Ptz> {
    const KEPT: usize = 40;
    let angles = |from: Angle, upto: Angle, step_deg: f64| {
        let (from, upto) = (from.degrees(), upto.degrees());
        let count = ((upto - from) / step_deg).ceil().clamp(1.0, 90.0);
        (0..=count as usize).map(move |i| Angle::from_degrees(from + (upto - from) * i as f64 / count))
    };
    let PtzRanges { pan: pans, tilt: tilts, .. } = &context.ranges;
    let mut scored: Vec<(f64, Ptz)> = Vec::new();
    for focal_px in log_steps(context, 10) {
        // Steps of a quarter of the field of view.
        let step_deg = (0.5 * f64::from(context.image_size.width) / focal_px).atan().to_degrees() / 2.0;
        for pan in angles(pans.start(), pans.end(), step_deg.max(4.0)) {
            for tilt in angles(*tilts.start(), *tilts.end(), step_deg.max(4.0) / 2.0) {
                let ptz = Ptz { pan, tilt, focal_px };
                let camera = PtzCamera::new(*base, ptz);
                let distances = observations.iter().map(|observation| observation.distance_px(&camera));
                if let Some(score) = distances.sum::<Option<f64>>() {
                    scored.push((score, ptz));
                }
            }
        }
    }
    scored.sort_by(|a, b| a.0.total_cmp(&b.0));
    scored.truncate(KEPT);
    scored
        .into_iter()
        .map(|(_, ptz)| refine(base, ptz, observations, Loss::Squared, context.prior.as_ref()).ptz)
        .filter(Ptz::is_finite)
        .collect()
}

/// Focal lengths over the plausible range, evenly in log f.
fn log_steps(context: &SolveContext, count: usize) -> impl Iterator<Item = f64> + use<> {
    let (from, upto) = (context.ranges.focal_px.start().max(1.0).ln(), context.ranges.focal_px.end().max(1.0).ln());
    (0..=count).map(move |i| (from + (upto - from) * i as f64 / count as f64).exp())
}

/// The best-scoring starts, near duplicates left out.
fn best_distinct(base: &CameraBase, found: Vec<Ptz>, observations: &[Observation]) -> Vec<Ptz> {
    let mut scored: Vec<(f64, Ptz)> =
        found.into_iter().map(|ptz| (cost(&PtzCamera::new(*base, ptz), observations, SCORE_LOSS), ptz)).collect();
    scored.sort_by(|a, b| a.0.total_cmp(&b.0));
    let mut kept: Vec<Ptz> = Vec::with_capacity(MAX_STARTS);
    for (_, ptz) in scored {
        if kept.iter().all(|other| camera_distance(other, &ptz) > DISTINCT) {
            kept.push(ptz);
            if kept.len() == MAX_STARTS {
                break;
            }
        }
    }
    kept
}

/// How differently two cameras see: the largest of the turns in units of 1000 px and the change of log focal length.
pub(super) fn camera_distance(one: &Ptz, two: &Ptz) -> f64 {
    let per_radian = one.focal_px.min(two.focal_px) / 1000.0;
    let pan = one.pan.turn_from(two.pan).abs().radians() * per_radian;
    let tilt = (one.tilt - two.tilt).abs().radians() * per_radian;
    pan.max(tilt).max((one.focal_px / two.focal_px).ln().abs())
}
