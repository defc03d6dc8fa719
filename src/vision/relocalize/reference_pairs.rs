//! Pairs of references with overlapping views, and the pose of one relative to the other.

use super::{CERTAIN, Pose, PoseOptions, RayCandidate, RayMatches, pose_of_moving};
use crate::features::{DESCRIPTOR_NORM, Descriptor, Features, MAX_MATCH_SQUARED_DISTANCE};
use touchline_core::camera::{Ptz, PtzCamera};
use touchline_core::geometry::Angle;
use touchline_core::geometry::rotation::angle_between;

/// A reference: the features of its picture, and its label.
#[derive(Clone, Copy, Debug)]
pub struct Reference<'a> {
    /// The features of its picture.
    pub features: &'a Features,
    /// Its camera according to the label.
    pub camera: PtzCamera,
}

impl Reference<'_> {
    /// The distance between this camera's overlay and that of another camera on the same base, at
    /// the worst corner, px at 1920 px width.
    pub(super) fn disagreement_px(&self, other: &Ptz) -> f64 {
        let size = self.features.image_size;
        let other = PtzCamera::new(*self.camera.base(), *other);
        // A corner without a ray, or with a ray that the other camera does not show, is infinitely
        // far: such labels contradict each other by any tolerance.
        let moved = size.corners().map(|corner| {
            let image = self
                .camera
                .ray_from_image(corner)
                .ok()
                .and_then(|ray| other.image_from_ray(ray).ok());
            image.map_or(f64::INFINITY, |image| image.distance_px(corner))
        });
        moved.into_iter().fold(0.0, f64::max) / size.scale_from_1920()
    }

    /// Half the horizontal angle of view.
    fn half_view(&self) -> Angle {
        let width_px = f64::from(self.features.image_size.width);
        Angle::from_radians((width_px / 2.0 / self.camera.ptz().focal_px).atan())
    }
}

/// The pose of the second reference if the label of the first is right, from the strongest features
/// of each; `None` if their pictures do not determine it.
pub(super) fn pose_from_reference(
    first: &Reference,
    second: &Reference,
    features: usize,
) -> Option<Pose> {
    // Features of the first get rays from its label; those of the second are relocalized by them,
    // as a forest's candidates are.
    let mut matches = RayMatches::new();
    for (one, other, squared_distance) in mutual(first.features, second.features, features) {
        let Ok(ray) = first
            .camera
            .ray_from_image(first.features.keypoints[one].point)
        else {
            continue;
        };
        matches.push(
            second.features.keypoints[other].point,
            &[RayCandidate {
                ray,
                squared_distance,
            }],
        );
    }
    // Only a certain pose may speak against a label, or adjust it. The ranges are those of any
    // camera, because a grossly wrong label looks far away from the other.
    let pose = PoseOptions {
        min_confidence: CERTAIN,
        ..PoseOptions::default()
    };
    let found = pose_of_moving(
        &matches,
        second.features,
        second.camera.base(),
        &[first.camera.ptz()],
        &pose,
    );
    found.ok().map(|(pose, _)| pose)
}

/// Pairs each reference with its nearest neighbours in viewing direction that share part of its
/// view; ascending, each pair once.
pub(super) fn pairs(references: &[Reference], neighbours: usize) -> Vec<[usize; 2]> {
    // All against all: directions alone are compared, which costs little beside matching pictures.
    // Each reference names its own neighbours, so a pair may come twice.
    let mut pairs = Vec::new();
    for (index, reference) in references.iter().enumerate() {
        let mut near: Vec<(f64, usize)> = references
            .iter()
            .enumerate()
            .filter(|(other, _)| *other != index)
            .map(|(other, neighbour)| {
                // Rotation between the two as a share of the sum of their half views: below 1 they
                // overlap, zoom ignored.
                let apart = angle_between(
                    reference.camera.cam_from_base(),
                    neighbour.camera.cam_from_base(),
                );
                let half_views = reference.half_view() + neighbour.half_view();
                let share = apart.radians() / half_views.radians();
                (share, other)
            })
            .filter(|(share, _)| *share < 1.0)
            .collect();
        near.sort_by(|a, b| a.0.total_cmp(&b.0).then(a.1.cmp(&b.1)));
        pairs.extend(
            near.iter()
                .take(neighbours)
                .map(|(_, other)| [index.min(*other), index.max(*other)]),
        );
    }
    pairs.sort_unstable();
    pairs.dedup();
    pairs
}

/// Brute-force nearest neighbours between two lists of descriptors: for each row and each column,
/// the squared distance in bytes and the index. Not a closure, because only inlined code is
/// compiled for the processor at hand.
struct Nearest<'a> {
    rows: &'a [Descriptor],
    columns: &'a [Descriptor],
}

impl pulp::WithSimd for Nearest<'_> {
    type Output = (Vec<(u32, usize)>, Vec<(u32, usize)>);

    #[inline(always)]
    #[allow(
        clippy::inline_always,
        reason = "only what is inlined into the dispatch is compiled for this processor"
    )]
    fn with_simd<S: pulp::Simd>(self, _: S) -> Self::Output {
        // One pass fills both directions. Distances are compared with the index as second key, so
        // that equal distances have the same nearest neighbour in every run.
        let mut best_of_row = vec![(u32::MAX, 0); self.rows.len()];
        let mut best_of_column = vec![(u32::MAX, 0); self.columns.len()];
        for (row, descriptor) in self.rows.iter().enumerate() {
            for (column, neighbour) in self.columns.iter().enumerate() {
                let distance = descriptor.squared_byte_distance(neighbour);
                best_of_row[row] = best_of_row[row].min((distance, column));
                best_of_column[column] = best_of_column[column].min((distance, row));
            }
        }
        (best_of_row, best_of_column)
    }
}

/// Mutual nearest neighbours among the first `limit` features of two pictures, with their squared
/// distance.
fn mutual(one: &Features, other: &Features, limit: usize) -> Vec<(usize, usize, f32)> {
    let (rows, columns) = (
        &one.descriptors[..one.len().min(limit)],
        &other.descriptors[..other.len().min(limit)],
    );
    // Dispatch compiles the same code for several instruction sets and runs the best one.
    let (best_of_row, best_of_column) = pulp::Arch::new().dispatch(Nearest { rows, columns });
    // A match counts only if each is the other's nearest, which rejects most features that the
    // other picture does not show. `get` covers a picture without features, where rows name column
    // 0.
    let rows = best_of_row.into_iter().enumerate();
    let mutual = rows.filter(|(row, (_, column))| {
        best_of_column
            .get(*column)
            .is_some_and(|best| best.1 == *row)
    });
    mutual
        .map(|(row, (distance, column))| {
            (
                row,
                column,
                distance as f32 / (DESCRIPTOR_NORM * DESCRIPTOR_NORM),
            )
        })
        .filter(|(.., squared_distance)| *squared_distance <= MAX_MATCH_SQUARED_DISTANCE)
        .collect()
}
