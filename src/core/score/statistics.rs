//! Summary statistics.

use crate::geometry::{mean, median, quantile};
use rand::{RngExt, SeedableRng};
use rand_pcg::Pcg64Mcg;
use serde::Serialize;

/// Number of bootstrap resamples.
const RESAMPLES: usize = 1000;
/// The probability outside the intervals, on each side.
const TAIL: f64 = 0.025;

/// Summary statistics of a list of numbers.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Summary {
    /// Number of values.
    pub count: usize,
    /// Their mean.
    pub mean: f64,
    /// The 95 % bootstrap interval of the mean (percentiles of 1000 resamples).
    #[serde(rename = "mean_interval_95")]
    pub mean_interval: [f64; 2],
    /// Their standard deviation (n − 1); 0 for a single value, infinite if one of several is.
    pub std: f64,
    /// The minimum.
    pub min: f64,
    /// The 10th percentile. Percentiles are interpolated between neighbours.
    pub p10: f64,
    /// The lower quartile.
    pub p25: f64,
    /// The median.
    pub median: f64,
    /// The 95 % bootstrap interval of the median.
    #[serde(rename = "median_interval_95")]
    pub median_interval: [f64; 2],
    /// The upper quartile.
    pub p75: f64,
    /// The 90th percentile.
    pub p90: f64,
    /// The 95th percentile.
    pub p95: f64,
    /// The maximum.
    pub max: f64,
}

impl Summary {
    /// Summarises values; none without any. Values that are not finite count as infinitely large,
    /// so that a failure never improves a summary. The same seed gives the same intervals.
    pub fn from_values(values: &[f64], seed: u64) -> Option<Self> {
        if values.is_empty() {
            return None;
        }
        let mut sorted: Vec<f64> = values
            .iter()
            .map(|value| {
                if value.is_finite() {
                    *value
                } else {
                    f64::INFINITY
                }
            })
            .collect();
        sorted.sort_by(f64::total_cmp);
        let mean = mean(&sorted)?;
        let [mean_interval, median_interval] = bootstrap(&sorted, seed);
        Some(Self {
            count: sorted.len(),
            mean,
            mean_interval,
            std: standard_deviation(&sorted, mean),
            min: sorted[0],
            p10: quantile(&sorted, 0.10),
            p25: quantile(&sorted, 0.25),
            median: quantile(&sorted, 0.50),
            median_interval,
            p75: quantile(&sorted, 0.75),
            p90: quantile(&sorted, 0.90),
            p95: quantile(&sorted, 0.95),
            max: sorted[sorted.len() - 1],
        })
    }
}

/// The standard deviation (n − 1); 0 for a single value, infinite if one of several is.
fn standard_deviation(values: &[f64], mean: f64) -> f64 {
    if values.len() < 2 {
        return 0.0;
    }
    // Infinity minus the mean, which is infinite too, would be NaN.
    if mean.is_infinite() {
        return f64::INFINITY;
    }
    let squares: f64 = values.iter().map(|value| (value - mean).powi(2)).sum();
    (squares / (values.len() - 1) as f64).sqrt()
}

/// The 95 % percentile bootstrap intervals of mean and median (Efron 1979).
fn bootstrap(ascending: &[f64], seed: u64) -> [[f64; 2]; 2] {
    // Both statistics come from the same resamples. The values are drawn from the sorted list, so
    // the intervals do not depend on the order of the input.
    let mut rng = Pcg64Mcg::seed_from_u64(seed);
    let mut drawn = vec![0.0; ascending.len()];
    let (mut means, mut medians) = (Vec::with_capacity(RESAMPLES), Vec::with_capacity(RESAMPLES));
    for _ in 0..RESAMPLES {
        drawn.fill_with(|| ascending[rng.random_range(0..ascending.len())]);
        means.extend(mean(&drawn));
        medians.extend(median(&mut drawn));
    }
    [means, medians].map(|mut found| {
        found.sort_by(f64::total_cmp);
        [quantile(&found, TAIL), quantile(&found, 1.0 - TAIL)]
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use rand_distr::StandardNormal;

    #[test]
    fn statistics_of_a_few_known_numbers() {
        let summary = Summary::from_values(&[4.0, 1.0, 3.0, 2.0], 0).unwrap();
        assert_eq!((summary.count, summary.mean, summary.median), (4, 2.5, 2.5));
        assert!((summary.std - (5.0f64 / 3.0).sqrt()).abs() < 1e-15);
        assert_eq!(
            (summary.min, summary.p25, summary.p75, summary.max),
            (1.0, 1.75, 3.25, 4.0)
        );
        assert!((summary.p90 - 3.7).abs() < 1e-12);
        assert_eq!(Summary::from_values(&[], 0), None);
        let one = Summary::from_values(&[7.0], 0).unwrap();
        assert_eq!(
            (one.mean, one.std, one.median, one.mean_interval),
            (7.0, 0.0, 7.0, [7.0, 7.0])
        );
    }

    #[test]
    fn a_failure_never_makes_it_better() {
        let summary = Summary::from_values(&[1.0, f64::NAN, 2.0], 0).unwrap();
        assert_eq!(
            (summary.median, summary.max, summary.mean),
            (2.0, f64::INFINITY, f64::INFINITY)
        );
        assert_eq!(summary.std, f64::INFINITY);
    }

    #[test]
    fn the_interval_of_the_mean_is_as_wide_as_theory_says_and_repeats() {
        let mut rng = Pcg64Mcg::seed_from_u64(3);
        let values: Vec<f64> = (0..400).map(|_| rng.sample(StandardNormal)).collect();
        let summary = Summary::from_values(&values, 11).unwrap();
        let half = 0.5 * (summary.mean_interval[1] - summary.mean_interval[0]);
        // 1.96 σ / √n.
        assert!((half - 0.098).abs() < 0.012, "{half}");
        assert!(summary.mean_interval[0] < summary.mean && summary.mean < summary.mean_interval[1]);
        let median_half = 0.5 * (summary.median_interval[1] - summary.median_interval[0]);
        assert!((0.09..0.17).contains(&median_half), "{median_half}");
        assert_eq!(Summary::from_values(&values, 11), Some(summary));
    }
}
