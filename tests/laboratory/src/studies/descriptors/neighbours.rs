//! Cameras from nearest neighbours, without a forest.

use super::described::{Described, Neighbour};
use crate::scoring::answers::FrameAnswer;
use crate::sets::Split;
use rayon::prelude::*;
use touchline::camera::{Ptz, PtzCamera};
use touchline::relocalize::{
    PoseOptions, RayCandidate, RayMatches, SeenRange, pose_from_candidates,
};

/// Solves the cameras of the test frames. `repeat` is the index of the set among those of other
/// seeds.
pub fn ask_neighbours(described: &Described, repeat: usize) -> Vec<FrameAnswer> {
    let set = &described.set;
    let of_split = |(number, split): (usize, &Split)| -> Vec<FrameAnswer> {
        let seen: Vec<Ptz> = split
            .training_frames
            .iter()
            .map(|&training_frame| set.frames[training_frame].truth.ptz())
            .collect();
        // As with a forest: the limits of plausible cameras follow from the training frames, and
        // the test of confidence is applied afterwards. Without training frames no feature has a
        // ray, and every frame is a refusal.
        let options = PoseOptions {
            seed: set.seed,
            ranges: SeenRange::from_cameras(&seen).map(|seen| seen.plausible()),
            ..PoseOptions::default()
        };
        let untested = PoseOptions {
            min_confidence: 0.0,
            ..options.clone()
        };
        let one = |&frame: &usize| {
            let known = &set.frames[frame];
            let base = *known.truth.base();
            let matches = nearest_rays(described, frame, &split.training_frames);
            let answer = FrameAnswer::blank(set, repeat, number, frame);
            let size = known.features.image_size;
            let Ok(pose) = pose_from_candidates(&matches, &base, size, &untested) else {
                return answer;
            };
            let is_sure = pose.confidence >= options.min_confidence;
            answer.with_camera(set, &PtzCamera::new(base, pose.ptz), is_sure)
        };
        split.test_frames.par_iter().map(one).collect()
    };
    set.splits.iter().enumerate().flat_map(of_split).collect()
}

/// For each feature of a frame, the ray of its nearest neighbour among the training frames'
/// features.
fn nearest_rays(described: &Described, frame: usize, training_frames: &[usize]) -> RayMatches {
    let frames = &described.set.frames;
    let keypoints = &frames[frame].features.keypoints;
    // One training frame at a time, so that only the products of two frames are in memory.
    let mut best: Vec<Option<(Neighbour, usize)>> = vec![None; keypoints.len()];
    for &training_frame in training_frames {
        let neighbours = described.neighbours(frame, training_frame);
        for (best, neighbour) in best.iter_mut().zip(neighbours) {
            if let Some(neighbour) = neighbour
                // Of equal distances the earlier training frame stays.
                && best.is_none_or(|(least, _)| neighbour.0 < least.0)
            {
                *best = Some((neighbour, training_frame));
            }
        }
    }
    let mut matches = RayMatches::new();
    for (keypoint, best) in keypoints.iter().zip(best) {
        let Some(((distance, feature), training_frame)) =
            best.filter(|((distance, _), _)| *distance <= described.neighbour_gate())
        else {
            continue;
        };
        let training = &frames[training_frame];
        let point = training.features.keypoints[feature].point;
        // A point beyond the fold of the lens has no ray.
        if let Ok(ray) = training.truth.ray_from_image(point) {
            matches.push(
                keypoint.point,
                &[RayCandidate {
                    ray,
                    squared_distance: distance,
                }],
            );
        }
    }
    matches
}
