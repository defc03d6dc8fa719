//! Asking the forest: a descriptor to the rays it may show.

use super::PredictOptions;
use super::tree::{Branch, Forest, Target};
use crate::camera::PanTilt;
use crate::features::{DESCRIPTOR_NORM, Descriptor, Sketch};
use crate::geometry::Angle;
use std::cmp::Reverse;
use std::collections::BinaryHeap;

/// Candidates nearer to a better one than this show the same place, rad (0.05°): what leaves hold is merged as widely.
const SAME_RAY_RAD: f64 = 9e-4;

/// Candidates of a feature at most.
const CANDIDATES: usize = 5;

/// Nearest descriptors kept while leaves are examined; several may show one place.
const NEAREST: usize = 12;

/// A branch missed by more than this share of the best squared distance is not followed: a miss in a few bytes grows with
/// the bytes that the way has not looked at. Twice as much costs time, and finds hardly anything.
const MISSED_SHARE: f32 = 0.25;

/// A ray that a descriptor may show.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct RayCandidate {
    /// In `base`.
    pub ray: PanTilt,
    /// From the descriptor to the nearest one known of this ray, squared, both of unit length.
    pub squared_distance: f32,
}

/// A branch that a way down passed by: by how much its side was missed (sum of squared byte differences on the way to
/// it), then its tree and number so that equals have one order.
type Missed = Reverse<(u32, u32, u32)>;

/// A descriptor of a leaf: its squared distance in bytes, its tree and its number there.
type Near = (u32, u32, u32);

/// Memory that lookups use again and again; one for each thread.
#[derive(Debug, Default)]
pub struct Search {
    missed: BinaryHeap<Missed>,
    /// Nearest first.
    nearest: Vec<Near>,
}

impl Forest {
    /// The rays that a descriptor may show, the likeliest first: the nearest descriptors in the leaves examined, if they
    /// pass the gates, each place once. Empties and fills `candidates`.
    pub fn predict(
        &self,
        descriptor: &Descriptor,
        options: &PredictOptions,
        search: &mut Search,
        candidates: &mut Vec<RayCandidate>,
    ) {
        // The same code for every kind of processor, compiled for the instructions that this one has.
        pulp::Arch::new().dispatch(|| self.examine(descriptor, options, search));
        self.collect(options, search, candidates);
    }

    #[inline(always)]
    #[allow(clippy::inline_always, reason = "only what is inlined into the dispatch is compiled for this processor")]
    fn examine(&self, descriptor: &Descriptor, options: &PredictOptions, search: &mut Search) {
        let Search { missed, nearest } = search;
        let sketch = Sketch::of(descriptor);
        missed.clear();
        nearest.clear();
        let gate = (options.max_squared_distance * DESCRIPTOR_NORM * DESCRIPTOR_NORM) as u32;
        let more = self.trees.len() * options.leaves_per_tree.saturating_sub(1) as usize;
        for number in 0..self.trees.len() + more {
            let (margin, tree, branch) = if let Some(grown) = self.trees.get(number) {
                (0, number as u32, grown.root)
            } else {
                let Some(Reverse((margin, tree, branch))) = missed.pop() else { break };
                (margin, tree, Branch(branch))
            };
            let best = nearest.first().map_or(gate, |near| near.0);
            let follow = if more > 0 { (MISSED_SHARE * best as f32) as u32 } else { 0 };
            if margin > follow {
                break;
            }
            let leaf = self.descend(descriptor, (margin, tree, branch), follow, missed);
            let grown = &self.trees[tree as usize];
            let held = grown.held(leaf);
            for (number, known) in held.clone().zip(&grown.sketches[held]) {
                let limit = if nearest.len() < NEAREST { gate } else { nearest[NEAREST - 1].0.min(gate) };
                if sketch.least_squared_byte_distance(known) > limit {
                    continue;
                }
                let distance = descriptor.squared_byte_distance(&grown.descriptors[number]);
                if distance <= limit {
                    insert(nearest, (distance, tree, number as u32));
                }
            }
        }
    }

    /// Walks down to a leaf, and notes the branches passed by that were missed by no more than `follow`.
    #[inline(always)]
    #[allow(clippy::inline_always, reason = "a part of the dispatched search")]
    fn descend(
        &self,
        descriptor: &Descriptor,
        (margin, tree, mut branch): (u32, u32, Branch),
        follow: u32,
        missed: &mut BinaryHeap<Missed>,
    ) -> usize {
        let nodes = &self.trees[tree as usize].nodes;
        loop {
            match branch.target() {
                Target::Node(index) => {
                    let node = &nodes[index];
                    let value = descriptor.0[usize::from(node.dimension)];
                    let above = value > node.threshold;
                    let by = u32::from(value.abs_diff(node.threshold)) + u32::from(!above);
                    let margin = margin + by * by;
                    if margin <= follow {
                        missed.push(Reverse((margin, tree, node.branches[usize::from(!above)].0)));
                    }
                    branch = node.branches[usize::from(above)];
                }
                Target::Leaf(leaf) => return leaf,
            }
        }
    }

    /// The nearest descriptors' rays, each place once, those that mix places left out.
    fn collect(&self, options: &PredictOptions, search: &Search, candidates: &mut Vec<RayCandidate>) {
        candidates.clear();
        for &(distance, tree, number) in &search.nearest {
            let mean = &self.trees[tree as usize].rays[number as usize];
            if f64::from(mean.spread) > options.max_spread.radians() {
                continue;
            }
            let [pan, tilt] = mean.pan_tilt.map(|angle| Angle::from_radians(f64::from(angle)));
            let known = candidates.iter().any(|other| {
                let (pan, tilt) = ((pan - other.ray.pan).abs().radians(), (tilt - other.ray.tilt).abs().radians());
                pan.max(tilt) < SAME_RAY_RAD
            });
            if !known {
                let squared_distance = distance as f32 / (DESCRIPTOR_NORM * DESCRIPTOR_NORM);
                candidates.push(RayCandidate { ray: PanTilt { pan, tilt }, squared_distance });
                if candidates.len() == CANDIDATES {
                    break;
                }
            }
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
        for distance in [5u32, 3, 9, 1, 7, 2, 8, 6, 4, 11, 10, 15, 14, 13, 12, 0] {
            insert(&mut nearest, (distance, 0, distance));
        }
        assert_eq!(nearest.iter().map(|near| near.0).collect::<Vec<_>>(), (0..12).collect::<Vec<u32>>());
    }
}
