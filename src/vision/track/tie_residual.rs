//! A match of two frames: the directions in which both see it should be the same.

use nalgebra::Matrix3x2;
use touchline_core::camera::{FocalCurve, PanTilt, undistort};
use touchline_core::geometry::rotation::skew;
use touchline_core::geometry::{ImagePoint, Mat3, Vec2, Vec3};

/// A frame of a camera that turns and zooms about one place.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct View {
    /// Turns coordinates of the common frame into this one's.
    pub cam_from_common: Mat3,
    pub focal_px: f64,
    pub principal_point: ImagePoint,
}

/// The direction in which a frame sees a point, `common`, unit, and how it changes.
#[derive(Clone, Copy, Debug)]
pub(super) struct Sight {
    pub direction: Vec3,
    /// By the logarithm of the focal length, the curve of k₁ followed.
    pub by_log_focal: Vec3,
    pub by_k1: Vec3,
}

impl View {
    /// Where a point of the picture lies in the common frame; none beyond the fold of the lens.
    pub fn sight(&self, at: ImagePoint, lens: &FocalCurve) -> Option<Sight> {
        let radial = lens.radial_at(self.focal_px);
        let distorted = at.offset_from(self.principal_point) / self.focal_px;
        let ideal: Vec2 = undistort(distorted, radial).ok()?;
        let radius_squared = ideal.norm_squared();
        let ideal_by = radial.by_ideal(ideal).try_inverse()?;
        let by_k1 = -(ideal_by * ideal) * lens.stretch_by_k1(self.focal_px, radius_squared);
        let by_log_focal = -(ideal_by * distorted) + by_k1 * (lens.slope_per_px() * self.focal_px);
        let in_cam = Vec3::new(ideal.x, ideal.y, 1.0);
        let length = in_cam.norm();
        let unit = in_cam / length;
        let across = (Mat3::identity() - unit * unit.transpose()) / length;
        let common_from_cam = self.cam_from_common.transpose();
        let chain: Matrix3x2<f64> = common_from_cam * across.fixed_columns::<2>(0);
        Some(Sight { direction: common_from_cam * unit, by_log_focal: chain * by_log_focal, by_k1: chain * by_k1 })
    }

    /// How far a point of the picture lies from the eye, px: a direction that is off by an angle is off in the picture by so many times
    /// that, across the radius.
    ///
    /// A focal length alone would let frames agree about everything by shrinking to nothing.
    pub fn range_px(&self, at: ImagePoint) -> f64 {
        self.focal_px.hypot(at.distance_px(self.principal_point))
    }

    /// Where the frame looks, if the common frame is upright.
    pub fn ray(&self) -> PanTilt {
        PanTilt::from_direction(self.cam_from_common.row(2).transpose())
    }

    /// The axes about which the direction of a sight turns with pan and with tilt, `common`.
    pub fn pan_and_tilt_axes(&self) -> [Vec3; 2] {
        [Vec3::y(), self.cam_from_common.row(0).transpose()]
    }
}

/// The direction's change with a turn about each of the common frame's own axes, applied before the frame's rotation.
pub(super) fn by_turn(direction: Vec3) -> Mat3 {
    skew(direction)
}

#[cfg(test)]
mod tests {
    use super::*;
    use touchline_core::geometry::Angle;
    use touchline_core::geometry::rotation::{from_rotation_vector, q_pan, q_tilt};

    fn view(pan: f64, tilt: f64, log_focal: f64) -> View {
        let cam_from_common = q_tilt(Angle::from_radians(tilt)) * q_pan(Angle::from_radians(pan));
        View { cam_from_common, focal_px: 1900.0 * log_focal.exp(), principal_point: ImagePoint::new(960.0, 540.0) }
    }

    #[test]
    fn a_sight_changes_as_its_derivatives_say() {
        let lens = FocalCurve { at_focal_px: 2000.0, value: -0.07, per_1000_px: 0.21, ..FocalCurve::NONE };
        let at = ImagePoint::new(1700.0, 130.0);
        let here = view(0.3, -0.2, 0.0).sight(at, &lens).unwrap();
        let numeric = |of: &dyn Fn(f64) -> Sight| (of(1e-6).direction - of(-1e-6).direction) / 2e-6;
        let [pan_axis, tilt_axis] = view(0.3, -0.2, 0.0).pan_and_tilt_axes();
        let by_pan = numeric(&|step| view(0.3 + step, -0.2, 0.0).sight(at, &lens).unwrap());
        let by_tilt = numeric(&|step| view(0.3, -0.2 + step, 0.0).sight(at, &lens).unwrap());
        let by_focal = numeric(&|step| view(0.3, -0.2, step).sight(at, &lens).unwrap());
        let by_k1 =
            numeric(&|step| view(0.3, -0.2, 0.0).sight(at, &FocalCurve { value: lens.value + step, ..lens }).unwrap());
        assert!((by_pan - pan_axis.cross(&here.direction)).norm() < 1e-8);
        assert!((by_tilt - tilt_axis.cross(&here.direction)).norm() < 1e-8);
        assert!((by_focal - here.by_log_focal).norm() < 1e-8);
        assert!((by_k1 - here.by_k1).norm() < 1e-8);
        for axis in 0..3 {
            let by = numeric(&|step| {
                let mut turn = Vec3::zeros();
                turn[axis] = step;
                let from = view(0.3, -0.2, 0.0);
                let turned = from.cam_from_common * from_rotation_vector(turn);
                View { cam_from_common: turned, ..from }.sight(at, &lens).unwrap()
            });
            assert!((by - by_turn(here.direction).column(axis)).norm() < 1e-8, "axis {axis}");
        }
    }
}
