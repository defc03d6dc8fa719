//! Errors of feature detection.

#[cfg(feature = "opencv")]
use crate::media::one_line;
use thiserror::Error;
#[cfg(feature = "opencv")]
use touchline_core::geometry::ImageSize;

/// Why the features of a picture could not be computed.
#[derive(Clone, Debug, PartialEq, Eq, Error)]
#[non_exhaustive]
pub enum FeatureError {
    /// The program was built without the feature `opencv`.
    #[error(
        "this touchline was built without OpenCV and finds no image features; build it with the feature `opencv`"
    )]
    WithoutOpenCv,
    /// OpenCV reported an error.
    #[error("OpenCV could not find the features of a picture of {width} × {height} px: {reason}")]
    OpenCv {
        /// Columns of the picture.
        width: u32,
        /// Rows of the picture.
        height: u32,
        /// OpenCV's message, on one line.
        reason: String,
    },
}

#[cfg(feature = "opencv")]
impl FeatureError {
    /// OpenCV's error in a picture of this size.
    pub(super) fn from_opencv(error: &opencv::Error, picture: ImageSize) -> Self {
        Self::OpenCv {
            width: picture.width,
            height: picture.height,
            reason: one_line(&error.to_string()),
        }
    }
}
