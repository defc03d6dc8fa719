//! Pan and tilt from one point, focal length known (appendix 6.2 of the paper, made total).
//!
//! With b the unit direction to the point in `base`, u that of its pixel in `cam` and h =
//! hypot(`b_x`, `b_z`):
//!
//! θ = atan2(`b_x`, `b_z`) − asin(`u_x` / h), φ = atan2(`u_y`, `u_z`) − atan2(`b_y`, √(h² −
//! `u_x`²)).
//!
//! This is the solution of the paper's quadratic in tan(pan), but without its division by the
//! pixel's x, which is zero on the picture's vertical centre line. The other branch of the arcsine
//! gives a camera that is upside down.

use crate::camera::{CameraBase, Ptz, PtzCamera, UndistortError};
use crate::geometry::{Angle, ImagePoint, Vec2, Vec3};
use std::f64::consts::PI;
use thiserror::Error;

/// Why one point gives no pan and tilt.
#[derive(Clone, Copy, Debug, PartialEq, Error)]
#[non_exhaustive]
pub enum OnePointError {
    /// The point is so steeply above or below the camera that no pan brings it to that column.
    #[error(
        "no pan brings a point at tilt {tilt_deg:.2}° to a pixel {column_deg:.2}° beside the optical axis"
    )]
    OutOfReach {
        /// The tilt of the point's ray, degrees.
        tilt_deg: f64,
        /// The angle of the pixel's column beside the optical axis, degrees.
        column_deg: f64,
    },
    /// The pixel lies beyond the fold of the lens model.
    #[error(transparent)]
    Undistort(#[from] UndistortError),
}

/// Pan and tilt that bring a direction (in `base`, any length but zero) to an ideal point on the
/// plane z = 1 of `cam`.
///
/// # Errors
/// [`OnePointError::OutOfReach`] near the poles of the pan axis, and for a direction that is zero or
/// not finite.
pub fn pan_tilt_from_one_ray(
    direction_in_base: Vec3,
    ideal_in_cam: Vec2,
) -> Result<(Angle, Angle), OnePointError> {
    // A zero direction normalises to NaN, which the negated comparison rejects.
    let b = direction_in_base.normalize();
    let u = Vec3::new(ideal_in_cam.x, ideal_in_cam.y, 1.0).normalize();
    let horizontal = b.x.hypot(b.z);
    if !(u.x.abs() <= horizontal && horizontal > 0.0) {
        return Err(OnePointError::OutOfReach {
            tilt_deg: (-b.y).atan2(horizontal).to_degrees(),
            column_deg: u.x.asin().to_degrees(),
        });
    }
    let [in_front, _] = pan_tilts_from_directions(b, u);
    Ok(in_front)
}

/// The two pairs of pan and tilt that turn a unit direction in `base` into one in `cam`; NaN where
/// none does. For the direction of a point in front of the camera, the second camera is upside
/// down; for the normal of a plane either may be the right one.
pub(super) fn pan_tilts_from_directions(in_base: Vec3, in_cam: Vec3) -> [(Angle, Angle); 2] {
    let (b, u) = (in_base, in_cam);
    // After the pan, x of the direction must be `u_x`: h sin(α − θ) = `u_x`, with α the direction's
    // own pan.
    let horizontal = b.x.hypot(b.z);
    let to_column = (u.x / horizontal).asin();
    // The tilt is the angle from the direction (y, z) = (`b_y`, ±√(h² − `u_x`²)) to the pixel's.
    // The product form of h² − u² does not cancel for u near h.
    let ahead = ((horizontal - u.x) * (horizontal + u.x)).sqrt();
    [(to_column, ahead), (PI - to_column, -ahead)].map(|(to_column, ahead)| {
        let pan = b.x.atan2(b.z) - to_column;
        let tilt = u.y.atan2(u.z) - b.y.atan2(ahead);
        (
            Angle::from_radians(pan).wrap(),
            Angle::from_radians(tilt).wrap(),
        )
    })
}

/// Pan and tilt that bring a world point to a pixel at a given focal length, distortion included.
///
/// # Errors
/// The pixel has no ray, or no pan and tilt reach it.
pub fn pan_tilt_from_one_point(
    base: &CameraBase,
    focal_px: f64,
    point_in_world: Vec3,
    image: ImagePoint,
) -> Result<Ptz, OnePointError> {
    let lens = PtzCamera::new(*base, Ptz::from_degrees(0.0, 0.0, focal_px));
    let ideal = lens.cam_plane_from_image(image)?;
    let (pan, tilt) = pan_tilt_from_one_ray(base.base_from_world_point(point_in_world), ideal)?;
    Ok(Ptz::new(pan, tilt, focal_px))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::testing::{SIZE, TestBase, turned_base};
    use proptest::prelude::*;

    fn base(k1: f64) -> CameraBase {
        turned_base([2.0, -60.0, 18.0], [0.0, 1.0, 0.0], SIZE).bent(k1)
    }

    proptest! {
        #[test]
        fn pan_and_tilt_come_back(
            pan in -170.0..170.0f64, tilt in -60.0..20.0f64, focal in 1000.0..8000.0f64, k1 in -0.1..0.2f64,
            x in 0.0..1920.0f64, y in 0.0..1080.0f64,
        ) {
            let truth = Ptz::from_degrees(pan, tilt, focal);
            let camera = PtzCamera::new(base(k1), truth);
            let image = ImagePoint::new(x, y);
            let point = camera.base().position_m + camera.world_direction_from_image(image).unwrap() * 70.0;
            let found = pan_tilt_from_one_point(camera.base(), focal, point, image).unwrap();
            prop_assert!(found.pan.turn_from(truth.pan).abs().radians() < 1e-10);
            prop_assert!((found.tilt - truth.tilt).abs().radians() < 1e-10);
        }
    }

    #[test]
    fn a_click_on_the_principal_point_is_an_ordinary_case() {
        let base = base(-0.05);
        let found =
            pan_tilt_from_one_point(&base, 2000.0, Vec3::zeros(), base.principal_point).unwrap();
        let camera = PtzCamera::new(base, found);
        assert!(
            camera
                .image_from_world(Vec3::zeros())
                .unwrap()
                .distance_px(base.principal_point)
                < 1e-9
        );
    }

    #[test]
    fn straight_below_the_camera_is_out_of_reach_beside_the_axis() {
        let straight_down = Vec3::new(0.0, 1.0, 0.0);
        let error = pan_tilt_from_one_ray(straight_down, Vec2::new(0.2, 0.0)).unwrap_err();
        assert!(matches!(error, OnePointError::OutOfReach { tilt_deg, .. } if tilt_deg < -89.0));
        assert!(pan_tilt_from_one_ray(Vec3::zeros(), Vec2::zeros()).is_err());
    }
}
