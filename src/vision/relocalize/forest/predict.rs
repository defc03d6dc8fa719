//! Prediction: from descriptors to candidate rays.

use super::search::{Near, Search};
use super::{Forest, PredictOptions};
use crate::features::{DESCRIPTOR_NORM, Descriptor};
use touchline_core::camera::PanTilt;

/// Candidates closer than this to a better one are the same place, rad (0.05°): leaves are merged
/// with the same radius.
const SAME_RAY_RAD: f64 = 9e-4;

/// Maximum number of candidates of a feature.
const CANDIDATES: usize = 5;

/// A candidate ray of a descriptor.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct RayCandidate {
    /// The ray in `base`.
    pub ray: PanTilt,
    /// Squared distance between the descriptor and the nearest known one of this ray, both of unit
    /// length.
    pub squared_distance: f32,
}

impl Forest {
    /// The candidate rays of a descriptor, the most likely first: the nearest descriptors in the
    /// leaves examined that pass the gates, each place once. Replaces the content of `candidates`.
    pub fn predict(
        &self,
        descriptor: &Descriptor,
        options: &PredictOptions,
        search: &mut Search,
        candidates: &mut Vec<RayCandidate>,
    ) {
        search.for_each(
            self,
            std::slice::from_ref(descriptor),
            options,
            |_, nearest| {
                self.collect(options, nearest, candidates);
            },
        );
    }

    /// [`Self::predict`] for many descriptors, several times as fast. Passes the index of each to
    /// `found` with its candidates.
    pub fn predict_all(
        &self,
        descriptors: &[Descriptor],
        options: &PredictOptions,
        mut found: impl FnMut(usize, &[RayCandidate]),
    ) {
        let mut candidates = Vec::with_capacity(CANDIDATES);
        Search::default().for_each(self, descriptors, options, |number, nearest| {
            self.collect(options, nearest, &mut candidates);
            found(number, &candidates);
        });
    }

    /// The rays of the nearest descriptors, each place once, without means that mix places.
    fn collect(
        &self,
        options: &PredictOptions,
        nearest: &[Near],
        candidates: &mut Vec<RayCandidate>,
    ) {
        candidates.clear();
        for near in nearest {
            // A mean over different places, as repeated boards are, has a ray between them that
            // shows none of them.
            let mean = &self.trees[near.tree as usize].rays[near.number as usize];
            if f64::from(mean.spread) > options.max_spread.radians() {
                continue;
            }
            // The nearest come first, so that each place has the smallest of its distances. Several
            // trees usually name the same place. Pan is compared without the cosine of tilt: at the
            // tilts of a camera on a stand the two differ by a few per cent.
            let (pan, tilt) = (mean.pan(), mean.tilt());
            let known = candidates.iter().any(|other| {
                let (by_pan, by_tilt) = (
                    pan.turn_from(other.ray.pan).abs(),
                    (tilt - other.ray.tilt).abs(),
                );
                by_pan.radians().max(by_tilt.radians()) < SAME_RAY_RAD
            });
            if !known {
                let squared_distance =
                    near.squared_distance as f32 / (DESCRIPTOR_NORM * DESCRIPTOR_NORM);
                candidates.push(RayCandidate {
                    ray: PanTilt { pan, tilt },
                    squared_distance,
                });
                if candidates.len() == CANDIDATES {
                    break;
                }
            }
        }
    }
}
