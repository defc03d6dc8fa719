//! Why frames could not be matched or adjusted.

#[cfg(feature = "opencv")]
use crate::media::one_line;
use thiserror::Error;

/// Why frames could not be matched or adjusted.
#[derive(Clone, Debug, PartialEq, Error)]
#[non_exhaustive]
pub enum TrackError {
    /// The program was built without the feature `opencv`.
    #[error(
        "this touchline was built without OpenCV and cannot match frames; build it with the feature \
         `opencv`"
    )]
    WithoutOpenCv,
    /// OpenCV returned an error.
    #[error("OpenCV could not compare two frames: {reason}")]
    OpenCv {
        /// OpenCV's message, on one line.
        reason: String,
    },
    /// Too few frames, or frames that matches do not connect.
    #[error(
        "{frames} frames with {edges} pairwise matches between them; at least 2 frames that show the \
         same are needed"
    )]
    TooFew {
        /// Number of frames to adjust.
        frames: usize,
        /// Number of pairwise matches between them.
        edges: usize,
    },
    /// No rotation and zoom explains the pairwise matches.
    #[error(
        "the {edges} pairwise matches of {frames} frames fit no camera that only rotates and \
         zooms: they lie {residual_px:.1} px off"
    )]
    NotTurning {
        /// Number of frames to adjust.
        frames: usize,
        /// Number of pairwise matches between them.
        edges: usize,
        /// Median residual of the matches, px at 1920 px width.
        residual_px: f64,
    },
}

#[cfg(feature = "opencv")]
impl TrackError {
    /// OpenCV's message, with line breaks and runs of spaces collapsed.
    pub(super) fn from_opencv(error: &opencv::Error) -> Self {
        Self::OpenCv {
            reason: one_line(&error.to_string()),
        }
    }
}
