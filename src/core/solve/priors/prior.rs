//! The prior of a frame's pan, tilt and focal length.

use crate::camera::{Ptz, PtzCamera, SHARED_COLUMNS};
use crate::field::FieldElement;
use crate::geometry::{Angle, Mat3, Vec3};
use crate::solve::Loss;
use crate::solve::optimiser::residual::{Linearised, Residual};
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

    fn element(&self) -> Option<FieldElement> {
        None
    }

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
        Some(Linearised {
            value: self.value(camera)?,
            by_shared: SMatrix::zeros(),
            by_own,
        })
    }

    fn loss(&self, _: Loss) -> Loss {
        // A robust loss is for wrong names; a prior has none.
        Loss::Squared
    }
}
