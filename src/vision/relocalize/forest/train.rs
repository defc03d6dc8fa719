//! Training of a forest from samples; the result is the same bytes for any number of threads.

use super::TrainOptions;
use super::split::{Samples, Split, choose_split};
use super::tree::{Branch, Forest, MAX_ITEMS, MeanRay, Node, Tree, means};
use crate::features::{Descriptor, Sketch};
use rand::seq::SliceRandom;
use rand::{RngExt, SeedableRng};
use rand_pcg::Pcg64Mcg;
use rayon::prelude::*;
use std::collections::BTreeSet;
use std::sync::atomic::{AtomicUsize, Ordering};
use thiserror::Error;
use touchline_core::geometry::pluralise;
use touchline_core::progress::Progress;

/// Progress of training.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct TrainProgress {
    /// Samples that have reached a leaf, over all trees.
    pub placed: usize,
    /// Samples in total, over all trees.
    pub total: usize,
}

/// Why training gave no forest.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Error)]
pub enum Stopped {
    /// `progress` cancelled it.
    #[error("training was stopped")]
    Cancelled,
    /// There are no samples.
    #[error(
        "no features to learn from in {}; label frames that show the stadium",
        pluralise(*frames, "reference")
    )]
    NoSamples {
        /// Number of frames given.
        frames: usize,
    },
    /// There are more samples than a tree can index.
    #[error("{samples} samples are more than a forest can hold; use fewer references or features")]
    TooMany {
        /// Number of samples.
        samples: usize,
    },
}

/// Nodes with fewer samples do not spawn a task.
const PARALLEL_SAMPLES: usize = 512;

/// Trains a forest.
///
/// # Errors
/// No samples, too many, or `progress` cancelled it.
pub fn train(
    samples: &Samples,
    options: &TrainOptions,
    progress: &Progress<'_, TrainProgress>,
) -> Result<Forest, Stopped> {
    train_without(samples, &BTreeSet::new(), options, progress)
}

/// Trains on all samples but those of some frames, given by index. The result is the same as if
/// those samples had never been added, without copying the others.
///
/// # Errors
/// No samples, too many (those left out included), or `progress` cancelled it.
pub fn train_without(
    samples: &Samples,
    left_out: &BTreeSet<usize>,
    options: &TrainOptions,
    progress: &Progress<'_, TrainProgress>,
) -> Result<Forest, Stopped> {
    if samples.len() >= MAX_ITEMS {
        return Err(Stopped::TooMany {
            samples: samples.len(),
        });
    }
    let used: Vec<usize> = (0..samples.frames())
        .filter(|frame| !left_out.contains(frame) && !samples.frame_range(*frame).is_empty())
        .collect();
    if used.is_empty() {
        return Err(Stopped::NoSamples {
            frames: samples.frames(),
        });
    }
    // Each tree draws its own frames; all trees grow in parallel. They are drawn first, because the
    // progress states the number of samples in total.
    let drawn: Vec<Vec<u32>> = (0..options.trees.max(1))
        .map(|tree| draw(samples, used.clone(), options, tree))
        .collect();
    let total = drawn.iter().map(Vec::len).sum();
    let watch = TrainWatch {
        placed: AtomicUsize::new(0),
        total,
        progress,
    };
    let trees: Option<Vec<Tree>> = drawn
        .into_par_iter()
        .enumerate()
        .map(|(tree, mut at)| {
            let grower = Grower {
                samples,
                options,
                watch: &watch,
            };
            let grown = grower.grow(&mut at, 0, derive_seed(options.seed, tree as u64))?;
            Some(flatten(&grown))
        })
        .collect();
    trees
        .map(|trees| Forest { trees })
        .ok_or(Stopped::Cancelled)
}

/// The samples of the `frames` drawn for a tree.
fn draw(samples: &Samples, mut frames: Vec<usize>, options: &TrainOptions, tree: u32) -> Vec<u32> {
    if let Some(count) = options.frames_per_tree
        && (count as usize) < frames.len()
    {
        // The seed is complemented, so that this draw is independent of the splits of the same
        // tree.
        let mut rng = Pcg64Mcg::seed_from_u64(derive_seed(!options.seed, u64::from(tree)));
        frames.shuffle(&mut rng);
        frames.truncate(count.max(1) as usize);
        frames.sort_unstable();
    }
    frames
        .into_iter()
        .flat_map(|frame| samples.frame_range(frame))
        .collect()
}

/// Derives a seed from a seed and a number (the finaliser of `SplitMix64`).
fn derive_seed(seed: u64, number: u64) -> u64 {
    let mut z = seed.wrapping_add(number.wrapping_add(1).wrapping_mul(0x9e37_79b9_7f4a_7c15));
    z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
    z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
    z ^ (z >> 31)
}

struct TrainWatch<'a> {
    placed: AtomicUsize,
    total: usize,
    progress: &'a Progress<'a, TrainProgress>,
}

impl TrainWatch<'_> {
    /// Counts samples that have reached a leaf, and reports every thousand.
    fn add_placed(&self, count: usize) {
        // The count alone is shared, so that no other memory has to be ordered with it.
        let before = self.placed.fetch_add(count, Ordering::Relaxed);
        let placed = before + count;
        if before / 1000 != placed / 1000 || placed == self.total {
            // Cancellation is checked at every node.
            let _ = self.progress.report(TrainProgress {
                placed,
                total: self.total,
            });
        }
    }
}

/// A tree as it grows.
enum Grown {
    Leaf(Vec<(Descriptor, MeanRay)>),
    Node(Split, Box<[Grown; 2]>),
}

struct Grower<'a> {
    samples: &'a Samples,
    options: &'a TrainOptions,
    watch: &'a TrainWatch<'a>,
}

impl Grower<'_> {
    /// Grows the subtree of the samples `at`, which are reordered; `None` if cancelled.
    fn grow(&self, at: &mut [u32], depth: u32, seed: u64) -> Option<Grown> {
        if self.watch.progress.is_cancelled() {
            return None;
        }
        // A node becomes a leaf if it is small enough, if a split could not leave both sides
        // `min_leaf`, or at the maximum depth.
        let unsplit =
            (self.options.leaf_samples as usize).max(2 * self.options.min_leaf.max(1) as usize - 1);
        let splits = depth < self.options.max_depth && at.len() > unsplit;
        let mut rng = Pcg64Mcg::seed_from_u64(seed);
        let split = if splits {
            choose_split(self.samples, at, self.options, &mut rng)
        } else {
            None
        };
        let Some(split) = split else {
            self.watch.add_placed(at.len());
            return Some(Grown::Leaf(means(
                self.samples,
                at,
                self.options.merge_within,
            )));
        };
        // In place: all nodes of a tree work on disjoint parts of one list of indices.
        let middle = partition(at, |sample| {
            self.samples.byte(sample, split.dimension) <= split.threshold
        });
        // Each child has a seed of its own, drawn before the tasks fork: the tree does not depend
        // on scheduling.
        let seeds: [u64; 2] = rng.random();
        let (below, above) = at.split_at_mut(middle);
        let (below, above) = if below.len().min(above.len()) >= PARALLEL_SAMPLES {
            rayon::join(
                || self.grow(below, depth + 1, seeds[0]),
                || self.grow(above, depth + 1, seeds[1]),
            )
        } else {
            (
                self.grow(below, depth + 1, seeds[0]),
                self.grow(above, depth + 1, seeds[1]),
            )
        };
        Some(Grown::Node(split, Box::new([below?, above?])))
    }
}

/// Partitions in place and returns the start of the second part. The order of the second part
/// changes, deterministically.
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

/// Flattens a tree: nodes in depth-first order, so that a descent mostly moves forward in memory.
fn flatten(grown: &Grown) -> Tree {
    let mut tree = Tree {
        root: Branch::leaf(0),
        nodes: Vec::new(),
        leaf_ends: Vec::new(),
        descriptors: Vec::new(),
        sketches: Vec::new(),
        rays: Vec::new(),
    };
    tree.root = add(grown, &mut tree);
    tree
}

fn add(grown: &Grown, tree: &mut Tree) -> Branch {
    match grown {
        Grown::Leaf(means) => {
            tree.descriptors.extend(means.iter().map(|mean| mean.0));
            tree.sketches
                .extend(means.iter().map(|mean| Sketch::from_descriptor(&mean.0)));
            tree.rays.extend(means.iter().map(|mean| mean.1));
            tree.leaf_ends.push(tree.rays.len() as u32);
            Branch::leaf(tree.leaf_ends.len() - 1)
        }
        Grown::Node(split, children) => {
            let index = tree.nodes.len();
            let (dimension, threshold) = (split.dimension, split.threshold);
            // Reserve the node's place before its children, then fill in where they went.
            tree.nodes.push(Node {
                dimension,
                threshold,
                branches: [Branch::node(0); 2],
            });
            let branches = [add(&children[0], tree), add(&children[1], tree)];
            tree.nodes[index].branches = branches;
            Branch::node(index)
        }
    }
}
