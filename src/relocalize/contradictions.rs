//! References that contradict each other.
//!
//! Two references that look the same way share features. The features of one, with the rays that its label gives them,
//! say where the other looks, as the forest would; where that is not what the other's label says, one of the two labels is
//! wrong. Which one, a third reference tells: the label that contradicts most others is the one to look at.
//!
//! A grossly wrong label, as one with mirrored names, says that it looks where none of the pictures is like its own: nothing
//! there contradicts it. A reference that shares nothing with those that look nearest is therefore compared with all others,
//! and believed to be wrong if two of them at least say so: one alone may be like it by chance, as repeated boards are.

use super::{PoseOptions, RayCandidate, RayMatches, pose_of_moving};
use crate::camera::{Ptz, PtzCamera};
use crate::features::{DESCRIPTOR_NORM, Descriptor, Features};
use crate::geometry::rotation::{angle_between, q_pan, q_tilt};
use crate::geometry::{Angle, ImagePoint};
use rayon::prelude::*;
use std::collections::BTreeSet;

/// A reference: what its picture looks like, and its label.
#[derive(Clone, Copy, Debug)]
pub struct Reference<'a> {
    /// The features of its picture.
    pub features: &'a Features,
    /// Its base, pointed as the label says.
    pub camera: PtzCamera,
}

/// Two references whose labels do not agree.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Contradiction {
    /// Their places among the references, in ascending order.
    pub references: [usize; 2],
    /// How far the overlay of the second lies from where the first says it is, at the worst corner, px at 1920 px width.
    pub disagreement_px: f64,
    /// Features that the two share.
    pub shared: usize,
}

/// When references contradict each other.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ContradictionOptions {
    /// Labels that differ by less agree, px at 1920 px width. 15 by default: people's clicks make references differ by
    /// about a third of that.
    pub tolerance_px: f64,
    /// Every reference is compared with as many that look nearest to where it looks. 4 by default.
    pub neighbours: usize,
    /// Features compared of each, the strongest. 400 by default.
    pub features: usize,
}

impl Default for ContradictionOptions {
    fn default() -> Self {
        Self { tolerance_px: 15.0, neighbours: 4, features: 400 }
    }
}

/// How sure it must be where the second looks.
const MIN_CONFIDENCE: f64 = 0.9;

/// The squared distance of descriptors that may show one place, of descriptors of unit length.
const MAX_SQUARED_DISTANCE: f32 = 0.2;

/// At most this many references that share nothing with those beside them are compared with all others.
const MOST_ALONE: usize = 16;

/// At least this many others, far from where a label says that it looks, have to contradict it.
const MANY: usize = 2;

/// The references whose labels contradict each other, the greatest disagreement first.
#[must_use]
pub fn contradictions(references: &[Reference], options: &ContradictionOptions) -> Vec<Contradiction> {
    let near = pairs(references, options.neighbours);
    let mut compared = compare(references, &near, options);
    let alone = (0..references.len()).filter(|index| !compared.iter().any(|found| found.references.contains(index)));
    let alone: Vec<usize> = alone.take(MOST_ALONE).collect();
    let everywhere: Vec<[usize; 2]> = alone
        .iter()
        .flat_map(|&one| (0..references.len()).map(move |other| [one.min(other), one.max(other)]))
        .filter(|pair| pair[0] != pair[1] && near.binary_search(pair).is_err())
        .collect::<BTreeSet<_>>()
        .into_iter()
        .collect();
    let far = compare(references, &everywhere, options);
    let contradicts = |found: &&Contradiction| !(found.disagreement_px <= options.tolerance_px);
    let by = |index: usize| far.iter().filter(contradicts).filter(|found| found.references.contains(&index)).count();
    let wrong: Vec<usize> = alone.into_iter().filter(|&index| by(index) >= MANY).collect();
    compared.extend(far.iter().filter(|found| wrong.iter().any(|index| found.references.contains(index))));
    let mut found: Vec<Contradiction> = compared.iter().filter(contradicts).copied().collect();
    found.sort_by(|a, b| b.disagreement_px.total_cmp(&a.disagreement_px).then(a.references.cmp(&b.references)));
    found
}

/// The references to look at: again and again the one that most of the remaining contradictions name, the one with the
/// greater disagreement of equals. Without it they would be gone.
#[must_use]
pub fn suspects(contradictions: &[Contradiction]) -> Vec<usize> {
    let mut rest = contradictions.to_vec();
    let mut suspects = Vec::new();
    while !rest.is_empty() {
        let mut counts = std::collections::BTreeMap::<usize, (usize, f64)>::new();
        for contradiction in &rest {
            for reference in contradiction.references {
                let (count, most) = counts.entry(reference).or_default();
                (*count, *most) = (*count + 1, most.max(contradiction.disagreement_px));
            }
        }
        let worst = counts.iter().max_by(|(_, a), (_, b)| a.0.cmp(&b.0).then(a.1.total_cmp(&b.1)));
        let Some((&worst, _)) = worst else { break };
        suspects.push(worst);
        rest.retain(|contradiction| !contradiction.references.contains(&worst));
    }
    suspects
}

/// Every reference with those that look nearest to where it looks and share some of its view.
fn pairs(references: &[Reference], neighbours: usize) -> Vec<[usize; 2]> {
    let turned = |ptz: Ptz| q_tilt(ptz.tilt) * q_pan(ptz.pan);
    let mut pairs = Vec::new();
    for (index, reference) in references.iter().enumerate() {
        let half_view = |reference: &Reference| {
            let width_px = f64::from(reference.features.image_size.width);
            Angle::from_radians((width_px / 2.0 / reference.camera.ptz().focal_px).atan())
        };
        let mut near: Vec<(f64, usize)> = references
            .iter()
            .enumerate()
            .filter(|(other, _)| *other != index)
            .map(|(other, neighbour)| {
                let apart = angle_between(&turned(reference.camera.ptz()), &turned(neighbour.camera.ptz()));
                let share = apart.radians() / (half_view(reference) + half_view(neighbour)).radians();
                (share, other)
            })
            .filter(|(share, _)| *share < 1.0)
            .collect();
        near.sort_by(|a, b| a.0.total_cmp(&b.0).then(a.1.cmp(&b.1)));
        pairs.extend(near.iter().take(neighbours).map(|(_, other)| [index.min(*other), index.max(*other)]));
    }
    pairs.sort_unstable();
    pairs.dedup();
    pairs
}

/// How far the labels of pairs are apart, as far as their pictures tell.
fn compare(references: &[Reference], pairs: &[[usize; 2]], options: &ContradictionOptions) -> Vec<Contradiction> {
    pairs.par_iter().filter_map(|pair| disagreement(references, *pair, options)).collect()
}

/// How far a pair's labels are apart; none where the pictures do not tell.
fn disagreement(references: &[Reference], pair: [usize; 2], options: &ContradictionOptions) -> Option<Contradiction> {
    let [first, second] = pair.map(|index| &references[index]);
    let mut matches = RayMatches::new();
    for (one, other, squared_distance) in mutual(first.features, second.features, options.features) {
        let Ok(ray) = first.camera.ray_from_image(first.features.keypoints[one].point) else { continue };
        matches.push(second.features.keypoints[other].point, &[RayCandidate { ray, squared_distance }]);
    }
    let (base, size) = (second.camera.base(), second.features.image_size);
    let pose = PoseOptions { min_confidence: MIN_CONFIDENCE, ..PoseOptions::default() };
    let (pose, _) = pose_of_moving(&matches, second.features, base, &[first.camera.ptz()], &pose).ok()?;
    let said = PtzCamera::new(*base, pose.ptz);
    let (width, height) = (f64::from(size.width), f64::from(size.height));
    let corners = [(0.0, 0.0), (width, 0.0), (0.0, height), (width, height)].map(|(x, y)| ImagePoint::new(x, y));
    let moved = corners.iter().map(|&corner| {
        let image = second.camera.ray_from_image(corner).ok().and_then(|ray| said.image_from_ray(ray).ok());
        image.map_or(f64::INFINITY, |image| image.distance_px(corner))
    });
    let disagreement_px = moved.fold(0.0, f64::max) / size.scale_from_1920();
    Some(Contradiction { references: pair, disagreement_px, shared: pose.inliers.len() })
}

/// The search for the nearest of each row among the columns and of each column among the rows: squared distance in bytes,
/// number. No closure, as only what is inlined is compiled for the processor at hand.
struct Nearest<'a> {
    rows: &'a [Descriptor],
    columns: &'a [Descriptor],
}

impl pulp::WithSimd for Nearest<'_> {
    type Output = (Vec<(u32, usize)>, Vec<(u32, usize)>);

    #[inline(always)]
    #[allow(clippy::inline_always, reason = "only what is inlined into the dispatch is compiled for this processor")]
    fn with_simd<S: pulp::Simd>(self, _: S) -> Self::Output {
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

/// Features of two pictures that are each other's nearest, and their squared distance.
fn mutual(one: &Features, other: &Features, limit: usize) -> Vec<(usize, usize, f32)> {
    let (rows, columns) = (&one.descriptors[..one.len().min(limit)], &other.descriptors[..other.len().min(limit)]);
    // The same code for every kind of processor, compiled for the instructions that this one has.
    let (best_of_row, best_of_column) = pulp::Arch::new().dispatch(Nearest { rows, columns });
    let rows = best_of_row.into_iter().enumerate();
    let mutual = rows.filter(|(row, (_, column))| best_of_column.get(*column).is_some_and(|best| best.1 == *row));
    mutual
        .map(|(row, (distance, column))| (row, column, distance as f32 / (DESCRIPTOR_NORM * DESCRIPTOR_NORM)))
        .filter(|(.., squared_distance)| *squared_distance <= MAX_SQUARED_DISTANCE)
        .collect()
}
