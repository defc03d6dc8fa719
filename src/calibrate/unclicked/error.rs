//! Why a base was not found without clicks.

use crate::track::TrackError;
use thiserror::Error;

/// Why a base was not found from frames alone.
#[derive(Clone, Debug, PartialEq, Error)]
#[non_exhaustive]
pub enum UnclickedError {
    /// The frames do not show the same.
    #[error(
        "{tied} of {frames} frames at most show the same stadium: give frames of one camera that stands still, near enough \
         to each other to overlap"
    )]
    NotTied {
        /// Frames asked for.
        frames: usize,
        /// Frames of the largest group.
        tied: usize,
    },
    /// The frames are not of a camera that turns and zooms.
    #[error(transparent)]
    Track(#[from] TrackError),
    /// Hardly any paint.
    #[error("only {places} places of paint stay where they are: give frames that show more of the lines")]
    LittlePaint {
        /// Directions in which paint stays.
        places: usize,
    },
    /// No place for the camera explains anything.
    #[error("no place for the camera explains the paint: is it another sport's field?")]
    NothingFits,
    /// The best answer is not certain.
    #[error("the best answer is not certain, so none is given: {reason}. Click 4 landmarks on 2 frames instead")]
    Uncertain {
        /// What speaks against it.
        reason: String,
    },
    /// It was given up.
    #[error("the search was stopped")]
    Stopped,
}
