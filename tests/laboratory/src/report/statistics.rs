//! Means and their confidence intervals.

use statrs::distribution::{ContinuousCDF as _, StudentsT};
use touchline::geometry::quantile;

/// The confidence of intervals.
pub const CONFIDENCE: f64 = 0.95;

/// Mean and standard deviation (n − 1).
pub fn mean_sd(values: &[f64]) -> [f64; 2] {
    let count = values.len() as f64;
    let mean = values.iter().sum::<f64>() / count;
    let squares: f64 = values.iter().map(|value| (value - mean).powi(2)).sum();
    [mean, (squares / (count - 1.0).max(1.0)).sqrt()]
}

/// The median of numbers in any order; NaN without any.
pub fn median_of(mut values: Vec<f64>) -> f64 {
    values.sort_by(f64::total_cmp);
    quantile(&values, 0.5)
}

/// The least and the greatest of some numbers; ∞ and −∞ without any.
pub fn range_of(values: impl Iterator<Item = f64>) -> [f64; 2] {
    values.fold([f64::INFINITY, f64::NEG_INFINITY], |[low, high], value| {
        [low.min(value), high.max(value)]
    })
}

/// The confidence interval of a mean from independent values (Student's t), as wide as Bonferroni's
/// correction for this number of comparisons asks. NaN with a single value.
pub fn interval_of_mean(values: &[f64], comparisons: usize) -> [f64; 2] {
    // No or one value leaves no degree of freedom, for which there is no distribution.
    let Ok(student) = StudentsT::new(0.0, 1.0, values.len() as f64 - 1.0) else {
        return [f64::NAN; 2];
    };
    // Bonferroni: the probability of an error is shared by all comparisons.
    let outside = (1.0 - CONFIDENCE) / comparisons.max(1) as f64;
    let [mean, sd] = mean_sd(values);
    let half = student.inverse_cdf(1.0 - outside / 2.0) * sd / (values.len() as f64).sqrt();
    [mean - half, mean + half]
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn intervals_are_those_of_students_tables() {
        // 4.303 × 0.01 / √3 = 0.02484; with three comparisons t is 7.649 (two-sided, 0.05 / 3).
        for (comparisons, half) in [(1, 0.024_84), (3, 0.044_16)] {
            let [low, high] = interval_of_mean(&[0.60, 0.61, 0.62], comparisons);
            assert!((low - (0.61 - half)).abs() < 1e-4, "{low}");
            assert!((high - (0.61 + half)).abs() < 1e-4, "{high}");
        }
        assert!(interval_of_mean(&[0.5], 1)[0].is_nan());
        assert!(interval_of_mean(&[], 1)[0].is_nan());
        assert_eq!(interval_of_mean(&[0.5, 0.5], 1), [0.5, 0.5]);
    }
}
