//! Scores of poses of the panorama on a field: by the share of the paint that lies near a line, and
//! by the share of the lines that lies near paint.
//!
//! Paint alone also matches poses that see lines where the picture has bare grass, so the product
//! of both counts. Rough poses get a tolerance that bridges the spacing of the grid, fitted ones a
//! narrow one.

use super::pitch_map::{PitchMap, Scatter, View};
use super::pose::PanoramaPose;
use crate::autocalibrate::frames::panorama::Panorama;
use crate::calibrate::kept::kept;
use nalgebra::Matrix2;
use touchline_core::geometry::{Vec2, Vec3};

/// A pose of the panorama, scored by the search.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ScoredPose {
    pub pose: PanoramaPose,
    /// Index of the field among those that were searched.
    pub field: usize,
    /// The share of the paint that the field's lines explain.
    pub explained: f64,
    /// The share of the visible length of the lines that lies near paint.
    pub visible: f64,
}

kept! {
    PanoramaPose { position_m, world_from_panorama }
    ScoredPose { pose, field, explained, visible }
}

impl ScoredPose {
    pub fn score(&self) -> f64 {
        self.explained * self.visible
    }
}

/// Sorts poses by their score, the highest first.
pub fn sort_by_score(poses: &mut [ScoredPose]) {
    poses.sort_by(|a, b| b.score().total_cmp(&a.score()));
}

/// Tolerance of the grid search for the pan of a direction, rad (1-σ). It bridges the spacing of
/// the grid.
const SCATTER: f64 = 0.025;

/// The same for tilt: a share of the sine of the angle below the horizon, because errors of height
/// and distance scale with it, and a constant for a pan axis that is not vertical, rad.
const SCATTER_OF_FALL: f64 = 0.025;
const LEAN: f64 = 0.005;

/// A line counts as visible if paint lies this near, while poses are those of the grid, degrees.
pub const WIDE_DEG: f64 = 1.2;

/// A line of a fitted pose counts as visible if paint lies this near, degrees, for a camera at the
/// usual height ([`PitchMap::angular_scale`]).
pub const PAINTED_DEG: f64 = 0.3;

/// Scores a pose of a grid with all directions.
pub fn score_roughly(
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

/// Scores a fitted pose by the share of explained paint and of visible lines.
pub fn score_pose(
    pose: PanoramaPose,
    panorama: &Panorama,
    (field, map): (usize, &PitchMap),
) -> ScoredPose {
    const WITHIN_DEG: f64 = 0.25;
    let within = map.angular_scale(pose.position_m.z) * WITHIN_DEG.to_radians();
    let explained = panorama
        .directions
        .iter()
        .filter(|direction| is_on_line(**direction, &pose, map, within))
        .count() as f64
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
            PAINTED_DEG * map.angular_scale(pose.position_m.z),
        ),
    }
}

/// Whether a direction of paint lies within an angle (rad) of the line that the pose sees nearest
/// to it.
fn is_on_line(direction: Vec3, pose: &PanoramaPose, map: &PitchMap, within: f64) -> bool {
    pose.line_at(direction, map).is_some_and(|line| {
        line.sine_of_distance(pose.position_m, pose.world_from_panorama * direction) < within
    })
}

/// The share of the paint that lies near a line, weighted by [`nearness`]. `share_of_scatter` is 1
/// at the spacing of the grid and falls as the pose gets better.
pub fn mean_nearness(
    pose: &PanoramaPose,
    directions: &[Vec3],
    map: &PitchMap,
    share_of_scatter: f64,
) -> f64 {
    directions
        .iter()
        .map(|direction| nearness_of_direction(*direction, pose, map, share_of_scatter))
        .sum::<f64>()
        / directions.len().max(1) as f64
}

/// The weight ([`nearness`]) of the paint in one direction; 0 if it does not meet the ground.
#[inline]
fn nearness_of_direction(
    direction: Vec3,
    pose: &PanoramaPose,
    map: &PitchMap,
    share_of_scatter: f64,
) -> f64 {
    let Some(ground) = map.ground_roughly(|z_m| pose.at_height(direction, z_m)) else {
        return 0.0;
    };
    nearness(
        ground,
        View::new(ground, pose.position_m),
        map,
        share_of_scatter,
    )
}

/// A direction below the horizon, in `panorama`, prepared for poses with a vertical pan axis.
pub struct BelowHorizon {
    /// Horizontal offset of the ground point per metre of the height of the camera above it.
    over_ground: Vec2,
    /// The sine of the angle below the horizon, squared; a rotation about the vertical does not
    /// change it.
    fall_squared: f64,
}

impl BelowHorizon {
    pub fn from_direction(direction: &Vec3) -> Option<Self> {
        let over_ground = direction.xy() / -direction.z;
        (direction.z < 0.0).then(|| Self {
            over_ground,
            fall_squared: 1.0 / (1.0 + over_ground.norm_squared()),
        })
    }

    /// The weight ([`nearness`]) of the paint in this direction, for a camera at `eye_m` whose pose
    /// rotates the ground plane by `turn`.
    #[inline]
    fn nearness(&self, turn: &Matrix2<f64>, eye_m: Vec3, map: &PitchMap) -> f64 {
        // Intersect the ray with the horizontal plane at height z: no 3×3 rotation, no division.
        let per_m = turn * self.over_ground;
        let Some(ground) = map.ground_roughly(|z_m| {
            let over = per_m * (eye_m.z - z_m);
            Some(Vec3::new(eye_m.x + over.x, eye_m.y + over.y, z_m))
        }) else {
            return 0.0;
        };
        let view = View {
            over_ground: (ground - eye_m).xy(),
            fall_squared: self.fall_squared,
        };
        nearness(ground, view, map, 1.0)
    }
}

/// The sum that [`mean_nearness`] divides by the number of directions, for a pose of the grid.
/// With a vertical pan axis a pose is a rotation in the plane and a scaling by the height. The
/// search spends most of its time here.
pub fn sum_upright_nearness(
    pose: &PanoramaPose,
    directions: &[BelowHorizon],
    map: &PitchMap,
) -> f64 {
    let turn = pose
        .world_from_panorama
        .fixed_view::<2, 2>(0, 0)
        .into_owned();
    directions
        .iter()
        .map(|direction| direction.nearness(&turn, pose.position_m, map))
        .sum()
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

/// The share of the lines in front of seen ground that lies near paint. Each sample is weighted by
/// its apparent length, so that far lines do not count for more than they take up in the pictures.
pub fn visible(
    pose: &PanoramaPose,
    panorama: &Panorama,
    map: &PitchMap,
    spacing_m: f64,
    within_deg: f64,
) -> f64 {
    let (mut all, mut seen) = (0.0, 0.0);
    for sample in map.samples(spacing_m * map.relative_size()) {
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
        if panorama.is_paint_within(direction, within_deg) {
            seen += weight;
        }
    }
    if all > 0.0 { seen / all } else { 0.0 }
}

/// The unit direction of an offset.
fn direction_of(offset: Vec3) -> Vec3 {
    offset / offset.norm().max(1e-9)
}
