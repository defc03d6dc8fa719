//! Where a camera may stand: many places tried, the best fitted.

use super::pitch_map::{PitchMap, Scatter, View};
use super::pose::{PanoramaPose, angular_scale, fit_pose};
use rayon::prelude::*;
use std::collections::BTreeSet;
use std::ops::Range;
use touchline_core::geometry::rotation::{from_rotation_vector, nearest_rotation};
use touchline_core::geometry::{Angle, Vec2, Vec3, stride_of_subsample, subsample};
use touchline_vision::paint::SeenGround;

/// What is known of the paint: directions in `panorama`, and where ground was seen.
pub(super) struct Panorama {
    /// Spread over the sphere.
    pub directions: Vec<Vec3>,
    pub seen: SeenGround,
    painted: PaintedSphere,
}

/// How far directions are from paint: a grid over pan and tilt.
struct PaintedSphere {
    columns: usize,
    rows: usize,
    /// To the nearest paint, in cells; [`FARTHEST`] and beyond.
    off: Vec<u8>,
}

const CELL_DEG: f64 = 0.05;

/// No distance from paint is asked beyond so many cells.
const FARTHEST: u8 = 24;

impl PaintedSphere {
    fn of(directions: &[Vec3]) -> Self {
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
        for (column, row) in painted {
            for dy in -reach..=reach {
                let y = row as isize + dy;
                if y < 0 || y >= rows as isize {
                    continue;
                }
                for dx in -reach..=reach {
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

    /// Whether paint lies within an angle of a direction, [`FARTHEST`] cells at most.
    fn is_within(&self, direction: Vec3, within_deg: f64) -> bool {
        let off = self
            .cell(direction)
            .map(|(column, row)| self.off[row * self.columns + column]);
        off.is_some_and(|off| off < FARTHEST && f64::from(off) * CELL_DEG <= within_deg)
    }
}

impl Panorama {
    /// `all` the directions of paint; as many are kept as a search needs.
    pub fn new(all: &[Vec3], seen: SeenGround) -> Self {
        const KEPT: usize = 1500;
        const APART_DEG: f64 = 0.2;
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
        let painted = PaintedSphere::of(all);
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
    /// Which of the fields.
    pub field: usize,
    /// The share of the paint that the field's lines explain.
    pub explained: f64,
    /// The share of the lines that should be seen and are.
    pub visible: f64,
}

impl ScoredPose {
    pub fn score(&self) -> f64 {
        self.explained * self.visible
    }
}

/// The ranges in which a camera is looked for, m and degrees.
const X_M: Steps = Steps {
    from: -64.0,
    step: 4.0,
    count: 33,
};
const Y_M: Steps = Steps {
    from: -110.0,
    step: 5.0,
    count: 15,
};
const TURN_DEG: Steps = Steps {
    from: -40.0,
    step: 2.0,
    count: 41,
};
const LOWEST_M: f64 = 5.0;
const HEIGHT_RATIO: f64 = 1.14;
const HEIGHTS: usize = 15;

/// Values tried one after the other.
struct Steps {
    from: f64,
    step: f64,
    count: usize,
}

impl Steps {
    fn at(&self, index: usize) -> f64 {
        self.from + self.step * (index % self.count) as f64
    }
}

/// How many places are tried.
pub(super) const PLACES: usize = HEIGHTS * Y_M.count * X_M.count * TURN_DEG.count;

/// One of the places, with the heading: near the direction of the field's middle.
fn place(index: usize) -> (Vec3, Angle) {
    let (x, y) = (
        X_M.at(index / TURN_DEG.count),
        Y_M.at(index / (TURN_DEG.count * X_M.count)),
    );
    let height = index / (TURN_DEG.count * X_M.count * Y_M.count);
    let to_middle_deg = (-x).atan2(-y).to_degrees();
    let z = LOWEST_M * HEIGHT_RATIO.powi(height as i32);
    (
        Vec3::new(x, y, z),
        Angle::from_degrees(to_middle_deg + TURN_DEG.at(index)),
    )
}

/// How far paint may be seen beside a line at the first look, sideways, rad.
const SCATTER: f64 = 0.025;

/// The same upright: by this share of how steeply the camera looks down, and by how far the pan
/// axis may lean, rad.
const SCATTER_OF_FALL: f64 = 0.025;
const LEAN: f64 = 0.005;

/// How many of the places first tried on a field are looked at closer, and how many are fitted.
const LOOKED_AT: usize = 400;
const FITTED: usize = 60;

/// A line is seen where paint lies this near at a first look, degrees.
const WIDE_DEG: f64 = 1.2;

/// Directions of paint that are asked at the first look.
const ASKED_FIRST: usize = 500;

/// They are asked in parts, so many ninths of them at a time, the later parts only of the best: of
/// one in so many of the places that the part before was asked of.
const PARTS: [(Range<usize>, usize); 3] = [(0..1, 3), (1..3, 4), (3..9, 1)];

/// The best places on one of several fields, the most likely first.
pub(super) fn search(panorama: &Panorama, maps: &[PitchMap]) -> Vec<ScoredPose> {
    let mut found: Vec<ScoredPose> = maps
        .iter()
        .enumerate()
        .flat_map(|(field, map)| on_one_field(panorama, (field, map), maps.len()))
        .collect();
    sort(&mut found);
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

/// Places on one of `of` fields: together the fields are asked as little longer as that allows.
fn on_one_field(
    panorama: &Panorama,
    (field, map): (usize, &PitchMap),
    of: usize,
) -> Vec<ScoredPose> {
    let every = stride_of_subsample(panorama.directions.len() * of.div_ceil(2), ASKED_FIRST);
    let few: Vec<Vec3> = panorama.directions.iter().step_by(every).copied().collect();
    let below = |ninths: &Range<usize>| -> Vec<BelowHorizon> {
        let asked = few
            .iter()
            .enumerate()
            .filter(|(number, _)| ninths.contains(&(number % 9)));
        asked
            .filter_map(|(_, direction)| BelowHorizon::of(direction))
            .collect()
    };
    let explained = |index: usize, asked: &[BelowHorizon]| {
        let (position_m, heading) = place(index);
        explained_upright(&PanoramaPose::upright(position_m, heading), asked, map)
    };
    let best_first = |a: &(f64, usize), b: &(f64, usize)| b.0.total_cmp(&a.0).then(a.1.cmp(&b.1));
    let mut scored: Vec<(f64, usize)> = (0..PLACES).map(|index| (0.0, index)).collect();
    for (ninths, one_in) in PARTS {
        let asked = below(&ninths);
        scored
            .par_iter_mut()
            .for_each(|(score, index)| *score += explained(*index, &asked));
        let kept = scored.len() / one_in;
        if kept < scored.len() {
            scored.select_nth_unstable_by(kept, best_first);
            scored.truncate(kept);
        }
    }
    scored.sort_by(best_first);
    let mut chosen: Vec<(Vec3, Angle)> = Vec::new();
    for (_, index) in &scored {
        let (position_m, heading) = place(*index);
        let near = |other: &(Vec3, Angle)| {
            (other.0 - position_m).norm() < 6.5
                && (other.1 - heading).wrapped().degrees().abs() < 5.0
        };
        if !chosen.iter().any(near) {
            chosen.push((position_m, heading));
        }
        if chosen.len() >= LOOKED_AT {
            break;
        }
    }
    let mut looked: Vec<ScoredPose> = chosen
        .par_iter()
        .map(|(position_m, heading)| {
            let pose = PanoramaPose::upright(*position_m, *heading);
            let explained = explained_roughly(&pose, &panorama.directions, map, 1.0);
            ScoredPose {
                pose,
                field,
                explained,
                visible: visible(&pose, panorama, map, 1.0, WIDE_DEG),
            }
        })
        .collect();
    sort(&mut looked);
    looked.truncate(FITTED);
    let fit = |scored_pose: &ScoredPose| {
        let pose = climbed(scored_pose.pose, &few, panorama, map);
        score_pose(
            fit_pose(pose, &panorama.directions, map),
            panorama,
            (field, map),
        )
    };
    looked.par_iter().map(fit).collect()
}

pub(super) fn sort(poses: &mut [ScoredPose]) {
    poses.sort_by(|a, b| b.score().total_cmp(&a.score()));
}

/// A line is seen where paint lies this near, degrees, from the usual height.
const PAINTED_DEG: f64 = 0.3;

/// What speaks for a fitted place.
pub(super) fn score_pose(
    pose: PanoramaPose,
    panorama: &Panorama,
    (field, map): (usize, &PitchMap),
) -> ScoredPose {
    const WITHIN_DEG: f64 = 0.25;
    let within = angular_scale(pose.position_m.z) * WITHIN_DEG.to_radians();
    let explains = |direction: &&Vec3| {
        let line = pose.line_at(**direction, map);
        line.is_some_and(|line| {
            line.passed_by(pose.position_m, pose.world_from_panorama * **direction) < within
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

/// The share of the paint that lies near a line, more the nearer; at the first look (1) paint may
/// lie farther off than later.
fn explained_roughly(
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
            View::of(ground, pose.position_m),
            map,
            share_of_scatter,
        )
    };
    directions.iter().map(near).sum::<f64>() / directions.len().max(1) as f64
}

/// A direction (`panorama`) below the horizon of a camera whose pan axis is upright.
struct BelowHorizon {
    /// Over the ground, per metre of the camera's height.
    over_ground: Vec2,
    fall_squared: f64,
}

impl BelowHorizon {
    fn of(direction: &Vec3) -> Option<Self> {
        let over_ground = direction.xy() / -direction.z;
        (direction.z < 0.0).then(|| Self {
            over_ground,
            fall_squared: 1.0 / (1.0 + over_ground.norm_squared()),
        })
    }
}

/// [`explained_roughly`] at the first look, not divided by the number of directions, for a pose whose pan axis is upright: most of
/// the time of a search passes here.
fn explained_upright(pose: &PanoramaPose, directions: &[BelowHorizon], map: &PitchMap) -> f64 {
    let turn = pose
        .world_from_panorama
        .fixed_view::<2, 2>(0, 0)
        .into_owned();
    let eye_m = pose.position_m;
    let near = |direction: &BelowHorizon| -> f64 {
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

/// From 1 on a line to 0 where none is near.
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

/// A pose moved to where paint and lines belong together the most: places and headings that are
/// tried lie too far apart for a low camera, and its pan axis leans.
fn climbed(
    start: PanoramaPose,
    directions: &[Vec3],
    panorama: &Panorama,
    map: &PitchMap,
) -> PanoramaPose {
    /// Of the distance between the places that are tried, and of the scatter, round by round.
    const ROUNDS: [(f64, f64); 5] = [(0.5, 1.0), (0.35, 0.7), (0.2, 0.4), (0.1, 0.2), (0.05, 0.1)];
    /// Of the lean that is tried, degrees.
    const LEAN_DEG: f64 = 1.0;
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
            0 => shifted(Vec3::x() * (step * X_M.step)),
            1 => shifted(Vec3::y() * (step * Y_M.step)),
            2 => shifted(Vec3::z() * (from.position_m.z * (HEIGHT_RATIO.powf(step) - 1.0))),
            3 => turned(Vec3::z(), step * TURN_DEG.step),
            4 => turned(Vec3::x(), step * LEAN_DEG),
            _ => turned(Vec3::y(), step * LEAN_DEG),
        }
    };
    let mut pose = start;
    for (step, scatter) in ROUNDS {
        let score = |pose: &PanoramaPose| {
            let within_deg =
                (WIDE_DEG * scatter).max(PAINTED_DEG * angular_scale(pose.position_m.z));
            explained_roughly(pose, directions, map, scatter)
                * visible(pose, panorama, map, SPACING_M, within_deg)
        };
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

/// The share of the lines that lie where ground was seen and near paint; weighted by how long they
/// seem.
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
        if !panorama.seen.holds(direction) {
            continue;
        }
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
