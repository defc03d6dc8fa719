//! Training: samples to a forest, the same bytes on any number of threads.

use super::TrainOptions;
use super::split::{Split, choose_split};
use super::tree::{Branch, Forest, LeafRay, MAX_ITEMS, Node, Tree};
use crate::camera::PanTilt;
use crate::features::{DESCRIPTOR_BYTES, Descriptor};
use crate::geometry::Vec3;
use rand::seq::SliceRandom;
use rand::{RngExt, SeedableRng};
use rand_pcg::Pcg64Mcg;
use rayon::prelude::*;
use std::ops::ControlFlow;
use std::sync::atomic::{AtomicBool, AtomicUsize, Ordering};
use thiserror::Error;

/// What a forest learns from: descriptors and the rays they show, frame by frame.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Samples {
    pub(super) descriptors: Vec<Descriptor>,
    /// Unit directions in `base`.
    pub(super) rays: Vec<Vec3>,
    /// Where each frame's samples end.
    frame_ends: Vec<usize>,
}

impl Samples {
    /// No samples.
    #[must_use]
    pub fn new() -> Self {
        Self::default()
    }

    /// Adds a frame's descriptors with their rays in `base`.
    pub fn add_frame(&mut self, samples: impl IntoIterator<Item = (Descriptor, PanTilt)>) {
        for (descriptor, ray) in samples {
            self.descriptors.push(descriptor);
            self.rays.push(ray.direction());
        }
        self.frame_ends.push(self.descriptors.len());
    }

    /// How many samples there are.
    #[must_use]
    pub const fn len(&self) -> usize {
        self.descriptors.len()
    }

    /// Whether there is none.
    #[must_use]
    pub const fn is_empty(&self) -> bool {
        self.descriptors.is_empty()
    }

    /// How many frames they are from.
    #[must_use]
    pub const fn frames(&self) -> usize {
        self.frame_ends.len()
    }

    /// The samples of one frame.
    fn of_frame(&self, frame: usize) -> std::ops::Range<u32> {
        let start = if frame == 0 { 0 } else { self.frame_ends[frame - 1] };
        start as u32..self.frame_ends[frame] as u32
    }
}

/// How far training has come.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct TrainProgress {
    /// Samples that have reached their leaf, over all trees.
    pub placed: usize,
    /// Samples to place, over all trees.
    pub total: usize,
}

/// Why there is no forest.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Error)]
pub enum Stopped {
    /// The caller ended it.
    #[error("training was stopped")]
    Asked,
    /// There is nothing to learn from.
    #[error("{frames} references give no features to learn from")]
    NoSamples {
        /// Frames looked at.
        frames: usize,
    },
    /// The samples of one tree are more than a forest can number.
    #[error("{samples} samples are more than a forest can hold; use fewer references or features")]
    TooMany {
        /// How many there are.
        samples: usize,
    },
}

/// Nodes with fewer samples than this are not worth another task.
const PARALLEL_SAMPLES: usize = 512;

/// Trains a forest. `progress` is called now and then from any thread, and may end it.
///
/// # Errors
/// No samples, too many, or the caller ended it.
pub fn train(
    samples: &Samples,
    options: &TrainOptions,
    progress: &(dyn Fn(TrainProgress) -> ControlFlow<()> + Sync),
) -> Result<Forest, Stopped> {
    if samples.is_empty() {
        return Err(Stopped::NoSamples { frames: samples.frames() });
    }
    if samples.len() >= MAX_ITEMS {
        return Err(Stopped::TooMany { samples: samples.len() });
    }
    let drawn: Vec<Vec<u32>> = (0..options.trees.max(1)).map(|tree| draw(samples, options, tree)).collect();
    let total = drawn.iter().map(Vec::len).sum();
    let watch = Watch { placed: AtomicUsize::new(0), total, stopped: AtomicBool::new(false), progress };
    let trees: Option<Vec<Tree>> = drawn
        .into_par_iter()
        .enumerate()
        .map(|(tree, mut at)| {
            let grower = Grower { samples, options, watch: &watch };
            let grown = grower.grow(&mut at, 0, mixed(options.seed, tree as u64))?;
            Some(flatten(&grown))
        })
        .collect();
    trees.map(|trees| Forest { trees }).ok_or(Stopped::Asked)
}

/// The samples of the frames drawn for a tree.
fn draw(samples: &Samples, options: &TrainOptions, tree: u32) -> Vec<u32> {
    let mut frames: Vec<usize> = (0..samples.frames()).filter(|&frame| !samples.of_frame(frame).is_empty()).collect();
    if let Some(count) = options.frames_per_tree
        && (count as usize) < frames.len()
    {
        let mut rng = Pcg64Mcg::seed_from_u64(mixed(!options.seed, u64::from(tree)));
        frames.shuffle(&mut rng);
        frames.truncate(count.max(1) as usize);
        frames.sort_unstable();
    }
    frames.into_iter().flat_map(|frame| samples.of_frame(frame)).collect()
}

/// A seed from a seed and a number (the finaliser of `SplitMix64`).
fn mixed(seed: u64, number: u64) -> u64 {
    let mut z = seed.wrapping_add(number.wrapping_add(1).wrapping_mul(0x9e37_79b9_7f4a_7c15));
    z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
    z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
    z ^ (z >> 31)
}

struct Watch<'a> {
    placed: AtomicUsize,
    total: usize,
    stopped: AtomicBool,
    progress: &'a (dyn Fn(TrainProgress) -> ControlFlow<()> + Sync),
}

impl Watch<'_> {
    /// Counts samples that have reached their leaf; every thousand the caller hears of it.
    fn placed(&self, count: usize) {
        let before = self.placed.fetch_add(count, Ordering::Relaxed);
        let placed = before + count;
        if (before / 1000 != placed / 1000 || placed == self.total)
            && (self.progress)(TrainProgress { placed, total: self.total }).is_break()
        {
            self.stopped.store(true, Ordering::Relaxed);
        }
    }
}

/// A tree as it grows.
enum Grown {
    Leaf(Box<(Descriptor, LeafRay)>),
    Node(Split, Box<[Grown; 2]>),
}

struct Grower<'a> {
    samples: &'a Samples,
    options: &'a TrainOptions,
    watch: &'a Watch<'a>,
}

impl Grower<'_> {
    /// The tree of the samples `at`, which are put in its order; none when the caller ended it.
    fn grow(&self, at: &mut [u32], depth: u32, seed: u64) -> Option<Grown> {
        if self.watch.stopped.load(Ordering::Relaxed) {
            return None;
        }
        let splits = depth < self.options.max_depth && at.len() >= 2 * self.options.min_leaf.max(1) as usize;
        let mut rng = Pcg64Mcg::seed_from_u64(seed);
        let split = if splits { choose_split(self.samples, at, self.options, &mut rng) } else { None };
        let Some(split) = split else {
            self.watch.placed(at.len());
            return Some(Grown::Leaf(Box::new(self.leaf(at))));
        };
        let (dimension, threshold) = (usize::from(split.dimension), split.threshold);
        let middle = partition(at, |sample| self.samples.descriptors[sample as usize].0[dimension] <= threshold);
        let seeds: [u64; 2] = rng.random();
        let (below, above) = at.split_at_mut(middle);
        let (below, above) = if below.len().min(above.len()) >= PARALLEL_SAMPLES {
            rayon::join(|| self.grow(below, depth + 1, seeds[0]), || self.grow(above, depth + 1, seeds[1]))
        } else {
            (self.grow(below, depth + 1, seeds[0]), self.grow(above, depth + 1, seeds[1]))
        };
        Some(Grown::Node(split, Box::new([below?, above?])))
    }

    fn leaf(&self, at: &[u32]) -> (Descriptor, LeafRay) {
        let count = at.len() as f64;
        let mut sums = [0u32; DESCRIPTOR_BYTES];
        let mut direction = Vec3::zeros();
        for &sample in at {
            for (sum, &byte) in sums.iter_mut().zip(&self.samples.descriptors[sample as usize].0) {
                *sum += u32::from(byte);
            }
            direction += self.samples.rays[sample as usize];
        }
        let mean = if at.len() == 1 { direction } else { direction.normalize() };
        let squares: f64 = at.iter().map(|&sample| (self.samples.rays[sample as usize] - mean).norm_squared()).sum();
        let ray = PanTilt::from_direction(mean);
        let descriptor = Descriptor(sums.map(|sum| ((f64::from(sum) / count).round()) as u8));
        let pan_tilt = [ray.pan.radians() as f32, ray.tilt.radians() as f32];
        (descriptor, LeafRay { pan_tilt, spread: (squares / count).sqrt() as f32 })
    }
}

/// Puts what belongs first in front, in place; where the rest begins.
fn partition(at: &mut [u32], belongs_first: impl Fn(u32) -> bool) -> usize {
    let mut middle = 0;
    for i in 0..at.len() {
        if belongs_first(at[i]) {
            at.swap(i, middle);
            middle += 1;
        }
    }
    middle
}

/// A grown tree in flat memory: nodes in depth-first order, so that a way down mostly walks forward.
fn flatten(grown: &Grown) -> Tree {
    let mut tree = Tree { root: Branch::leaf(0), nodes: Vec::new(), descriptors: Vec::new(), rays: Vec::new() };
    tree.root = add(grown, &mut tree);
    tree
}

fn add(grown: &Grown, tree: &mut Tree) -> Branch {
    match grown {
        Grown::Leaf(leaf) => {
            tree.descriptors.push(leaf.0);
            tree.rays.push(leaf.1);
            Branch::leaf(tree.rays.len() - 1)
        }
        Grown::Node(split, children) => {
            let index = tree.nodes.len();
            let (dimension, threshold) = (split.dimension, split.threshold);
            tree.nodes.push(Node { dimension, threshold, branches: [Branch::node(0); 2] });
            let branches = [add(&children[0], tree), add(&children[1], tree)];
            tree.nodes[index].branches = branches;
            Branch::node(index)
        }
    }
}
