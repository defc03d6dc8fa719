//! One reference as the forest learns from it.

use std::sync::Arc;
use touchline_core::camera::{PanTilt, Ptz, PtzCamera};
use touchline_documents::document::{CameraId, Frame};
use touchline_vision::features::{Descriptor, Features};
use touchline_vision::relocalize::{Label, Samples};

/// One reference as the forest learns from it: what its features look like and which rays they
/// show.
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
        let ray = |feature: u32| Some((feature, ray(camera, &features, feature)?));
        let rays = (0..features.len() as u32).filter_map(ray).collect();
        Self {
            frame: index,
            camera: frame.camera.clone(),
            ptz: camera.ptz(),
            label,
            features,
            rays,
        }
    }

    /// Adds it as one frame.
    pub(super) fn add_to(&self, samples: &mut Samples) {
        samples.add_frame(
            self.rays
                .iter()
                .map(|&(feature, ray)| (self.descriptor(feature), ray)),
        );
    }

    /// Adds it as one frame that another camera took.
    pub(super) fn add_as_taken_by(&self, camera: &PtzCamera, samples: &mut Samples) {
        let shown = self.rays.iter().map(|(feature, _)| *feature);
        let of_camera = |feature: u32| {
            Some((
                self.descriptor(feature),
                ray(camera, &self.features, feature)?,
            ))
        };
        samples.add_frame(shown.filter_map(of_camera));
    }

    fn descriptor(&self, feature: u32) -> Descriptor {
        self.features.descriptors[feature as usize]
    }
}

/// The ray that a feature shows; beyond the fold of a lens a point shows none.
fn ray(camera: &PtzCamera, features: &Features, feature: u32) -> Option<PanTilt> {
    camera
        .ray_from_image(features.keypoints[feature as usize].point)
        .ok()
}
