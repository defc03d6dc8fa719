//! The use of a picture's features by the forest, for display over the picture.

use crate::proposals::FrameFeatures;
use std::collections::BTreeSet;
use touchline_core::geometry::ImagePoint;
use touchline_documents::document::{Camera, Document, FrameId};
use touchline_vision::relocalize::{
    ForestModel, PoseOptions, RelocalizeOptions, candidates_of, pose_of_moving,
};

/// The features of a frame and their use.
#[derive(Clone, Debug, PartialEq)]
pub struct UsedFeatures {
    /// Id of the frame.
    pub frame: FrameId,
    /// Positions, px, and use of each.
    pub features: Vec<(ImagePoint, FeatureUse)>,
}

/// The use of a feature.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum FeatureUse {
    /// It resembles no feature of the references.
    Kept,
    /// It resembles a feature of the references.
    Matched,
    /// It is an inlier of the camera that was found.
    Agrees,
}

impl UsedFeatures {
    /// Queries a forest for a frame and records the use of each feature. Without a forest or a base
    /// of its camera, none is matched.
    pub fn from_query(
        document: &Document,
        index: usize,
        found: &FrameFeatures,
        model: &ForestModel,
        options: &RelocalizeOptions,
    ) -> Self {
        let frame = &*document.frames[index];
        let keypoints = &found.features.keypoints;
        let mut features: Vec<_> = keypoints
            .iter()
            .map(|keypoint| (keypoint.point, FeatureUse::Kept))
            .collect();
        let base = document.camera_of(frame).and_then(Camera::base);
        // Without either, the features are shown all the same, each as one that nothing is known
        // of.
        let Some((forest, base)) = model.camera(frame.camera.as_str()).zip(base) else {
            return Self {
                frame: frame.id.clone(),
                features,
            };
        };
        // Predict and estimate the pose as for a proposal, within the plausible ranges of the
        // forest.
        let matches = candidates_of(&found.features, &forest.forest, &options.predict);
        let ranges = options
            .pose
            .ranges
            .clone()
            .unwrap_or_else(|| forest.seen.plausible());
        let pose = PoseOptions {
            ranges: Some(ranges),
            ..options.pose.clone()
        };
        let seen = &forest.seen.cameras;
        let agreeing = pose_of_moving(&matches, &found.features, &base, seen, &pose)
            .map(|(pose, _)| pose.inliers);
        let agreeing: BTreeSet<usize> = agreeing.unwrap_or_default().into_iter().collect();
        // Matches come in the order of the features, without those that match nothing; merge the
        // two lists by position.
        let mut at = 0;
        for (point, used) in &mut features {
            if at < matches.len() && matches.point(at) == *point {
                *used = if agreeing.contains(&at) {
                    FeatureUse::Agrees
                } else {
                    FeatureUse::Matched
                };
                at += 1;
            }
        }
        Self {
            frame: frame.id.clone(),
            features,
        }
    }

    /// Number of features with at least this use.
    pub fn count(&self, at_least: FeatureUse) -> usize {
        self.features
            .iter()
            .filter(|(_, used)| *used >= at_least)
            .count()
    }
}
