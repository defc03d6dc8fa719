//! Exhaustive search for the pose of the panorama on a field.
//!
//! Poses on a grid over position and heading are scored by the share of the paint that lies near a
//! line. The best are improved by a pattern search, fitted to the lines by iterative closest point,
//! and scored by paint on lines and by lines on paint (`pose_score.rs`). The result is a ranked
//! list of distinct poses.

use super::pitch_map::PitchMap;
use super::places::{HEIGHT_RATIO, SearchPlaces, TURN_STEP_DEG, X_STEP_M, Y_STEP_M};
use super::pose::{PanoramaPose, fit_pose};
use super::pose_score::{
    BelowHorizon, PAINTED_DEG, ScoredPose, WIDE_DEG, mean_nearness, score_pose, score_roughly,
    sort_by_score, sum_upright_nearness, visible,
};
use crate::autocalibrate::frames::panorama::Panorama;
use rayon::prelude::*;
use std::cmp::Ordering;
use std::ops::Range;
use touchline_core::geometry::{Angle, Vec3, stride_of_subsample};

/// The number of grid poses that are scored with all directions, and the number of those that are
/// fitted.
const LOOKED_AT: usize = 400;
const FITTED: usize = 60;

/// Poses nearer to each other than this are one, on a soccer pitch, m; while they are those of the
/// grid, than the second, if their headings are alike.
const APART_M: f64 = 3.0;
const GRID_APART_M: f64 = 6.5;

/// The number of directions that score a pose of the grid.
const FEW_DIRECTIONS: usize = 500;

/// The directions are evaluated in stages, so that bad poses cost little: the range of ninths of
/// the directions to evaluate, and the share (1 in n) of the poses that goes on. Compare the
/// breadth-first preemption of Nistér, "Preemptive RANSAC", ICCV 2003.
const PARTS: [(Range<usize>, usize); 3] = [(0..1, 3), (1..3, 4), (3..9, 1)];

/// The best poses on any of several fields, the highest score first. Positions are at least
/// [`APART_M`] apart.
pub fn search(panorama: &Panorama, maps: &[PitchMap], places: &SearchPlaces) -> Vec<ScoredPose> {
    let mut found: Vec<ScoredPose> = maps
        .iter()
        .enumerate()
        .flat_map(|(field, map)| search_field(panorama, (field, map), maps.len(), places))
        .collect();
    sort_by_score(&mut found);
    // Non-maximum suppression over all fields: one position on a field of another size is the same
    // hypothesis, because the size is fitted later.
    let apart_m = APART_M * places.relative_size();
    let mut distinct: Vec<ScoredPose> = Vec::new();
    for scored_pose in found {
        let position_m = scored_pose.pose.position_m;
        if !distinct
            .iter()
            .any(|other| (other.pose.position_m - position_m).norm() < apart_m)
        {
            distinct.push(scored_pose);
        }
    }
    distinct
}

/// The best poses on one of several fields, fitted.
fn search_field(
    panorama: &Panorama,
    (field, map): (usize, &PitchMap),
    num_fields: usize,
    places: &SearchPlaces,
) -> Vec<ScoredPose> {
    let few = few_directions(panorama, num_fields);
    // 1. Score all poses of the grid.
    let scored = score_grid(places, &few, map);
    // 2. Keep the local maxima.
    let chosen = local_maxima(&scored, places);
    // 3. Score these with all directions, and by the lines that should be visible: paint alone also
    //    matches poses that see lines where the picture has bare grass.
    let mut looked: Vec<ScoredPose> = chosen
        .par_iter()
        .map(|(position_m, heading)| {
            let pose = PanoramaPose::upright(*position_m, *heading);
            score_roughly(pose, panorama, (field, map))
        })
        .collect();
    sort_by_score(&mut looked);
    looked.truncate(FITTED);
    // 4. Improve the best of them.
    looked
        .par_iter()
        .map(|scored| climb_and_fit(scored.pose, &few, panorama, (field, map)))
        .collect()
}

/// The directions that score a pose of the grid on one of several fields, evenly subsampled. Their
/// number falls with that of the fields: several fields together take at most about twice as long
/// as one.
fn few_directions(panorama: &Panorama, num_fields: usize) -> Vec<Vec3> {
    let all = &panorama.directions;
    let stride = stride_of_subsample(all.len() * num_fields.div_ceil(2), FEW_DIRECTIONS);
    all.iter().step_by(stride).copied().collect()
}

/// The scores of the grid poses that get through all stages, each with the number of its pose, best
/// first.
///
/// Scores add up over the stages. Equal scores are ordered by the number, so that the result does
/// not depend on the threads.
fn score_grid(places: &SearchPlaces, directions: &[Vec3], map: &PitchMap) -> Vec<(f64, usize)> {
    let mut scored: Vec<(f64, usize)> = (0..places.len()).map(|index| (0.0, index)).collect();
    for (ninths, one_in) in PARTS {
        let below_horizon = directions_of_stage(directions, &ninths);
        scored.par_iter_mut().for_each(|(score, index)| {
            let (position_m, heading) = places.at(*index);
            let pose = PanoramaPose::upright(position_m, heading);
            *score += sum_upright_nearness(&pose, &below_horizon, map);
        });
        let kept = scored.len() / one_in;
        if kept < scored.len() {
            scored.select_nth_unstable_by(kept, best_first);
            scored.truncate(kept);
        }
    }
    scored.sort_by(best_first);
    scored
}

/// The directions below the horizon that one stage evaluates: of every nine directions, those with
/// the numbers `ninths`. They are not a contiguous part, so that each stage covers the whole
/// sphere.
fn directions_of_stage(directions: &[Vec3], ninths: &Range<usize>) -> Vec<BelowHorizon> {
    directions
        .iter()
        .enumerate()
        .filter(|(number, _)| ninths.contains(&(number % 9)))
        .filter_map(|(_, direction)| BelowHorizon::from_direction(direction))
        .collect()
}

/// The order of scores, each with the number of its pose: the highest first, then by number.
fn best_first(a: &(f64, usize), b: &(f64, usize)) -> Ordering {
    b.0.total_cmp(&a.0).then(a.1.cmp(&b.1))
}

/// The positions and headings of scored grid poses (best first) that are local maxima: of poses
/// closer than [`GRID_APART_M`] and 5° only the best. At most [`LOOKED_AT`].
fn local_maxima(scored: &[(f64, usize)], places: &SearchPlaces) -> Vec<(Vec3, Angle)> {
    let mut chosen: Vec<(Vec3, Angle)> = Vec::new();
    for (_, index) in scored {
        let (position_m, heading) = places.at(*index);
        let is_near_better = chosen.iter().any(|(better_m, better_heading)| {
            (better_m - position_m).norm() < GRID_APART_M * places.relative_size()
                && (*better_heading - heading).wrap().degrees().abs() < 5.0
        });
        if !is_near_better {
            chosen.push((position_m, heading));
        }
        if chosen.len() >= LOOKED_AT {
            break;
        }
    }
    chosen
}

/// Improves and fits a pose of a grid.
pub fn fit_coarse_pose(
    pose: PanoramaPose,
    panorama: &Panorama,
    field: (usize, &PitchMap),
) -> ScoredPose {
    climb_and_fit(pose, &few_directions(panorama, 1), panorama, field)
}

/// Improves a pose by the pattern search on a few of the directions and fits it to all of them: a
/// grid is too coarse for iterative closest point to converge from it.
fn climb_and_fit(
    pose: PanoramaPose,
    few: &[Vec3],
    panorama: &Panorama,
    (field, map): (usize, &PitchMap),
) -> ScoredPose {
    let pose = climb(pose, few, panorama, map);
    let fitted = fit_pose(pose, &panorama.directions, map);
    score_pose(fitted, panorama, (field, map))
}

/// Improves a pose by a pattern search over position, heading and the lean of the pan axis
/// (exploratory moves of Hooke and Jeeves, 1961).
///
/// The grid is too coarse for a low camera, and the pan axes of its poses are exactly vertical. The
/// visible share of the lines is a step function of the pose ([`visible`]), so the search uses no
/// gradient.
fn climb(
    start: PanoramaPose,
    directions: &[Vec3],
    panorama: &Panorama,
    map: &PitchMap,
) -> PanoramaPose {
    /// The step, as a share of the spacing of the grid, and the share of the scatter, round by
    /// round.
    const ROUNDS: [(f64, f64); 5] = [(0.5, 1.0), (0.35, 0.7), (0.2, 0.4), (0.1, 0.2), (0.05, 0.1)];
    let mut pose = start;
    for (step, scatter) in ROUNDS {
        // Try both directions of each of the six parameters once and keep what raises the score.
        // The score itself changes from round to round, so it is computed anew.
        let mut best = score_of_climb(&pose, directions, panorama, map, scatter);
        for parameter in 0..6 {
            for sign in [-1.0, 1.0] {
                let there = step_pose(&pose, parameter, sign * step, map.relative_size());
                let found = score_of_climb(&there, directions, panorama, map, scatter);
                if found > best {
                    (pose, best) = (there, found);
                }
            }
        }
    }
    pose
}

/// The score that the pattern search raises: the explained share of a few directions times the
/// visible share of the lines. Both tolerances shrink with `share_of_scatter`.
fn score_of_climb(
    pose: &PanoramaPose,
    directions: &[Vec3],
    panorama: &Panorama,
    map: &PitchMap,
    share_of_scatter: f64,
) -> f64 {
    /// Spacing of the samples of the lines on a soccer pitch, m: coarser than in the final score, for speed.
    const SPACING_M: f64 = 3.0;
    let within_deg =
        (WIDE_DEG * share_of_scatter).max(PAINTED_DEG * map.angular_scale(pose.position_m.z));
    mean_nearness(pose, directions, map, share_of_scatter)
        * visible(pose, panorama, map, SPACING_M, within_deg)
}

/// A pose moved along one of its six parameters (position, heading, lean about x and about y) by a
/// share of the spacing of the grid.
fn step_pose(from: &PanoramaPose, parameter: usize, step: f64, relative_size: f64) -> PanoramaPose {
    /// The full step of the lean, degrees.
    const LEAN_DEG: f64 = 1.0;
    match parameter {
        0 => from.shift_by(Vec3::x() * (step * X_STEP_M * relative_size)),
        1 => from.shift_by(Vec3::y() * (step * Y_STEP_M * relative_size)),
        2 => from.shift_by(Vec3::z() * (from.position_m.z * (HEIGHT_RATIO.powf(step) - 1.0))),
        3 => from.turn_by(Vec3::z() * f64::to_radians(step * TURN_STEP_DEG)),
        4 => from.turn_by(Vec3::x() * f64::to_radians(step * LEAN_DEG)),
        _ => from.turn_by(Vec3::y() * f64::to_radians(step * LEAN_DEG)),
    }
}
