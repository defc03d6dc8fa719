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
#[cfg(feature = "opencv")]
mod flow;
mod follow;
mod propagate;
mod smooth;

pub use adjust::{AdjustOptions, AdjustedClip, adjust_clip};
pub use follow::{FollowOptions, PointFollower, PointTrack, PointTracks};
pub use propagate::{PropagateOptions, PropagatedClip, PropagationStop, propagate};
pub use smooth::{Jitter, SmoothOptions, UnsmoothedFrame, smooth};

use touchline_core::camera::{CameraBase, FocalCurve, Ptz, PtzCamera};
use touchline_core::geometry::ImagePoint;

/// The camera of a clip.
///
/// All frames share position and rotation of the base. They also share its lens, except frames with
/// a known lens of their own, as a zoom encoder or the provider of a recording states it frame by
/// frame.
#[derive(Clone, Debug, PartialEq)]
pub struct ClipCamera {
    base: CameraBase,
    lenses: Vec<Option<ClipLens>>,
}

/// The lens of one frame, known beforehand.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ClipLens {
    /// Principal point, px.
    pub principal_point: ImagePoint,
    /// Radial distortion as a function of the focal length.
    pub distortion: FocalCurve,
    /// The focal length, px; `None` where it is estimated with pan and tilt.
    pub focal_px: Option<f64>,
}

impl ClipCamera {
    /// A camera with one lens for all frames.
    pub const fn new(base: CameraBase) -> Self {
        Self {
            base,
            lenses: Vec::new(),
        }
    }

    /// A camera with a lens per frame, by the frame's index in the clip. Frames without one, and
    /// those beyond the list, have the lens of the base.
    pub const fn with_lenses(base: CameraBase, lenses: Vec<Option<ClipLens>>) -> Self {
        Self { base, lenses }
    }

    /// The base.
    pub const fn base(&self) -> &CameraBase {
        &self.base
    }

    /// The lenses of its frames; frames beyond the list have that of the base.
    pub fn lenses(&self) -> &[Option<ClipLens>] {
        &self.lenses
    }

    fn lens_at(&self, frame: usize) -> Option<&ClipLens> {
        self.lenses.get(frame)?.as_ref()
    }

    /// The base with the lens of a frame.
    pub fn base_at(&self, frame: usize) -> CameraBase {
        let Some(lens) = self.lens_at(frame) else {
            return self.base;
        };
        CameraBase {
            principal_point: lens.principal_point,
            distortion: lens.distortion,
            ..self.base
        }
    }

    /// The focal length of a frame, where it is known, px.
    pub fn focal_px_at(&self, frame: usize) -> Option<f64> {
        self.lens_at(frame)?.focal_px
    }

    /// `ptz` with the frame's focal length where that is known.
    pub fn with_known_focal(&self, frame: usize, ptz: Ptz) -> Ptz {
        Ptz {
            focal_px: self.focal_px_at(frame).unwrap_or(ptz.focal_px),
            ..ptz
        }
    }

    /// The camera of a frame, positioned at the origin, so that it projects directions of `base`.
    fn at_origin(&self, frame: usize, ptz: Ptz) -> PtzCamera {
        PtzCamera::new(self.base_at(frame).at_origin(), ptz)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use touchline_core::testing::base_at;

    #[test]
    fn a_frame_has_its_own_lens_or_that_of_the_base() {
        let middle = ImagePoint::new(960.0, 540.0);
        let base = base_at([0.0, -70.0, 15.0], middle);
        let lens = ClipLens {
            principal_point: ImagePoint::new(970.0, 530.0),
            distortion: FocalCurve::constant(0.3),
            focal_px: Some(3000.0),
        };
        let sought = ClipLens {
            focal_px: None,
            ..lens
        };
        let camera = ClipCamera::with_lenses(base, vec![None, Some(lens), Some(sought)]);
        assert_eq!((camera.base_at(0), camera.base_at(7)), (base, base));
        assert_eq!(camera.base_at(1).principal_point, lens.principal_point);
        assert_eq!(camera.base_at(2), camera.base_at(1));
        let ptz = Ptz::from_degrees(3.0, -10.0, 2000.0);
        let focal_px = |frame| camera.with_known_focal(frame, ptz).focal_px;
        assert_eq!(
            [focal_px(0), focal_px(1), focal_px(2)],
            [2000.0, 3000.0, 2000.0]
        );
    }
}
