//! The training sample of one reference.

use std::sync::Arc;
use touchline_core::camera::{PanTilt, Ptz, PtzCamera};
use touchline_documents::document::{CameraId, Frame};
use touchline_vision::features::{Descriptor, Features};
use touchline_vision::relocalize::{Label, Samples};

/// The training sample of one reference: its features and their rays.
#[derive(Clone, Debug, PartialEq)]
pub struct TrainingSample {
    /// Index of the reference in the document.
    pub frame: usize,
    /// Id of its camera.
    pub camera: CameraId,
    /// Pan, tilt and focal length of its label.
    pub ptz: Ptz,
    /// Uncertainty of the label.
    pub label: Label,
    /// Its features.
    pub features: Arc<Features>,
    /// Indices of the features that have a ray, with the ray in `base`.
    pub rays: Vec<(u32, PanTilt)>,
}

impl TrainingSample {
    /// The sample of a frame with its index in the document and its camera.
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

    /// Adds it to the samples as one frame.
    pub(super) fn add_to(&self, samples: &mut Samples) {
        samples.add_frame(
            self.rays
                .iter()
                .map(|&(feature, ray)| (self.descriptor(feature), ray)),
        );
    }

    /// Adds it to the samples as one frame, with the rays of another camera.
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

/// The ray of a feature; none beyond the fold of the lens.
fn ray(camera: &PtzCamera, features: &Features, feature: u32) -> Option<PanTilt> {
    camera
        .ray_from_image(features.keypoints[feature as usize].point)
        .ok()
}
