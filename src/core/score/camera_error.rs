//! Errors of a camera's parameters.

use crate::camera::{PanTilt, PtzCamera};
use crate::geometry::rotation::angle_between;
use crate::geometry::{Angle, ImageSize, Vec3};
use serde::Serialize;

/// The errors of an estimated camera's parameters: estimate minus truth.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct CameraError {
    /// Angle between the two rotations from `world` to `cam`, never negative. It includes roll.
    #[serde(rename = "rotation_deg")]
    pub rotation: Angle,
    /// Error of the optical axis's pan. Both axes are expressed in the true camera's base, because
    /// the bases may differ.
    #[serde(rename = "pan_deg")]
    pub pan: Angle,
    /// Error of the optical axis's tilt, in the true camera's base.
    #[serde(rename = "tilt_deg")]
    pub tilt: Angle,
    /// Error of the focal length, px.
    pub focal_px: f64,
    /// Error of the focal length, per cent of the true one.
    pub focal_percent: f64,
    /// Distance between the centres of projection, m.
    pub position_m: f64,
}

/// Compares an estimated camera with the true one. Both must refer to pictures of the same size.
pub fn camera_error(truth: &PtzCamera, estimate: &PtzCamera) -> CameraError {
    // The optical axis of a camera in `world` is Rᵀ e_z. Both axes are expressed in the truth's
    // base.
    let axis = PanTilt::from_direction(
        truth.base().base_from_world
            * (estimate.cam_from_world().transpose() * Vec3::new(0.0, 0.0, 1.0)),
    );
    let true_axis =
        PanTilt::from_direction(truth.cam_from_base().transpose() * Vec3::new(0.0, 0.0, 1.0));
    let focal_px = estimate.ptz().focal_px - truth.ptz().focal_px;
    CameraError {
        rotation: angle_between(&truth.cam_from_world(), &estimate.cam_from_world()),
        pan: axis.pan.turn_from(true_axis.pan),
        tilt: axis.tilt - true_axis.tilt,
        focal_px,
        focal_percent: 100.0 * focal_px / truth.ptz().focal_px,
        position_m: (estimate.base().position_m - truth.base().position_m).norm(),
    }
}

/// The horizontal field of view of a picture, for a pinhole camera with the principal point in the
/// middle.
pub fn horizontal_view(focal_px: f64, image_size: ImageSize) -> Angle {
    Angle::from_radians(2.0 * (0.5 * f64::from(image_size.width)).atan2(focal_px))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::camera::CameraBase;
    use crate::testing::{HD, TestBase, turned_base};

    fn base(heading_deg: f64) -> CameraBase {
        turned_base([0.0, -60.0, 15.0], [heading_deg, 0.0, 0.0], HD)
    }

    #[test]
    fn errors_of_one_base_are_differences() {
        let truth = base(0.0).aim(10.0, -8.0, 2000.0);
        let estimate = base(0.0).aim(10.5, -8.25, 2100.0);
        let error = camera_error(&truth, &estimate);
        assert!((error.pan.degrees() - 0.5).abs() < 1e-12);
        assert!((error.tilt.degrees() + 0.25).abs() < 1e-12);
        assert!(
            (error.focal_px - 100.0).abs() < 1e-12 && (error.focal_percent - 5.0).abs() < 1e-12
        );
        assert!(error.position_m == 0.0);
        // A rotation of 0.5° about the vertical axis at tilt −8° moves the optical axis by 0.495°
        // and adds some roll. All of the 0.5° and the error of tilt count.
        assert!(
            (error.rotation.degrees() - 0.5f64.hypot(0.25)).abs() < 1e-3,
            "{}",
            error.rotation.degrees()
        );
    }

    #[test]
    fn another_pan_zero_is_no_error() {
        let truth = base(0.0).aim(10.0, -8.0, 2000.0);
        let estimate = base(4.0).aim(6.0, -8.0, 2000.0);
        let error = camera_error(&truth, &estimate);
        assert!(error.rotation.degrees() < 1e-9 && error.pan.degrees().abs() < 1e-9);
    }

    #[test]
    fn pans_on_both_sides_of_half_a_turn_are_near_each_other() {
        let at = |pan: f64| base(0.0).aim(pan, 0.0, 2000.0);
        assert!((camera_error(&at(179.5), &at(-179.5)).pan.degrees() - 1.0).abs() < 1e-9);
    }

    #[test]
    fn the_view_is_a_right_angle_where_the_focal_length_is_half_the_width() {
        assert!((horizontal_view(640.0, ImageSize::new(1280, 720)).degrees() - 90.0).abs() < 1e-12);
    }
}
