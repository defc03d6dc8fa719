//! Quantiles and probabilities of the distributions that errors are compared with.

use statrs::distribution::{ChiSquared, ContinuousCDF, Normal};

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

#[cfg(test)]
mod tests {
    use super::*;

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
}
