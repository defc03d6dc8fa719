//! A tree in flat memory.

use crate::features::Descriptor;

/// Where a branch leads: an inner node or a leaf, by its number.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Branch(pub(super) u32);

/// Set in a [`Branch`] that leads to a leaf.
const LEAF: u32 = 1 << 31;

/// The most nodes and the most leaves that a tree may have.
pub(super) const MAX_ITEMS: usize = LEAF as usize;

/// What a branch leads to.
pub(super) enum Target {
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

    pub(super) const fn target(self) -> Target {
        if self.0 & LEAF == 0 { Target::Node(self.0 as usize) } else { Target::Leaf((self.0 & !LEAF) as usize) }
    }
}

/// An inner node: bytes up to the threshold go to the first branch, larger ones to the second.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Node {
    pub dimension: u8,
    pub threshold: u8,
    pub branches: [Branch; 2],
}

/// The ray of a leaf.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct LeafRay {
    /// Mean pan and tilt in `base`, rad.
    pub pan_tilt: [f32; 2],
    /// Root mean square of the angles to the mean, rad.
    pub spread: f32,
}

/// Nodes before their children, leaves apart.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Tree {
    pub root: Branch,
    pub nodes: Vec<Node>,
    pub descriptors: Vec<Descriptor>,
    pub rays: Vec<LeafRay>,
}

/// A trained pan-tilt forest. It holds descriptors and rays, and nothing about where they came from.
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

    /// How many leaves all trees have.
    #[must_use]
    pub fn leaves(&self) -> usize {
        self.trees.iter().map(|tree| tree.rays.len()).sum()
    }

    /// How many leaves mix rays that spread by more than an angle (rad, root mean square): different places that look
    /// alike, or references that contradict each other.
    #[must_use]
    pub fn mixed_leaves(&self, spread: f64) -> usize {
        self.trees.iter().flat_map(|tree| &tree.rays).filter(|ray| f64::from(ray.spread) > spread).count()
    }
}
