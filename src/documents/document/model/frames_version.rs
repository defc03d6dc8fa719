//! The version of a document's frames: which state they are in, and how it arose from those before.
//!
//! Undo keeps many states that differ in a few frames. A version remembers the positions at which
//! frames were borrowed mutably, so that two states are compared there alone, however long the
//! document is.

use std::cmp::Ordering;
use std::collections::{BTreeSet, VecDeque};
use std::sync::OnceLock;
use std::sync::atomic::{self, AtomicU64};

/// The identity of a state of the frames, and its recent predecessors.
#[derive(Clone, Default)]
pub(super) struct FramesVersion {
    /// Unique to this state and its clones. The empty state has number 0.
    number: u64,
    /// The last changes, oldest first: the number of the state before, and the position of the
    /// frame that was borrowed mutably.
    changes: VecDeque<(u64, usize)>,
    /// Whether every frame is at the known position of its id; computed when an id is not found. It
    /// avoids a linear search for each of many ids that no frame has.
    pub(super) are_known: OnceLock<bool>,
}

/// The number of remembered changes of single frames: an edit makes a few, a batch of 64 proposals
/// a few for each.
const REMEMBERED: usize = 256;

impl FramesVersion {
    /// A new state without predecessors.
    pub(super) fn new() -> Self {
        static LAST: AtomicU64 = AtomicU64::new(0);
        Self {
            number: LAST.fetch_add(1, atomic::Ordering::Relaxed) + 1,
            ..Self::default()
        }
    }

    /// Advances to a new state in which the frame at a position may differ.
    pub(super) fn record_change(&mut self, position: usize) {
        let mut changes = std::mem::take(&mut self.changes);
        if changes.len() == REMEMBERED {
            changes.pop_front();
        }
        changes.push_back((self.number, position));
        *self = Self {
            changes,
            ..Self::new()
        };
    }

    /// The positions at which frames may differ from those of another state; none unless both
    /// remember a common predecessor.
    pub(super) fn possible_differences(&self, other: &Self) -> Option<BTreeSet<usize>> {
        // The nearest state that both remember. Frames outside the changes since then, on either
        // side, are those of that state in both. A later state has a larger number, so the side with
        // the larger one goes back.
        let mut own = self.back().enumerate().peekable();
        let mut others = other.back().enumerate().peekable();
        loop {
            let ((own_ago, own_state), (others_ago, others_state)) =
                (*own.peek()?, *others.peek()?);
            match own_state.cmp(&others_state) {
                Ordering::Greater => drop(own.next()),
                Ordering::Less => drop(others.next()),
                Ordering::Equal => {
                    return Some(self.last(own_ago).chain(other.last(others_ago)).collect());
                }
            }
        }
    }

    /// The positions of the last `many` changes.
    fn last(&self, many: usize) -> impl Iterator<Item = usize> {
        self.changes.iter().rev().take(many).map(|(_, at)| *at)
    }

    /// The numbers of this state and of its remembered predecessors.
    fn back(&self) -> impl Iterator<Item = u64> {
        std::iter::once(self.number).chain(self.changes.iter().rev().map(|(before, _)| *before))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The same version after changes at some positions.
    fn changed(version: &FramesVersion, positions: &[usize]) -> FramesVersion {
        let mut next = version.clone();
        for position in positions {
            next.record_change(*position);
        }
        next
    }

    #[test]
    fn versions_differ_at_most_where_either_changed_since_they_parted() {
        let common = changed(&FramesVersion::new(), &[7]);
        let (one, other) = (changed(&common, &[1, 3]), changed(&common, &[3, 5]));
        let differ = one.possible_differences(&other);
        assert_eq!(differ, Some(BTreeSet::from([1, 3, 5])));
        assert_eq!(
            one.possible_differences(&one.clone()),
            Some(BTreeSet::new())
        );
    }

    #[test]
    fn versions_without_a_common_predecessor_may_differ_anywhere() {
        let common = FramesVersion::new();
        assert_eq!(common.possible_differences(&FramesVersion::new()), None);
        let far = changed(&common, &[2; REMEMBERED + 1]);
        assert_eq!(far.possible_differences(&common), None, "it is forgotten");
    }
}
