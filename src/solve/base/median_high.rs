//! A median that is always one of the values.
//!
//! Residuals and positions take this one: a residual between two that clicks have would be no residual.
//! [`crate::score::median`] is the usual one, which lies half way between the two in the middle.

/// The high median of values in any order: the one in the middle, of two in the middle the greater; none without any.
pub(super) fn median_high(mut values: Vec<f64>) -> Option<f64> {
    values.sort_by(f64::total_cmp);
    values.get(values.len() / 2).copied()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn of_two_in_the_middle_the_greater_is_taken() {
        assert_eq!(median_high(vec![4.0, 1.0, 3.0, 2.0]), Some(3.0));
        assert_eq!(median_high(vec![5.0, 1.0, 2.0]), Some(2.0));
        assert_eq!(median_high(Vec::new()), None);
    }
}
