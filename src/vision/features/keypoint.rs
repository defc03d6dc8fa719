//! The features of a picture: keypoints with their descriptors.

use super::Descriptor;
use touchline_core::geometry::{ImagePoint, ImageSize};

/// Position, size and strength of a feature.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Keypoint {
    /// Position, px of the full picture, corner convention.
    pub point: ImagePoint,
    /// Diameter of the patch, px of the full picture.
    pub size_px: f32,
    /// The detector's response; larger is stronger.
    pub strength: f32,
}

/// The features of a picture, the strongest first.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Features {
    /// The size of the full picture, px.
    pub image_size: ImageSize,
    /// Positions, sizes and strengths.
    pub keypoints: Vec<Keypoint>,
    /// One descriptor for each keypoint.
    pub descriptors: Vec<Descriptor>,
}

impl Features {
    /// Number of features.
    pub const fn len(&self) -> usize {
        self.keypoints.len()
    }

    /// Whether the picture has no features.
    pub const fn is_empty(&self) -> bool {
        self.keypoints.is_empty()
    }
}
