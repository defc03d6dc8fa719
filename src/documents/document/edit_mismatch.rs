//! Why an edit does not fit a document.

use super::FrameId;
use thiserror::Error;

/// An edit that does not fit the document it is applied to.
#[derive(Clone, Debug, PartialEq, Eq, Error)]
pub enum EditMismatch {
    /// The document has no such frame.
    #[error("the edit concerns frame {id}, which the document does not have")]
    NoFrame {
        /// Its id.
        id: FrameId,
    },
    /// The frame is another one than was edited: the edit was made before, or another one was.
    #[error(
        "the edit was made on revision {made_on} of frame {id}, the document has revision {found}"
    )]
    Revision {
        /// The frame.
        id: FrameId,
        /// The revision that was edited.
        made_on: u64,
        /// The document's.
        found: u64,
    },
    /// What the frame is to become has the id of another.
    #[error("the edit makes frame {id} into frame {found}")]
    OtherFrame {
        /// The frame.
        id: FrameId,
        /// What it would be called.
        found: FrameId,
    },
    /// A frame that is to come is there.
    #[error("the edit brings frame {id}, which the document has")]
    Present {
        /// Its id.
        id: FrameId,
    },
    /// A new order names other frames than there are.
    #[error(
        "the edit puts {ordered} frames in order, the document has {frames} frames, not all of them the same"
    )]
    Order {
        /// How many frames it names.
        ordered: usize,
        /// How many there are.
        frames: usize,
    },
    /// In a journal of an earlier version: a position that the document does not have.
    #[error("the edit concerns frame {index}, the document has {frames} frames")]
    Position {
        /// The position.
        index: usize,
        /// How many frames there are.
        frames: usize,
    },
}
