//! The training sample of one reference.

use std::sync::Arc;
use touchline_core::camera::{CameraBase, PanTilt, Ptz, PtzCamera};
use touchline_documents::document::{CameraId, Frame};
use touchline_vision::features::{Descriptor, Features};
use touchline_vision::relocalize::{
    Forest, Label, RelocalizeOptions, Relocalized, Samples, SeenRange, relocalize,
};

/// The training sample of one reference: its features and their rays. Other frames are looked at
/// coarsely first, so a forest learns the coarse features, too.
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
    /// Its features by the options.
    pub fine: FeatureRays,
    /// Those of the quick first look; none for a narrow picture.
    pub coarse: Option<FeatureRays>,
}

/// The features of a reference, with rays.
#[derive(Clone, Debug, PartialEq)]
pub struct FeatureRays {
    /// The features.
    pub features: Arc<Features>,
    /// Indices of the features that have a ray, with the ray in `base`.
    pub rays: Vec<(u32, PanTilt)>,
}

impl TrainingSample {
    /// The sample of a frame with its index in the document and its camera.
    pub(in crate::proposals) fn new(
        (index, frame): (usize, &Frame),
        camera: &PtzCamera,
        label: Label,
        fine: Arc<Features>,
        coarse: Option<Arc<Features>>,
    ) -> Self {
        Self {
            frame: index,
            camera: frame.camera.clone(),
            ptz: camera.ptz(),
            label,
            fine: FeatureRays::new(camera, fine),
            coarse: coarse.map(|coarse| FeatureRays::new(camera, coarse)),
        }
    }

    /// Adds it to the samples as one frame.
    pub(super) fn add_to(&self, samples: &mut Samples) {
        // Coarse and fine features count as one frame, because they are of the same picture.
        samples.add_frame(self.all().flat_map(FeatureRays::samples));
    }

    /// Adds it to the samples as one frame, with the rays of another camera.
    pub(super) fn add_as_taken_by(&self, camera: &PtzCamera, samples: &mut Samples) {
        samples.add_frame(
            self.all()
                .flat_map(|features| features.samples_as_taken_by(camera)),
        );
    }

    /// Queries a forest for its camera as for any frame: by its coarse features first.
    pub(in crate::proposals) fn relocalize(
        &self,
        forest: &Forest,
        seen: &SeenRange,
        base: &CameraBase,
        options: &RelocalizeOptions,
    ) -> Relocalized {
        // As for a proposal: the coarse answer counts only if it is certain.
        let by = |look: &FeatureRays| relocalize(&look.features, forest, seen, base, options);
        self.coarse
            .as_ref()
            .map(by)
            .filter(Relocalized::is_certain)
            .unwrap_or_else(|| by(&self.fine))
    }

    fn all(&self) -> impl Iterator<Item = &FeatureRays> {
        [&self.fine].into_iter().chain(&self.coarse)
    }
}

impl FeatureRays {
    fn new(camera: &PtzCamera, features: Arc<Features>) -> Self {
        let rays = (0..features.len() as u32)
            .filter_map(|feature| Some((feature, ray(camera, &features, feature)?)))
            .collect();
        Self { features, rays }
    }

    /// The descriptors with their rays.
    fn samples(&self) -> impl Iterator<Item = (Descriptor, PanTilt)> {
        self.rays
            .iter()
            .map(|&(feature, ray)| (self.descriptor(feature), ray))
    }

    /// The descriptors with the rays of another camera.
    fn samples_as_taken_by(
        &self,
        camera: &PtzCamera,
    ) -> impl Iterator<Item = (Descriptor, PanTilt)> {
        self.rays.iter().filter_map(|&(feature, _)| {
            Some((
                self.descriptor(feature),
                ray(camera, &self.features, feature)?,
            ))
        })
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
