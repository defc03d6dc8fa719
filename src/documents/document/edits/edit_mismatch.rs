//! Why an edit does not fit a document.

use crate::document::FrameId;
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
    /// The frame has another revision than the edited one: this edit was already applied, or
    /// another one was.
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
    /// The new state of the frame has the id of another frame.
    #[error("the edit makes frame {id} into frame {found}")]
    OtherFrame {
        /// The frame.
        id: FrameId,
        /// The id of the new state.
        found: FrameId,
    },
    /// A frame to be added already exists.
    #[error("the edit brings frame {id}, which the document has")]
    Present {
        /// Its id.
        id: FrameId,
    },
    /// A new order does not contain exactly the existing frames.
    #[error(
        "the edit puts {ordered} frames in order, the document has {frames} frames, not all of them the same"
    )]
    Order {
        /// How many frames it names.
        ordered: usize,
        /// How many there are.
        frames: usize,
    },
}
