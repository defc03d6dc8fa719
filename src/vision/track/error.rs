//! Why frames could not be matched or adjusted.

#[cfg(feature = "opencv")]
use crate::media::one_line;
use thiserror::Error;
use touchline_core::geometry::pluralise;

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
        "{} with {} between them; at least 2 frames that show the same are needed",
        pluralise(*frames, "frame"), pluralise(*edges, "matched pair")
    )]
    TooFew {
        /// Number of frames to adjust.
        frames: usize,
        /// Number of pairwise matches between them.
        edges: usize,
    },
    /// No rotation and zoom explains the pairwise matches.
    #[error(
        "no camera that only rotates and zooms fits the {} of {frames} frames: the matches lie \
         {residual_px:.1} px off",
        pluralise(*edges, "matched pair")
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

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn counts_agree_with_their_nouns() {
        let [alone, pair] = [
            TrackError::TooFew {
                frames: 1,
                edges: 0,
            },
            TrackError::NotTurning {
                frames: 2,
                edges: 1,
                residual_px: 9.5,
            },
        ]
        .map(|error| error.to_string());
        assert_eq!(
            alone,
            "1 frame with 0 matched pairs between them; at least 2 frames that show the same are \
             needed"
        );
        assert_eq!(
            pair,
            "no camera that only rotates and zooms fits the 1 matched pair of 2 frames: the \
             matches lie 9.5 px off"
        );
    }
}
