//! Derivatives of a projected point by all parameters that the frames of a camera share.

use crate::camera::{PtzCamera, SHARED_COLUMNS};
use crate::field::Crown;
use crate::geometry::{Vec2, Vec3};
use nalgebra::{Matrix2, Matrix2x3, SMatrix};

/// The derivatives of a projected point by all shared parameters, in the order of
/// [`crate::camera::BaseSigma::root`], from its derivatives by the base's pose, by k₁, by the world
/// point and by a shift of the picture.
pub(in crate::solve) fn by_shared(
    camera: &PtzCamera,
    by_pose: &SMatrix<f64, 2, 6>,
    by_k1: Vec2,
    by_world: &Matrix2x3<f64>,
    by_image: &Matrix2<f64>,
    point_in_world: Vec3,
) -> SMatrix<f64, 2, SHARED_COLUMNS> {
    let base = camera.base();
    let mut by = SMatrix::<f64, 2, SHARED_COLUMNS>::zeros();
    by.fixed_columns_mut::<6>(0).copy_from(by_pose);
    // The other columns would be multiplied by a σ of zero.
    if base.sigma.is_of_pose_alone() {
        return by;
    }
    // k₁ = value + slope (f − f₀) / 1000.
    let kilo_px = (camera.ptz().focal_px - base.distortion.at_focal_px) / 1000.0;
    by.set_column(6, &by_k1);
    by.set_column(7, &(by_k1 * kilo_px));
    if base.sigma.crown_m > 0.0 {
        // A higher crown lowers the ground beside the middle.
        let crown = Crown {
            height_m: 0.0,
            width_m: base.sigma.crown_width_m,
        };
        by.set_column(
            8,
            &(by_world.column(2) * -crown.drop_share(point_in_world.y)),
        );
    }
    by.fixed_columns_mut::<2>(9).copy_from(by_image);
    by
}
