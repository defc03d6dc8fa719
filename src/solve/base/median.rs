//! The median of residuals and positions. The scores have one that interpolates, on a floor of their own: a residual that
//! nobody had would be no residual.

/// The median of numbers in any order, of two in the middle the greater; none without any.
pub(super) fn median(mut values: Vec<f64>) -> Option<f64> {
    values.sort_by(f64::total_cmp);
    values.get(values.len() / 2).copied()
}
