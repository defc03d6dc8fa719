//! Approximate nearest neighbours of descriptors in the leaves of a forest.
//!
//! The contents of the leaves are scattered over tens of megabytes, and memory latency dominates.
//! So descriptors are processed in groups, stage by stage: the descents of a group side by side,
//! then the sketches in its leaves, then the descriptors that these do not rule out. Each stage
//! first touches all memory that it will need, so that cache misses overlap.

use super::PredictOptions;
use super::tree::{Branch, Child, Forest, Tree};
use crate::features::{DESCRIPTOR_NORM, Descriptor, Sketch};
use std::cmp::Reverse;
use std::collections::BinaryHeap;

/// Number of descriptors per group: the contents of their leaves fit into the processor's caches.
const GROUP: usize = 32;

/// Number of descents that are interleaved.
const WAYS: usize = 8;

/// Number of nearest descriptors kept per query; several may show the same place of the stadium.
const NEAREST: usize = 12;

/// A descriptor is compared if the squared distance of its sketch, times this, is within the gate.
/// Of SIFT descriptors that pass the gate, one in a hundred has more than half of its squared
/// distance in its sketch, and such a one passes narrowly; of outliers in the same leaf, one in
/// thirty has less.
const SKETCH_SHARE: u32 = 2;

/// A branch is not followed if its margin exceeds this share of the best squared distance. The
/// margin comes from the few bytes tested on the way; the bytes not tested only add to the
/// distance. A share of 0.5 costs time and finds hardly anything.
const MISSED_SHARE: f32 = 0.25;

/// A branch not taken in a descent: its margin (sum of squared byte differences to the thresholds
/// on the way to it), then tree and branch, so that equal margins have one order. Reversed, so that
/// the heap pops the smallest margin.
type Missed = Reverse<(u32, u32, u32)>;

/// A known descriptor.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub(super) struct Near {
    /// Squared distance from the query, in bytes².
    pub squared_distance: u32,
    pub tree: u32,
    /// Its index in the tree.
    pub number: u32,
}

/// A known descriptor that its sketch does not rule out.
#[derive(Clone, Copy, Debug)]
struct Likely {
    /// The query, as an index into the group.
    query: u32,
    tree: u32,
    number: u32,
}

/// Buffers reused between lookups; one instance per thread.
#[derive(Debug, Default)]
pub struct Search {
    sketches: Vec<Sketch>,
    /// The leaves of the first descents: tree by tree, and within a tree for each query of the
    /// group.
    leaves: Vec<u32>,
    likely: Vec<Likely>,
    /// For each query of the group, the branches not taken.
    missed: [BinaryHeap<Missed>; GROUP],
    /// For each query of the group, its neighbours, the nearest first.
    nearest: [Vec<Near>; GROUP],
}

impl Search {
    /// Finds the nearest neighbours of each descriptor in the leaves examined and passes them to
    /// `found`, the nearest first, with the descriptor's index.
    pub(super) fn for_each(
        &mut self,
        forest: &Forest,
        descriptors: &[Descriptor],
        options: &PredictOptions,
        mut found: impl FnMut(usize, &[Near]),
    ) {
        // The gate of unit descriptors, in bytes².
        let gate = (options.max_squared_distance * DESCRIPTOR_NORM * DESCRIPTOR_NORM) as u32;
        let more = forest.trees.len() * options.leaves_per_tree.saturating_sub(1) as usize;
        for (number, group) in descriptors.chunks(GROUP).enumerate() {
            // Dispatch compiles the same code for several instruction sets and runs the best one.
            pulp::Arch::new().dispatch(Examination {
                trees: &forest.trees,
                group,
                gate,
                more,
                search: self,
            });
            for (place, nearest) in self.nearest[..group.len()].iter().enumerate() {
                found(number * GROUP + place, nearest);
            }
        }
    }
}

/// The lookup of one group. Not a closure, because only inlined code is compiled for the processor
/// at hand.
struct Examination<'a> {
    trees: &'a [Tree],
    group: &'a [Descriptor],
    /// Maximum squared distance of a neighbour, in bytes².
    gate: u32,
    /// Number of leaves examined beyond the first of each tree.
    more: usize,
    search: &'a mut Search,
}

impl pulp::WithSimd for Examination<'_> {
    type Output = ();

    #[inline(always)]
    #[allow(
        clippy::inline_always,
        reason = "only what is inlined into the dispatch is compiled for this processor"
    )]
    fn with_simd<S: pulp::Simd>(mut self, _: S) {
        self.begin();
        // With a budget beyond the first leaves, branches not taken are recorded for later.
        for (number, tree) in self.trees.iter().enumerate() {
            if self.more == 0 {
                self.walk(tree);
            } else {
                self.walk_and_note(number as u32, tree);
            }
        }
        // First leaves of all trees, then the extra leaves query by query.
        self.scan();
        self.compare();
        for query in 0..self.group.len() {
            self.follow_missed(query);
        }
    }
}

#[allow(
    clippy::inline_always,
    reason = "only what is inlined into the dispatch is compiled for this processor"
)]
impl Examination<'_> {
    #[inline(always)]
    fn begin(&mut self) {
        let Search {
            sketches,
            leaves,
            likely,
            missed,
            nearest,
        } = &mut *self.search;
        sketches.clear();
        sketches.extend(self.group.iter().map(Sketch::from_descriptor));
        leaves.clear();
        likely.clear();
        missed.iter_mut().for_each(BinaryHeap::clear);
        nearest.iter_mut().for_each(Vec::clear);
    }

    /// The leaves of a group. Some descents are interleaved step by step, so that they do not wait
    /// for each other's nodes.
    #[inline(always)]
    fn walk(&mut self, tree: &Tree) {
        for together in self.group.chunks(WAYS) {
            let mut ways = [tree.root; WAYS];
            let mut leaves = [0; WAYS];
            let mut under_way = true;
            // One step of each descent in turn: while one waits for its node, the others proceed.
            while under_way {
                under_way = false;
                for ((way, leaf), descriptor) in ways.iter_mut().zip(&mut leaves).zip(together) {
                    match way.child() {
                        Child::Node(index) => {
                            let node = &tree.nodes[index];
                            let above = descriptor.0[usize::from(node.dimension)] > node.threshold;
                            *way = node.branches[usize::from(above)];
                            under_way = true;
                        }
                        Child::Leaf(index) => *leaf = index as u32,
                    }
                }
            }
            self.search.leaves.extend(&leaves[..together.len()]);
        }
    }

    /// The same, one descent after the other, recording the branches not taken.
    #[inline(always)]
    fn walk_and_note(&mut self, number: u32, tree: &Tree) {
        let follow = most_missed(self.gate);
        for (descriptor, missed) in self.group.iter().zip(&mut self.search.missed) {
            let leaf = descend(descriptor, tree, (0, number, tree.root), follow, missed);
            self.search.leaves.push(leaf as u32);
        }
    }

    /// Lists the descriptors of the leaves reached that their sketches do not rule out.
    #[inline(always)]
    fn scan(&mut self) {
        let Search {
            sketches,
            leaves,
            likely,
            ..
        } = &mut *self.search;
        // Touch the sketches of all leaves before comparing any; `black_box` keeps the compiler
        // from removing the loop.
        let mut touched = 0u32;
        for (tree, leaves) in self.trees.iter().zip(leaves.chunks(self.group.len())) {
            for &leaf in leaves {
                let known = &tree.sketches[tree.leaf_range(leaf as usize)];
                // Two sketches share a cache line.
                touched += known
                    .iter()
                    .step_by(2)
                    .map(|sketch| u32::from(sketch.first()))
                    .sum::<u32>();
            }
        }
        std::hint::black_box(touched);
        // The sketches are in the caches: compare them with their queries.
        for ((number, tree), leaves) in self
            .trees
            .iter()
            .enumerate()
            .zip(leaves.chunks(self.group.len()))
        {
            for ((query, sketch), &leaf) in sketches.iter().enumerate().zip(leaves) {
                list_likely(
                    tree,
                    (query as u32, number as u32, leaf as usize),
                    sketch,
                    self.gate,
                    likely,
                );
            }
        }
    }

    /// Compares the listed descriptors with their queries and keeps the nearest.
    #[inline(always)]
    fn compare(&mut self) {
        let Search {
            likely, nearest, ..
        } = &mut *self.search;
        // Touch first and last byte of each descriptor, which spans two cache lines, and its ray,
        // before comparing any. The sum has no meaning and wraps: a file may state any number of
        // samples.
        let mut touched = 0u32;
        for at in &*likely {
            let (tree, number) = (&self.trees[at.tree as usize], at.number as usize);
            let [first, .., last] = tree.descriptors[number].0;
            touched = touched
                .wrapping_add(u32::from(first) + u32::from(last))
                .wrapping_add(tree.rays[number].samples);
        }
        std::hint::black_box(touched);
        for &Likely {
            query,
            tree,
            number,
        } in &*likely
        {
            // A full list only accepts what is nearer than its last entry, or as near: `insert`
            // decides by tree and number then.
            let nearest = &mut nearest[query as usize];
            let limit = if nearest.len() < NEAREST {
                self.gate
            } else {
                nearest[NEAREST - 1].squared_distance
            };
            let known = &self.trees[tree as usize].descriptors[number as usize];
            let squared_distance = self.group[query as usize].squared_byte_distance(known);
            if squared_distance <= limit {
                insert(
                    nearest,
                    Near {
                        squared_distance,
                        tree,
                        number,
                    },
                );
            }
        }
    }

    /// Best-bin-first: follows the branches of smallest margin, over all trees, until the budget is
    /// spent or no margin is small enough (Beis and Lowe: "Shape indexing using approximate
    /// nearest-neighbour search in high-dimensional spaces", CVPR 1997).
    #[inline(always)]
    fn follow_missed(&mut self, query: usize) {
        for _ in 0..self.more {
            let Some(Reverse((margin, number, branch))) = self.search.missed[query].pop() else {
                break;
            };
            // The limit shrinks as better neighbours are found. The heap pops ascending margins, so
            // that the first one beyond the limit ends the search.
            let best = self.search.nearest[query]
                .first()
                .map_or(self.gate, |near| near.squared_distance);
            let follow = most_missed(best);
            if margin > follow {
                break;
            }
            let (descriptor, tree) = (&self.group[query], &self.trees[number as usize]);
            let Search {
                sketches,
                likely,
                missed,
                ..
            } = &mut *self.search;
            // Go on from this branch with its margin; branches not taken on the way are recorded
            // as well.
            let leaf = descend(
                descriptor,
                tree,
                (margin, number, Branch(branch)),
                follow,
                &mut missed[query],
            );
            likely.clear();
            list_likely(
                tree,
                (query as u32, number, leaf),
                &sketches[query],
                self.gate,
                likely,
            );
            self.compare();
        }
    }
}

/// The largest margin of a branch that is followed, given the best squared distance so far.
fn most_missed(best: u32) -> u32 {
    (MISSED_SHARE * best as f32) as u32
}

/// Lists the descriptors of one leaf that their sketches do not rule out, for a query, given as
/// (query, tree, leaf).
#[inline(always)]
#[allow(clippy::inline_always, reason = "a part of the dispatched search")]
fn list_likely(
    tree: &Tree,
    (query, number, leaf): (u32, u32, usize),
    sketch: &Sketch,
    gate: u32,
    likely: &mut Vec<Likely>,
) {
    let in_leaf = tree.leaf_range(leaf);
    for (place, known) in in_leaf.clone().zip(&tree.sketches[in_leaf]) {
        if SKETCH_SHARE * sketch.squared_byte_distance(known) <= gate {
            likely.push(Likely {
                query,
                tree: number,
                number: place as u32,
            });
        }
    }
}

/// Descends to a leaf, and records the branches not taken whose margin is at most `follow`.
#[inline(always)]
#[allow(clippy::inline_always, reason = "a part of the dispatched search")]
fn descend(
    descriptor: &Descriptor,
    tree: &Tree,
    (margin, number, mut branch): (u32, u32, Branch),
    follow: u32,
    missed: &mut BinaryHeap<Missed>,
) -> usize {
    loop {
        match branch.child() {
            Child::Node(index) => {
                let node = &tree.nodes[index];
                let value = descriptor.0[usize::from(node.dimension)];
                let above = value > node.threshold;
                // The byte distance to the other side of the threshold: values equal to it go to
                // the first branch, so from there the second begins one further. Branches taken add
                // nothing, hence the margin of the start stays that of the whole descent.
                let by = u32::from(value.abs_diff(node.threshold)) + u32::from(!above);
                let margin = margin + by * by;
                if margin <= follow {
                    missed.push(Reverse((
                        margin,
                        number,
                        node.branches[usize::from(!above)].0,
                    )));
                }
                branch = node.branches[usize::from(above)];
            }
            Child::Leaf(leaf) => return leaf,
        }
    }
}

/// Inserts into the sorted list of neighbours, which has at most [`NEAREST`] entries: a full one
/// loses its last, or refuses what comes after that.
fn insert(nearest: &mut Vec<Near>, near: Near) {
    let at = nearest.partition_point(|other| *other < near);
    if at < NEAREST {
        nearest.truncate(NEAREST - 1);
        nearest.insert(at, near);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_nearest_are_kept_in_order() {
        let mut nearest = Vec::new();
        for squared_distance in [5u32, 3, 9, 1, 7, 2, 8, 6, 4, 11, 10, 15, 14, 13, 12, 0] {
            insert(
                &mut nearest,
                Near {
                    squared_distance,
                    tree: 0,
                    number: squared_distance,
                },
            );
        }
        let kept: Vec<u32> = nearest.iter().map(|near| near.squared_distance).collect();
        assert_eq!(kept, (0..12).collect::<Vec<u32>>());
        // As near as the last of a full list, in another tree: it comes after that one.
        let before = nearest.clone();
        insert(
            &mut nearest,
            Near {
                tree: 1,
                ..before[NEAREST - 1]
            },
        );
        assert_eq!(nearest, before, "a full list loses no entry to a later one");
    }
}
