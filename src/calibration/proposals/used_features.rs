//! What the forest made of a picture's features: to be looked at over the picture.

use super::FrameFeatures;
use std::collections::BTreeSet;
use touchline_core::geometry::ImagePoint;
use touchline_documents::document::{Camera, Document, FrameId};
use touchline_vision::relocalize::{
    ForestModel, PoseOptions, RelocalizeOptions, candidates_of, pose_of_moving,
};

/// The features of a frame, and what became of each.
#[derive(Clone, Debug, PartialEq)]
pub struct UsedFeatures {
    /// The frame.
    pub frame: FrameId,
    /// Where they are, px, and what became of them.
    pub features: Vec<(ImagePoint, FeatureUse)>,
}

/// What became of a feature.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum FeatureUse {
    /// It looks like nothing in the references.
    Kept,
    /// It looks like something in them.
    Matched,
    /// It agrees with the camera that was found.
    Agrees,
}

impl UsedFeatures {
    /// Asks a forest for a frame and keeps what it made of each feature. Without a forest of its
    /// camera, or a base, they are only kept.
    #[must_use]
    pub fn of(
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
        let Some((forest, base)) = model.camera(frame.camera.as_str()).zip(base) else {
            return Self {
                frame: frame.id.clone(),
                features,
            };
        };
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
        // Matches are features in their order, without those that match nothing.
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

    /// How many became at least this.
    #[must_use]
    pub fn count(&self, at_least: FeatureUse) -> usize {
        self.features
            .iter()
            .filter(|(_, used)| *used >= at_least)
            .count()
    }
}
