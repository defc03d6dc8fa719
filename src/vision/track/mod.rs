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
//! * Matching: `pairs.rs` (two frames), `cycles.rs` (pairs against each other).
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
mod edge_problem;
mod edge_residual;
mod envelope;
mod error;
mod matched_frames;
mod pairs;
mod pose_equations;
mod pose_problem;
mod relative_rotations;
mod start;

pub use clip::{AdjustOptions, AdjustedClip, FollowOptions, Jitter, PropagateOptions};
pub use cycles::ViewGraphEdge;
pub use cycles::groups;
pub use error::TrackError;
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
