//! One camera: its base (position, base rotation, principal point, distortion) and a frame's pan,
//! tilt and focal length.
//!
//! Frames, signs and units: [`crate::conventions`]. `cam_from_world = Q_tilt(φ) · Q_pan(θ) ·
//! base_from_world` and `x_in_cam ∝ cam_from_world · (X − C)`. Every formula is exact. The
//! separable model of Chen, Zhu, Little (WACV 2018, eq. 2) is not used, because its errors reach 30
//! px within an ordinary frame.

mod base;
mod base_sigma;
mod distance;
mod distortion;
mod jacobian;
mod projection;
mod ray;
mod shared_parameters;

pub use base::{BaseAngles, CameraBase};
pub use base_sigma::BaseSigma;
pub use distortion::{FocalCurve, Radial, UndistortError};
pub use jacobian::{DirectionJacobian, ProjectionJacobian};
pub use projection::{ProjectError, PtzCamera};
pub use ray::PanTilt;
pub(crate) use shared_parameters::SHARED_COLUMNS;
pub use shared_parameters::{BaseCorrelation, SHARED_PARAMETERS, SharedCovariance, SharedError};
// For the crates above alone: no promise to other programs.
#[doc(hidden)]
pub use {
    distance::{AngularDistance, image_space_distances_px},
    distortion::undistort,
    projection::MIN_DEPTH,
};

use crate::geometry::rotation::{q_pan, q_tilt};
use crate::geometry::{Angle, Mat3};
use serde::Serialize;

/// The parameters of a frame beside its camera's base: pan, tilt and focal length.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Ptz {
    /// Positive to the right.
    #[serde(rename = "pan_deg")]
    pub pan: Angle,
    /// Positive up.
    #[serde(rename = "tilt_deg")]
    pub tilt: Angle,
    /// px of the frame.
    pub focal_px: f64,
}

impl Ptz {
    /// From degrees and px.
    pub const fn from_degrees(pan_deg: f64, tilt_deg: f64, focal_px: f64) -> Self {
        Self {
            pan: Angle::from_degrees(pan_deg),
            tilt: Angle::from_degrees(tilt_deg),
            focal_px,
        }
    }

    /// Whether all three are finite and the focal length is positive.
    pub fn is_finite(&self) -> bool {
        self.pan.is_finite()
            && self.tilt.is_finite()
            && self.focal_px.is_finite()
            && self.focal_px > 0.0
    }

    /// `Q_tilt` · `Q_pan`: the rotation from the frame in which pan and tilt are given, `base` as a
    /// rule, to `cam`.
    pub fn cam_from_base(&self) -> Mat3 {
        q_tilt(self.tilt) * q_pan(self.pan)
    }

    /// The value at a share (0 to 1) of the way to another: pan and tilt linear, the pan by the
    /// shorter way around; the focal length in its logarithm, so that equal ratios take equal
    /// times.
    #[must_use]
    pub fn interpolate(&self, to: &Self, share: f64) -> Self {
        Self {
            pan: interpolate_angle(self.pan, to.pan, share),
            tilt: interpolate_angle(self.tilt, to.tilt, share),
            focal_px: (self.focal_px.ln() * (1.0 - share) + to.focal_px.ln() * share).exp(),
        }
    }
}

/// The angle at a share (0 to 1) of the way to another, by the shorter way around.
fn interpolate_angle(from: Angle, to: Angle, share: f64) -> Angle {
    from + Angle::from_radians(to.turn_from(from).radians() * share)
}
