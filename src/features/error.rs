//! What can go wrong while features are looked for.

use thiserror::Error;

/// Why a picture has no features to offer.
#[derive(Clone, Debug, PartialEq, Eq, Error)]
#[non_exhaustive]
pub enum FeatureError {
    /// The program was built without the feature `opencv`.
    #[error("this touchline was built without OpenCV and finds no image features; build it with the feature `opencv`")]
    WithoutOpenCv,
    /// OpenCV refused.
    #[error("OpenCV could not find the features of a picture of {width} × {height} px: {reason}")]
    OpenCv {
        /// Columns of the picture.
        width: u32,
        /// Rows of the picture.
        height: u32,
        /// In OpenCV's words, on one line.
        reason: String,
    },
}
