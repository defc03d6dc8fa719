//! Documents with the features of their frames.

use rayon::prelude::*;
use std::path::Path;
use touchline::camera::{CameraBase, Ptz};
use touchline::document::{Document, Frame};
use touchline::features::{FeatureCache, FeatureKey, FeatureOptions, Features, burnt_in, extract};
use touchline::geometry::rotation;
use touchline::media::{load_image, sha256_of_file};
use touchline::progress::Progress;
use touchline::relocalize::{Forest, Samples, SeenRange, TrainOptions, train};
use touchline::store::read;

pub struct Set {
    pub document: Document,
    pub features: Vec<Features>,
    /// What stands still on the screen counts as any feature does: to compare with.
    pub keeps_standing: bool,
}

/// As the trainer has it: references that see a point this far apart by their labels, px at 1920 px
/// width, moved.
const MOVED_PX: f64 = 20.0;

impl Set {
    pub fn of(path: &Path, options: &FeatureOptions) -> Self {
        Self::from_document(read(path).unwrap().1, path.parent().unwrap(), options)
    }

    /// A document without any mask.
    pub fn without_masks(mut document: Document, folder: &Path, options: &FeatureOptions) -> Self {
        for camera in &mut document.cameras {
            camera.masks.clear();
            camera.ranged_masks.clear();
        }
        for frame in &mut document.frames {
            frame.masks.clear();
        }
        Self::from_document(document, folder, options)
    }

    /// The features of some frames that stand still on the screen, as the trainer finds them.
    fn burnt_in(&self, frames: &[usize]) -> Vec<Vec<usize>> {
        let pictures: Vec<&Features> = frames.iter().map(|&frame| &self.features[frame]).collect();
        let camera = |place: usize| {
            self.document
                .ptz_camera(&self.document.frames[frames[place]])
                .unwrap()
        };
        let cameras: Vec<_> = (0..frames.len()).map(camera).collect();
        let moved = |one: usize, other: usize, point| {
            let least_px = MOVED_PX * pictures[one].image_size.scale_from_1920();
            cameras[one].ray_from_image(point).is_ok_and(|ray| {
                !cameras[other]
                    .image_from_ray(ray)
                    .is_ok_and(|image| image.distance_px(point) <= least_px)
            })
        };
        burnt_in(&pictures, &moved).features
    }

    pub fn from_document(document: Document, folder: &Path, options: &FeatureOptions) -> Self {
        let find = |frame| features_of(&document, folder, frame, options);
        let features = document
            .frames
            .par_iter()
            .map(|frame| find(frame))
            .collect();
        Self {
            document,
            features,
            keeps_standing: false,
        }
    }

    pub fn truth(&self, frame: usize) -> Ptz {
        self.document.frames[frame].ptz.as_ref().unwrap().ptz()
    }

    pub fn base(&self, frame: usize) -> CameraBase {
        let frame = &self.document.frames[frame];
        self.document
            .camera_of(frame)
            .unwrap()
            .base_for(frame)
            .unwrap()
    }

    /// The training samples of some frames, each limited to a number of features, and where they
    /// looked.
    pub fn samples(&self, frames: &[usize], features_per_frame: usize) -> (Samples, SeenRange) {
        let mut samples = Samples::new();
        let range = self.samples_into(frames, features_per_frame, &mut samples);
        (samples, range)
    }

    /// The same, added to others.
    pub fn samples_into(
        &self,
        frames: &[usize],
        features_per_frame: usize,
        samples: &mut Samples,
    ) -> SeenRange {
        let burnt_in = if self.keeps_standing {
            vec![Vec::new(); frames.len()]
        } else {
            self.burnt_in(frames)
        };
        for (&frame, burnt_in) in frames.iter().zip(burnt_in) {
            let camera = self
                .document
                .ptz_camera(&self.document.frames[frame])
                .unwrap();
            let features = &self.features[frame];
            let rays = features
                .keypoints
                .iter()
                .map(|keypoint| camera.ray_from_image(keypoint.point));
            let pairs = rays
                .zip(&features.descriptors)
                .enumerate()
                .take(features_per_frame);
            let moving = pairs.filter(|(feature, _)| burnt_in.binary_search(feature).is_err());
            samples.add_frame(
                moving.filter_map(|(_, (ray, descriptor))| Some((*descriptor, ray.ok()?))),
            );
        }
        let seen: Vec<Ptz> = frames.iter().map(|&frame| self.truth(frame)).collect();
        let mut range = SeenRange::from_cameras(&seen).unwrap();
        if self.keeps_standing {
            range.cameras.clear();
        }
        range
    }

    pub fn all(&self) -> Vec<usize> {
        (0..self.features.len()).collect()
    }
}

/// The features of a frame, from the cache in the build folder if they are there.
fn features_of(
    document: &Document,
    folder: &Path,
    frame: &Frame,
    options: &FeatureOptions,
) -> Features {
    let cache = FeatureCache::new(
        &Path::new(env!("CARGO_TARGET_TMPDIR")).join("features"),
        1 << 30,
    );
    let path = frame.image_path(folder).unwrap();
    let masks = &document.masks_of(frame);
    let key = FeatureKey::new(&sha256_of_file(&path).unwrap(), options, masks);
    cache.get(&key).unwrap_or_else(|| {
        let features = extract(&load_image(&path).unwrap(), masks, options).unwrap();
        cache.put(&key, &features).unwrap();
        features
    })
}

pub fn grown(samples: &Samples, options: &TrainOptions) -> Forest {
    train(samples, options, &Progress::default()).unwrap()
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
