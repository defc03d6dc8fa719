//! Errors of tracking a clip.

use crate::calibrate::BaseEstimationError;
use thiserror::Error;
use touchline_core::field::FieldError;
use touchline_vision::media::MediaError;
use touchline_vision::track::TrackError;

/// Why a clip could not be tracked.
#[derive(Debug, PartialEq, Error)]
#[non_exhaustive]
pub enum TrackClipError {
    /// The camera has no base.
    #[error("camera {camera} has no base yet: estimate it first (touchline refine-base)")]
    NoBase {
        /// The camera's name.
        camera: String,
    },
    /// The camera has no base, and its clicks give none.
    #[error("camera {camera} has no base yet, and its clicks give none: {why}")]
    NoBaseFromClicks {
        /// The camera's name.
        camera: String,
        /// Why they give none.
        why: Box<BaseEstimationError>,
    },
    /// No frame has a camera to begin with.
    #[error(
        "none of its {frames} frames has a camera to track from: solve or accept one of them first"
    )]
    NothingKnown {
        /// Number of frames of the clip.
        frames: usize,
    },
    /// A picture could not be read.
    #[error(transparent)]
    Media(#[from] MediaError),
    /// A picture has another size than the rest.
    #[error("{picture} is {} × {} px, but the clip is {} × {} px", .actual.0, .actual.1, .expected.0, .expected.1)]
    Size {
        /// The file, and its frame.
        picture: String,
        /// Its size, px.
        actual: (u32, u32),
        /// The size that the document states, px.
        expected: (u32, u32),
    },
    /// The field is not valid.
    #[error(transparent)]
    Field(#[from] FieldError),
    /// Points could not be tracked.
    #[error(transparent)]
    Track(#[from] TrackError),
    /// The adjustment has no solution.
    #[error(
        "the cameras of its {frames} frames cannot be adjusted: they are not determined by what is known; accept one more of them"
    )]
    Undetermined {
        /// Number of frames of the clip.
        frames: usize,
    },
    /// It was cancelled.
    #[error("stopped; nothing was changed")]
    Stopped,
}
