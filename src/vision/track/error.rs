//! Why frames could not be tied.

use thiserror::Error;

/// Why frames could not be tied to each other.
#[derive(Clone, Debug, PartialEq, Error)]
#[non_exhaustive]
pub enum TrackError {
    /// The program was built without the feature `opencv`.
    #[error(
        "this touchline was built without OpenCV and cannot tie frames; build it with the feature `opencv`"
    )]
    WithoutOpenCv,
    /// OpenCV refused.
    #[error("OpenCV could not compare two frames: {reason}")]
    OpenCv {
        /// In OpenCV's words, on one line.
        reason: String,
    },
    /// Nothing to adjust.
    #[error(
        "{frames} frames with {ties} ties between them; at least 2 frames that show the same are needed"
    )]
    TooFew {
        /// Frames asked for.
        frames: usize,
        /// Ties between them.
        ties: usize,
    },
    /// No rotation and zoom explains the ties.
    #[error(
        "the {ties} ties of {frames} frames fit no camera that only turns and zooms: they lie {residual_px:.1} px off"
    )]
    NotTurning {
        /// Frames asked for.
        frames: usize,
        /// Ties between them.
        ties: usize,
        /// Median distance of the matches, px at 1920 px width.
        residual_px: f64,
    },
}

#[cfg(feature = "opencv")]
impl TrackError {
    /// What OpenCV says, on one line.
    pub(super) fn of_opencv(error: &opencv::Error) -> Self {
        Self::OpenCv {
            reason: error
                .to_string()
                .split_whitespace()
                .collect::<Vec<_>>()
                .join(" "),
        }
    }
}
