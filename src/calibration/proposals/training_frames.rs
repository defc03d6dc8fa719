//! The references that the forest learns from.

use touchline_documents::document::{Document, FrameStatus};

/// The references of a document, and which of them are used for training: see
/// [`touchline_documents::document::Frame::is_used_for_training`].
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct TrainingFrames {
    /// The frames used for training, by their places.
    pub frames: Vec<usize>,
    /// All references.
    pub references: usize,
    /// References not used for training: accepted suggestions, frames judged Wrong, and those that
    /// a person excluded.
    pub withheld: usize,
}

impl TrainingFrames {
    /// Those of a document; `all_references` takes accepted suggestions, too.
    #[must_use]
    pub fn of(document: &Document, all_references: bool) -> Self {
        let mut found = Self::default();
        for (index, frame) in document.frames.iter().enumerate() {
            if frame.status != FrameStatus::Reference {
                continue;
            }
            found.references += 1;
            if frame.is_used_for_training() || all_references && frame.is_suggestion() {
                found.frames.push(index);
            } else {
                found.withheld += 1;
            }
        }
        found
    }

    /// Those of a document that can be used by now: their camera's base is known and they are
    /// solved.
    #[must_use]
    pub fn of_solved(document: &Document) -> Self {
        let mut found = Self::of(document, false);
        found
            .frames
            .retain(|&index| document.pointed(&document.frames[index]).is_some());
        found
    }
}
