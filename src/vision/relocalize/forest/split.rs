//! The choice of a split: byte and threshold.

use super::{SplitRule, TrainOptions};
use crate::features::{DESCRIPTOR_BYTES, Descriptor};
use rand::RngExt;
use rand_pcg::Pcg64Mcg;
use touchline_core::camera::PanTilt;
use touchline_core::geometry::Vec3;

/// A test of one byte: samples up to the threshold go to the first branch, larger ones to the
/// second.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Split {
    pub dimension: u8,
    pub threshold: u8,
}

/// Maximum number of draws per dimension that the options ask for: constant bytes are drawn again.
const DRAWS: u32 = 4;

/// Number of bytes of largest variance among which the widest gap is searched, and number of
/// samples that estimate the variance.
const VARYING: usize = 24;
const VARIANCE_SAMPLES: usize = 64;

/// Preferred minimum share of the samples on each side of the widest gap.
const LEAST_SHARE: f64 = 0.3;

/// The best of some random splits of the samples `at`; `None` if no byte drawn separates them.
pub(super) fn choose_split(
    samples: &Samples,
    at: &[u32],
    options: &TrainOptions,
    rng: &mut Pcg64Mcg,
) -> Option<Split> {
    match options.rule {
        SplitRule::WidestGap => widest_gap(samples, at, options, rng),
        SplitRule::RayDeviation { thresholds } => {
            least_deviation(samples, at, thresholds, options, rng)
        }
    }
}

/// At most `count` of the samples, evenly spaced.
fn some(at: &[u32], count: usize) -> impl ExactSizeIterator<Item = u32> + Clone {
    // By stride, not at random: no draws are spent on it.
    let considered = at.len().min(count);
    (0..considered).map(move |i| at[i * at.len() / considered])
}

/// The widest gap between neighbouring values of a byte, over the bytes drawn. Splits that leave
/// both sides their share come first; among these the gap decides.
fn widest_gap(
    samples: &Samples,
    at: &[u32],
    options: &TrainOptions,
    rng: &mut Pcg64Mcg,
) -> Option<Split> {
    let bytes = most_varying(samples, at);
    let chosen = some(at, options.node_samples.max(2) as usize);
    // A share above `least` counts as `least`: balance beyond that is worth less than a wide gap.
    let least = (LEAST_SHARE * chosen.len() as f64).ceil() as u32;
    let (mut best, mut tried) = (None::<(u32, u8, Split)>, 0);
    for _ in 0..options.dimensions.max(1) * DRAWS {
        if tried == options.dimensions.max(1) {
            break;
        }
        let dimension = bytes[rng.random_range(0..VARYING)];
        let mut counts = [0u32; 256];
        // A histogram of the byte; then every pair of neighbouring occupied values is a gap. A
        // better balance wins until both sides have their share, then the wider gap.
        for sample in chosen.clone() {
            counts[usize::from(samples.byte(sample, dimension))] += 1;
        }
        let (mut below, mut last) = (0, None::<u8>);
        for value in 0..=u8::MAX {
            let here = counts[usize::from(value)];
            if here == 0 {
                continue;
            }
            if let Some(last) = last {
                let smaller = below.min(chosen.len() as u32 - below);
                let (share, gap) = (smaller.min(least), value - last);
                let enough = smaller >= options.min_leaf.max(1);
                if enough && best.is_none_or(|(most, widest, _)| (share, gap) > (most, widest)) {
                    best = Some((
                        share,
                        gap,
                        Split {
                            dimension,
                            // The middle of the gap, farthest from both sides.
                            threshold: last + (value - 1 - last) / 2,
                        },
                    ));
                }
            }
            below += here;
            last = Some(value);
        }
        // A byte that is constant over the samples does not count as tried.
        tried +=
            u32::from(last.is_some_and(|last| counts[usize::from(last)] < chosen.len() as u32));
    }
    best.map(|(.., split)| split)
}

/// The bytes of largest variance over the samples.
fn most_varying(samples: &Samples, at: &[u32]) -> [u8; VARYING] {
    let (mut sums, mut squares) = ([0u32; DESCRIPTOR_BYTES], [0u32; DESCRIPTOR_BYTES]);
    let chosen = some(at, VARIANCE_SAMPLES);
    let count = chosen.len() as u32;
    for sample in chosen {
        let bytes = &samples.descriptors[sample as usize].0;
        for ((sum, square), &byte) in sums.iter_mut().zip(&mut squares).zip(bytes) {
            let byte = u32::from(byte);
            *sum += byte;
            *square += byte * byte;
        }
    }
    let mut order: [(u32, u8); DESCRIPTOR_BYTES] = std::array::from_fn(|byte| {
        // n² times the variance. Inverted, so that ascending order puts the largest first; equal
        // values are ordered by index.
        let variance = count * squares[byte] - sums[byte] * sums[byte];
        (u32::MAX - variance, byte as u8)
    });
    order.select_nth_unstable(VARYING - 1);
    order[..VARYING].sort_unstable();
    std::array::from_fn(|i| order[i].1)
}

/// The published rule. Minimising the summed squared deviation of unit rays r from the means of
/// both sides is maximising |Σ r|² / n summed over the sides, since Σ |r|² is constant. Of equal
/// scores, the widest gap between the bytes of the two sides wins.
fn least_deviation(
    samples: &Samples,
    at: &[u32],
    thresholds: u32,
    options: &TrainOptions,
    rng: &mut Pcg64Mcg,
) -> Option<Split> {
    let chosen = some(at, options.node_samples.max(2) as usize);
    let (mut best, mut tried) = (None::<(f64, u8, Split)>, 0);
    for _ in 0..options.dimensions * DRAWS {
        if tried == options.dimensions {
            break;
        }
        let dimension = rng.random_range(0..DESCRIPTOR_BYTES) as u8;
        // Count and sum of rays per byte value; then one sweep gives the score of every threshold.
        let mut bins = [(0u32, Vec3::zeros()); 256];
        let (mut low, mut high) = (u8::MAX, 0);
        for sample in chosen.clone() {
            let value = samples.byte(sample, dimension);
            (low, high) = (low.min(value), high.max(value));
            let bin = &mut bins[usize::from(value)];
            bin.0 += 1;
            bin.1 += samples.ray(sample);
        }
        if low >= high {
            continue;
        }
        tried += 1;
        // Random thresholds in the range of the byte.
        let mut wanted = [false; 256];
        for _ in 0..thresholds {
            wanted[usize::from(rng.random_range(low..high))] = true;
        }
        let whole = (usize::from(low)..=usize::from(high))
            .map(|value| bins[value])
            .fold((0, Vec3::zeros()), |sum, bin| {
                (sum.0 + bin.0, sum.1 + bin.1)
            });
        // One sweep over the values: the rays up to a threshold, and by subtraction those above
        // it, give its score.
        let (mut below, mut last) = ((0u32, Vec3::zeros()), low);
        for value in low..high {
            let bin = bins[usize::from(value)];
            below = (below.0 + bin.0, below.1 + bin.1);
            if bin.0 > 0 {
                last = value;
            }
            let above = (whole.0 - below.0, whole.1 - below.1);
            if !wanted[usize::from(value)] || below.0.min(above.0) < options.min_leaf.max(1) {
                continue;
            }
            let Some(next) = (value + 1..=high).find(|&next| bins[usize::from(next)].0 > 0) else {
                continue;
            };
            let score = [below, above]
                .iter()
                .map(|(count, sum)| sum.norm_squared() / f64::from(*count))
                .sum();
            let gap = next - last;
            if best.is_none_or(|(most, widest, _)| (score, gap) > (most, widest)) {
                best = Some((
                    score,
                    gap,
                    Split {
                        dimension,
                        threshold: last + (gap - 1) / 2,
                    },
                ));
            }
        }
    }
    best.map(|(.., split)| split)
}

/// Training samples of a forest: descriptors and their rays, frame by frame.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Samples {
    pub(super) descriptors: Vec<Descriptor>,
    /// Unit directions in `base`.
    rays: Vec<Vec3>,
    /// End index of each frame's samples.
    frame_ends: Vec<usize>,
}

impl Samples {
    /// No samples.
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

    /// Number of samples.
    pub const fn len(&self) -> usize {
        self.descriptors.len()
    }

    /// Whether there is none.
    pub const fn is_empty(&self) -> bool {
        self.descriptors.is_empty()
    }

    /// Number of frames that were added.
    pub const fn frames(&self) -> usize {
        self.frame_ends.len()
    }

    /// The samples of one frame.
    pub(super) fn frame_range(&self, frame: usize) -> std::ops::Range<u32> {
        let start = frame.checked_sub(1).map_or(0, |last| self.frame_ends[last]);
        start as u32..self.frame_ends[frame] as u32
    }

    /// The ray of a sample: a unit direction in `base`.
    pub(super) fn ray(&self, sample: u32) -> Vec3 {
        self.rays[sample as usize]
    }

    /// One byte of a sample's descriptor.
    pub(super) fn byte(&self, sample: u32, dimension: u8) -> u8 {
        self.descriptors[sample as usize].0[usize::from(dimension)]
    }
}
