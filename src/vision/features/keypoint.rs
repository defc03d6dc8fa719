//! What is found in a picture: keypoints with their descriptors.

use super::Descriptor;
use touchline_core::geometry::{ImagePoint, ImageSize};

/// Where a feature is, and how large and strong.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Keypoint {
    /// px of the full picture, corner convention.
    pub point: ImagePoint,
    /// The diameter of the patch, px of the full picture.
    pub size_px: f32,
    /// The detector's response; larger is stronger.
    pub strength: f32,
}

/// The features of a picture, the strongest first.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Features {
    /// The size of the full picture, px.
    pub image_size: ImageSize,
    /// Where they are.
    pub keypoints: Vec<Keypoint>,
    /// What they look like, one for each keypoint.
    pub descriptors: Vec<Descriptor>,
}

impl Features {
    /// How many there are.
    #[must_use]
    pub const fn len(&self) -> usize {
        self.keypoints.len()
    }

    /// Whether there is none.
    #[must_use]
    pub const fn is_empty(&self) -> bool {
        self.keypoints.is_empty()
    }
}
