//! Frames of one camera tied to each other: what the same camera shows in two of its frames, turned and zoomed.
//!
//! | what | where |
//! |---|---|
//! | [`tie_frames`], [`Tie`] | matches of two frames that one rotation and one zoom explain |
//! | [`CutFinder`] | where one shot of a video ends and the next begins |
//! | [`PointFollower`], [`carry`], [`adjust_clip`], [`smooth`] | a clip whose camera's base is known: points followed by optical flow, cameras carried from known frames to all others, adjusted together, made one motion |
//! | [`groups`] | the frames that hang together |
//! | [`hold_frames`] | the same where the base is known, from the ties and what each frame's own picture says |
//! | [`adjust_turns`], [`Turns`] | pan, tilt and focal length of every frame of a group, from the ties alone |
//!
//! Nothing here knows a field. Where no base is known, pan is counted from the middle of what the frames show, and the axis about which the camera
//! pans is taken as vertical.
//!
//! Frames, signs and units: [`touchline_core::conventions`].

mod anchor_residual;
mod axis;
mod clip;
mod cuts;
mod cycles;
mod error;
mod group;
mod held;
mod homography;
mod matches;
mod pairs;
mod start;
mod tie;
mod tie_problem;
mod tie_residual;
mod turns;

pub use anchor_residual::Hold;
pub use clip::{
    AdjustOptions, AdjustedClip, AdjustedFrame, Anchor, AnchorSource, Carried, CarryOptions, CarryStop, ClipCamera,
    ClipLens, FollowOptions, Jitter, PointFollower, PointTrack, PointTracks, SmoothOptions, Unsmoothed, adjust_clip,
    carry, smooth,
};
pub use cuts::{CutFinder, FoundCut, Miniature};
pub use error::TrackError;
pub use group::groups;
pub use held::{HeldFrame, filled, hold_frames};
pub use pairs::tie_frames;
pub use tie::Tie;
pub use turns::{TurnOptions, Turns, adjust_turns};
