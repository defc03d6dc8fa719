//! The references that teach.

use crate::document::{Document, FrameStatus};

/// The references of a document, and which of them teach: see [`crate::document::Frame::teaches`].
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Teachers {
    /// The frames that teach, by their places.
    pub frames: Vec<usize>,
    /// All references.
    pub references: usize,
    /// References that do not teach: accepted suggestions, and those that a person excluded.
    pub withheld: usize,
}

impl Teachers {
    /// Those of a document; `all_references` has accepted suggestions teach, too.
    #[must_use]
    pub fn of(document: &Document, all_references: bool) -> Self {
        let mut found = Self::default();
        for (index, frame) in document.frames.iter().enumerate() {
            if frame.status != FrameStatus::Reference {
                continue;
            }
            found.references += 1;
            if frame.teaches() || all_references && frame.is_suggestion() {
                found.frames.push(index);
            } else {
                found.withheld += 1;
            }
        }
        found
    }

    /// Those of a document that can teach by now: their camera's base is known and they are solved.
    #[must_use]
    pub fn of_solved(document: &Document) -> Self {
        let mut found = Self::of(document, false);
        found.frames.retain(|&index| document.pointed(&document.frames[index]).is_some());
        found
    }
}
