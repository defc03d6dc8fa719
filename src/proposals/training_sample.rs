//! One reference as the forest learns from it.

use crate::camera::{PanTilt, Ptz, PtzCamera};
use crate::document::{CameraId, Frame};
use crate::features::Features;
use crate::relocalize::{Label, Samples};
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
    /// How well that is known.
    pub label: Label,
    /// Its features.
    pub features: Arc<Features>,
    /// Which of them show a ray, and which ray in `base`.
    pub rays: Vec<(u32, PanTilt)>,
}

impl TrainingSample {
    /// A frame whose camera is known, with its place in the document.
    pub(super) fn new(
        (index, frame): (usize, &Frame),
        camera: &PtzCamera,
        label: Label,
        features: Arc<Features>,
    ) -> Self {
        let rays = rays(camera, 0..features.len() as u32, &features);
        Self { frame: index, camera: frame.camera.clone(), ptz: camera.ptz(), label, features, rays }
    }

    /// The same features as another camera shows them.
    pub(super) fn turned_to(&self, camera: &PtzCamera) -> Self {
        let shown = self.rays.iter().map(|(feature, _)| *feature);
        Self { ptz: camera.ptz(), rays: rays(camera, shown, &self.features), ..self.clone() }
    }

    /// Adds it as one frame.
    pub(super) fn add_to(&self, samples: &mut Samples) {
        let descriptor = |feature: u32| self.features.descriptors[feature as usize];
        samples.add_frame(self.rays.iter().map(|&(feature, ray)| (descriptor(feature), ray)));
    }
}

/// The rays that some features show; beyond the fold of a lens a point shows none.
fn rays(camera: &PtzCamera, some: impl Iterator<Item = u32>, features: &Features) -> Vec<(u32, PanTilt)> {
    let ray = |feature: u32| camera.ray_from_image(features.keypoints[feature as usize].point).ok();
    some.filter_map(|feature| Some((feature, ray(feature)?))).collect()
}
