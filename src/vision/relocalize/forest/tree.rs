//! A trained tree in flat memory.

use super::Samples;
use crate::features::{DESCRIPTOR_BYTES, Descriptor, Sketch};
use std::ops::Range;
use touchline_core::camera::PanTilt;
use touchline_core::geometry::{Angle, Vec3};

/// A branch: the index of an inner node, or of a leaf with the top bit set.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Branch(pub(super) u32);

/// The bit of a [`Branch`] to a leaf.
const LEAF: u32 = 1 << 31;

/// The exclusive upper bound of the number of nodes and of leaves of a tree.
pub(super) const MAX_ITEMS: usize = LEAF as usize;

/// The target of a branch.
pub(super) enum Child {
    Node(usize),
    Leaf(usize),
}

impl Branch {
    pub(super) const fn node(index: usize) -> Self {
        Self(index as u32)
    }

    pub(super) const fn leaf(index: usize) -> Self {
        Self(index as u32 | LEAF)
    }

    pub(super) const fn child(self) -> Child {
        if self.0 & LEAF == 0 {
            Child::Node(self.0 as usize)
        } else {
            Child::Leaf((self.0 & !LEAF) as usize)
        }
    }
}

/// An inner node: bytes up to the threshold go to the first branch, larger ones to the second.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Node {
    pub dimension: u8,
    pub threshold: u8,
    pub branches: [Branch; 2],
}

/// The mean ray of samples that show one place of the stadium.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct MeanRay {
    /// Mean pan and tilt in `base`, rad.
    pub pan_tilt: [f32; 2],
    /// Root mean square of the angles to the mean, rad.
    pub spread: f32,
    /// Number of samples averaged.
    pub samples: u32,
}

impl MeanRay {
    /// The mean pan in `base`.
    pub(super) fn pan(&self) -> Angle {
        Angle::from_radians(f64::from(self.pan_tilt[0]))
    }

    /// The mean tilt in `base`.
    pub(super) fn tilt(&self) -> Angle {
        Angle::from_radians(f64::from(self.pan_tilt[1]))
    }
}

/// A tree: nodes precede their children; descriptors and rays are stored leaf after leaf.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Tree {
    pub root: Branch,
    pub nodes: Vec<Node>,
    /// End index of each leaf's descriptors and rays.
    pub leaf_ends: Vec<u32>,
    pub descriptors: Vec<Descriptor>,
    /// Sketches of the descriptors; not stored in files.
    pub sketches: Vec<Sketch>,
    pub rays: Vec<MeanRay>,
}

impl Tree {
    /// The indices of a leaf's descriptors and rays.
    #[inline]
    pub(super) fn leaf_range(&self, leaf: usize) -> Range<usize> {
        let start = leaf.checked_sub(1).map_or(0, |last| self.leaf_ends[last]);
        start as usize..self.leaf_ends[leaf] as usize
    }

    /// Memory in bytes.
    fn memory_bytes(&self) -> usize {
        let mean = size_of::<Descriptor>() + size_of::<Sketch>() + size_of::<MeanRay>();
        self.rays.len() * mean
            + self.nodes.len() * size_of::<Node>()
            + self.leaf_ends.len() * size_of::<u32>()
    }
}

/// A trained pan-tilt forest. It contains descriptors and rays, and nothing about where they came
/// from.
#[derive(Clone, Debug, PartialEq)]
pub struct Forest {
    pub(super) trees: Vec<Tree>,
}

impl Forest {
    /// Number of trees.
    pub const fn trees(&self) -> usize {
        self.trees.len()
    }

    /// The forest of its first trees only.
    #[must_use]
    pub fn first_trees(&self, trees: usize) -> Self {
        Self {
            trees: self.trees.iter().take(trees).cloned().collect(),
        }
    }

    /// Number of leaves of all trees.
    pub fn leaves(&self) -> usize {
        self.trees.iter().map(|tree| tree.leaf_ends.len()).sum()
    }

    /// Number of descriptors in all leaves; each is the mean of samples that show one place.
    pub fn means(&self) -> usize {
        self.trees.iter().map(|tree| tree.rays.len()).sum()
    }

    /// Memory in bytes.
    pub fn memory_bytes(&self) -> usize {
        self.trees.iter().map(Tree::memory_bytes).sum()
    }
}

/// Clusters the samples `at` of a leaf by their rays and returns the mean of each cluster.
///
/// Greedy: a sample joins the first cluster whose first ray is within `merge_within`, else it
/// starts a cluster.
pub(super) fn means(
    samples: &Samples,
    at: &[u32],
    merge_within: Angle,
) -> Vec<(Descriptor, MeanRay)> {
    // Sorted by the x coordinate of the rays, clusters whose x lies farther back than the radius
    // can no longer match. The radius is a chord of the unit sphere. Equal values are ordered by
    // index, so the result is deterministic.
    let mut order = at.to_vec();
    order.sort_unstable_by(|&a, &b| {
        let by_x = samples.ray(a).x.total_cmp(&samples.ray(b).x);
        by_x.then(a.cmp(&b))
    });
    let chord = 2.0 * (merge_within.radians() / 2.0).sin();
    let mut places: Vec<(Vec3, Vec<u32>)> = Vec::new();
    let mut first_near = 0;
    for sample in order {
        // Clusters are in the order of x of their first rays, so `first_near` only moves forward.
        let at = samples.ray(sample);
        while places
            .get(first_near)
            .is_some_and(|(place, _)| at.x - place.x > chord)
        {
            first_near += 1;
        }
        let near = places[first_near..]
            .iter_mut()
            .find(|(place, _)| (at - *place).norm() < chord);
        match near {
            Some((_, members)) => members.push(sample),
            None => places.push((at, vec![sample])),
        }
    }
    places
        .iter()
        .map(|(_, members)| mean(samples, members))
        .collect()
}

/// The mean descriptor, rounded, and the mean ray of at least one sample.
fn mean(samples: &Samples, members: &[u32]) -> (Descriptor, MeanRay) {
    let count = members.len() as u32;
    let mut sums = [0u32; DESCRIPTOR_BYTES];
    let mut direction = Vec3::zeros();
    for &sample in members {
        for (sum, &byte) in sums.iter_mut().zip(&samples.descriptors[sample as usize].0) {
            *sum += u32::from(byte);
        }
        direction += samples.ray(sample);
    }
    // A single ray is kept exactly; normalising would round it.
    let mean = if count == 1 {
        direction
    } else {
        direction.normalize()
    };
    // Chords stand for angles, which they equal for rays near each other.
    let squares: f64 = members
        .iter()
        .map(|&sample| (samples.ray(sample) - mean).norm_squared())
        .sum();
    let ray = PanTilt::from_direction(mean);
    let pan_tilt = [ray.pan.radians() as f32, ray.tilt.radians() as f32];
    let spread = (squares / f64::from(count)).sqrt() as f32;
    let descriptor = Descriptor(sums.map(|sum| ((sum + count / 2) / count) as u8));
    (
        descriptor,
        MeanRay {
            pan_tilt,
            spread,
            samples: count,
        },
    )
}
