//! Some of many values: evenly spaced ones, pairs that are far apart, and those that differ.

use std::iter::StepBy;

/// The stride with which at most `most` of `count` values are taken; at least 1.
pub const fn stride_of_subsample(count: usize, most: usize) -> usize {
    let stride = count.div_ceil(most);
    if stride == 0 { 1 } else { stride }
}

/// At most `most` of the values, evenly spaced, including the first.
pub fn subsample<I>(values: I, most: usize) -> StepBy<I::IntoIter>
where
    I: IntoIterator<IntoIter: ExactSizeIterator>,
{
    let values = values.into_iter();
    let stride = stride_of_subsample(values.len(), most);
    values.step_by(stride)
}

/// The pairs of items that are farthest apart, the farthest first, at most `most`.
pub(crate) fn farthest_pairs<T: Copy>(
    items: &[T],
    most: usize,
    separation: impl Fn(&[T; 2]) -> f64,
) -> Vec<[T; 2]> {
    // All pairs are compared, which suits the clicks of a frame. The sort is stable, so that equal
    // separations leave the result the same on every run.
    let mut pairs: Vec<[T; 2]> = Vec::new();
    for (index, one) in items.iter().enumerate() {
        pairs.extend(items[index + 1..].iter().map(|two| [*one, *two]));
    }
    pairs.sort_by(|a, b| separation(b).total_cmp(&separation(a)));
    pairs.truncate(most);
    pairs
}

/// The first candidates that differ from all kept before them, at most `most`.
pub(crate) fn keep_distinct<T>(
    candidates: impl IntoIterator<Item = T>,
    most: usize,
    differ: impl Fn(&T, &T) -> bool,
) -> Vec<T> {
    let mut kept: Vec<T> = Vec::with_capacity(most);
    for candidate in candidates {
        if kept.len() == most {
            break;
        }
        if kept.iter().all(|other| differ(other, &candidate)) {
            kept.push(candidate);
        }
    }
    kept
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_few_values_stay_and_many_become_few() {
        assert_eq!(subsample([3, 1, 4], 3).collect::<Vec<_>>(), [3, 1, 4]);
        assert_eq!(subsample(0..10, 4).collect::<Vec<_>>(), [0, 3, 6, 9]);
        assert_eq!(subsample(&[2.5; 9], 4).count(), 3);
        assert_eq!(subsample(Vec::<u8>::new(), 5).count(), 0);
    }
}
