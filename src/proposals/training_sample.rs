//! One reference as the forest learns from it.

use crate::camera::{PanTilt, Ptz};
use crate::document::CameraId;
use crate::features::Features;
use crate::geometry::Mat3;
use crate::relocalize::Samples;
use std::sync::Arc;

/// One reference as the forest learns from it: what its features look like and which rays they show.
#[derive(Clone, Debug, PartialEq)]
pub struct TrainingSample {
    /// The reference's place in the document.
    pub frame: usize,
    /// Its camera.
    pub camera: CameraId,
    /// How it was pointed.
    pub ptz: Ptz,
    /// How well that is known if the base is exact: covariance of (pan rad, tilt rad, focal px).
    pub label: Mat3,
    /// Its features.
    pub features: Arc<Features>,
    /// Which of them show a ray, and which ray in `base`.
    pub rays: Vec<(u32, PanTilt)>,
}

impl TrainingSample {
    /// Adds it as one frame.
    pub(super) fn add_to(&self, samples: &mut Samples) {
        let descriptor = |feature: u32| self.features.descriptors[feature as usize];
        samples.add_frame(self.rays.iter().map(|&(feature, ray)| (descriptor(feature), ray)));
    }
}
