//! A clip: frames of one camera that follow each other in time. What is known of some of its frames is carried to all.
//!
//! | what | where |
//! |---|---|
//! | [`ClipCamera`] | the base, and lenses that are known frame by frame |
//! | [`PointFollower`], [`PointTracks`] | points followed from picture to picture by optical flow |
//! | [`carry`] | pan, tilt and focal length of every frame, one after the other, from the frames that are known |
//! | [`adjust_clip`] | all frames in one adjustment, with covariance |
//! | [`smooth`] | the frames' cameras as one smooth motion |
//!
//! The base of the camera is known and stays as it is ([`ClipCamera`]). Where the lens of a frame is known beforehand, its focal length
//! stays as well, and pan and tilt alone are sought.

mod adjust;
pub(super) mod anchor;
mod camera;
mod carry;
mod envelope;
mod equations;
#[cfg(feature = "opencv")]
mod flow;
mod follow;
mod jitter;
mod point_tracks;
mod problem;
mod smooth;

pub use adjust::{AdjustOptions, AdjustedClip, AdjustedFrame, adjust_clip};
pub use anchor::{Anchor, AnchorSource};
pub use camera::{ClipCamera, ClipLens};
pub use carry::{Carried, CarryOptions, CarryStop, carry};
pub use follow::{FollowOptions, PointFollower};
pub use jitter::Jitter;
pub use point_tracks::{PointTrack, PointTracks};
pub use smooth::{SmoothOptions, Unsmoothed, smooth};
