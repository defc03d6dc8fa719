//! Relative motion of one camera: matching its frames, tracking points through a clip, and
//! adjusting rotation and zoom of all frames together.
//!
//! | what | where |
//! |---|---|
//! | [`tie_frames`], [`Tie`] | pairwise matches: correspondences of two frames that one rotation and one zoom explain |
//! | [`CutFinder`] | where one shot of a video ends and the next begins |
//! | [`PointFollower`], [`carry`], [`adjust_clip`], [`smooth`] | a clip whose camera has a known base: points tracked by optical flow, cameras propagated from known frames to all others, adjusted together and smoothed |
//! | [`groups`] | connected components of the view graph |
//! | [`adjust_matched_frames`] | pan, tilt and focal length of matched frames with a known base, from the matches and a prior of each frame |
//! | [`PosePrior`] | a prior of one frame in a joint adjustment |
//! | [`adjust_turns`], [`Turns`] | pan, tilt and focal length of every frame of a connected group, from matches alone |
//!
//! Nothing here knows a field. Without a known base, pan is measured from the mean viewing
//! direction, and the pan axis is taken as vertical.
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
pub use cuts::{CutFinder, FoundCut, Miniature, find_cuts};
pub use error::TrackError;
pub use group::groups;
pub use matched_frames::{adjust_matched_frames, filled};
pub use pairs::tie_frames;
pub use pose_prior::{PosePrior, PriorSource};
pub use pose_problem::AdjustedFrame;
pub use tie::Tie;
pub use turns::{TurnOptions, Turns, adjust_turns};
