//! Where a camera may stand: many places tried, the best fitted.

use super::pitch_map::PitchMap;
use super::pose::{RigPose, fitted};
use crate::geometry::{Angle, Vec3};
use crate::paint::SeenGround;
use rayon::prelude::*;

/// What is known of the paint: directions in the rig's frame, and where ground was seen.
pub(super) struct Panorama {
    /// Spread over the sphere.
    pub directions: Vec<Vec3>,
    pub seen: SeenGround,
    painted: PaintedSphere,
}

/// Directions near paint: a grid over pan and tilt.
struct PaintedSphere {
    columns: usize,
    rows: usize,
    painted: Vec<bool>,
}

const CELL_DEG: f64 = 0.1;

impl PaintedSphere {
    fn of(directions: &[Vec3], reach_deg: f64) -> Self {
        let (columns, rows) = ((360.0 / CELL_DEG) as usize, (90.0 / CELL_DEG) as usize);
        let mut sphere = Self { columns, rows, painted: vec![false; columns * rows] };
        let reach = (reach_deg / CELL_DEG).round() as isize;
        for direction in directions {
            let Some((column, row)) = sphere.cell(*direction) else { continue };
            for dy in -reach..=reach {
                for dx in -reach..=reach {
                    let y = row as isize + dy;
                    if dx * dx + dy * dy <= reach * reach && y >= 0 && y < rows as isize {
                        let x = (column as isize + dx).rem_euclid(columns as isize);
                        sphere.painted[y as usize * columns + x as usize] = true;
                    }
                }
            }
        }
        sphere
    }

    fn cell(&self, direction: Vec3) -> Option<(usize, usize)> {
        let down = (-direction.z).atan2(direction.x.hypot(direction.y)).to_degrees();
        let pan = direction.x.atan2(direction.y).to_degrees() + 180.0;
        (down > 0.0)
            .then(|| ((pan / CELL_DEG) as usize % self.columns, ((down / CELL_DEG) as usize).min(self.rows - 1)))
    }

    fn holds(&self, direction: Vec3) -> bool {
        self.cell(direction).is_some_and(|(column, row)| self.painted[row * self.columns + column])
    }
}

impl Panorama {
    /// `all` the directions of paint; as many are kept as a search needs.
    pub fn of(all: &[Vec3], seen: SeenGround) -> Self {
        const KEPT: usize = 1500;
        const APART_DEG: f64 = 0.2;
        let mut taken = std::collections::BTreeSet::new();
        let spread: Vec<Vec3> = all
            .iter()
            .filter(|direction| {
                let down = (-direction.z).atan2(direction.x.hypot(direction.y)).to_degrees();
                let pan = direction.x.atan2(direction.y).to_degrees();
                taken.insert(((down / APART_DEG).round() as i64, (pan / APART_DEG).round() as i64))
            })
            .copied()
            .collect();
        let every = spread.len().div_ceil(KEPT).max(1);
        let directions = spread.iter().step_by(every).copied().collect();
        let painted = PaintedSphere::of(all, 0.3);
        Self { directions, seen, painted }
    }
}

/// A place with what speaks for it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Hypothesis {
    pub pose: RigPose,
    /// Which of the fields.
    pub field: usize,
    /// The share of the paint that the field's lines explain.
    pub explained: f64,
    /// The share of the lines that should be seen and are.
    pub visible: f64,
}

impl Hypothesis {
    pub fn score(&self) -> f64 {
        self.explained * self.visible
    }
}

/// The ranges in which a camera is looked for, m and degrees.
const X_M: Range = Range { from: -64.0, step: 4.0, count: 33 };
const Y_M: Range = Range { from: -110.0, step: 5.0, count: 15 };
const TURN_DEG: Range = Range { from: -40.0, step: 2.0, count: 41 };
const LOWEST_M: f64 = 5.0;
const HEIGHT_RATIO: f64 = 1.14;
const HEIGHTS: usize = 15;

/// Values tried one after the other.
struct Range {
    from: f64,
    step: f64,
    count: usize,
}

impl Range {
    fn at(&self, index: usize) -> f64 {
        self.from + self.step * (index % self.count) as f64
    }
}

/// How many places are tried.
pub(super) const PLACES: usize = HEIGHTS * Y_M.count * X_M.count * TURN_DEG.count;

/// One of the places, with the heading: near the direction of the field's middle.
fn place(index: usize) -> (Vec3, Angle) {
    let (x, y) = (X_M.at(index / TURN_DEG.count), Y_M.at(index / (TURN_DEG.count * X_M.count)));
    let height = index / (TURN_DEG.count * X_M.count * Y_M.count);
    let to_middle_deg = (-x).atan2(-y).to_degrees();
    let z = LOWEST_M * HEIGHT_RATIO.powi(height as i32);
    (Vec3::new(x, y, z), Angle::from_degrees(to_middle_deg + TURN_DEG.at(index)))
}

/// How far paint may lie beside a line at the first look, as a share of its distance from the camera, and at least, m.
const SCATTER: f64 = 0.025;
const SCATTER_M: f64 = 0.3;

/// A pan axis that leans by this, rad, moves what is seen at a distance by its square over the camera's height: from low cameras
/// that is more than the scatter.
const LEAN: f64 = 0.005;

/// How many of the places first tried on a field are looked at closer, and how many are fitted.
const LOOKED_AT: usize = 400;
const FITTED: usize = 80;

/// Directions of paint that are asked at the first look.
const ASKED_FIRST: usize = 500;

/// The best places on one of several fields, the most likely first.
pub(super) fn search(panorama: &Panorama, maps: &[PitchMap]) -> Vec<Hypothesis> {
    let mut found: Vec<Hypothesis> =
        maps.iter().enumerate().flat_map(|(field, map)| on_one_field(panorama, (field, map), maps.len())).collect();
    sort(&mut found);
    let mut distinct: Vec<Hypothesis> = Vec::new();
    for hypothesis in found {
        let near = |other: &Hypothesis| (other.pose.position_m - hypothesis.pose.position_m).norm() < 3.0;
        if !distinct.iter().any(near) {
            distinct.push(hypothesis);
        }
    }
    distinct
}

/// Places on one of `of` fields: together the fields are asked as little longer as that allows.
fn on_one_field(panorama: &Panorama, (field, map): (usize, &PitchMap), of: usize) -> Vec<Hypothesis> {
    let every = (panorama.directions.len() * of.div_ceil(2)).div_ceil(ASKED_FIRST).max(1);
    let few: Vec<Vec3> = panorama.directions.iter().step_by(every).copied().collect();
    let mut scored: Vec<(f64, usize)> = (0..PLACES)
        .into_par_iter()
        .map(|index| {
            let (position_m, heading) = place(index);
            (explained_roughly(&RigPose::upright(position_m, heading), &few, map), index)
        })
        .collect();
    scored.sort_by(|a, b| b.0.total_cmp(&a.0).then(a.1.cmp(&b.1)));
    let mut chosen: Vec<(Vec3, Angle)> = Vec::new();
    for (_, index) in &scored {
        let (position_m, heading) = place(*index);
        let near = |other: &(Vec3, Angle)| {
            (other.0 - position_m).norm() < 6.5 && (other.1 - heading).wrapped().degrees().abs() < 5.0
        };
        if !chosen.iter().any(near) {
            chosen.push((position_m, heading));
        }
        if chosen.len() >= LOOKED_AT {
            break;
        }
    }
    let mut looked: Vec<Hypothesis> = chosen
        .par_iter()
        .map(|(position_m, heading)| {
            let pose = RigPose::upright(*position_m, *heading);
            let explained = explained_roughly(&pose, &panorama.directions, map);
            Hypothesis { pose, field, explained, visible: visible(&pose, panorama, map, 1.2) }
        })
        .collect();
    sort(&mut looked);
    looked.truncate(FITTED);
    let fitted =
        |hypothesis: &Hypothesis| judged(fitted(hypothesis.pose, &panorama.directions, map), panorama, (field, map));
    looked.par_iter().map(fitted).collect()
}

pub(super) fn sort(hypotheses: &mut [Hypothesis]) {
    hypotheses.sort_by(|a, b| b.score().total_cmp(&a.score()));
}

/// What speaks for a fitted place.
pub(super) fn judged(pose: RigPose, panorama: &Panorama, (field, map): (usize, &PitchMap)) -> Hypothesis {
    const WITHIN_DEG: f64 = 0.25;
    let explains = |direction: &&Vec3| {
        pose.ground(**direction).and_then(|ground| map.nearest(ground)).is_some_and(|line| {
            let across = (line.at - pose.position_m).cross(&line.tangent);
            let off = (pose.world_from_rig * **direction).dot(&across) / across.norm();
            let there = (line.at - pose.position_m).normalize();
            let along = (pose.world_from_rig * **direction - there).norm();
            off.abs() < WITHIN_DEG.to_radians() && along < 3.0 * WITHIN_DEG.to_radians()
        })
    };
    let explained =
        panorama.directions.iter().filter(explains).count() as f64 / panorama.directions.len().max(1) as f64;
    Hypothesis { pose, field, explained, visible: visible(&pose, panorama, map, 0.0) }
}

/// The share of the paint that lies near a line, more the nearer.
fn explained_roughly(pose: &RigPose, directions: &[Vec3], map: &PitchMap) -> f64 {
    let near = |direction: &Vec3| -> f64 {
        let Some(ground) = pose.ground(*direction) else { return 0.0 };
        let Some(distance_m) = map.distance_m(ground.x, ground.y) else { return 0.0 };
        let range_m = (ground - pose.position_m).norm();
        let leaning_m = LEAN * range_m * range_m / pose.position_m.z;
        let scatter_m = (SCATTER * range_m).max(leaning_m).max(SCATTER_M);
        let ratio = distance_m / scatter_m;
        if ratio < 2.0 { (1.0 - 0.25 * ratio * ratio).powi(2) } else { 0.0 }
    };
    directions.iter().map(near).sum::<f64>() / directions.len().max(1) as f64
}

/// The share of the lines that lie where ground was seen and near paint; weighted by how long they seem.
fn visible(pose: &RigPose, panorama: &Panorama, map: &PitchMap, more_deg: f64) -> f64 {
    const SPACING_M: f64 = 1.0;
    let (mut all, mut seen) = (0.0, 0.0);
    for sample in map.samples(SPACING_M) {
        let Some(direction) = pose.direction_in_rig(sample.at) else { continue };
        if !panorama.seen.holds(direction) {
            continue;
        }
        let offset = sample.at - pose.position_m;
        let along = sample.tangent.normalize();
        let weight = (along - direction_of(offset) * along.dot(&direction_of(offset))).norm() / offset.norm();
        all += weight;
        let near =
            if more_deg > 0.0 { near_within(panorama, direction, more_deg) } else { panorama.painted.holds(direction) };
        if near {
            seen += weight;
        }
    }
    if all > 0.0 { seen / all } else { 0.0 }
}

fn direction_of(offset: Vec3) -> Vec3 {
    offset / offset.norm().max(1e-9)
}

/// Whether paint lies within an angle of a direction: the direction itself and eight around it are asked.
fn near_within(panorama: &Panorama, direction: Vec3, within_deg: f64) -> bool {
    let side = Vec3::z().cross(&direction).normalize();
    let up = direction.cross(&side);
    let reach = within_deg.to_radians() / 2.0;
    let mut steps = (-2..=2).flat_map(|a| (-2..=2).map(move |b| (f64::from(a), f64::from(b))));
    steps.any(|(a, b)| panorama.painted.holds(direction + side * (a * reach) + up * (b * reach)))
}
