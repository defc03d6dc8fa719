//! The base: the parameters that are constant while the camera pans, tilts and zooms.

use super::{BaseSigma, FocalCurve, PanTilt, Ptz};
use crate::geometry::rotation::{q_pan, rotation_vector};
use crate::geometry::{Angle, ImagePoint, Mat3, Vec3};
use serde::Serialize;

/// The parameters of a fixed camera that all its frames share (C and S in section 3.1 of the
/// paper).
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct CameraBase {
    /// C: the centre of projection in `world`, m.
    pub position_m: Vec3,
    /// S: the rotation from `world` to `base`.
    #[serde(serialize_with = "crate::geometry::rows")]
    pub base_from_world: Mat3,
    /// The principal point, px.
    #[serde(rename = "principal_point_px")]
    pub principal_point: ImagePoint,
    /// k₁ by focal length.
    pub distortion: FocalCurve,
    /// The uncertainty of position and rotation.
    pub sigma: BaseSigma,
}

/// A base rotation as heading, pitch and roll.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct BaseAngles {
    /// The direction of the base's z axis seen from above; 0 is world +y, positive towards +x
    /// (clockwise).
    pub heading: Angle,
    /// The elevation of the base's z axis above the horizon.
    pub pitch: Angle,
    /// The rotation of the camera about its z axis, positive when it leans to its right.
    pub roll: Angle,
}

impl BaseAngles {
    /// The rotation `base_from_world` of these angles: roll · pitch · heading ·
    /// level-looking-along-+y.
    pub fn base_from_world(self) -> Mat3 {
        use crate::geometry::rotation::q_tilt;
        let level = Mat3::new(1.0, 0.0, 0.0, 0.0, 0.0, -1.0, 0.0, 1.0, 0.0);
        q_roll(self.roll) * q_tilt(self.pitch) * q_pan(self.heading) * level
    }

    /// The angles of a rotation. Looking straight up or down the heading is taken as zero.
    pub fn from_base_from_world(base_from_world: &Mat3) -> Self {
        // Rows of a rotation to `base` are the axes of `base` in `world`; row 2 is the view axis.
        let forward = base_from_world.row(2).transpose();
        let horizontal = forward.x.hypot(forward.y);
        // Nearly vertical, the horizontal part is rounding and has no direction.
        let heading = if horizontal < 1e-12 {
            Angle::ZERO
        } else {
            Angle::from_radians(forward.x.atan2(forward.y))
        };
        let pitch = Angle::from_radians(forward.z.atan2(horizontal));
        // What heading and pitch do not explain is a rotation about z, the roll.
        let without_roll = Self {
            heading,
            pitch,
            roll: Angle::ZERO,
        }
        .base_from_world();
        let roll_only = base_from_world * without_roll.transpose();
        Self {
            heading,
            pitch,
            roll: Angle::from_radians(roll_only[(0, 1)].atan2(roll_only[(0, 0)])),
        }
    }
}

/// The rotation about the viewing axis; positive leans the camera to its right.
fn q_roll(roll: Angle) -> Mat3 {
    let (s, c) = roll.sin_cos();
    Mat3::new(c, s, 0.0, -s, c, 0.0, 0.0, 0.0, 1.0)
}

impl CameraBase {
    /// A base that is exactly known, without distortion.
    pub fn new(position_m: Vec3, base_from_world: Mat3, principal_point: ImagePoint) -> Self {
        Self {
            position_m,
            base_from_world,
            principal_point,
            distortion: FocalCurve::NONE,
            sigma: BaseSigma::default(),
        }
    }

    /// The base rotation with a pan axis (`world`, of unit length, not along world y) in the pan
    /// gauge: at pan zero the camera looks, seen from above, along world +y.
    pub fn rotation_about(pan_axis: &Vec3) -> Mat3 {
        // The rows are the axes of `base` in `world`: right, perpendicular to world y as the gauge
        // requires; down, along −axis; forward.
        let right = Vec3::y().cross(pan_axis).normalize();
        Mat3::from_rows(&[
            right.transpose(),
            -pan_axis.transpose(),
            pan_axis.cross(&right).transpose(),
        ])
    }

    /// The same lens at the origin of the world with an identity rotation, exactly known. Its world
    /// points are directions in `base`.
    #[must_use]
    pub fn at_origin(&self) -> Self {
        Self {
            distortion: self.distortion,
            ..Self::new(Vec3::zeros(), Mat3::identity(), self.principal_point)
        }
    }

    /// The direction from the camera to a world point, in `base`, not normalised (m).
    pub fn base_from_world_point(&self, point_in_world: Vec3) -> Vec3 {
        self.base_from_world * (point_in_world - self.position_m)
    }

    /// Pan and tilt with which it looks where a camera with this rotation (`world` to `cam`) looks,
    /// and that one's focal length, px.
    #[doc(hidden)]
    pub fn ptz_like(&self, cam_from_world: &Mat3, focal_px: f64) -> Ptz {
        // The optical axis is the third row of the rotation.
        let axis = cam_from_world.row(2).transpose();
        let PanTilt { pan, tilt } = PanTilt::from_direction(self.base_from_world * axis);
        Ptz::new(pan, tilt, focal_px)
    }

    /// Whether all entries are finite.
    pub fn is_finite(&self) -> bool {
        self.position_m
            .iter()
            .chain(self.base_from_world.iter())
            .all(|x| x.is_finite())
            && self.principal_point.is_finite()
            && self.distortion.is_finite()
    }

    /// The base rotation as heading, pitch and roll.
    pub fn angles(&self) -> BaseAngles {
        BaseAngles::from_base_from_world(&self.base_from_world)
    }

    /// The same base in the pan gauge of the conventions (at pan 0 it looks, seen from above, along
    /// world +y) and the angle to add to every pan of frames solved with the old one.
    pub fn in_pan_gauge(&self) -> (Self, Angle) {
        let forward = self.base_from_world.row(2).transpose();
        let right = self.base_from_world.row(0).transpose();
        // A pan of δ rotates the forward axis to sin δ · right + cos δ · forward: choose δ so that
        // its world x is zero. Of the two solutions, take the one that looks along +y.
        let mut delta = Angle::from_radians((-forward.x).atan2(right.x));
        let turned = q_pan(delta) * self.base_from_world;
        if turned[(2, 1)] < 0.0 {
            delta = (delta + Angle::from_degrees(180.0)).wrap();
        }
        let base = Self {
            base_from_world: q_pan(delta) * self.base_from_world,
            ..*self
        };
        (base, -delta)
    }

    /// The rotation vector (in `world`, rad) that leads from another base's rotation to this one's.
    pub fn rotation_from(&self, other: &Self) -> Vec3 {
        rotation_vector(&(other.base_from_world.transpose() * self.base_from_world))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::rotation::{angle_between, q_tilt};

    #[test]
    fn angles_survive_the_round_trip_and_mean_what_they_say() {
        for (heading, pitch, roll) in [(0.0, 0.0, 0.0), (30.0, -12.0, 1.5), (-150.0, 40.0, -20.0)] {
            let angles = BaseAngles {
                heading: Angle::from_degrees(heading),
                pitch: Angle::from_degrees(pitch),
                roll: Angle::from_degrees(roll),
            };
            let again = BaseAngles::from_base_from_world(&angles.base_from_world());
            for (got, want) in [
                (again.heading, heading),
                (again.pitch, pitch),
                (again.roll, roll),
            ] {
                assert!(
                    (got.degrees() - want).abs() < 1e-9,
                    "{again:?} for {angles:?}"
                );
            }
        }
        let right_and_down = BaseAngles {
            heading: Angle::from_degrees(90.0),
            pitch: Angle::from_degrees(-10.0),
            roll: Angle::ZERO,
        };
        let forward = right_and_down.base_from_world().row(2).transpose();
        assert!(forward.x > 0.98 && forward.z < -0.17);
        let leaning = BaseAngles {
            roll: Angle::from_degrees(5.0),
            ..BaseAngles::default()
        };
        let right = leaning.base_from_world().row(0).transpose();
        assert!(right.z < 0.0, "leaning right lowers the right-hand side");
    }

    #[test]
    fn the_pan_gauge_changes_no_picture() {
        let tilted = q_tilt(Angle::from_degrees(2.0))
            * q_pan(Angle::from_degrees(-100.0))
            * BaseAngles {
                roll: Angle::from_degrees(1.0),
                ..BaseAngles::default()
            }
            .base_from_world();
        let base = CameraBase::new(
            Vec3::new(1.0, -60.0, 15.0),
            tilted,
            ImagePoint::new(640.0, 360.0),
        );
        let (gauged, added) = base.in_pan_gauge();
        let forward = gauged.base_from_world.row(2).transpose();
        assert!(forward.x.abs() < 1e-12 && forward.y > 0.0);
        let pan = Angle::from_degrees(33.0);
        let before = q_pan(pan) * base.base_from_world;
        let after = q_pan(pan + added) * gauged.base_from_world;
        assert!(angle_between(&before, &after).degrees() < 1e-9);
    }
}
