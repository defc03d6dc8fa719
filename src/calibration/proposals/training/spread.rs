//! Evenly spread subsets.

use std::collections::BTreeSet;

/// At most `most` of the values, evenly spread and including the first and the last. `most` must be
/// at least 2.
pub(in crate::proposals) fn spread<T>(all: Vec<T>, most: usize) -> Vec<T> {
    let count = all.len();
    if count <= most {
        return all;
    }
    let chosen: BTreeSet<usize> = (0..most).map(|i| i * (count - 1) / (most - 1)).collect();
    all.into_iter()
        .enumerate()
        .filter(|(index, _)| chosen.contains(index))
        .map(|(_, one)| one)
        .collect()
}

#[cfg(test)]
mod tests {
    use super::spread;

    #[test]
    fn pictures_are_spread_from_the_first_to_the_last() {
        let places: Vec<usize> = (100..140).collect();
        assert_eq!(spread(places[..5].to_vec(), 16), [100, 101, 102, 103, 104]);
        let spread = spread(places, 4);
        assert_eq!(spread, [100, 113, 126, 139]);
    }
}
