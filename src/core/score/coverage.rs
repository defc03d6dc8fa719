//! Tests whether stated uncertainties match the actual errors.

use super::chi_squared_quantile;
use crate::geometry::{Mat3, Vec3};
use serde::Serialize;

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
