//! The references that the forest is trained on.

use touchline_documents::document::{Document, FrameStatus};

/// The references of a document, and which of them are used for training: see
/// [`touchline_documents::document::Frame::is_used_for_training`].
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct TrainingFrames {
    /// Indices of the frames used for training.
    pub frames: Vec<usize>,
    /// Number of references.
    pub references: usize,
    /// Number of references not used for training: accepted suggestions, frames with the verdict
    /// Wrong, and those that the user excluded.
    pub withheld: usize,
}

impl TrainingFrames {
    /// The training frames of a document; `all_references` includes accepted suggestions.
    pub fn from_document(document: &Document, all_references: bool) -> Self {
        let mut found = Self::default();
        for (index, frame) in document.frames.iter().enumerate() {
            if frame.status != FrameStatus::Reference {
                continue;
            }
            found.references += 1;
            // Accepted suggestions are left out by default: a forest that learns its own answers
            // repeats their errors.
            if frame.is_used_for_training() || all_references && frame.is_suggestion() {
                found.frames.push(index);
            } else {
                found.withheld += 1;
            }
        }
        found
    }

    /// The training frames of a document that are usable now: solved, with a known base.
    pub fn from_solved_frames(document: &Document) -> Self {
        let mut found = Self::from_document(document, false);
        found
            .frames
            .retain(|&index| document.ptz_camera(&document.frames[index]).is_some());
        found
    }
}
