//! The prior of a frame's pan, tilt and focal length, their ranges, and what else a solve knows.

use super::motion_prior::PtzRanges;
use crate::camera::{Ptz, PtzCamera, SHARED_COLUMNS};
use crate::geometry::{Angle, ImageSize, Mat3, Vec3};
use crate::solve::optimiser::residual::{Linearised, Residual};
use crate::solve::{Loss, MotionPrior};
use nalgebra::SMatrix;

/// A Gaussian prior of pan, tilt and focal length, each with its 1-σ and without correlations.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PtzPrior {
    /// The mean.
    pub ptz: Ptz,
    /// 1-σ of the pan.
    pub sigma_pan: Angle,
    /// 1-σ of the tilt.
    pub sigma_tilt: Angle,
    /// 1-σ of the focal length as a share of it.
    pub sigma_focal_share: f64,
    /// The derivative of the mean by an error of the base, in the columns of
    /// [`Uncertainty::by_base`]; zero where the mean was not computed with that base.
    ///
    /// [`Uncertainty::by_base`]: crate::solve::Uncertainty::by_base
    pub by_base: SMatrix<f64, 3, SHARED_COLUMNS>,
}

impl PtzPrior {
    /// 1 / σ of (pan rad, tilt rad, log f).
    fn inverse_sigmas(&self) -> Vec3 {
        Vec3::new(
            self.sigma_pan.radians(),
            self.sigma_tilt.radians(),
            self.sigma_focal_share,
        )
        .map(f64::recip)
    }

    /// Its information on (pan rad, tilt rad, focal px) at a focal length.
    pub(in crate::solve) fn information(&self, focal_px: f64) -> Mat3 {
        // σ of f is f times σ of log f.
        let inverse = self
            .inverse_sigmas()
            .component_div(&Vec3::new(1.0, 1.0, focal_px));
        Mat3::from_diagonal(&inverse.component_mul(&inverse))
    }
}

/// Three residuals, in sigmas.
impl Residual<3, 0, 3> for PtzPrior {
    type State = PtzCamera;

    fn sigma(&self) -> f64 {
        1.0
    }

    fn value(&self, camera: &PtzCamera) -> Option<Vec3> {
        // The pan by the shorter way around: a prior at 179° pulls a pan of −179° by two degrees.
        let ptz = camera.ptz();
        let off = Vec3::new(
            ptz.pan.turn_from(self.ptz.pan).radians(),
            (ptz.tilt - self.ptz.tilt).radians(),
            (ptz.focal_px / self.ptz.focal_px).ln(),
        );
        Some(off.component_mul(&self.inverse_sigmas()))
    }

    fn linearise(&self, camera: &PtzCamera) -> Option<Linearised<3, 0, 3>> {
        let by_own = Mat3::from_diagonal(&self.inverse_sigmas());
        Some(Linearised::without_shared(self.value(camera)?, by_own))
    }

    fn loss(&self, _: Loss) -> Loss {
        // A robust loss is for wrong names; a prior has none.
        Loss::Squared
    }
}

/// Clicks cannot decide between two candidates whose χ² differ by less than this (times its
/// expectation): five sigmas, since a base is never exact.
pub(in crate::solve) const SAME_FIT: f64 = 25.0;

/// Knowledge about a frame beside its clicks and its camera's base.
#[derive(Clone, Debug, PartialEq)]
pub struct SolveContext {
    /// The size of the frame.
    pub image_size: ImageSize,
    /// The plausible range of this camera; candidates outside are chosen only if there is no other.
    pub ranges: PtzRanges,
    /// Cameras of solved frames before and after, nearest first. They decide between candidates,
    /// and are starts where the clicks alone have no closed form. They are not part of the cost.
    pub neighbours: Vec<Ptz>,
    /// The usual motion of this camera. It decides where the clicks cannot, and an unusual result
    /// gives a warning. It is not part of the cost.
    pub motion: MotionPrior,
    /// A start, for example the solution before a click was moved. Like `neighbours`, it is not
    /// part of the cost.
    pub start: Option<Ptz>,
    /// The robust loss of the clicks.
    pub loss: Loss,
    /// A prior of pan, tilt and focal length, such as a neighbour's solution and its motion. It is
    /// part of the cost: three more equations.
    pub prior: Option<PtzPrior>,
}

impl SolveContext {
    /// A context with the frame's size alone.
    pub fn new(image_size: ImageSize) -> Self {
        Self {
            image_size,
            ranges: PtzRanges::for_size(image_size),
            neighbours: Vec::new(),
            motion: MotionPrior::default(),
            start: None,
            loss: Loss::default(),
            prior: None,
        }
    }

    /// The camera that decides between equally good candidates: the start, else the nearest
    /// neighbour, else the prior.
    pub(in crate::solve) fn expected_ptz(&self) -> Option<Ptz> {
        self.start
            .or(self.neighbours.first().copied())
            .or(self.prior.map(|prior| prior.ptz))
    }
}
