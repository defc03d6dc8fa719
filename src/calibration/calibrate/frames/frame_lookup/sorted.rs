//! Sorted numbers that answer for one number left out without being copied.

use std::cmp::Ordering;

/// Numbers in ascending order; equal ones are allowed.
#[derive(Clone, Debug, Default)]
pub(super) struct Sorted(Vec<f64>);

impl FromIterator<f64> for Sorted {
    fn from_iter<I: IntoIterator<Item = f64>>(values: I) -> Self {
        let mut values: Vec<f64> = values.into_iter().collect();
        values.sort_unstable_by(f64::total_cmp);
        Self(values)
    }
}

impl Sorted {
    pub(super) const fn len(&self) -> usize {
        self.0.len()
    }

    pub(super) fn insert(&mut self, value: f64) {
        let place = self
            .0
            .partition_point(|known| known.total_cmp(&value).is_lt());
        self.0.insert(place, value);
    }

    /// Removes one instance of a number; does nothing if it is not in the list.
    pub(super) fn remove(&mut self, value: f64) {
        if let Ok(place) = self.0.binary_search_by(|known| known.total_cmp(&value)) {
            self.0.remove(place);
        }
    }

    /// The smallest and the largest number, with one instance of `left_out` excluded.
    pub(super) fn ends_without(&self, left_out: Option<f64>) -> Option<[f64; 2]> {
        let is_left_out =
            |value: &f64| left_out.is_some_and(|left_out| left_out.total_cmp(value).is_eq());
        let least = self
            .0
            .get(usize::from(self.0.first().is_some_and(is_left_out)))?;
        let greatest = self
            .0
            .iter()
            .rev()
            .nth(usize::from(self.0.last().is_some_and(is_left_out)))?;
        Some([*least, *greatest])
    }

    /// The number at index `place` after removing at most two numbers and adding one, without
    /// changing the list. Zero if the index is out of range.
    pub(super) fn nth_of_changed(&self, place: usize, removed: &[f64], added: Option<f64>) -> f64 {
        // The answer is the added value or an element of the list: that at index `place` − 1 if the
        // insertion shifted it up, or up to `place` + 2 if both removals shifted it down. It is the
        // one whose range of ranks contains `place`.
        let near = self.0.iter().skip(place.saturating_sub(1)).take(4);
        let found = near.copied().chain(added).find(|value| {
            let below = self.rank_in_changed(*value, Ordering::is_lt, removed, added);
            let upto = self.rank_in_changed(*value, Ordering::is_le, removed, added);
            (below..upto).contains(&place)
        });
        found.unwrap_or(0.0)
    }

    /// The number of values below (`is_lt`) or not above (`is_le`) a value, in the list changed as
    /// by [`Self::nth_of_changed`].
    fn rank_in_changed(
        &self,
        value: f64,
        counts: fn(Ordering) -> bool,
        removed: &[f64],
        added: Option<f64>,
    ) -> usize {
        let counts_value = |known: &f64| counts(known.total_cmp(&value));
        let before = self.0.partition_point(counts_value)
            + usize::from(added.as_ref().is_some_and(counts_value));
        before
            - removed
                .iter()
                .filter(|removed| counts_value(removed))
                .count()
    }
}
