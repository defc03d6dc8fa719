//! A tree in flat memory.

use crate::features::{Descriptor, Sketch};
use std::ops::Range;
use touchline_core::geometry::Angle;

/// Where a branch leads: an inner node or a leaf, by its number.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Branch(pub(super) u32);

/// Set in a [`Branch`] that leads to a leaf.
const LEAF: u32 = 1 << 31;

/// The most nodes and the most leaves that a tree may have.
pub(super) const MAX_ITEMS: usize = LEAF as usize;

/// What a branch leads to.
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

/// What samples of one place say together.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct MeanRay {
    /// Mean pan and tilt in `base`, rad.
    pub pan_tilt: [f32; 2],
    /// Root mean square of the angles to the mean, rad.
    pub spread: f32,
    /// Samples that it stands for.
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

/// Nodes before their children; what the leaves hold stands leaf after leaf.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Tree {
    pub root: Branch,
    pub nodes: Vec<Node>,
    /// Where what each leaf holds ends.
    pub leaf_ends: Vec<u32>,
    pub descriptors: Vec<Descriptor>,
    /// Of the descriptors; not stored in files.
    pub sketches: Vec<Sketch>,
    pub rays: Vec<MeanRay>,
}

impl Tree {
    /// What a leaf holds: indices of `descriptors` and `rays`.
    #[inline]
    pub(super) fn held(&self, leaf: usize) -> Range<usize> {
        let start = if leaf == 0 {
            0
        } else {
            self.leaf_ends[leaf - 1] as usize
        };
        start..self.leaf_ends[leaf] as usize
    }

    /// How far the rays of all samples of a leaf spread, rad, root mean square.
    fn spread(&self, leaf: usize) -> f64 {
        let held = &self.rays[self.held(leaf)];
        // Pans count from the first one, so that ±180° is no seam.
        let first = held.first().map_or(Angle::ZERO, MeanRay::pan);
        let place = |ray: &MeanRay| [ray.pan().turn_from(first).radians(), ray.tilt().radians()];
        let weight: f64 = held.iter().map(|ray| f64::from(ray.samples)).sum();
        let mean = |of: &dyn Fn(&MeanRay) -> f64| {
            held.iter()
                .map(|ray| f64::from(ray.samples) * of(ray))
                .sum::<f64>()
                / weight.max(1.0)
        };
        // A pan counts by the cosine of its tilt.
        let at = [0, 1].map(|axis| mean(&|ray| place(ray)[axis]));
        let squares = mean(&|ray| {
            let [pan, tilt] = place(ray);
            ((pan - at[0]) * at[1].cos()).powi(2)
                + (tilt - at[1]).powi(2)
                + f64::from(ray.spread).powi(2)
        });
        squares.sqrt()
    }
}

/// A trained pan-tilt forest. It holds descriptors and rays, and nothing about where they came
/// from.
#[derive(Clone, Debug, PartialEq)]
pub struct Forest {
    pub(super) trees: Vec<Tree>,
}

impl Forest {
    /// How many trees it has.
    #[must_use]
    pub const fn trees(&self) -> usize {
        self.trees.len()
    }

    /// The first few of its trees, as if no more had been trained.
    #[must_use]
    pub fn first_trees(&self, trees: usize) -> Self {
        Self {
            trees: self.trees.iter().take(trees).cloned().collect(),
        }
    }

    /// How many leaves all trees have.
    #[must_use]
    pub fn leaves(&self) -> usize {
        self.trees.iter().map(|tree| tree.leaf_ends.len()).sum()
    }

    /// How many descriptors all leaves hold, each the mean of samples that show one place.
    #[must_use]
    pub fn means(&self) -> usize {
        self.trees.iter().map(|tree| tree.rays.len()).sum()
    }

    /// The memory that it takes, bytes.
    #[must_use]
    pub fn memory_bytes(&self) -> usize {
        let mean = size_of::<Descriptor>() + size_of::<Sketch>() + size_of::<MeanRay>();
        let of_tree = |tree: &Tree| {
            tree.rays.len() * mean
                + tree.nodes.len() * size_of::<Node>()
                + tree.leaf_ends.len() * size_of::<u32>()
        };
        self.trees.iter().map(of_tree).sum()
    }

    /// How many leaves mix rays that spread by more than an angle (rad, root mean square):
    /// different places that look alike, or references that contradict each other.
    #[must_use]
    pub fn mixed_leaves(&self, spread: f64) -> usize {
        let mixed = |tree: &Tree| {
            (0..tree.leaf_ends.len())
                .filter(|&leaf| tree.spread(leaf) > spread)
                .count()
        };
        self.trees.iter().map(mixed).sum()
    }
}
