//! Image features: where a picture has a recognisable patch, and what the patch looks like.
//!
//! | what | where |
//! |---|---|
//! | [`extract`] | the SIFT features of a picture (ORB or AKAZE for comparison) outside its masks, spread over it |
//! | [`Features`], [`Keypoint`], [`Descriptor`] | the result |
//! | [`burnt_in`] | graphics, by features: what is static on the screen while the camera moves (score bugs, watermarks, black boxes) |
//! | [`standing_graphics`] | graphics, by edges, for those with few features: faint watermarks, black boxes and bars, banners that are shown for a while |
//! | [`has_moved`] | whether the camera moved between two pictures |
//! | [`FeatureCache`] | features on disk, by picture and settings |
//! | [`FeatureOptions`] | the settings: how many features, at which resolution, plain or RootSIFT |
//! | [`extract_binary`] | ORB and AKAZE with all their bits, for comparison |
//!
//! The detectors are OpenCV's. Each is called in one function, and the rest builds without OpenCV
//! (see [`FeatureError::WithoutOpenCv`]).
//!
//! Keypoints are in px of the full picture, corner convention. OpenCV counts from the first pixel's
//! centre, which adds 0.5 px; its SIFT lies 0.25 px too far right and down, because its first
//! octave is enlarged without the half pixel. Together, a corner coordinate is OpenCV's number plus
//! 0.25. A test with a mirrored picture checks this.
//!
//! Frames, signs and units: [`touchline_core::conventions`].

mod binary;
mod black_bars;
mod burnt_in;
mod cache;
mod descriptor;
mod displaced;
mod edge_groups;
mod extract;
mod grid;
mod options;
mod reduced;
#[cfg(feature = "opencv")]
mod sift;
mod spread;
mod standing;
mod standing_edges;

pub use burnt_in::burnt_in;
pub use cache::{FeatureCache, FeatureKey};
pub use descriptor::{DESCRIPTOR_BYTES, Descriptor, Features, Keypoint};
pub(crate) use descriptor::{MAX_MATCH_SQUARED_DISTANCE, Sketch};
pub use extract::extract;
pub(crate) use grid::{cell_in_grid, count_cells};
pub use options::{Detector, FeatureOptions};
pub(crate) use standing::{STANDING_PX, WHOLE_PICTURE, place_share};
// For the crates above alone: no promise to other programs.
#[doc(hidden)]
pub use {
    binary::{BinaryDescriptor, BinaryFeatures, BinaryKind, extract_binary},
    burnt_in::{BurntIn, BurntInGraphic, StaticGraphic},
    descriptor::{DESCRIPTOR_NORM, MAX_SQUARED_DISTANCE},
    extract::opencv_version,
    reduced::{ReducedPicture, has_moved},
    spread::spread,
    standing_edges::standing_graphics,
};

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
    fn from_opencv(error: &opencv::Error, picture: ImageSize) -> Self {
        Self::OpenCv {
            width: picture.width,
            height: picture.height,
            reason: one_line(&error.to_string()),
        }
    }
}
