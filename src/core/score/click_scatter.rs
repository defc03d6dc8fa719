//! An annotator's click noise, estimated from independent clicks on the same points.
//!
//! The input is differences scaled so that each coordinate has the variance σ² of a single click:
//! for two clicks a and b, (a − b) / √2. Their mean is assumed to be 0.
//!
//! 1. A first scale from the median of |d| (the MAD about 0). A pair farther out than 5 times this
//!    scale (plus its uncertainty) is not noise but shows another point: it is excluded and
//!    counted.
//! 2. Huber's M-estimate of scale ("proposal 2" with a known centre): the σ at which the mean of
//!    min(d² / σ², 4) is 0.9205, its value for a normal distribution. Its efficiency on normal
//!    noise is 89 %, where the MAD's is 37 %: the same interval needs less than half the clicks.
//! 3. The interval is that of a χ² variable with n / (2 V) degrees of freedom, where V is the
//!    larger of the variance for normal noise and the variance that the pairs show, both
//!    coordinates of a pair together.

use super::{chi_squared_quantile, median_normal_size};
use crate::geometry::{Vec2, quantile};
use serde::Serialize;

/// No estimate from fewer pairs: the interval would span a factor of three or more.
const MIN_PAIRS: usize = 5;
/// A pair farther out than this multiple of the first scale shows another point.
const ANOTHER_SPOT: f64 = 5.0;
/// Twice the relative 1-σ of the first scale for normal noise, times √n.
const FIRST_SCALE_2_SIGMA: f64 = 2.33;
/// The clipping point of the M-estimate, in σ.
const BEND: f64 = 2.0;
/// The mean of min(d², 4) for a standard normal d.
const EXPECTED: f64 = 0.920_536_925_636_323;
/// n times the variance of the estimate over σ², on normal noise.
const NORMAL_VARIANCE: f64 = 0.564_855_397_115_199;
/// Minimum degrees of freedom of an estimate. With these the interval spans a factor of seven.
const LEAST_FREEDOM: f64 = 3.0;

/// The estimated click noise.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct ClickScatter {
    /// 1-σ of one click in each direction, in the unit of the differences.
    pub sigma: f64,
    /// The 95 % interval of σ.
    pub interval_95: [f64; 2],
    /// Number of pairs used.
    pub pairs: usize,
    /// Number of pairs excluded because they show another point.
    pub set_aside: usize,
    /// The estimate's degrees of freedom.
    #[serde(rename = "worth")]
    pub freedom: f64,
}

impl ClickScatter {
    /// Estimates the noise from differences in x and y. None with fewer than five pairs, with a
    /// value that is not finite, and if at least half of the values are exactly 0 (copies, not
    /// clicks).
    pub fn from_differences(differences: &[Vec2]) -> Option<Self> {
        let pairs: Vec<[f64; 2]> = differences
            .iter()
            .map(|difference| [difference.x, difference.y])
            .collect();
        Self::from_pairs(&pairs)
    }

    /// The same from differences along one axis.
    pub fn along(differences: impl Iterator<Item = f64>) -> Option<Self> {
        Self::from_pairs(
            &differences
                .map(|difference| [difference])
                .collect::<Vec<_>>(),
        )
    }

    /// The estimate from pairs with N coordinates each: see the module.
    fn from_pairs<const N: usize>(all: &[[f64; N]]) -> Option<Self> {
        // Step 1: the first scale. No estimate if a value is not finite: a NaN would be sorted to
        // one end and shift the median.
        let mut sizes: Vec<f64> = all.iter().flatten().map(|value| value.abs()).collect();
        if all.len() < MIN_PAIRS || sizes.iter().any(|size| !size.is_finite()) {
            return None;
        }
        // A first scale of 0 means that at least half of the values are copies.
        sizes.sort_by(f64::total_cmp);
        let first = quantile(&sizes, 0.5) / median_normal_size();
        if first <= 0.0 {
            return None;
        }
        // The limit is raised by the uncertainty of the first scale, 2 σ.
        let limit =
            ANOTHER_SPOT * first * (1.0 + FIRST_SCALE_2_SIGMA / (sizes.len() as f64).sqrt());
        let kept: Vec<[f64; N]> = all
            .iter()
            .filter(|pair| pair.iter().all(|value| value.abs() <= limit))
            .copied()
            .collect();
        if kept.len() < MIN_PAIRS {
            return None;
        }

        // Steps 2 and 3: the M-estimate, and its interval from a χ² with the matching variance.
        let sigma = scale(&kept, first);
        let freedom = (kept.len() * N) as f64 / (2.0 * variance(&kept, sigma).max(NORMAL_VARIANCE));
        let freedom = freedom.max(LEAST_FREEDOM);
        let interval_95 = [0.975, 0.025]
            .map(|share| sigma * (freedom / chi_squared_quantile(freedom, share)).sqrt());
        Some(Self {
            sigma,
            interval_95,
            pairs: kept.len(),
            set_aside: all.len() - kept.len(),
            freedom,
        })
    }
}

/// The M-estimate, by fixed-point iteration from `first`: σ² is multiplied by the ratio of the mean
/// clipped square to its expectation.
fn scale<const N: usize>(pairs: &[[f64; N]], first: f64) -> f64 {
    // Clipped values do not change with σ, so each step removes only a part of the error of ln σ:
    // on normal noise four fifths.
    const STEPS: usize = 60;
    let count = (pairs.len() * N) as f64;
    let mut sigma = first;
    for _ in 0..STEPS {
        let clipped: f64 = pairs
            .iter()
            .flatten()
            .map(|value| (value / sigma).powi(2).min(BEND * BEND))
            .sum();
        let factor = (clipped / count / EXPECTED).sqrt();
        sigma *= factor;
        if (factor - 1.0).abs() < 1e-12 {
            break;
        }
    }
    sigma
}

/// n times the variance of the estimate over σ², from the pairs: Huber's sandwich estimator `E[ψ²]
/// / E[ψ']²`. The coordinates of a pair are summed before squaring, because they may be correlated.
fn variance<const N: usize>(pairs: &[[f64; N]], sigma: f64) -> f64 {
    // ψ(z²) = min(z², 4) − 0.9205, summed over a pair for `squares`; its derivative by ln σ is
    // −2 z² where nothing is clipped, and 0 elsewhere.
    let (mut squares, mut slope) = (0.0, 0.0);
    for pair in pairs {
        let squared = pair.map(|value| (value / sigma).powi(2));
        squares += squared
            .iter()
            .map(|z| z.min(BEND * BEND) - EXPECTED)
            .sum::<f64>()
            .powi(2);
        slope += squared
            .iter()
            .filter(|z| **z < BEND * BEND)
            .map(|z| 2.0 * z)
            .sum::<f64>();
    }
    let count = (pairs.len() * N) as f64;
    (squares / count) / (slope / count).powi(2)
}

#[cfg(test)]
mod tests {
    use super::*;
    use rand::{RngExt, SeedableRng};
    use rand_distr::{StandardNormal, StudentT};
    use rand_pcg::Pcg64Mcg;

    fn drawn(rng: &mut Pcg64Mcg, pairs: usize, sigma: f64) -> Vec<Vec2> {
        (0..pairs)
            .map(|_| Vec2::from_fn(|_, _| sigma * rng.sample::<f64, _>(StandardNormal)))
            .collect()
    }

    #[test]
    fn the_constants_are_those_of_a_normal_variable() {
        let (mut expected, mut fourth, mut slope) = (0.0, 0.0, 0.0);
        let step = 1e-4;
        for index in 0..160_000 {
            let z = -8.0 + step * (f64::from(index) + 0.5);
            let weight = step * (-0.5 * z * z).exp() / std::f64::consts::TAU.sqrt();
            let clipped = (z * z).min(BEND * BEND);
            expected += weight * clipped;
            fourth += weight * clipped * clipped;
            slope += if z.abs() < BEND {
                weight * 2.0 * z * z
            } else {
                0.0
            };
        }
        assert!((expected - EXPECTED).abs() < 1e-6, "{expected}");
        assert!(((fourth - expected * expected) / (slope * slope) - NORMAL_VARIANCE).abs() < 1e-6);
    }

    #[test]
    fn nineteen_of_twenty_intervals_hold_the_truth() {
        let mut rng = Pcg64Mcg::seed_from_u64(5);
        for pairs in [5, 12, 40] {
            let (mut held, mut logs, mut silent) = (0, 0.0, 0);
            for _ in 0..2000 {
                let Some(found) = ClickScatter::from_differences(&drawn(&mut rng, pairs, 1.3))
                else {
                    silent += 1;
                    continue;
                };
                held += usize::from((found.interval_95[0]..=found.interval_95[1]).contains(&1.3));
                logs += (found.sigma / 1.3).ln();
            }
            assert!(silent < 10, "{pairs} pairs: {silent} say nothing");
            let (share, bias) = (held as f64 / 2000.0, logs / 2000.0);
            assert!((0.93..0.985).contains(&share), "{pairs} pairs: {share}");
            // ln of a root of χ² over its freedom falls short by about 1 / (2 freedom).
            assert!(bias.abs() < 0.06, "{pairs} pairs: {bias}");
        }
    }

    #[test]
    fn wrong_spots_are_set_aside_and_fat_tails_widen_the_interval() {
        let mut rng = Pcg64Mcg::seed_from_u64(6);
        let mut differences = drawn(&mut rng, 45, 1.0);
        let clean = ClickScatter::from_differences(&differences).unwrap();
        differences.extend((0..5).map(|index| Vec2::new(30.0 + f64::from(index), -200.0)));
        let found = ClickScatter::from_differences(&differences).unwrap();
        assert_eq!((found.pairs, found.set_aside), (45, 5));
        assert!((found.sigma - clean.sigma).abs() < 1e-9);
        let fat = StudentT::new(3.0).unwrap();
        let tails: Vec<Vec2> = (0..200)
            .map(|_| Vec2::from_fn(|_, _| rng.sample(fat)))
            .collect();
        let found = ClickScatter::from_differences(&tails).unwrap();
        assert!(
            found.freedom < 0.8 * clean.freedom / 45.0 * found.pairs as f64,
            "{found:?}"
        );
    }

    #[test]
    fn copies_and_too_few_say_nothing() {
        let one = Vec2::new(1.0, 0.5);
        assert_eq!(ClickScatter::from_differences(&[one; 4]), None);
        assert_eq!(ClickScatter::from_differences(&[Vec2::zeros(); 9]), None);
        assert_eq!(
            ClickScatter::from_differences(&[Vec2::new(f64::NAN, 0.0); 9]),
            None
        );
        assert!(ClickScatter::from_differences(&[one; 5]).is_some());
        assert!(ClickScatter::along([1.0, -1.0, 0.5, 0.3, 2.0].into_iter()).is_some());
    }
}
