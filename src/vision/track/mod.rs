//! Relative motion of one camera: matching its frames, tracking points through a clip, and
//! adjusting rotation and zoom of all frames together.
//!
//! | what | where |
//! |---|---|
//! | [`match_frames_pairwise`], [`ViewGraphEdge`] | pairwise matches: correspondences of two frames that one rotation and one zoom explain |
//! | [`find_cuts`] | where one shot of a video ends and the next begins |
//! | [`PointFollower`], [`propagate`], [`adjust_clip`], [`smooth`] | a clip whose camera has a known base: points tracked by optical flow, cameras propagated from known frames to all others, adjusted together and smoothed |
//! | [`groups`] | connected components of the view graph |
//! | [`adjust_matched_frames`] | pan, tilt and focal length of matched frames with a known base, from the matches and a prior of each frame |
//! | [`PosePrior`] | a prior of one frame in a joint adjustment |
//! | [`adjust_rotations`], [`RelativeRotations`] | pan, tilt and focal length of every frame of a connected group, from matches alone |
//!
//! # Files
//!
//! * Matching: `pairs.rs` (two frames, with `descriptor_matches.rs`, `homography.rs`), `cycles.rs`
//!   (pairs against each other).
//! * Without a base: `relative_rotations.rs` from a start by `start.rs`, with the problem in
//!   `edge_problem.rs`, its residual in `edge_residual.rs`.
//! * With a base: `pose_problem.rs` states the problem of `matched_frames.rs` and of
//!   `clip/adjust.rs`; `pose_equations.rs` and `envelope.rs` solve it; `pose_problem.rs` has its
//!   prior.
//!
//! Parameters of a frame are pan (rad), tilt (rad) and ln f: a zoom by a factor is then a step of
//! the same length everywhere, and the focal length stays positive.
//!
//! Nothing here knows a field. Without a known base, pan is measured from the mean viewing
//! direction, and the pan axis is taken as vertical.
//!
//! Frames, signs and units: [`touchline_core::conventions`].

mod clip;
mod cuts;
mod cycles;
mod descriptor_matches;
mod edge_problem;
mod edge_residual;
mod envelope;
mod homography;
mod matched_frames;
mod pairs;
mod pose_equations;
mod pose_problem;
mod relative_rotations;
mod start;

pub use clip::{AdjustOptions, AdjustedClip, FollowOptions, Jitter, PropagateOptions};
pub use cycles::{ViewGraphEdge, groups};
pub use pose_problem::AdjustedFrame;
// For the crates above alone: no promise to other programs.
#[doc(hidden)]
pub use {
    clip::{
        ClipCamera, ClipLens, PointFollower, PointTrack, PointTracks, PropagatedClip,
        PropagationStop, SmoothOptions, UnsmoothedFrame, adjust_clip, propagate, smooth,
    },
    cuts::{FoundCut, find_cuts},
    matched_frames::{adjust_matched_frames, fill_missing_cameras},
    pairs::match_frames_pairwise,
    pose_problem::{PosePrior, PriorSource},
    relative_rotations::{RelativeRotations, TurnOptions, adjust_rotations},
};

#[cfg(feature = "opencv")]
use crate::media::one_line;
use thiserror::Error;
use touchline_core::geometry::pluralise;

/// Why frames could not be matched or adjusted.
#[derive(Clone, Debug, PartialEq, Error)]
#[non_exhaustive]
pub enum TrackError {
    /// The program was built without the feature `opencv`.
    #[error(
        "this touchline was built without OpenCV and cannot match frames; build it with the feature \
         `opencv`"
    )]
    WithoutOpenCv,
    /// OpenCV returned an error.
    #[error("OpenCV could not compare two frames: {reason}")]
    OpenCv {
        /// OpenCV's message, on one line.
        reason: String,
    },
    /// Too few frames, or frames that matches do not connect.
    #[error(
        "{} with {} between them; at least 2 frames that show the same are needed",
        pluralise(*frames, "frame"), pluralise(*edges, "matched pair")
    )]
    TooFew {
        /// Number of frames to adjust.
        frames: usize,
        /// Number of pairwise matches between them.
        edges: usize,
    },
    /// No rotation and zoom explains the pairwise matches.
    #[error(
        "no camera that only rotates and zooms fits the {} of {frames} frames: the matches lie \
         {residual_px:.1} px off",
        pluralise(*edges, "matched pair")
    )]
    NotTurning {
        /// Number of frames to adjust.
        frames: usize,
        /// Number of pairwise matches between them.
        edges: usize,
        /// Median residual of the matches, px at 1920 px width.
        residual_px: f64,
    },
}

#[cfg(feature = "opencv")]
impl TrackError {
    /// OpenCV's message, with line breaks and runs of spaces collapsed.
    fn from_opencv(error: &opencv::Error) -> Self {
        Self::OpenCv {
            reason: one_line(&error.to_string()),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn counts_agree_with_their_nouns() {
        let [alone, pair] = [
            TrackError::TooFew {
                frames: 1,
                edges: 0,
            },
            TrackError::NotTurning {
                frames: 2,
                edges: 1,
                residual_px: 9.5,
            },
        ]
        .map(|error| error.to_string());
        assert_eq!(
            alone,
            "1 frame with 0 matched pairs between them; at least 2 frames that show the same are \
             needed"
        );
        assert_eq!(
            pair,
            "no camera that only rotates and zooms fits the 1 matched pair of 2 frames: the \
             matches lie 9.5 px off"
        );
    }
}
