//! Described points, and the features that a camera sees of them.
#![allow(
    clippy::unwrap_used,
    clippy::panic,
    clippy::missing_panics_doc,
    clippy::must_use_candidate,
    missing_docs,
    reason = "for tests alone"
)]

use crate::features::{DESCRIPTOR_BYTES, Descriptor, Features, Keypoint};
use rand::RngExt;
use rand_pcg::Pcg64Mcg;
use touchline_core::camera::{CameraBase, PanTilt, Ptz, PtzCamera};
use touchline_core::geometry::ImagePoint;
pub use touchline_core::testing::HD as SIZE;
use touchline_core::testing::base_at;

/// Where the camera stands.
pub fn base() -> CameraBase {
    base_at([0.0, -60.0, 18.0], SIZE)
}

/// What a point looks like.
pub fn descriptor(rng: &mut Pcg64Mcg) -> Descriptor {
    Descriptor(std::array::from_fn::<u8, DESCRIPTOR_BYTES, _>(|_| {
        (rng.random_range(0.0..1.0f64).powi(4) * 135.0) as u8
    }))
}

/// Points by their descriptors and rays.
pub fn scene(rng: &mut Pcg64Mcg) -> Vec<(Descriptor, PanTilt)> {
    let point = |rng: &mut Pcg64Mcg| {
        let ray =
            PanTilt::from_degrees(rng.random_range(-30.0..30.0), rng.random_range(-20.0..-2.0));
        (descriptor(rng), ray)
    };
    (0..1500).map(|_| point(rng)).collect()
}

/// A picture in which nothing is seen yet.
pub fn empty() -> Features {
    Features {
        image_size: SIZE,
        ..Features::default()
    }
}

/// Adds a point to a picture; its descriptor is never quite the same.
pub fn add(features: &mut Features, what: &Descriptor, point: ImagePoint, rng: &mut Pcg64Mcg) {
    features.keypoints.push(Keypoint {
        point,
        size_px: 3.0,
        strength: 1.0,
    });
    let noisy = what
        .0
        .map(|byte| (i16::from(byte) + rng.random_range(-4..=4)).clamp(0, 255) as u8);
    features.descriptors.push(Descriptor(noisy));
}

/// What a camera sees of the scene.
pub fn picture(scene: &[(Descriptor, PanTilt)], ptz: Ptz, rng: &mut Pcg64Mcg) -> Features {
    let camera = PtzCamera::new(base(), ptz);
    let mut features = empty();
    for (descriptor, ray) in scene {
        let Ok(point) = camera.image_from_ray(*ray) else {
            continue;
        };
        if SIZE.contains(point) {
            add(&mut features, descriptor, point, rng);
        }
    }
    features
}
