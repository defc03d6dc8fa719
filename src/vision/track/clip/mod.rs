//! A clip: consecutive frames of one camera. Cameras that are known for some of its frames are
//! propagated to all.
//!
//! | what | where |
//! |---|---|
//! | [`ClipCamera`] | the base, and lenses that are known frame by frame |
//! | [`PointFollower`], [`PointTracks`] | points tracked from picture to picture by optical flow |
//! | [`propagate`] | pan, tilt and focal length of every frame, one after the other, from the known frames |
//! | [`adjust_clip`] | all frames in one adjustment, with covariance |
//! | [`smooth`] | the cameras of all frames as one smooth motion |
//!
//! # Problem
//!
//! Some frames have cameras, from user clicks, painted lines or a forest (`PosePrior`).
//! Neighbouring frames show mostly the same points, and between them the camera rotates and zooms.
//! Find pan, tilt and focal length of all frames, and the covariance of each. The base of the
//! camera is known and held fixed. Where the lens of a frame is known beforehand, its focal length
//! is held as well, and only pan and tilt are estimated.
//!
//! # Method
//!
//! 1. **Tracking** (`follow.rs`, `flow.rs`): up to 320 corners by pyramidal Lucas–Kanade, each
//!    checked by tracking it back. A track ends after at most 60 frames, because it drifts.
//! 2. **Propagation** (`propagate/`): a point is the mean direction in which the frames so far saw
//!    it. The next frame's camera is the one that projects the directions onto the points, under a
//!    Cauchy loss whose scale shrinks. A point that disagrees three times is taken to move in the
//!    scene. A frame is not reached if fewer than 40 % of its points, or fewer than 20, agree, or
//!    if these lie in a corner.
//! 3. **Joint adjustment** (`adjust.rs`, `../pose_problem.rs`): all cameras and all directions at
//!    once, from all observations and priors. Directions are eliminated; what remains is a band of
//!    3 × 3 blocks, solved by Cholesky factorisation in envelope storage (`../envelope.rs`). The
//!    same factor gives the covariance of every frame. The noise of the points is estimated from
//!    the clip, per frame, since motion blur displaces all points of a frame alike.
//! 4. **Contradiction**. A small error of lens or base biases all points alike and does not appear
//!    in their scatter. Where priors of persons or paint lie farther off than they state, the
//!    covariance of the points is inflated until they agree, and the difference is spread over the
//!    frames around a prior. For a forest's answers it is the prior that is inflated.
//! 5. **Smoothing** (`smooth.rs`), optional: a Rauch–Tung–Striebel smoother whose noise parameters
//!    are those of maximum likelihood for the clip.
//!
//! `calibrate::track_clip` adds the painted lines: frames are aligned to them in rounds, and a
//! verdict on each follows at the end.
//!
//! # Robustness
//!
//! Robust against players, scrolling boards, a burnt-in graphic, a camera at rest, and motion blur.
//! Not robust against a dissolve between two shots that hardly move: points of the second shot
//! appear while those of the first fade, and only the paint reveals it (`calibrate/clip/fit.rs`).

mod adjust;
mod camera;
#[cfg(feature = "opencv")]
mod flow;
mod follow;
mod propagate;
mod smooth;

pub use adjust::adjust_clip;
pub use adjust::{AdjustOptions, AdjustedClip};
pub use camera::{ClipCamera, ClipLens};
pub use follow::{FollowOptions, PointFollower, PointTrack, PointTracks};
pub use propagate::{PropagateOptions, PropagatedClip, PropagationStop, propagate};
pub use smooth::{Jitter, SmoothOptions, UnsmoothedFrame, smooth};
