//! Frames of one camera tied to each other: what the same camera shows in two of its frames, turned
//! and zoomed.
//!
//! | what | where |
//! |---|---|
//! | [`tie_frames`], [`Tie`] | matches of two frames that one rotation and one zoom explain |
//! | [`CutFinder`] | where one shot of a video ends and the next begins |
//! | [`PointFollower`], [`carry`], [`adjust_clip`], [`smooth`] | a clip whose camera's base is known: points followed by optical flow, cameras carried from known frames to all others, adjusted together, made one motion |
//! | [`groups`] | the frames that hang together |
//! | [`adjust_matched_frames`] | pan, tilt and focal length of tied frames whose base is known, from the ties and what each frame's own picture says |
//! | [`PosePrior`] | what is known of one frame before frames are adjusted together |
//! | [`adjust_turns`], [`Turns`] | pan, tilt and focal length of every frame of a group, from the ties alone |
//!
//! Nothing here knows a field. Where no base is known, pan is counted from the middle of what the
//! frames show, and the axis about which the camera pans is taken as vertical.
//!
//! Frames, signs and units: [`touchline_core::conventions`].

mod axis;
mod clip;
mod cuts;
mod cycles;
mod envelope;
mod error;
mod group;
mod homography;
mod matched_frames;
mod matches;
mod pairs;
mod pose_equations;
mod pose_prior;
mod pose_problem;
mod start;
mod tie;
mod tie_problem;
mod tie_residual;
mod turns;

pub use clip::{
    AdjustOptions, AdjustedClip, Carried, CarryOptions, CarryStop, ClipCamera, ClipLens,
    FollowOptions, Jitter, PointFollower, PointTrack, PointTracks, SmoothOptions, Unsmoothed,
    adjust_clip, carry, smooth,
};
pub use cuts::{CutFinder, FoundCut, Miniature};
pub use error::TrackError;
pub use group::groups;
pub use matched_frames::{adjust_matched_frames, filled};
pub use pairs::tie_frames;
pub use pose_prior::{PosePrior, PriorSource};
pub use pose_problem::AdjustedFrame;
pub use tie::Tie;
pub use turns::{TurnOptions, Turns, adjust_turns};
