//! Relocalization: from the features of a picture to its camera.

use super::not_found::NotFound;
use super::{
    CERTAIN, Forest, Pose, PoseOptions, PredictOptions, RayMatches, SeenRange, pose_of_moving,
};
use crate::features::Features;
use std::time::{Duration, Instant};
use touchline_core::camera::CameraBase;
use touchline_core::geometry::Angle;
use touchline_core::solve::PtzRanges;

/// Options of [`relocalize()`].
#[derive(Clone, Debug, Default, PartialEq)]
pub struct RelocalizeOptions {
    /// Options of the forest's predictions.
    pub predict: PredictOptions,
    /// Options of the pose search. Without ranges of its own, it searches near the references.
    pub pose: PoseOptions,
}

/// The result for a picture.
#[derive(Clone, Debug, PartialEq)]
pub struct Relocalized {
    /// Its camera, or the reason why there is none.
    pub pose: Result<Pose, NotFound>,
    /// Time spent on the forest's predictions.
    pub predict_time: Duration,
    /// Time spent on the pose.
    pub pose_time: Duration,
}

impl Relocalized {
    /// Whether there is a camera that is certain by the evidence of its features ([`CERTAIN`]). One
    /// from coarse features is kept only then; else finer ones are extracted.
    pub fn is_certain(&self) -> bool {
        self.pose
            .as_ref()
            .is_ok_and(|pose| pose.confidence >= CERTAIN)
    }
}

/// How far beyond the references' axes a camera may look, degrees: farther away it shares no
/// feature with them.
const BEYOND_PAN_DEG: f64 = 30.0;
const BEYOND_TILT_DEG: f64 = 15.0;
/// Largest ratio of a focal length to the references': SIFT matches over about two octaves.
const BEYOND_FOCAL: f64 = 2.5;

impl SeenRange {
    /// The range of cameras that may share features with the references.
    pub fn plausible(&self) -> PtzRanges {
        // Pan is an arc of the circle, so it is expanded as one; tilt does not wrap, and a focal
        // length scales.
        let (lowest, highest) = (
            self.tilt_deg.start() - BEYOND_TILT_DEG,
            self.tilt_deg.end() + BEYOND_TILT_DEG,
        );
        PtzRanges {
            pan: self.pan().expand(Angle::from_degrees(BEYOND_PAN_DEG)),
            tilt: Angle::from_degrees(lowest)..=Angle::from_degrees(highest),
            focal_px: self.focal_px.start() / BEYOND_FOCAL..=self.focal_px.end() * BEYOND_FOCAL,
        }
    }
}

/// The candidate rays of all features.
pub fn candidates_of(features: &Features, forest: &Forest, options: &PredictOptions) -> RayMatches {
    let mut matches = RayMatches::with_capacity(features.len());
    forest.predict_all(&features.descriptors, options, |feature, candidates| {
        matches.push(features.keypoints[feature].point, candidates);
    });
    matches
}

/// The camera of a picture from its features, or the reason why there is none. Features that stand
/// still on the screen while others move are excluded.
pub fn relocalize(
    features: &Features,
    forest: &Forest,
    seen: &SeenRange,
    base: &CameraBase,
    options: &RelocalizeOptions,
) -> Relocalized {
    let start = Instant::now();
    let matches = candidates_of(features, forest, &options.predict);
    let predict_time = start.elapsed();
    let start = Instant::now();
    let ranges = options
        .pose
        .ranges
        .clone()
        .unwrap_or_else(|| seen.plausible());
    // The threshold on confidence applies only after the labels are included in the uncertainty, so
    // the search itself rejects no answer by its confidence.
    let unsure = PoseOptions {
        ranges: Some(ranges),
        min_confidence: 0.0,
        ..options.pose.clone()
    };
    let pose = pose_of_moving(&matches, features, base, &seen.cameras, &unsure).and_then(
        |(pose, stands_still)| {
            let stated = pose.with_uncertainty(&matches, base, features.image_size, seen);
            // If graphics were excluded, that they stood still is the better reason: it tells the
            // user why the rest does not suffice.
            stated
                .if_sure(options.pose.min_confidence)
                .map_err(|unsure| stands_still.unwrap_or(unsure))
        },
    );
    Relocalized {
        pose,
        predict_time,
        pose_time: start.elapsed(),
    }
}
