//! What one reference teaches.

use crate::camera::{PanTilt, Ptz};
use crate::document::CameraId;
use crate::features::Features;
use crate::relocalize::Samples;
use std::sync::Arc;

/// What one reference teaches: what its features look like and which rays they show.
#[derive(Clone, Debug, PartialEq)]
pub struct Lesson {
    /// The reference's place in the document.
    pub frame: usize,
    /// Its camera.
    pub camera: CameraId,
    /// How it was pointed.
    pub ptz: Ptz,
    /// Its features.
    pub features: Arc<Features>,
    /// Which of them show a ray, and which ray in `base`.
    pub taught: Vec<(u32, PanTilt)>,
}

impl Lesson {
    /// Adds what it teaches as one frame.
    pub(super) fn add_to(&self, samples: &mut Samples) {
        let descriptor = |feature: u32| self.features.descriptors[feature as usize];
        samples.add_frame(self.taught.iter().map(|&(feature, ray)| (descriptor(feature), ray)));
    }
}
