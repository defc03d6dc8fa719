//! Summary statistics, quantiles of distributions, and how often errors lie within their σ.

use crate::geometry::{Mat3, Vec3, mean, median, quantile};
use rand::{RngExt, SeedableRng};
use rand_pcg::Pcg64Mcg;
use serde::Serialize;
use statrs::distribution::{ChiSquared, ContinuousCDF, Normal};

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

/// A quantile of the χ² distribution; NaN if the number of degrees of freedom is not positive.
pub fn chi_squared_quantile(freedom: f64, share: f64) -> f64 {
    ChiSquared::new(freedom).map_or(f64::NAN, |chi_squared| chi_squared.inverse_cdf(share))
}

/// The median of |d| for a normal variable d, in σ.
pub fn median_normal_size() -> f64 {
    Normal::standard().inverse_cdf(0.75)
}

/// The median distance of a point if both of its coordinates have the same normal noise (Rayleigh
/// distribution), in σ of one coordinate.
pub fn median_rayleigh() -> f64 {
    // The squared distance is χ² with two degrees of freedom, and that has the median 2 ln 2.
    (2.0 * std::f64::consts::LN_2).sqrt()
}

/// The probability that a point with the same normal noise in both coordinates lies within a
/// distance, in σ of one coordinate.
pub fn rayleigh_share(distance_sigmas: f64) -> f64 {
    ChiSquared::new(2.0).map_or(f64::NAN, |squared| {
        squared.cdf(distance_sigmas * distance_sigmas)
    })
}

/// The probability of a normal variable within 1 σ.
const ONE_SIGMA: f64 = 0.682_689_492_137_086;

/// The squared Mahalanobis distance of an error, eᵀ Σ⁻¹ e. Its mean is 3 if Σ is right. None if the
/// covariance cannot be inverted.
pub fn squared_mahalanobis(error: Vec3, covariance: &Mat3) -> Option<f64> {
    // Scale to unit variances first: degrees and px in one matrix make it badly conditioned.
    let sigmas = covariance.diagonal().map(f64::sqrt);
    let scale = Mat3::from_diagonal(&sigmas.map(f64::recip));
    let correlation = scale * covariance * scale;
    let error = scale * error;
    // Of an indefinite matrix the form may be negative; a σ of zero makes it NaN.
    let squared = error.dot(&(correlation.try_inverse()? * error));
    (squared.is_finite() && squared >= 0.0).then_some(squared)
}

/// How often errors of three parameters lie within their stated confidence regions.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct SigmaCoverage {
    /// Number of errors with a stated covariance.
    pub count: usize,
    /// The share within the 68.27 % ellipsoid.
    pub within_68: f64,
    /// The share within the 95 % ellipsoid.
    pub within_95: f64,
    /// The ratio of actual to stated errors: the square root of the mean of χ² / 3. It is 1 if the
    /// stated covariances are right.
    pub error_over_sigma: f64,
}

impl SigmaCoverage {
    /// Computes the coverage from squared Mahalanobis distances. None without any.
    pub fn from_squared_distances(squared_mahalanobis: &[f64]) -> Option<Self> {
        let count = squared_mahalanobis.len();
        (count > 0).then(|| Self {
            count,
            within_68: share_within(squared_mahalanobis, ONE_SIGMA),
            within_95: share_within(squared_mahalanobis, 0.95),
            error_over_sigma: (squared_mahalanobis.iter().sum::<f64>() / count as f64 / 3.0).sqrt(),
        })
    }
}

/// The share of squared Mahalanobis distances within the ellipsoid of a probability.
fn share_within(squared_mahalanobis: &[f64], probability: f64) -> f64 {
    let limit = chi_squared_quantile(3.0, probability);
    let within = squared_mahalanobis.iter().filter(|s| **s <= limit);
    within.count() as f64 / squared_mahalanobis.len() as f64
}

#[cfg(test)]
mod tests {
    use super::*;
    use rand::{RngExt, SeedableRng};
    use rand_distr::StandardNormal;
    use rand_pcg::Pcg64Mcg;

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

    #[test]
    fn published_quantiles() {
        // Tables of χ² at 2.5 % and 97.5 %.
        for (freedom, low, high) in [
            (3.0, 0.216, 9.348),
            (5.0, 0.831, 12.833),
            (20.0, 9.591, 34.170),
            (100.0, 74.222, 129.561),
        ] {
            assert!(
                (chi_squared_quantile(freedom, 0.025) - low).abs() < 6e-4,
                "{freedom}"
            );
            assert!(
                (chi_squared_quantile(freedom, 0.975) - high).abs() < 6e-4,
                "{freedom}"
            );
        }
        assert!((chi_squared_quantile(3.0, 0.95) - 7.814_728).abs() < 1e-6);
        assert!(chi_squared_quantile(-1.0, 0.5).is_nan());
        assert!((median_normal_size() - 0.674_489_750_196_082).abs() < 1e-12);
        assert!((median_rayleigh() - chi_squared_quantile(2.0, 0.5).sqrt()).abs() < 1e-9);
        assert!((rayleigh_share(median_rayleigh()) - 0.5).abs() < 1e-12);
    }

    #[test]
    fn independent_sigmas_add_their_squares() {
        let covariance = Mat3::from_diagonal(&Vec3::new(0.01, 0.04, 100.0));
        let squared = squared_mahalanobis(Vec3::new(0.1, -0.4, 30.0), &covariance).unwrap();
        assert!((squared - (1.0 + 4.0 + 9.0)).abs() < 1e-12);
        assert_eq!(squared_mahalanobis(Vec3::repeat(1.0), &Mat3::zeros()), None);
    }

    #[test]
    fn drawn_errors_are_covered_as_often_as_stated() {
        let mut rng = Pcg64Mcg::seed_from_u64(7);
        let root = Mat3::new(0.02, 0.0, 0.0, 0.01, 0.03, 0.0, 4.0, -3.0, 6.0);
        let covariance = root * root.transpose();
        let mut draw = || root * Vec3::from_fn(|_, _| rng.sample::<f64, _>(StandardNormal));
        let squared: Vec<f64> = (0..20_000)
            .map(|_| squared_mahalanobis(draw(), &covariance).unwrap())
            .collect();
        let coverage = SigmaCoverage::from_squared_distances(&squared).unwrap();
        assert!((coverage.within_68 - 0.6827).abs() < 0.01, "{coverage:?}");
        assert!((coverage.within_95 - 0.95).abs() < 0.005, "{coverage:?}");
        assert!(
            (coverage.error_over_sigma - 1.0).abs() < 0.02,
            "{coverage:?}"
        );
        assert_eq!(SigmaCoverage::from_squared_distances(&[]), None);
    }
}
