//! Asking the forest: a descriptor to the rays it may show.

use super::PredictOptions;
use super::tree::{Forest, Target};
use crate::camera::PanTilt;
use crate::features::Descriptor;
use crate::geometry::Angle;
use std::cmp::Reverse;
use std::collections::BinaryHeap;

/// Candidates nearer to a better one than this are the same, rad: about the noise of a label.
const SAME_RAY_RAD: f32 = 2e-5;

/// A ray that a descriptor may show.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct RayCandidate {
    /// In `base`.
    pub ray: PanTilt,
    /// From the descriptor to that of the leaf, squared, both of unit length.
    pub squared_distance: f32,
}

/// A branch that a way down passed by: by how much its side was missed (sum of squared byte differences on the way to
/// it), then its tree and number so that equals have one order.
type Missed = Reverse<(u32, u32, u32)>;

/// Memory that lookups use again and again; one for each thread.
#[derive(Debug, Default)]
pub struct Search {
    missed: BinaryHeap<Missed>,
    best: Vec<Option<(f32, u32)>>,
}

impl Forest {
    /// The rays that a descriptor may show, the likeliest first: of each tree the best of the leaves examined, if it
    /// passes the gates. Empties and fills `candidates`.
    pub fn predict(
        &self,
        descriptor: &Descriptor,
        options: &PredictOptions,
        search: &mut Search,
        candidates: &mut Vec<RayCandidate>,
    ) {
        let Search { missed, best } = search;
        missed.clear();
        best.clear();
        best.resize(self.trees.len(), None);
        for (tree, grown) in self.trees.iter().enumerate() {
            self.descend(descriptor, (0, tree as u32, grown.root.0), options, missed, best);
        }
        let budget = self.trees.len() * options.leaves_per_tree.saturating_sub(1) as usize;
        for _ in 0..budget {
            let Some(Reverse(branch)) = missed.pop() else { break };
            self.descend(descriptor, branch, options, missed, best);
        }
        self.collect(best, candidates);
    }

    /// Walks down to a leaf, notes the branches passed by, and keeps the leaf if it is its tree's best.
    fn descend(
        &self,
        descriptor: &Descriptor,
        (margin, tree, branch): (u32, u32, u32),
        options: &PredictOptions,
        missed: &mut BinaryHeap<Missed>,
        best: &mut [Option<(f32, u32)>],
    ) {
        let grown = &self.trees[tree as usize];
        let mut branch = super::tree::Branch(branch);
        loop {
            match branch.target() {
                Target::Node(index) => {
                    let node = &grown.nodes[index];
                    let value = descriptor.0[usize::from(node.dimension)];
                    let above = value > node.threshold;
                    let by = u32::from(value.abs_diff(node.threshold)) + u32::from(!above);
                    missed.push(Reverse((margin + by * by, tree, node.branches[usize::from(!above)].0)));
                    branch = node.branches[usize::from(above)];
                }
                Target::Leaf(index) => {
                    let distance = descriptor.squared_distance(&grown.descriptors[index]);
                    let passes = distance <= options.max_squared_distance
                        && f64::from(grown.rays[index].spread) <= options.max_spread.radians();
                    let best = &mut best[tree as usize];
                    if passes && best.is_none_or(|(least, at)| (distance, index as u32) < (least, at)) {
                        *best = Some((distance, index as u32));
                    }
                    return;
                }
            }
        }
    }

    /// Every tree's best, ordered by distance, without those that say the same.
    fn collect(&self, best: &[Option<(f32, u32)>], candidates: &mut Vec<RayCandidate>) {
        candidates.clear();
        let found = best.iter().zip(&self.trees).filter_map(|(best, tree)| {
            let (squared_distance, leaf) = (*best)?;
            let [pan, tilt] = tree.rays[leaf as usize].pan_tilt.map(|angle| Angle::from_radians(f64::from(angle)));
            Some(RayCandidate { ray: PanTilt { pan, tilt }, squared_distance })
        });
        candidates.extend(found);
        candidates.sort_by(|a, b| a.squared_distance.total_cmp(&b.squared_distance));
        let mut kept = 0;
        for i in 0..candidates.len() {
            let candidate = candidates[i];
            let known = candidates[..kept].iter().any(|other| {
                let pan = (candidate.ray.pan - other.ray.pan).abs().radians();
                let tilt = (candidate.ray.tilt - other.ray.tilt).abs().radians();
                pan.max(tilt) < f64::from(SAME_RAY_RAD)
            });
            if !known {
                candidates[kept] = candidate;
                kept += 1;
            }
        }
        candidates.truncate(kept);
    }
}
