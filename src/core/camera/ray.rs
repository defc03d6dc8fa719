//! The direction of a ray in `base` by its exact pan and tilt.

use crate::geometry::rotation::angle_between_directions;
use crate::geometry::{Angle, Vec3};

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
