//! Choosing a split: which byte, which threshold.

use super::TrainOptions;
use super::train::Samples;
use crate::features::DESCRIPTOR_BYTES;
use crate::geometry::Vec3;
use rand::RngExt;
use rand_pcg::Pcg64Mcg;

/// A test of one byte: samples up to the threshold go one way, larger ones the other.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Split {
    pub dimension: u8,
    pub threshold: u8,
}

/// Draws of a dimension until one tells samples apart, per dimension that the options ask for.
const DRAWS: u32 = 4;

/// The best of some random splits of the samples `at`; none if no dimension drawn tells them apart.
///
/// Best is where the unit rays of the two sides deviate least from their means in sum of squares, n − |Σ r|² / n each;
/// among equals, where the gap between the two sides' bytes is widest, so that noise rarely changes sides.
pub(super) fn choose_split(samples: &Samples, at: &[u32], options: &TrainOptions, rng: &mut Pcg64Mcg) -> Option<Split> {
    let considered = at.len().min(options.node_samples.max(2) as usize);
    let chosen: Vec<(usize, Vec3)> = (0..considered)
        .map(|i| at[i * at.len() / considered] as usize)
        .map(|sample| (sample, samples.rays[sample]))
        .collect();
    let (mut best, mut tried) = (None::<(f64, u8, Split)>, 0);
    for _ in 0..options.dimensions * DRAWS {
        if tried == options.dimensions {
            break;
        }
        let dimension = rng.random_range(0..DESCRIPTOR_BYTES);
        let bins = Bins::of(samples, &chosen, dimension);
        if bins.low == bins.high {
            continue;
        }
        tried += 1;
        for _ in 0..options.thresholds {
            let threshold = rng.random_range(bins.low..bins.high);
            let Some((score, gap, threshold)) = bins.score(threshold, options.min_leaf as usize) else { continue };
            if best.is_none_or(|(least, widest, _)| (score, gap) > (least, widest)) {
                best = Some((score, gap, Split { dimension: dimension as u8, threshold }));
            }
        }
    }
    best.map(|(.., split)| split)
}

/// The samples of a node by one byte of their descriptors.
struct Bins<'a> {
    values: Vec<u8>,
    chosen: &'a [(usize, Vec3)],
    low: u8,
    high: u8,
}

impl<'a> Bins<'a> {
    fn of(samples: &Samples, chosen: &'a [(usize, Vec3)], dimension: usize) -> Self {
        let values: Vec<u8> = chosen.iter().map(|(sample, _)| samples.descriptors[*sample].0[dimension]).collect();
        let low = values.iter().copied().min().unwrap_or(0);
        let high = values.iter().copied().max().unwrap_or(0);
        Self { values, chosen, low, high }
    }

    /// |Σ r|² / n of both sides, the gap between them, and a threshold in the middle of it; none if a side has fewer than
    /// `min_leaf` samples.
    fn score(&self, threshold: u8, min_leaf: usize) -> Option<(f64, u8, u8)> {
        let (mut sums, mut counts) = ([Vec3::zeros(); 2], [0usize; 2]);
        let (mut below, mut above) = (0u8, u8::MAX);
        for (&value, (_, ray)) in self.values.iter().zip(self.chosen) {
            let side = usize::from(value > threshold);
            sums[side] += ray;
            counts[side] += 1;
            if side == 0 {
                below = below.max(value);
            } else {
                above = above.min(value);
            }
        }
        if counts[0].min(counts[1]) < min_leaf.max(1) {
            return None;
        }
        let score = sums[0].norm_squared() / counts[0] as f64 + sums[1].norm_squared() / counts[1] as f64;
        Some((score, above - below, below + (above - below) / 2))
    }
}
