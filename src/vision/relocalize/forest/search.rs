//! The known descriptors nearest to some that are asked for.
//!
//! What the leaves hold lies scattered over tens of megabytes, and waiting for it is most of the
//! work. So descriptors are looked up in groups, stage by stage: the ways down of a group side by
//! side, then what its leaves hold, then what of that is likely. Before a stage compares, it
//! touches all the memory that it will need, so that the waits overlap.

use super::PredictOptions;
use super::tree::{Branch, Child, Forest, Tree};
use crate::features::{DESCRIPTOR_NORM, Descriptor, Sketch};
use std::cmp::Reverse;
use std::collections::BinaryHeap;

/// Descriptors looked up together: what their leaves hold fits the fast memories of a processor.
const GROUP: usize = 32;

/// Ways down that are walked side by side.
const WAYS: usize = 8;

/// Nearest descriptors kept while leaves are examined; several may show one place.
const NEAREST: usize = 12;

/// A descriptor is compared if its sketch has no more than the gate's squared distance divided by
/// this. Of SIFT descriptors that pass the gate, one in a hundred has more than half its squared
/// distance in its sketch, and that one passes narrowly; of outliers in the same leaf, one in
/// thirty has less.
const SKETCH_SHARE: u32 = 2;

/// A branch missed by more than this share of the best squared distance is not followed: a miss in
/// a few bytes grows with the bytes that the way has not looked at. Twice as much costs time, and
/// finds hardly anything.
const MISSED_SHARE: f32 = 0.25;

/// A branch that a way down passed by: by how much its side was missed (sum of squared byte
/// differences on the way to it), then its tree and number so that equals have one order.
type Missed = Reverse<(u32, u32, u32)>;

/// A known descriptor.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub(super) struct Near {
    /// From the one that is asked for, in bytes.
    pub squared_distance: u32,
    pub tree: u32,
    /// Its number in the tree.
    pub number: u32,
}

/// A known descriptor that its sketch does not rule out.
#[derive(Clone, Copy, Debug)]
struct Likely {
    /// Whose neighbour it may be: a number in the group.
    whose: u32,
    tree: u32,
    number: u32,
}

/// Memory that lookups use again and again; one for each thread.
#[derive(Debug, Default)]
pub struct Search {
    sketches: Vec<Sketch>,
    /// The leaves that the first ways down reach: tree after tree, for each descriptor of the
    /// group.
    leaves: Vec<u32>,
    likely: Vec<Likely>,
    /// For each descriptor of the group the branches that its ways passed by.
    missed: [BinaryHeap<Missed>; GROUP],
    /// For each descriptor of the group, nearest first.
    nearest: [Vec<Near>; GROUP],
}

impl Search {
    /// Finds the nearest of each descriptor in the leaves examined and hands them on, the nearest
    /// first, with the descriptor's number.
    pub(super) fn for_each(
        &mut self,
        forest: &Forest,
        descriptors: &[Descriptor],
        options: &PredictOptions,
        mut found: impl FnMut(usize, &[Near]),
    ) {
        let gate = (options.max_squared_distance * DESCRIPTOR_NORM * DESCRIPTOR_NORM) as u32;
        let more = forest.trees.len() * options.leaves_per_tree.saturating_sub(1) as usize;
        for (number, group) in descriptors.chunks(GROUP).enumerate() {
            // The same code for every kind of processor, compiled for the instructions that this
            // one has.
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

/// The examination of a group: no closure, as only what is inlined is compiled for the processor at
/// hand.
struct Examination<'a> {
    trees: &'a [Tree],
    group: &'a [Descriptor],
    /// The greatest squared distance of a neighbour, in bytes.
    gate: u32,
    /// Leaves examined beyond the first of each tree.
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
        for (number, tree) in self.trees.iter().enumerate() {
            if self.more == 0 {
                self.walk(tree)
            } else {
                self.walk_and_note(number as u32, tree)
            }
        }
        self.scan();
        self.compare();
        for whose in 0..self.group.len() {
            self.follow_missed(whose);
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
        sketches.extend(self.group.iter().map(Sketch::of));
        leaves.clear();
        likely.clear();
        missed.iter_mut().for_each(BinaryHeap::clear);
        nearest.iter_mut().for_each(Vec::clear);
    }

    /// The leaves of a group, some ways at a time step by step, so that they do not wait for each
    /// other's nodes.
    #[inline(always)]
    fn walk(&mut self, tree: &Tree) {
        for together in self.group.chunks(WAYS) {
            let mut ways = [tree.root; WAYS];
            let mut leaves = [0; WAYS];
            let mut under_way = true;
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

    /// The same way by way, with the branches passed by.
    #[inline(always)]
    fn walk_and_note(&mut self, number: u32, tree: &Tree) {
        let follow = most_missed(self.gate);
        for (descriptor, missed) in self.group.iter().zip(&mut self.search.missed) {
            let leaf = descend(descriptor, tree, (0, number, tree.root), follow, missed);
            self.search.leaves.push(leaf as u32);
        }
    }

    /// Which descriptors of the leaves reached are likely by their sketches.
    #[inline(always)]
    fn scan(&mut self) {
        let Search {
            sketches,
            leaves,
            likely,
            ..
        } = &mut *self.search;
        let mut touched = 0u32;
        for (tree, leaves) in self.trees.iter().zip(leaves.chunks(self.group.len())) {
            for &leaf in leaves {
                let known = &tree.sketches[tree.held(leaf as usize)];
                // Two lie in a line of the processor's memory.
                touched += known
                    .iter()
                    .step_by(2)
                    .map(|sketch| u32::from(sketch.first()))
                    .sum::<u32>();
            }
        }
        std::hint::black_box(touched);
        for ((number, tree), leaves) in self
            .trees
            .iter()
            .enumerate()
            .zip(leaves.chunks(self.group.len()))
        {
            for ((whose, sketch), &leaf) in sketches.iter().enumerate().zip(leaves) {
                list_likely(
                    tree,
                    (whose as u32, number as u32, leaf as usize),
                    sketch,
                    self.gate,
                    likely,
                );
            }
        }
    }

    /// Compares what is likely and keeps what is nearest.
    #[inline(always)]
    fn compare(&mut self) {
        let Search {
            likely, nearest, ..
        } = &mut *self.search;
        let mut touched = 0u32;
        for at in &*likely {
            let (tree, number) = (&self.trees[at.tree as usize], at.number as usize);
            let [first, .., last] = tree.descriptors[number].0;
            touched += u32::from(first) + u32::from(last) + tree.rays[number].samples;
        }
        std::hint::black_box(touched);
        for &Likely {
            whose,
            tree,
            number,
        } in &*likely
        {
            let nearest = &mut nearest[whose as usize];
            let limit = if nearest.len() < NEAREST {
                self.gate
            } else {
                nearest[NEAREST - 1].squared_distance
            };
            let known = &self.trees[tree as usize].descriptors[number as usize];
            let squared_distance = self.group[whose as usize].squared_byte_distance(known);
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

    /// The branches of a descriptor missed by least, whichever tree they stand in.
    #[inline(always)]
    fn follow_missed(&mut self, whose: usize) {
        for _ in 0..self.more {
            let Some(Reverse((margin, number, branch))) = self.search.missed[whose].pop() else {
                break;
            };
            let best = self.search.nearest[whose]
                .first()
                .map_or(self.gate, |near| near.squared_distance);
            let follow = most_missed(best);
            if margin > follow {
                break;
            }
            let (descriptor, tree) = (&self.group[whose], &self.trees[number as usize]);
            let Search {
                sketches,
                likely,
                missed,
                ..
            } = &mut *self.search;
            let leaf = descend(
                descriptor,
                tree,
                (margin, number, Branch(branch)),
                follow,
                &mut missed[whose],
            );
            likely.clear();
            list_likely(
                tree,
                (whose as u32, number, leaf),
                &sketches[whose],
                self.gate,
                likely,
            );
            self.compare();
        }
    }
}

/// By how much a branch may be missed that is followed, where the nearest descriptor so far is as
/// far off.
fn most_missed(best: u32) -> u32 {
    (MISSED_SHARE * best as f32) as u32
}

/// Lists the descriptors of one leaf that are likely: whose neighbours they may be, the tree's
/// number, the leaf.
#[inline(always)]
#[allow(clippy::inline_always, reason = "a part of the dispatched search")]
fn list_likely(
    tree: &Tree,
    (whose, number, leaf): (u32, u32, usize),
    sketch: &Sketch,
    gate: u32,
    likely: &mut Vec<Likely>,
) {
    let held = tree.held(leaf);
    for (place, known) in held.clone().zip(&tree.sketches[held]) {
        if SKETCH_SHARE * sketch.squared_byte_distance(known) <= gate {
            likely.push(Likely {
                whose,
                tree: number,
                number: place as u32,
            });
        }
    }
}

/// Walks down to a leaf, and notes the branches passed by that were missed by no more than
/// `follow`.
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

/// Puts a descriptor where it belongs among the nearest, which stay at most [`NEAREST`].
fn insert(nearest: &mut Vec<Near>, near: Near) {
    let at = nearest.partition_point(|other| *other < near);
    nearest.truncate(NEAREST - 1);
    if at <= nearest.len() {
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
    }
}
