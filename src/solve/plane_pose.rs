//! A camera from four or more landmarks on the ground, nothing else known but the principal point.
//!
//! The homography of the plane z = 0 has K [r₁ r₂ t] for its columns, up to scale. Zero skew and square pixels make two
//! equations, linear in 1/f², of r₁ ⟂ r₂ and |r₁| = |r₂| (Zhang 2000, section 3.1, with a known principal point); then R and
//! the position follow.

use crate::geometry::rotation::nearest_rotation;
use crate::geometry::{HomographyError, ImagePoint, Mat3, Vec2, Vec3, homography};
use thiserror::Error;

/// A camera that one picture determines by itself.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PlanePose {
    /// The centre of projection in `world`, m.
    pub position_m: Vec3,
    /// The rotation from `world` to `cam`.
    pub cam_from_world: Mat3,
    /// The focal length, px.
    pub focal_px: f64,
}

/// Why a picture of the ground gives no camera.
#[derive(Clone, Copy, Debug, PartialEq, Error)]
#[non_exhaustive]
pub enum PlanePoseError {
    /// No homography.
    #[error(transparent)]
    Homography(#[from] HomographyError),
    /// No focal length explains the homography: the clicks are too noisy or too close together, or their names are wrong.
    #[error("no focal length explains these points (1/f² = {inverse_square:.2e} px⁻²)")]
    NoFocalLength {
        /// The least-squares solution for 1/f², px⁻².
        inverse_square: f64,
    },
}

/// The camera that shows points of the plane z = 0 (world, m) at pixels.
///
/// # Errors
/// Too few points, points on one line, or no focal length that explains them.
pub fn pose_from_plane(
    points: &[(Vec2, ImagePoint)],
    principal_point: ImagePoint,
) -> Result<PlanePose, PlanePoseError> {
    let pairs: Vec<(Vec2, Vec2)> =
        points.iter().map(|(ground, image)| (*ground, image.offset_from(principal_point))).collect();
    let h = homography(&pairs)?;
    let (h1, h2) = (h.column(0), h.column(1));
    // a · w + b = 0 with w = 1/f².
    let orthogonal = (h1.x * h2.x + h1.y * h2.y, h1.z * h2.z);
    let equal = (h1.x * h1.x + h1.y * h1.y - h2.x * h2.x - h2.y * h2.y, h1.z * h1.z - h2.z * h2.z);
    let inverse_square =
        -(orthogonal.0 * orthogonal.1 + equal.0 * equal.1) / (orthogonal.0 * orthogonal.0 + equal.0 * equal.0);
    if !(inverse_square > 0.0 && inverse_square.is_finite()) {
        return Err(PlanePoseError::NoFocalLength { inverse_square });
    }
    let focal_px = inverse_square.sqrt().recip();
    let mut columns = Mat3::from_diagonal(&Vec3::new(1.0 / focal_px, 1.0 / focal_px, 1.0)) * h;
    columns *= 2.0 / (columns.column(0).norm() + columns.column(1).norm());
    // Of the two signs the one that has the points before the camera.
    let depths: f64 = points.iter().map(|(ground, _)| (columns * Vec3::new(ground.x, ground.y, 1.0)).z).sum();
    if depths < 0.0 {
        columns = -columns;
    }
    let [r1, r2, t] = [0, 1, 2].map(|i| Vec3::from(columns.column(i)));
    let cam_from_world = nearest_rotation(&Mat3::from_columns(&[r1, r2, r1.cross(&r2)]));
    Ok(PlanePose { position_m: -(cam_from_world.transpose() * t), cam_from_world, focal_px })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::camera::{BaseAngles, CameraBase, Ptz, PtzCamera};
    use crate::geometry::rotation::angle_between;

    #[test]
    fn exact_points_give_the_camera() {
        let pp = ImagePoint::new(950.0, 545.0);
        let base = CameraBase::new(Vec3::new(5.0, -70.0, 21.0), BaseAngles::default().base_from_world(), pp);
        let camera = PtzCamera::new(base, Ptz::from_degrees(24.0, -14.0, 2100.0));
        let ground = [[36.0, 20.16], [52.5, -20.16], [36.0, -20.16], [52.5, 20.16], [41.5, 0.0]];
        let points: Vec<(Vec2, ImagePoint)> = ground
            .iter()
            .map(|&[x, y]| (Vec2::new(x, y), camera.image_from_world(Vec3::new(x, y, 0.0)).unwrap()))
            .collect();
        for points in [&points[..4], &points[..]] {
            let pose = pose_from_plane(points, pp).unwrap();
            assert!((pose.position_m - base.position_m).norm() < 1e-4, "{pose:?}");
            assert!((pose.focal_px - 2100.0).abs() < 1e-3);
            assert!(angle_between(&pose.cam_from_world, &camera.cam_from_world()).degrees() < 1e-5);
        }
        assert!(matches!(pose_from_plane(&points[..3], pp), Err(PlanePoseError::Homography(_))));
    }
}
