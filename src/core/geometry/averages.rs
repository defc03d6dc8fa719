//! Mean, quantiles, and two medians, which differ for an even count: the mean of the two middle
//! numbers, or the larger one.

/// The mean; none without any.
pub fn mean(values: &[f64]) -> Option<f64> {
    (!values.is_empty()).then(|| values.iter().sum::<f64>() / values.len() as f64)
}

/// A quantile of ascending numbers, interpolated between the two nearest (type 7 of Hyndman and Fan
/// 1996, the usual one); NaN without any.
pub fn quantile(ascending: &[f64], share: f64) -> f64 {
    let Some(last) = ascending.len().checked_sub(1) else {
        return f64::NAN;
    };
    let at = share.clamp(0.0, 1.0) * last as f64;
    let (below, above) = (
        ascending[at.floor() as usize],
        ascending[at.ceil() as usize],
    );
    // ∞ − ∞ would be NaN.
    if below == above {
        below
    } else {
        below + (above - below) * at.fract()
    }
}

/// The median of numbers in any order, which it reorders: of two in the middle their mean. None
/// without any.
pub fn median(values: &mut [f64]) -> Option<f64> {
    let odd = values.len() % 2 == 1;
    let (below, at) = split_at_middle(values)?;
    Some(if odd {
        at
    } else {
        // `at` is the upper of the two middle numbers; the lower one is the largest below it.
        f64::midpoint(below.iter().copied().fold(f64::NEG_INFINITY, f64::max), at)
    })
}

/// The high median of numbers in any order, which it reorders: of two in the middle the greater, so
/// that it is always one of the numbers. None without any.
pub fn median_high(values: &mut [f64]) -> Option<f64> {
    split_at_middle(values).map(|(_, at)| at)
}

/// The middle number, the larger of two, and the numbers before it, which are not larger; takes
/// linear time, unlike sorting.
fn split_at_middle(values: &mut [f64]) -> Option<(&[f64], f64)> {
    if values.is_empty() {
        return None;
    }
    let (below, at, _) = values.select_nth_unstable_by(values.len() / 2, f64::total_cmp);
    Some((below, *at))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn medians_in_any_order() {
        assert_eq!(median(&mut [5.0, 1.0, 3.0]), Some(3.0));
        assert_eq!(median(&mut [5.0, 1.0, 3.0, 4.0]), Some(3.5));
        assert_eq!(median_high(&mut [5.0, 1.0, 3.0, 4.0]), Some(4.0));
        assert_eq!(median_high(&mut [7.0]), Some(7.0));
        assert_eq!((median(&mut []), median_high(&mut [])), (None, None));
    }
}
