//! A picture's features to its camera.

use super::{
    Forest, NotFound, Pose, PoseOptions, PredictOptions, RayMatches, SeenRange, pose_of_moving,
};
use crate::features::Features;
use std::time::{Duration, Instant};
use touchline_core::camera::CameraBase;
use touchline_core::geometry::Angle;
use touchline_core::solve::PtzRanges;

/// How a picture is relocalized.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct RelocalizeOptions {
    /// How the forest is asked.
    pub predict: PredictOptions,
    /// How the pose is looked for; without ranges of its own, near where the references looked.
    pub pose: PoseOptions,
}

/// What became of a picture.
#[derive(Clone, Debug, PartialEq)]
pub struct Relocalized {
    /// Its camera, or why there is none.
    pub pose: Result<Pose, NotFound>,
    /// The time that asking the forest took.
    pub predict_time: Duration,
    /// The time that finding the pose took.
    pub pose_time: Duration,
}

/// How far beyond the references' axes a camera may look: farther off it shares no feature with
/// them.
const BEYOND_PAN_DEG: f64 = 30.0;
const BEYOND_TILT_DEG: f64 = 15.0;
/// How much longer or shorter than the references' a focal length may be: SIFT bridges about two
/// octaves.
const BEYOND_FOCAL: f64 = 2.5;

impl SeenRange {
    /// Where a camera may be that shares features with the references.
    #[must_use]
    pub fn plausible(&self) -> PtzRanges {
        let (lowest, highest) = (
            self.tilt_deg.start() - BEYOND_TILT_DEG,
            self.tilt_deg.end() + BEYOND_TILT_DEG,
        );
        PtzRanges {
            pan: self.pan().extended(Angle::from_degrees(BEYOND_PAN_DEG)),
            tilt: Angle::from_degrees(lowest)..=Angle::from_degrees(highest),
            focal_px: self.focal_px.start() / BEYOND_FOCAL..=self.focal_px.end() * BEYOND_FOCAL,
        }
    }
}

/// The candidate rays of all features.
#[must_use]
pub fn candidates_of(features: &Features, forest: &Forest, options: &PredictOptions) -> RayMatches {
    let mut matches = RayMatches::with_capacity(features.len());
    forest.predict_all(&features.descriptors, options, |feature, candidates| {
        matches.push(features.keypoints[feature].point, candidates);
    });
    matches
}

/// The camera of a picture from its features, or why there is none. Features that stand still on
/// the screen while others move carry no answer.
#[must_use]
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
    let unsure = PoseOptions {
        ranges: Some(ranges),
        min_confidence: 0.0,
        ..options.pose.clone()
    };
    let pose = pose_of_moving(&matches, features, base, &seen.cameras, &unsure).and_then(
        |(pose, stands_still)| {
            let stated = pose.stated(&matches, base, features.image_size, seen);
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
