//! A clip: frames of one camera that follow each other in time. What is known of some of its frames
//! is carried to all.
//!
//! | what | where |
//! |---|---|
//! | [`ClipCamera`] | the base, and lenses that are known frame by frame |
//! | [`PointFollower`], [`PointTracks`] | points followed from picture to picture by optical flow |
//! | [`carry`] | pan, tilt and focal length of every frame, one after the other, from the frames that are known |
//! | [`adjust_clip`] | all frames in one adjustment, with covariance |
//! | [`smooth`] | the frames' cameras as one smooth motion |
//!
//! # Problem
//!
//! Some frames have cameras: a person's, painted lines', a forest's (`PosePrior`). Neighbouring
//! frames show mostly the same points, and the camera between them turns and zooms. Find pan, tilt
//! and focal length of all frames, and the covariance of each. The base of the camera is known and
//! stays as it is. Where the lens of a frame is known beforehand, its focal length stays as well,
//! and pan and tilt alone are sought.
//!
//! # Method
//!
//! 1. **Following** (`follow.rs`, `flow.rs`): up to 320 corners by pyramidal Lucas–Kanade, each
//!    checked by following it back. A track ends after 60 frames at most, because it may creep.
//! 2. **Carrying** (`carry.rs`): a point is the mean direction in which frames so far saw it. The
//!    next frame's camera is the one that puts the directions where the points are, by a Cauchy
//!    loss whose scale shrinks. Points that disagree three times are of something that moves. A
//!    frame is not reached if fewer than 40 % of its points, or than 20, agree, or if these lie in
//!    a corner.
//! 3. **One adjustment** (`adjust.rs`, `../pose_problem.rs`): all cameras and all directions at
//!    once, from all sightings and priors. Directions are eliminated; what is left is a band of 3 ×
//!    3 blocks, solved by Cholesky factorisation in envelope storage (`../envelope.rs`). The same
//!    factor gives every frame's covariance. The points' noise is measured from the clip, per
//!    frame, for blur puts all points of a frame off alike.
//! 4. **Contradiction**. A lens or base that is a little off bends all points alike, which is no
//!    scatter. Where priors of people or paint lie farther off than they state, the points are
//!    taken as less exact until they do not, and the difference is spread over the frames around a
//!    prior. A forest's answers give way instead.
//! 5. **Smoothing** (`smooth.rs`), if asked for: a Rauch–Tung–Striebel smoother whose noise is what
//!    makes the clip most likely.
//!
//! `calibrate::track_clip` adds the painted lines: frames are aligned to them in rounds, and each
//! is judged where it ended.
//!
//! # What it is proof against
//!
//! Players, scrolling boards, a burnt-in graphic, a camera that stands still, motion blur. It is
//! not proof against a dissolve between two shots that hardly move: points of the second one appear
//! while those of the first fade, and only the paint tells (`calibrate/clip/fit.rs`).

mod adjust;
mod camera;
mod carry;
#[cfg(feature = "opencv")]
mod flow;
mod follow;
mod jitter;
mod point_tracks;
mod smooth;

pub use adjust::{AdjustOptions, AdjustedClip, adjust_clip};
pub use camera::{ClipCamera, ClipLens};
pub use carry::{Carried, CarryOptions, CarryStop, carry};
pub use follow::{FollowOptions, PointFollower};
pub use jitter::Jitter;
pub use point_tracks::{PointTrack, PointTracks};
pub use smooth::{SmoothOptions, Unsmoothed, smooth};
