//! Why no camera of a clip was found.

use thiserror::Error;
use touchline_vision::media::MediaError;
use touchline_vision::track::TrackError;

/// Why no camera of a clip was found.
#[derive(Debug, PartialEq, Error)]
#[non_exhaustive]
pub enum TrackClipError {
    /// Where the camera stands is not known.
    #[error("camera {camera} has no base yet: estimate it first (touchline refine-base)")]
    NoBase {
        /// The camera.
        camera: String,
    },
    /// No frame has a camera to begin with.
    #[error(
        "none of its {frames} frames has a camera to carry on: solve or accept one of them first"
    )]
    NothingKnown {
        /// Frames of the clip.
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
        /// As it is, px.
        actual: (u32, u32),
        /// As the document says, px.
        expected: (u32, u32),
    },
    /// Points could not be followed.
    #[error(transparent)]
    Track(#[from] TrackError),
    /// The adjustment has no solution.
    #[error(
        "the cameras of its {frames} frames cannot be adjusted: they are not determined by what is known; accept one more of them"
    )]
    Undetermined {
        /// Frames of the clip.
        frames: usize,
    },
    /// It was stopped.
    #[error("stopped; nothing was changed")]
    Stopped,
}
