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
mod shared_parameters;
mod size_error;
mod stated_lens;

pub use base::{BaseAngles, CameraBase};
pub use base_sigma::BaseSigma;
pub use distortion::{FocalCurve, PIXEL_ASPECTS, Radial, UndistortError};
pub use jacobian::{DirectionJacobian, ProjectionJacobian};
pub use projection::{ProjectError, PtzCamera};
pub use shared_parameters::{BaseCorrelation, SHARED_PARAMETERS, SharedCovariance, SharedError};
pub(crate) use shared_parameters::{SHARED_COLUMNS, SIZE_COLUMN};
pub use size_error::SizeError;
pub use stated_lens::{StatedLens, StatedRadial};
// For the crates above alone: no promise to other programs.
#[doc(hidden)]
pub use {
    distance::{AngularDistance, image_space_distances_px},
    distortion::undistort,
    projection::MIN_DEPTH,
};

use crate::geometry::rotation::{angle_between_directions, q_pan, q_tilt};
use crate::geometry::{Angle, Mat3, Vec3};
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
    /// From pan, tilt and the focal length, px.
    pub const fn new(pan: Angle, tilt: Angle, focal_px: f64) -> Self {
        Self {
            pan,
            tilt,
            focal_px,
        }
    }

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

/// A direction in `base`: pan α and tilt β of the ray itself, r = (sin α cos β, −sin β, cos α cos
/// β).
///
/// These are the exact angles of the direction, so one scene point has one label whichever frame
/// saw it; the angles of the paper's eq. (2) differ between frames by up to 1.6°.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct PanTilt {
    /// α, positive to the right.
    pub pan: Angle,
    /// β, positive up.
    pub tilt: Angle,
}

impl PanTilt {
    /// From degrees.
    pub const fn from_degrees(pan_deg: f64, tilt_deg: f64) -> Self {
        Self {
            pan: Angle::from_degrees(pan_deg),
            tilt: Angle::from_degrees(tilt_deg),
        }
    }

    /// The angles of a direction in `base` (any length but zero): α = atan2(x, z), β = atan2(−y,
    /// hypot(x, z)).
    pub fn from_direction(direction_in_base: Vec3) -> Self {
        let d = direction_in_base;
        Self {
            pan: Angle::from_radians(d.x.atan2(d.z)),
            tilt: Angle::from_radians((-d.y).atan2(d.x.hypot(d.z))),
        }
    }

    /// The unit direction in `base`.
    pub fn direction(self) -> Vec3 {
        let (sin_pan, cos_pan) = self.pan.sin_cos();
        let (sin_tilt, cos_tilt) = self.tilt.sin_cos();
        Vec3::new(sin_pan * cos_tilt, -sin_tilt, cos_pan * cos_tilt)
    }

    /// The angle between two rays.
    pub fn angle_to(self, other: Self) -> Angle {
        angle_between_directions(&self.direction(), &other.direction())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_direction_survives_the_round_trip() {
        for (pan, tilt) in [(0.0, 0.0), (40.0, -10.0), (-179.0, 80.0), (90.0, -89.0)] {
            let ray = PanTilt::from_degrees(pan, tilt);
            let again = PanTilt::from_direction(ray.direction() * 3.0);
            assert!(ray.angle_to(again).degrees() < 1e-12);
            assert!((again.pan.degrees() - pan).abs() < 1e-9);
        }
    }
}
