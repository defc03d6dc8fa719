//! Documents with the features of their frames.

use rayon::prelude::*;
use std::ops::ControlFlow;
use std::path::Path;
use touchline::camera::{CameraBase, Ptz};
use touchline::document::{Document, Frame};
use touchline::features::{FeatureCache, FeatureKey, FeatureOptions, Features, extract};
use touchline::geometry::rotation;
use touchline::media::{load_image, sha256_of_file};
use touchline::relocalize::{Forest, Samples, SeenRange, TrainOptions, train};
use touchline::store::read;

pub struct Set {
    pub document: Document,
    pub features: Vec<Features>,
}

impl Set {
    pub fn of(path: &Path, options: &FeatureOptions) -> Self {
        Self::from_document(read(path).unwrap().1, path.parent().unwrap(), options)
    }

    pub fn from_document(document: Document, folder: &Path, options: &FeatureOptions) -> Self {
        let find = |frame| features_of(&document, folder, frame, options);
        let features = document.frames.par_iter().map(|frame| find(frame)).collect();
        Self { document, features }
    }

    pub fn truth(&self, frame: usize) -> Ptz {
        self.document.frames[frame].ptz.as_ref().unwrap().ptz()
    }

    pub fn base(&self, frame: usize) -> CameraBase {
        let frame = &self.document.frames[frame];
        self.document.camera_of(frame).unwrap().base_for(frame).unwrap()
    }

    /// What some frames teach, each by at most so many features, and where they looked.
    pub fn samples(&self, frames: &[usize], features_per_frame: usize) -> (Samples, SeenRange) {
        let mut samples = Samples::new();
        for &frame in frames {
            let camera = self.document.pointed(&self.document.frames[frame]).unwrap();
            let features = &self.features[frame];
            let rays = features.keypoints.iter().map(|keypoint| camera.ray_from_image(keypoint.point));
            let pairs = rays.zip(&features.descriptors).take(features_per_frame);
            samples.add_frame(pairs.filter_map(|(ray, descriptor)| Some((*descriptor, ray.ok()?))));
        }
        let seen: Vec<Ptz> = frames.iter().map(|&frame| self.truth(frame)).collect();
        (samples, SeenRange::of(&seen).unwrap())
    }

    pub fn all(&self) -> Vec<usize> {
        (0..self.features.len()).collect()
    }
}

/// The features of a frame, from the cache in the build folder if they are there.
fn features_of(document: &Document, folder: &Path, frame: &Frame, options: &FeatureOptions) -> Features {
    let cache = FeatureCache::new(&Path::new(env!("CARGO_TARGET_TMPDIR")).join("features"), 1 << 30);
    let path = frame.image_path(folder).unwrap();
    let masks = &document.camera_of(frame).unwrap().masks;
    let key = FeatureKey::new(&sha256_of_file(&path).unwrap(), options, masks);
    cache.get(&key).unwrap_or_else(|| {
        let features = extract(&load_image(&path).unwrap(), masks, options).unwrap();
        cache.put(&key, &features).unwrap();
        features
    })
}

pub fn grown(samples: &Samples, options: &TrainOptions) -> Forest {
    train(samples, options, &|_| ControlFlow::Continue(())).unwrap()
}

pub fn quantile(values: &mut [f64], share: f64) -> f64 {
    values.sort_by(f64::total_cmp);
    let at = ((values.len() as f64 * share) as usize).min(values.len().saturating_sub(1));
    values.get(at).copied().unwrap_or(f64::NAN)
}

pub fn rotation_error_deg(a: Ptz, b: Ptz) -> f64 {
    let turned = |ptz: Ptz| rotation::q_tilt(ptz.tilt) * rotation::q_pan(ptz.pan);
    rotation::angle_between(&turned(a), &turned(b)).degrees()
}
