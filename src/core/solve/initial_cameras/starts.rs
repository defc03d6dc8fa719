//! Where the refinement of a frame starts: cameras that some of its observations determine in
//! closed form.
//!
//! | landmark clicks | starts |
//! |---|---|
//! | 2 | the one or two cameras of the two-point solve |
//! | 3 and more | the same for every pair, the pairs farthest apart in the picture first |
//! | 1 | for every focal length the camera that shows the landmark where it was clicked; those that fit the other observations locally best |
//! | 0 (lines only) | the two-point cameras of their crossings, or of points along them; where the lines are few, for every focal length the camera that shows one line where it was drawn; for arcs alone a grid over pan, tilt and focal length |
//!
//! Starts are ranked by a robust cost over *all* observations, so that one misnamed landmark spoils
//! the pairs that it is part of and no others; the best distinct ones are refined (`refine.rs`) and
//! compared (`frame.rs`). Cameras that are known from elsewhere (a prior, the previous solution,
//! neighbouring frames) are used where the clicks give none.

use super::focal_sweep::{
    LandmarkClick, RankedStart, log_spaced_focals, rank, sweep_landmark, sweep_line,
};
use super::line_pairs::{self, few_per_line, find_pairs};
use super::two_point::{
    MIN_RAY_ANGLE_DEG, MIN_SEPARATION_PX, OneOrTwo, TwoPointError, scan_two_points,
    solve_two_points,
};
use crate::camera::{CameraBase, Ptz, PtzCamera};
use crate::geometry::{Angle, farthest_pairs, keep_distinct};
use crate::solve::observations::crossings::find_crossings;
use crate::solve::observations::drawn_line::DrawnLine;
use crate::solve::refine::refine;
use crate::solve::{Loss, Observation, PtzRanges, SolveContext, SolveError};

/// Pairs of landmarks that are solved, at most.
const MAX_PAIRS: usize = 48;

/// Starts that are refined, at most.
const MAX_STARTS: usize = 4;

/// Cameras known from elsewhere that are used as starts, at most.
const MAX_KNOWN: usize = 3;

/// Starts nearer to each other than this lead to one solution ([`camera_distance`]).
const MIN_START_DISTANCE: f64 = 0.05;

/// With this many lines their crossings are starts enough.
const MANY_LINES: usize = 5;

/// Lines whose normals are swept, and starts from lines that are refined, at most.
const MAX_SWEPT_LINES: usize = 2;
const MAX_LINE_STARTS: usize = 12;

/// The starts worth refining, best first; at least one.
///
/// # Errors
/// No start exists, with the reason.
pub(in crate::solve) fn find_starts(
    base: &CameraBase,
    observations: &[Observation],
    context: &SolveContext,
) -> Result<Vec<Ptz>, SolveError> {
    // One case per number of landmarks, as in the table of the module page.
    let landmarks = landmark_clicks(observations);
    let known = known_cameras(context);
    let mut starts = match landmarks.as_slice() {
        [] => starts_from_lines(base, observations, context),
        [one] => {
            let swept = sweep_landmark(base, *one, observations, context);
            swept.into_iter().map(|start| start.ptz).collect()
        }
        [one, two] => {
            let roots = solve_pair(base, *one, *two);
            // Both roots fit two points exactly: without other observations there is nothing to
            // rank them by.
            if observations.len() == 2 && context.prior.is_none() {
                return Ok(roots?.iter().collect());
            }
            roots
                .map(|roots| roots.iter().collect())
                .unwrap_or_default()
        }
        many => solve_pairs(base, many)?,
    };

    // Two landmarks leave nothing to start from elsewhere. Where they give no start: use known
    // cameras, else report why the first pair has no solution.
    if landmarks.len() < 2 || starts.is_empty() {
        starts.extend(known);
    }
    if starts.is_empty() {
        let pair_error = match landmarks.as_slice() {
            [one, two, ..] => solve_pair(base, *one, *two).err(),
            _ => None,
        };
        return Err(pair_error.unwrap_or(SolveError::NoFit {
            observations: observations.len(),
        }));
    }
    Ok(keep_best_distinct(base, &starts, observations))
}

fn landmark_clicks(observations: &[Observation]) -> Vec<LandmarkClick> {
    observations
        .iter()
        .filter_map(|observation| {
            Some(LandmarkClick {
                point_in_world: observation.shape.point()?,
                image: observation.image,
                click: observation.click,
            })
        })
        .collect()
}

/// Cameras known without the clicks: from a prior, the previous solution, or neighbouring frames.
fn known_cameras(context: &SolveContext) -> Vec<Ptz> {
    let prior = context.prior.iter().map(|prior| prior.ptz);
    prior
        .chain(context.start)
        .chain(context.neighbours.iter().copied())
        .take(MAX_KNOWN)
        .collect()
}

/// The two-point solve of one pair, with its clicks named in the error.
fn solve_pair(
    base: &CameraBase,
    one: LandmarkClick,
    two: LandmarkClick,
) -> Result<OneOrTwo<Ptz>, SolveError> {
    let clicks = [one.click, two.click];
    let found = solve_two_points(
        base,
        [one.point_in_world, two.point_in_world],
        [one.image, two.image],
    );
    found.map_err(|error| match error {
        TwoPointError::PointsTooClose { separation_px } => SolveError::PointsTooClose {
            separation_px,
            needed_px: MIN_SEPARATION_PX,
        },
        TwoPointError::SameRay { angle_deg } => SolveError::SameRay {
            clicks,
            angle_deg,
            needed_deg: MIN_RAY_ANGLE_DEG,
        },
        TwoPointError::NoRealRoot {
            separation_px,
            angle_deg,
        } => SolveError::NoRealRoot {
            clicks,
            separation_px,
            angle_deg,
        },
    })
}

/// All cameras of two landmark clicks, those near the fold of the lens included
/// ([`scan_two_points`]); none for other observations, or without a lens.
pub(in crate::solve) fn scan_starts(base: &CameraBase, used: &[Observation]) -> Vec<Ptz> {
    let [one, two] = used else { return Vec::new() };
    match (one.shape.point(), two.shape.point()) {
        (Some(first), Some(second)) if !base.distortion.is_pinhole() => {
            scan_two_points(base, [first, second], [one.image, two.image])
        }
        _ => Vec::new(),
    }
}

/// The two-point solves of the pairs farthest apart in the picture, which determine the focal
/// length best.
///
/// # Errors
/// The error of the farthest pair, if no pair has a solution.
fn solve_pairs(base: &CameraBase, landmarks: &[LandmarkClick]) -> Result<Vec<Ptz>, SolveError> {
    let pairs = farthest_pairs(landmarks, MAX_PAIRS, |[one, two]| {
        one.image.distance_px(two.image)
    });

    let mut starts = Vec::with_capacity(pairs.len());
    let mut first_error = None;
    for [one, two] in pairs {
        match solve_pair(base, one, two) {
            Ok(roots) => starts.extend(roots.iter()),
            Err(error) => _ = first_error.get_or_insert(error),
        }
    }
    match first_error {
        Some(error) if starts.is_empty() => Err(error),
        _ => Ok(starts),
    }
}

/// No landmark: the cameras of pairs of points that the lines show, and, where the lines are few,
/// those that show one of them where it was drawn; the best refined by a few steps. The grid is for
/// arcs alone.
fn starts_from_lines(
    base: &CameraBase,
    observations: &[Observation],
    context: &SolveContext,
) -> Vec<Ptz> {
    // Ranking and refining use a few points of each line alone: a start need not be exact, and a
    // drawn line may have many points.
    let lines = DrawnLine::group(observations);
    let few = few_per_line(&lines, observations);
    let crossings = find_crossings(&lines, observations);
    let mut starts: Vec<RankedStart> = find_pairs(&lines, &crossings)
        .into_iter()
        .filter_map(|pair| line_pairs::solve_pair(base, &pair))
        .flat_map(|roots| roots.iter())
        .map(|ptz| rank(base, ptz, &few))
        .collect();
    if starts.is_empty() || lines.len() < MANY_LINES {
        for line in longest(&lines, MAX_SWEPT_LINES) {
            starts.extend(sweep_line(base, line, &few, context));
        }
    }
    if starts.is_empty() {
        return grid_starts(base, &few, context);
    }
    refine_best(base, starts, MAX_LINE_STARTS, &few, context)
}

/// The best of some starts, at most this many, refined by a few steps.
fn refine_best(
    base: &CameraBase,
    mut starts: Vec<RankedStart>,
    most: usize,
    observations: &[Observation],
    context: &SolveContext,
) -> Vec<Ptz> {
    starts.sort_by(|a, b| a.cost.total_cmp(&b.cost));
    starts.truncate(most);
    let prior = context.prior.as_ref();
    starts
        .into_iter()
        .map(|start| refine(base, start.ptz, observations, Loss::Squared, prior).ptz)
        .filter(Ptz::is_finite)
        .collect()
}

/// The straight lines that are longest in the picture, at most this many.
fn longest(lines: &[DrawnLine], most: usize) -> Vec<&DrawnLine> {
    let mut straight: Vec<(f64, &DrawnLine)> = lines
        .iter()
        .filter_map(|line| {
            let [from, to] = line.straight()?.ends;
            Some((from.distance_px(to), line))
        })
        .collect();
    straight.sort_by(|a, b| b.0.total_cmp(&a.0));
    straight
        .into_iter()
        .take(most)
        .map(|(_, line)| line)
        .collect()
}

/// Tries a coarse grid over what this camera does and refines the best cells by a few steps each.
fn grid_starts(
    base: &CameraBase,
    observations: &[Observation],
    context: &SolveContext,
) -> Vec<Ptz> {
    const FOCAL_STEPS: usize = 10;
    const MAX_CELLS: usize = 40;
    let PtzRanges {
        pan: pans,
        tilt: tilts,
        ..
    } = &context.ranges;
    let mut cells: Vec<RankedStart> = Vec::new();
    for focal_px in log_spaced_focals(context, FOCAL_STEPS) {
        // Steps of a quarter of the field of view in pan and of half that in tilt, but not of less
        // than 4° and 2°.
        let quarter_view_deg = (0.5 * f64::from(context.image_size.width) / focal_px)
            .atan()
            .to_degrees()
            / 2.0;
        let step_deg = quarter_view_deg.max(4.0);
        for pan in evenly_spaced(pans.start(), pans.end(), step_deg) {
            for tilt in evenly_spaced(*tilts.start(), *tilts.end(), step_deg / 2.0) {
                let ptz = Ptz::new(pan, tilt, focal_px);
                let camera = PtzCamera::new(*base, ptz);
                // A cell that does not show every line is dropped.
                let distances_px = observations
                    .iter()
                    .map(|observation| observation.distance_px(&camera));
                if let Some(cost) = distances_px.sum::<Option<f64>>() {
                    cells.push(RankedStart { cost, ptz });
                }
            }
        }
    }
    refine_best(base, cells, MAX_CELLS, observations, context)
}

/// Angles from one to another, both included, at most `step_deg` apart and at most 91.
fn evenly_spaced(from: Angle, upto: Angle, step_deg: f64) -> impl Iterator<Item = Angle> {
    // At least one step, because a range of a single angle would divide by zero.
    let (from_deg, upto_deg) = (from.degrees(), upto.degrees());
    let count = ((upto_deg - from_deg) / step_deg).ceil().clamp(1.0, 90.0);
    (0..=count as usize).map(move |step| {
        Angle::from_degrees(from_deg + (upto_deg - from_deg) * step as f64 / count)
    })
}

/// The best starts, near duplicates left out.
fn keep_best_distinct(base: &CameraBase, starts: &[Ptz], observations: &[Observation]) -> Vec<Ptz> {
    let mut ranked: Vec<RankedStart> = starts
        .iter()
        .map(|ptz| rank(base, *ptz, observations))
        .collect();
    ranked.sort_by(|a, b| a.cost.total_cmp(&b.cost));
    // Refinement of nearby starts ends in the same minimum, so only distinct ones are kept.
    let ranked = ranked.into_iter().map(|start| start.ptz);
    keep_distinct(ranked, MAX_STARTS, |one, other| {
        camera_distance(one, other) > MIN_START_DISTANCE
    })
}

/// How differently two cameras see: the largest of the differences in pan and tilt, as shifts of
/// the picture in units of 1000 px, and of that in log focal length.
pub(in crate::solve) fn camera_distance(one: &Ptz, two: &Ptz) -> f64 {
    // A rotation by δ rad moves the middle of the picture by f δ px.
    let per_radian = one.focal_px.min(two.focal_px) / 1000.0;
    let pan = one.pan.turn_from(two.pan).abs().radians() * per_radian;
    let tilt = (one.tilt - two.tilt).abs().radians() * per_radian;
    pan.max(tilt).max((one.focal_px / two.focal_px).ln().abs())
}
