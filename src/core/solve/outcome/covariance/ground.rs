//! The uncertainty of a solution on the ground: how far from its place a point of the pitch is put
//! that a picture shows, and how that error changes from one frame to another.
//!
//! The overlay at a ground point errs by `J_p` A n + M δb in the picture (see the room's page). A
//! consumer goes the other way, from a pixel to the ground, and is off by −`J_x`⁻¹ times that, with
//! `J_x` the derivative of the pixel by the point's x and y. Two frames of one camera share δb: of
//! its part only the difference moves a standing point. Their own errors A n are taken as
//! independent, which states too much where tracking handed them on from frame to frame.

use super::Uncertainty;
use super::overlay::OverlayPoint;
use crate::camera::{PtzCamera, SHARED_COLUMNS, SIZE_COLUMN};
use crate::geometry::Vec3;
use nalgebra::{Matrix2, SMatrix};

/// The error at a point of the ground, x and y in `world`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct GroundError {
    /// Covariance of the part that the frame's own evidence leaves, m².
    own: Matrix2<f64>,
    /// How the point moves for one σ of each independent error of the base, m.
    by_base: SMatrix<f64, 2, SHARED_COLUMNS>,
}

impl Uncertainty {
    /// The error of a ground point, taken from its pixel; none where the point has no image, or is
    /// seen edge-on.
    #[must_use]
    pub fn ground_error(&self, camera: &PtzCamera, point_in_world: Vec3) -> Option<GroundError> {
        let mut point = OverlayPoint::at_world(camera, point_in_world)?;
        // A place is so many metres from the middle of the field, wherever lines are drawn.
        point.by_base.fixed_columns_mut::<2>(SIZE_COLUMN).fill(0.0);
        let ground_by_image = point.image_by_ground.try_inverse()?;
        let by_ptz = ground_by_image * point.by_ptz;
        Some(GroundError {
            own: by_ptz * self.clicks * by_ptz.transpose(),
            by_base: ground_by_image * self.by_base_in_sigmas(&point),
        })
    }
}

impl GroundError {
    /// 1-σ of the place, m: the root of the covariance's trace, an RMS distance.
    #[must_use]
    pub fn sigma_m(&self) -> f64 {
        root(self.own.trace() + self.by_base.norm_squared())
    }

    /// 1-σ of how far the same standing point moves to its place in another frame of the same
    /// camera, m.
    #[must_use]
    pub fn sigma_of_move_m(&self, other: &Self) -> f64 {
        root((self.own + other.own).trace() + (other.by_base - self.by_base).norm_squared())
    }
}

/// The root of a variance, which rounding may leave slightly negative.
fn root(variance: f64) -> f64 {
    // `clamp` keeps what is not a number, where `max` would state certainty.
    variance.clamp(0.0, f64::INFINITY).sqrt()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::camera::{BaseSigma, CameraBase};
    use crate::geometry::{Mat3, Vec2};
    use crate::testing::{SIZE, TestBase, base_at};
    use rand::{RngExt, SeedableRng};
    use rand_distr::StandardNormal;
    use rand_pcg::Pcg64Mcg;

    /// Where a camera puts the pixel that another one shows of a ground point.
    fn moved(truth: &PtzCamera, estimate: &PtzCamera, point: Vec3) -> Vec2 {
        let pixel = truth.image_from_world(point).unwrap();
        let direction = estimate.cam_from_world().tr_mul(
            &estimate
                .cam_plane_from_image(pixel)
                .map(|ideal| Vec3::new(ideal.x, ideal.y, 1.0))
                .unwrap(),
        );
        let position = estimate.base().position_m;
        (position - direction * (position.z / direction.z) - point).xy()
    }

    #[test]
    fn drawn_errors_are_as_large_as_stated() {
        let base = base_at([0.0, -60.0, 18.0], SIZE);
        let sigma = BaseSigma {
            position_m: Vec3::new(0.2, 0.3, 0.1),
            ..BaseSigma::default()
        };
        let camera = CameraBase { sigma, ..base }.aim(8.0, -14.0, 2400.0);
        let own = Mat3::from_diagonal(&Vec3::new(4e-8, 4e-8, 4.0));
        let known = Uncertainty::from_covariance(&camera, own, SIZE).unwrap();
        let point = Vec3::new(12.0, 5.0, 0.0);
        let stated = known.ground_error(&camera, point).unwrap();
        let mut rng = Pcg64Mcg::seed_from_u64(3);
        let mut draw = |sigma: f64| sigma * rng.sample::<f64, _>(StandardNormal);
        let (mut squares, mut moves) = (0.0, 0.0);
        let count = 4000;
        for _ in 0..count {
            let off_m = Vec3::new(draw(0.2), draw(0.3), draw(0.1));
            // The camera follows the error of its base as the stated response K says.
            let follows = known.by_base.fixed_columns::<3>(0) * off_m;
            let mut errors = [0; 2].map(|_| {
                let turn = Vec3::new(draw(2e-4), draw(2e-4), draw(2.0)) - follows;
                let wrong = CameraBase {
                    position_m: base.position_m + off_m,
                    ..base
                };
                // The overlay is drawn with the nominal base: the truth is the one that differs.
                let truth = wrong.aim(
                    8.0 + turn.x.to_degrees(),
                    -14.0 + turn.y.to_degrees(),
                    2400.0 + turn.z,
                );
                moved(&truth, &camera, point)
            });
            squares += errors[0].norm_squared();
            errors[1] -= errors[0];
            moves += errors[1].norm_squared();
        }
        let [off_m, move_m] = [squares, moves].map(|sum: f64| (sum / f64::from(count)).sqrt());
        let move_stated_m = stated.sigma_of_move_m(&stated);
        assert!((off_m / stated.sigma_m() - 1.0).abs() < 0.04, "{off_m}");
        assert!((move_m / move_stated_m - 1.0).abs() < 0.04, "{move_m}");
        assert!(move_stated_m < stated.sigma_m(), "the base is common");
    }

    #[test]
    fn ground_edge_on_has_no_error() {
        let camera = base_at([0.0, -60.0, 0.0], SIZE).aim(0.0, 0.0, 2400.0);
        let known = Uncertainty {
            clicks: Mat3::identity(),
            by_base: SMatrix::zeros(),
            base_root: SMatrix::zeros(),
        };
        assert_eq!(known.ground_error(&camera, Vec3::zeros()), None);
    }
}
