//! Which frames changed between two states of a document, for the incremental update of derived
//! values.

use crate::document::Frames;

/// If more frames than this have changed, a complete recomputation is faster.
const MAX_CHANGED: usize = 64;

/// Which frames changed between two states of a document.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum FrameChanges {
    /// Those at these positions, ascending; all others are unchanged and at the same position.
    At(Vec<usize>),
    /// Frames were added or removed, or many changed.
    Anew,
}

impl Frames {
    /// The changes since an earlier state. Takes time in proportion to the changes, not to the
    /// shared frames.
    pub fn changes_since(&self, before: &Self) -> FrameChanges {
        if self.len() != before.len() {
            return FrameChanges::Anew;
        }
        let changed = self.differences(before);
        if changed.len() > MAX_CHANGED {
            FrameChanges::Anew
        } else {
            FrameChanges::At(changed)
        }
    }

    /// The positions at which frames changed since an earlier state; none if frames were added,
    /// removed or moved.
    pub fn changes_in_place(&self, before: &Self) -> Option<Vec<usize>> {
        // With as many frames as before, a frame that was added, removed or moved leaves another id
        // at some position.
        let changed = (self.len() == before.len()).then(|| self.differences(before))?;
        changed
            .iter()
            .all(|&position| self[position].id == before[position].id)
            .then_some(changed)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::document::{Frame, Shared};
    use crate::testing::new_frame;
    use touchline_core::geometry::ImageSize;

    #[test]
    fn few_changes_are_named_and_many_are_not() {
        let frame = |index: usize| -> Shared<Frame> {
            new_frame(&index.to_string(), ImageSize::new(64, 36)).into()
        };
        let before: Frames = (0..1000).map(frame).collect();
        let mut after = before.clone();
        assert_eq!(after.changes_since(&before), FrameChanges::At(Vec::new()));
        for position in [7, 900] {
            after[position].comment = Some("rain".to_owned());
        }
        assert_eq!(after.changes_since(&before), FrameChanges::At(vec![7, 900]));
        after.pop();
        assert_eq!(after.changes_since(&before), FrameChanges::Anew);
        let mut many = before.clone();
        many.iter_mut()
            .take(MAX_CHANGED + 1)
            .for_each(|frame| frame.comment = Some("rain".to_owned()));
        assert_eq!(many.changes_since(&before), FrameChanges::Anew);
    }
}
