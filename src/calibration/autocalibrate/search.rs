//! Exhaustive search for the pose of the panorama on a field.
//!
//! Poses on a grid over position and heading are scored by the share of the paint that lies near a
//! line. The best are improved by a pattern search, fitted to the lines by iterative closest point,
//! and scored by paint on lines and by lines on paint. The result is a ranked list of distinct
//! poses.

use super::pitch_map::{PitchMap, Scatter, View};
use super::pose::{PanoramaPose, angular_scale, fit_pose};
use super::search_places::{HEIGHT_RATIO, SearchPlaces, TURN_STEP_DEG, X_STEP_M, Y_STEP_M};
use rayon::prelude::*;
use std::collections::BTreeSet;
use std::ops::Range;
use touchline_core::geometry::rotation::{from_rotation_vector, nearest_rotation};
use touchline_core::geometry::{Angle, Vec2, Vec3, stride_of_subsample, subsample};
use touchline_vision::paint::GroundDirections;

/// What the search knows: the directions of paint in `panorama`, and where ground was seen.
pub(super) struct Panorama {
    /// At most one direction in each cell of a grid over the viewing sphere.
    pub directions: Vec<Vec3>,
    pub seen: GroundDirections,
    painted: PaintedSphere,
}

/// The distance from each direction below the horizon to the nearest paint: a distance transform on
/// a grid over pan and tilt.
struct PaintedSphere {
    columns: usize,
    rows: usize,
    /// Distance to the nearest paint, in cells and rounded down; [`FARTHEST`] where there is none
    /// nearer.
    off: Vec<u8>,
}

/// Side of a cell in pan and in tilt, degrees.
const CELL_DEG: f64 = 0.05;

/// Distances are computed up to this number of cells.
const FARTHEST: u8 = 24;

impl PaintedSphere {
    fn from_directions(directions: &[Vec3]) -> Self {
        let (columns, rows) = ((360.0 / CELL_DEG) as usize, (90.0 / CELL_DEG) as usize);
        let mut sphere = Self {
            columns,
            rows,
            off: vec![FARTHEST; columns * rows],
        };
        let painted: BTreeSet<(usize, usize)> = directions
            .iter()
            .filter_map(|direction| sphere.cell(*direction))
            .collect();
        let reach = isize::from(i8::try_from(FARTHEST).unwrap_or(i8::MAX));
        // A brute-force distance transform: each painted cell lowers the distances of the cells
        // around it. It runs once per focal scale and reaches FARTHEST cells.
        for (column, row) in painted {
            for dy in -reach..=reach {
                let y = row as isize + dy;
                if y < 0 || y >= rows as isize {
                    continue;
                }
                for dx in -reach..=reach {
                    // Pan is periodic; tilt ends at the horizon and at the nadir.
                    let x = (column as isize + dx).rem_euclid(columns as isize);
                    let off = f64::from((dx * dx + dy * dy) as i32)
                        .sqrt()
                        .min(f64::from(FARTHEST)) as u8;
                    let known = &mut sphere.off[y as usize * columns + x as usize];
                    *known = off.min(*known);
                }
            }
        }
        sphere
    }

    /// The column (pan from −180°) and row (angle below the horizon) of a direction; none at or
    /// above the horizon.
    fn cell(&self, direction: Vec3) -> Option<(usize, usize)> {
        let down = (-direction.z)
            .atan2(direction.x.hypot(direction.y))
            .to_degrees();
        let pan = direction.x.atan2(direction.y).to_degrees() + 180.0;
        (down > 0.0).then(|| {
            (
                (pan / CELL_DEG) as usize % self.columns,
                ((down / CELL_DEG) as usize).min(self.rows - 1),
            )
        })
    }

    /// Whether paint lies within an angle of a direction. Angles of [`FARTHEST`] cells and more
    /// count as too far.
    fn is_within(&self, direction: Vec3, within_deg: f64) -> bool {
        let off = self
            .cell(direction)
            .map(|(column, row)| self.off[row * self.columns + column]);
        off.is_some_and(|off| off < FARTHEST && f64::from(off) * CELL_DEG <= within_deg)
    }
}

impl Panorama {
    /// From all directions of paint. The distances to paint are computed from all of them; only as
    /// many as the search needs are kept as samples.
    pub fn new(all: &[Vec3], seen: GroundDirections) -> Self {
        const KEPT: usize = 1500;
        const APART_DEG: f64 = 0.2;
        // Keep the first direction in each cell: lines that many frames show would otherwise
        // outweigh the rest of the paint.
        let mut taken = BTreeSet::new();
        let spread: Vec<Vec3> = all
            .iter()
            .filter(|direction| {
                let down = (-direction.z)
                    .atan2(direction.x.hypot(direction.y))
                    .to_degrees();
                let pan = direction.x.atan2(direction.y).to_degrees();
                taken.insert((
                    (down / APART_DEG).round() as i64,
                    (pan / APART_DEG).round() as i64,
                ))
            })
            .copied()
            .collect();
        let directions = subsample(spread, KEPT).collect();
        let painted = PaintedSphere::from_directions(all);
        Self {
            directions,
            seen,
            painted,
        }
    }
}

/// A pose of the panorama, scored by the search.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct ScoredPose {
    pub pose: PanoramaPose,
    /// Index of the field among those that were searched.
    pub field: usize,
    /// The share of the paint that the field's lines explain.
    pub explained: f64,
    /// The share of the visible length of the lines that lies near paint.
    pub visible: f64,
}

impl ScoredPose {
    pub fn score(&self) -> f64 {
        self.explained * self.visible
    }
}

/// Tolerance of the grid search for the pan of a direction, rad (1-σ). It bridges the spacing of
/// the grid.
const SCATTER: f64 = 0.025;

/// The same for tilt: a share of the sine of the angle below the horizon, because errors of height
/// and distance scale with it, and a constant for a pan axis that is not vertical, rad.
const SCATTER_OF_FALL: f64 = 0.025;
const LEAN: f64 = 0.005;

/// The number of grid poses that are scored with all directions, and the number of those that are
/// fitted.
const LOOKED_AT: usize = 400;
const FITTED: usize = 60;

/// A line counts as visible if paint lies this near, while poses are those of the grid, degrees.
const WIDE_DEG: f64 = 1.2;

/// The number of directions that score a pose of the grid.
const FEW_DIRECTIONS: usize = 500;

/// The directions are evaluated in stages, so that bad poses cost little: the range of ninths of
/// the directions to evaluate, and the share (1 in n) of the poses that goes on. Compare the
/// breadth-first preemption of Nistér, "Preemptive RANSAC", ICCV 2003.
const PARTS: [(Range<usize>, usize); 3] = [(0..1, 3), (1..3, 4), (3..9, 1)];

/// The best poses on any of several fields, the highest score first. Positions are at least 3 m
/// apart.
pub(super) fn search(
    panorama: &Panorama,
    maps: &[PitchMap],
    places: &SearchPlaces,
) -> Vec<ScoredPose> {
    let mut found: Vec<ScoredPose> = maps
        .iter()
        .enumerate()
        .flat_map(|(field, map)| on_one_field(panorama, (field, map), maps.len(), places))
        .collect();
    sort(&mut found);
    // Non-maximum suppression over all fields: one position on a field of another size is the same
    // hypothesis, because the size is fitted later.
    let mut distinct: Vec<ScoredPose> = Vec::new();
    for scored_pose in found {
        let near =
            |other: &ScoredPose| (other.pose.position_m - scored_pose.pose.position_m).norm() < 3.0;
        if !distinct.iter().any(near) {
            distinct.push(scored_pose);
        }
    }
    distinct
}

/// The best poses on one of `of` fields, fitted. The number of directions per field falls with the
/// number of fields: several fields together take at most about twice as long as one.
fn on_one_field(
    panorama: &Panorama,
    (field, map): (usize, &PitchMap),
    of: usize,
    places: &SearchPlaces,
) -> Vec<ScoredPose> {
    let every = stride_of_subsample(panorama.directions.len() * of.div_ceil(2), FEW_DIRECTIONS);
    let few: Vec<Vec3> = panorama.directions.iter().step_by(every).copied().collect();
    // Every ninth direction, not a contiguous ninth, so that each stage covers the whole sphere.
    let below = |ninths: &Range<usize>| -> Vec<BelowHorizon> {
        let directions = few
            .iter()
            .enumerate()
            .filter(|(number, _)| ninths.contains(&(number % 9)));
        directions
            .filter_map(|(_, direction)| BelowHorizon::from_direction(direction))
            .collect()
    };
    let explained = |index: usize, directions: &[BelowHorizon]| {
        let (position_m, heading) = places.at(index);
        sum_upright_nearness(&PanoramaPose::upright(position_m, heading), directions, map)
    };
    let best_first = |a: &(f64, usize), b: &(f64, usize)| b.0.total_cmp(&a.0).then(a.1.cmp(&b.1));
    // 1. Score all poses of the grid. Scores add up over the stages. Equal scores are ordered by
    //    index, so that the result does not depend on the threads.
    let mut scored: Vec<(f64, usize)> = (0..places.len()).map(|index| (0.0, index)).collect();
    for (ninths, one_in) in PARTS {
        let directions = below(&ninths);
        scored
            .par_iter_mut()
            .for_each(|(score, index)| *score += explained(*index, &directions));
        let kept = scored.len() / one_in;
        if kept < scored.len() {
            scored.select_nth_unstable_by(kept, best_first);
            scored.truncate(kept);
        }
    }
    scored.sort_by(best_first);
    // 2. Keep the local maxima: of poses closer than 6.5 m and 5°, only the best.
    let mut chosen: Vec<(Vec3, Angle)> = Vec::new();
    for (_, index) in &scored {
        let (position_m, heading) = places.at(*index);
        let near = |other: &(Vec3, Angle)| {
            (other.0 - position_m).norm() < 6.5 && (other.1 - heading).wrap().degrees().abs() < 5.0
        };
        if !chosen.iter().any(near) {
            chosen.push((position_m, heading));
        }
        if chosen.len() >= LOOKED_AT {
            break;
        }
    }
    // 3. Score these with all directions, and by the lines that should be visible: paint alone also
    //    matches poses that see lines where the picture has bare grass.
    let mut looked: Vec<ScoredPose> = chosen
        .par_iter()
        .map(|(position_m, heading)| {
            let pose = PanoramaPose::upright(*position_m, *heading);
            score_roughly(pose, panorama, (field, map))
        })
        .collect();
    sort(&mut looked);
    looked.truncate(FITTED);
    // 4. Improve the best of them.
    let fit = |scored: &ScoredPose| climb_and_fit(scored.pose, &few, panorama, (field, map));
    looked.par_iter().map(fit).collect()
}

/// Scores a pose of a grid with all directions.
pub(super) fn score_roughly(
    pose: PanoramaPose,
    panorama: &Panorama,
    (field, map): (usize, &PitchMap),
) -> ScoredPose {
    ScoredPose {
        pose,
        field,
        explained: mean_nearness(&pose, &panorama.directions, map, 1.0),
        visible: visible(&pose, panorama, map, 1.0, WIDE_DEG),
    }
}

/// Improves and fits a pose of a grid.
pub(super) fn fit_coarse_pose(
    pose: PanoramaPose,
    panorama: &Panorama,
    field: (usize, &PitchMap),
) -> ScoredPose {
    let every = stride_of_subsample(panorama.directions.len(), FEW_DIRECTIONS);
    let few: Vec<Vec3> = panorama.directions.iter().step_by(every).copied().collect();
    climb_and_fit(pose, &few, panorama, field)
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

pub(super) fn sort(poses: &mut [ScoredPose]) {
    poses.sort_by(|a, b| b.score().total_cmp(&a.score()));
}

/// A line of a fitted pose counts as visible if paint lies this near, degrees, for a camera at the
/// usual height ([`angular_scale`]).
const PAINTED_DEG: f64 = 0.3;

/// Scores a fitted pose by the share of explained paint and of visible lines.
fn score_pose(
    pose: PanoramaPose,
    panorama: &Panorama,
    (field, map): (usize, &PitchMap),
) -> ScoredPose {
    const WITHIN_DEG: f64 = 0.25;
    let within = angular_scale(pose.position_m.z) * WITHIN_DEG.to_radians();
    let explains = |direction: &&Vec3| {
        let line = pose.line_at(**direction, map);
        line.is_some_and(|line| {
            line.sine_of_distance(pose.position_m, pose.world_from_panorama * **direction) < within
        })
    };
    let explained = panorama.directions.iter().filter(explains).count() as f64
        / panorama.directions.len().max(1) as f64;
    ScoredPose {
        pose,
        field,
        explained,
        visible: visible(
            &pose,
            panorama,
            map,
            1.0,
            PAINTED_DEG * angular_scale(pose.position_m.z),
        ),
    }
}

/// The share of the paint that lies near a line, weighted by [`nearness`]. `share_of_scatter` is 1
/// at the spacing of the grid and falls as the pose gets better.
fn mean_nearness(
    pose: &PanoramaPose,
    directions: &[Vec3],
    map: &PitchMap,
    share_of_scatter: f64,
) -> f64 {
    let near = |direction: &Vec3| -> f64 {
        let Some(ground) = map.ground_roughly(|z_m| pose.at_height(*direction, z_m)) else {
            return 0.0;
        };
        nearness(
            ground,
            View::new(ground, pose.position_m),
            map,
            share_of_scatter,
        )
    };
    directions.iter().map(near).sum::<f64>() / directions.len().max(1) as f64
}

/// A direction below the horizon, in `panorama`, prepared for poses with a vertical pan axis.
struct BelowHorizon {
    /// Horizontal offset of the ground point per metre of the height of the camera above it.
    over_ground: Vec2,
    /// The sine of the angle below the horizon, squared; a rotation about the vertical does not
    /// change it.
    fall_squared: f64,
}

impl BelowHorizon {
    fn from_direction(direction: &Vec3) -> Option<Self> {
        let over_ground = direction.xy() / -direction.z;
        (direction.z < 0.0).then(|| Self {
            over_ground,
            fall_squared: 1.0 / (1.0 + over_ground.norm_squared()),
        })
    }
}

/// The sum that [`mean_nearness`] divides by the number of directions, for a pose of the grid.
/// With a vertical pan axis a pose is a rotation in the plane and a scaling by the height. The
/// search spends most of its time here.
fn sum_upright_nearness(pose: &PanoramaPose, directions: &[BelowHorizon], map: &PitchMap) -> f64 {
    let turn = pose
        .world_from_panorama
        .fixed_view::<2, 2>(0, 0)
        .into_owned();
    let eye_m = pose.position_m;
    let near = |direction: &BelowHorizon| -> f64 {
        // Intersect the ray with the horizontal plane at height z: no 3×3 rotation, no division.
        let per_m = turn * direction.over_ground;
        let at = |z_m: f64| {
            let over = per_m * (eye_m.z - z_m);
            Some(Vec3::new(eye_m.x + over.x, eye_m.y + over.y, z_m))
        };
        let Some(ground) = map.ground_roughly(at) else {
            return 0.0;
        };
        let view = View {
            over_ground: (ground - eye_m).xy(),
            fall_squared: direction.fall_squared,
        };
        nearness(ground, view, map, 1.0)
    };
    directions.iter().map(near).sum()
}

/// The weight of paint at a ground point: 1 on a line, 0 from 2 σ on. (1 − (d/2σ)²)² is the weight
/// function of Tukey's biweight.
#[inline]
fn nearness(ground: Vec3, view: View, map: &PitchMap, share_of_scatter: f64) -> f64 {
    let upright_squared = SCATTER_OF_FALL.powi(2) * view.fall_squared + LEAN.powi(2);
    let [sideways_squared, upright_squared] =
        [SCATTER.powi(2), upright_squared].map(|scatter| share_of_scatter.powi(2) * scatter);
    match map.beside_squared(
        ground,
        view,
        Scatter {
            sideways_squared,
            upright_squared,
        },
    ) {
        Some(squared) if squared < 4.0 => (1.0 - 0.25 * squared).powi(2),
        _ => 0.0,
    }
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
    /// The full step of the lean, degrees.
    const LEAN_DEG: f64 = 1.0;
    /// Spacing of the samples of the lines, m: coarser than in the final score, for speed.
    const SPACING_M: f64 = 3.0;
    let moved = |from: &PanoramaPose, way: usize, step: f64| {
        let turned = |axis: Vec3, angle_deg: f64| {
            let turned =
                from_rotation_vector(axis * angle_deg.to_radians()) * from.world_from_panorama;
            PanoramaPose {
                world_from_panorama: nearest_rotation(&turned),
                ..*from
            }
        };
        let shifted = |by: Vec3| PanoramaPose {
            position_m: from.position_m + by,
            ..*from
        };
        match way {
            0 => shifted(Vec3::x() * (step * X_STEP_M)),
            1 => shifted(Vec3::y() * (step * Y_STEP_M)),
            2 => shifted(Vec3::z() * (from.position_m.z * (HEIGHT_RATIO.powf(step) - 1.0))),
            3 => turned(Vec3::z(), step * TURN_STEP_DEG),
            4 => turned(Vec3::x(), step * LEAN_DEG),
            _ => turned(Vec3::y(), step * LEAN_DEG),
        }
    };
    let mut pose = start;
    for (step, scatter) in ROUNDS {
        let score = |pose: &PanoramaPose| {
            let within_deg =
                (WIDE_DEG * scatter).max(PAINTED_DEG * angular_scale(pose.position_m.z));
            mean_nearness(pose, directions, map, scatter)
                * visible(pose, panorama, map, SPACING_M, within_deg)
        };
        // Try both directions of each of the six parameters once and keep what raises the score.
        // The score itself changes from round to round, so it is computed anew.
        let mut best = score(&pose);
        for way in 0..6 {
            for sign in [-1.0, 1.0] {
                let there = moved(&pose, way, sign * step);
                let found = score(&there);
                if found > best {
                    (pose, best) = (there, found);
                }
            }
        }
    }
    pose
}

/// The share of the lines in front of seen ground that lies near paint. Each sample is weighted by
/// its apparent length, so that far lines do not count for more than they take up in the pictures.
fn visible(
    pose: &PanoramaPose,
    panorama: &Panorama,
    map: &PitchMap,
    spacing_m: f64,
    within_deg: f64,
) -> f64 {
    let (mut all, mut seen) = (0.0, 0.0);
    for sample in map.samples(spacing_m) {
        let Some(direction) = pose.direction_in_panorama(sample.at) else {
            continue;
        };
        // Where no frame saw open ground, missing paint is no evidence against the pose.
        if !panorama.seen.holds(direction) {
            continue;
        }
        // Apparent length of a metre of the line, rad: the component of the tangent across the
        // view, divided by the distance.
        let offset = sample.at - pose.position_m;
        let along = sample.tangent.normalize();
        let weight = (along - direction_of(offset) * along.dot(&direction_of(offset))).norm()
            / offset.norm();
        all += weight;
        if panorama.painted.is_within(direction, within_deg) {
            seen += weight;
        }
    }
    if all > 0.0 { seen / all } else { 0.0 }
}

fn direction_of(offset: Vec3) -> Vec3 {
    offset / offset.norm().max(1e-9)
}
