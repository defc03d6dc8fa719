//! The covariance of a camera that four points in the picture determine, for cameras of which
//! nothing else is known. Units are converted here, too.

use super::Uncertainty;
use crate::camera::{CameraBase, FocalCurve, PtzCamera};
use crate::geometry::{ImageSize, Mat3, Vec2, Vec3};
use crate::solve::Observation;

/// The accuracy assumed of a camera that states none: that of four points with this 1-σ
/// ([`covariance_of_four_points`]), px at 1920 px width. Cameras from trained programs typically have
/// errors of this size.
pub const UNSTATED_PX: f64 = 4.0;

/// A covariance of (pan deg, tilt deg, focal px), as documents hold it, in (pan rad, tilt rad,
/// focal px).
pub fn covariance_in_radians(covariance_deg: &Mat3) -> Mat3 {
    let radian = 1f64.to_radians();
    let scale = Mat3::from_diagonal(&Vec3::new(radian, radian, 1.0));
    scale * covariance_deg * scale
}

/// The covariance of (pan rad, tilt rad, focal px) of a camera that is known by four points
/// half-way to the picture's corners, each to `sigma_px`; the base taken as exact. A lens that has
/// no rays there is left out of account.
pub fn covariance_of_four_points(camera: &PtzCamera, image_size: ImageSize, sigma_px: f64) -> Mat3 {
    // Seen from the origin, a ray is a point at unit distance.
    let base = camera.base().at_origin();
    let without_lens = CameraBase {
        distortion: FocalCurve::NONE,
        ..base
    };
    // Without its lens every pixel has a ray, so that the zeros below, which would state that the
    // camera is exact, are not reached.
    [base, without_lens]
        .into_iter()
        .find_map(|base| {
            let camera = PtzCamera::new(base, camera.ptz());
            covariance_of_rays(&camera, image_size, sigma_px)
        })
        .unwrap_or_else(Mat3::zeros)
}

/// The covariance of a camera at the origin by its rays half-way to the picture's corners; none if
/// too few of these pixels have a ray.
fn covariance_of_rays(camera: &PtzCamera, image_size: ImageSize, sigma_px: f64) -> Option<Mat3> {
    // Four pixels half-way from the middle to the corners, and the directions that the camera sees
    // there.
    let quarter = Vec2::new(f64::from(image_size.width), f64::from(image_size.height)) / 4.0;
    let corners = [(-1.0, -1.0), (1.0, -1.0), (-1.0, 1.0), (1.0, 1.0)];
    let points: Vec<Observation> = (0..)
        .zip(corners)
        .filter_map(|(number, (x, y))| {
            let at = image_size
                .centre()
                .translate(Vec2::new(x, y).component_mul(&quarter));
            let ray = camera.ray_from_image(at).ok()?.direction();
            Some(Observation::from_point(ray, at, sigma_px, number))
        })
        .collect();
    let uncertainty = Uncertainty::from_observations(camera, &points, None).ok()?;
    Some(uncertainty.clicks)
}

/// The reverse of [`covariance_in_radians`].
pub(super) fn covariance_in_degrees(covariance: &Mat3) -> Mat3 {
    let degree = 1f64.to_degrees();
    let scale = Mat3::from_diagonal(&Vec3::new(degree, degree, 1.0));
    scale * covariance * scale
}
