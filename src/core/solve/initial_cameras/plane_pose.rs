//! A camera from four or more landmarks on the ground; only the principal point is known.
//!
//! The homography of the plane z = 0 has K [r₁ r₂ t] for its columns, up to scale. Zero skew and
//! square pixels make two equations, linear in 1/f², of r₁ ⟂ r₂ and |r₁| = |r₂| (Zhang 2000,
//! section 3.1, with a known principal point); then R and the position follow.
//!
//! This closed form does not minimise the reprojection errors: a homography has eight degrees of
//! freedom, such a camera seven. [`PlanePose::refine`] minimises them.

use crate::camera::{BaseAngles, CameraBase, FocalCurve, Ptz, PtzCamera};
use crate::geometry::rotation::{from_rotation_vector, nearest_rotation, q_pan, q_tilt, skew};
use crate::geometry::{HomographyError, ImagePoint, Mat3, Vec2, Vec3, homography};
use crate::solve::Loss;
use crate::solve::optimiser::least_squares::{BlockEquations, Problem, Stopping, minimise};
use crate::solve::optimiser::residual::{Linearised, Residual};
use nalgebra::{Matrix2x3, SMatrix, SVector, Vector2};
use thiserror::Error;

/// Maximum number of iterations.
const MAX_ITERATIONS: usize = 60;
/// A step in (rad, m, log f) below this ends the search.
const SHORT_STEP: f64 = 1e-10;
/// The longest step of the logarithm of the focal length: a factor of three.
const LONGEST_FOCAL_STEP: f64 = 1.1;

/// A camera determined by a single picture.
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
    /// No focal length explains the homography: the clicks are too noisy or too close together, or
    /// their names are wrong.
    #[error("no focal length explains these points (1/f² = {inverse_square:.2e} px⁻²)")]
    NoFocalLength {
        /// The least-squares solution for 1/f², px⁻².
        inverse_square: f64,
    },
}

impl PlanePose {
    /// The camera with a base in the pan gauge and a lens; its roll is the base's.
    pub fn camera(&self, principal_point: ImagePoint, lens: FocalCurve) -> PtzCamera {
        // cam_from_world = Q_tilt Q_pan base_from_world: heading and pitch of the camera become pan
        // and tilt, and the base is what they leave.
        let looks = BaseAngles::from_base_from_world(&self.cam_from_world);
        let cam_from_base = q_tilt(looks.pitch) * q_pan(looks.heading);
        let rotation = cam_from_base.transpose() * self.cam_from_world;
        let base = CameraBase {
            distortion: lens,
            ..CameraBase::new(self.position_m, rotation, principal_point)
        };
        let ptz = Ptz::new(looks.heading, looks.pitch, self.focal_px);
        PtzCamera::new(base, ptz)
    }

    /// The local minimum of the squared reprojection errors (px²) of `points`, from this camera as
    /// the start.
    #[must_use]
    pub fn refine(self, points: &[(Vec2, ImagePoint)], principal_point: ImagePoint) -> Self {
        let points = points.iter().map(|(ground, image)| GroundCorrespondence {
            ground_m: Vec3::new(ground.x, ground.y, 0.0),
            offset_px: image.offset_from(principal_point),
        });
        let problem = NearestPose {
            points: points.collect(),
        };
        let until = Stopping {
            max_iterations: MAX_ITERATIONS,
            short_step: SHORT_STEP,
            small_gain: 0.0,
        };
        minimise(&problem, self, until).state
    }
}

/// A point of the ground, `world`, and the offset of its pixel from the principal point.
struct GroundCorrespondence {
    ground_m: Vec3,
    offset_px: Vec2,
}

/// Rotation (rad, applied in `cam`), position (m, `world`) and logarithm of the focal length.
type PoseStep = SVector<f64, 7>;

impl GroundCorrespondence {
    /// The point in `cam`; none where the camera does not see it.
    fn in_cam(&self, pose: &PlanePose) -> Option<Vec3> {
        let seen = pose.cam_from_world * (self.ground_m - pose.position_m);
        (seen.z > 0.0).then_some(seen)
    }
}

impl Residual<2, 0, 7> for GroundCorrespondence {
    type State = PlanePose;

    fn sigma(&self) -> f64 {
        1.0
    }

    fn value(&self, pose: &PlanePose) -> Option<Vector2<f64>> {
        let seen = self.in_cam(pose)?;
        Some(seen.xy() * (pose.focal_px / seen.z) - self.offset_px)
    }

    fn linearise(&self, pose: &PlanePose) -> Option<Linearised<2, 0, 7>> {
        let seen = self.in_cam(pose)?;
        // Derivatives at the point q in `cam`. A left rotation by ω moves q by ω × q = −[q]ₓ ω; a
        // shift of the position by d moves it by −R d; in log f the image offset is its own
        // derivative.
        let (x, y) = (seen.x / seen.z, seen.y / seen.z);
        let by_seen = Matrix2x3::new(1.0, 0.0, -x, 0.0, 1.0, -y) * (pose.focal_px / seen.z);
        let at = Vector2::new(x, y) * pose.focal_px;
        let mut by_own = SMatrix::<f64, 2, 7>::zeros();
        by_own
            .fixed_columns_mut::<3>(0)
            .copy_from(&(by_seen * -skew(seen)));
        by_own
            .fixed_columns_mut::<3>(3)
            .copy_from(&(by_seen * -pose.cam_from_world));
        by_own.set_column(6, &at);
        Some(Linearised::without_shared(at - self.offset_px, by_own))
    }
}

/// The pose with the least squared reprojection errors.
struct NearestPose {
    points: Vec<GroundCorrespondence>,
}

impl Problem for NearestPose {
    type State = PlanePose;
    type Equations = BlockEquations<0, 7>;

    fn equations(&self, at: &PlanePose) -> BlockEquations<0, 7> {
        let mut equations = BlockEquations::zero();
        for point in &self.points {
            equations.add(point, at, Loss::Squared);
        }
        equations
    }

    fn apply_step(&self, from: &PlanePose, step: &PoseStep) -> PlanePose {
        apply_step(from, step)
    }
}

/// A camera after a step.
fn apply_step(from: &PlanePose, step: &PoseStep) -> PlanePose {
    PlanePose {
        cam_from_world: from_rotation_vector(step.fixed_rows::<3>(0).into()) * from.cam_from_world,
        position_m: from.position_m + step.fixed_rows::<3>(3),
        focal_px: from.focal_px * step[6].clamp(-LONGEST_FOCAL_STEP, LONGEST_FOCAL_STEP).exp(),
    }
}

/// The camera that shows points of the plane z = 0 (world, m) at pixels, in closed form.
///
/// # Errors
/// Too few points, points on one line, or no focal length that explains them.
pub fn pose_from_plane(
    points: &[(Vec2, ImagePoint)],
    principal_point: ImagePoint,
) -> Result<PlanePose, PlanePoseError> {
    let pairs: Vec<(Vec2, Vec2)> = points
        .iter()
        .map(|(ground, image)| (*ground, image.offset_from(principal_point)))
        .collect();
    let h = homography(&pairs)?;
    let (h1, h2) = (h.column(0), h.column(1));
    // K⁻¹ divides x and y of the columns h₁, h₂ by f. So r₁ · r₂ = 0 and |r₁|² − |r₂|² = 0 are two
    // equations a w + b = 0 in w = 1/f², where a is the x-y part and b the z part. Solve them by
    // least squares.
    let orthogonal = (h1.x * h2.x + h1.y * h2.y, h1.z * h2.z);
    let equal = (
        h1.x * h1.x + h1.y * h1.y - h2.x * h2.x - h2.y * h2.y,
        h1.z * h1.z - h2.z * h2.z,
    );
    let inverse_square = -(orthogonal.0 * orthogonal.1 + equal.0 * equal.1)
        / (orthogonal.0 * orthogonal.0 + equal.0 * equal.0);
    if !(inverse_square > 0.0 && inverse_square.is_finite()) {
        return Err(PlanePoseError::NoFocalLength { inverse_square });
    }

    // K⁻¹ H = λ [r₁ r₂ t]; λ is set by the mean length of r₁ and r₂, which are equal without noise.
    let focal_px = inverse_square.sqrt().recip();
    let mut columns = Mat3::from_diagonal(&Vec3::new(1.0 / focal_px, 1.0 / focal_px, 1.0)) * h;
    columns *= 2.0 / (columns.column(0).norm() + columns.column(1).norm());
    // H is known up to sign: choose the sign that puts the points in front of the camera.
    let depths: f64 = points
        .iter()
        .map(|(ground, _)| (columns * Vec3::new(ground.x, ground.y, 1.0)).z)
        .sum();
    if depths < 0.0 {
        columns = -columns;
    }

    // Noise leaves r₁ and r₂ not quite orthonormal: take the nearest rotation. The position is C =
    // −Rᵀ t.
    let [r1, r2, t] = [0, 1, 2].map(|i| Vec3::from(columns.column(i)));
    let cam_from_world = nearest_rotation(&Mat3::from_columns(&[r1, r2, r1.cross(&r2)]));
    Ok(PlanePose {
        position_m: -(cam_from_world.transpose() * t),
        cam_from_world,
        focal_px,
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::rotation::angle_between;
    use crate::testing::check_derivatives;
    use crate::testing::{TestBase, base_at};

    fn leaning() -> PtzCamera {
        let angles = BaseAngles {
            roll: crate::geometry::Angle::from_degrees(1.5),
            ..BaseAngles::default()
        };
        let base = CameraBase::new(
            Vec3::new(-8.0, -62.0, 17.0),
            angles.base_from_world(),
            ImagePoint::new(640.0, 360.0),
        );
        base.aim(-12.0, -11.0, 1800.0)
    }

    #[test]
    fn a_point_of_the_ground_moves_with_the_camera_as_its_jacobian_says() {
        let camera = leaning();
        let pose = PlanePose {
            position_m: camera.base().position_m,
            cam_from_world: camera.cam_from_world(),
            focal_px: camera.ptz().focal_px,
        };
        for ground in [[-20.0, 3.0], [-31.0, 20.0], [0.0, 34.0]] {
            let point = GroundCorrespondence {
                ground_m: Vec3::new(ground[0], ground[1], 0.0),
                offset_px: Vec2::new(12.0, -80.0),
            };
            check_derivatives(&point, |_: &SVector<f64, 0>, step| apply_step(&pose, step))
                .expect("ground");
        }
    }

    #[test]
    fn a_refined_camera_is_the_nearest_to_points_that_no_camera_shows_exactly() {
        let camera = leaning();
        let pp = camera.base().principal_point;
        let (mut points, mut exact) = (Vec::new(), Vec::new());
        for index in 0..81_u32 {
            let ground = Vec2::new(
                -35.0 + 4.0 * f64::from(index % 9),
                -5.0 + 4.0 * f64::from(index / 9),
            );
            let Ok(image) = camera.image_from_world(Vec3::new(ground.x, ground.y, 0.0)) else {
                continue;
            };
            // The picture a little sheared, as homographies without a camera are.
            exact.push((ground, image));
            points.push((
                ground,
                ImagePoint::new(image.x + 0.02 * (image.y - pp.y), image.y),
            ));
        }
        let rms_px = |pose: &PlanePose, points: &[(Vec2, ImagePoint)]| {
            let squared = |(ground, image): &(Vec2, ImagePoint)| {
                let shown = GroundCorrespondence {
                    ground_m: Vec3::new(ground.x, ground.y, 0.0),
                    offset_px: image.offset_from(pp),
                };
                shown.value(pose).unwrap().norm_squared()
            };
            (points.iter().map(squared).sum::<f64>() / points.len() as f64).sqrt()
        };
        let closed = pose_from_plane(&points, pp).unwrap();
        let refined = closed.refine(&points, pp);
        assert!(
            rms_px(&refined, &points) < 0.7 * rms_px(&closed, &points),
            "{closed:?} {refined:?}"
        );
        for parameter in 0..7 {
            for side in [-1e-4, 1e-4] {
                let mut step = PoseStep::zeros();
                step[parameter] = side;
                assert!(
                    rms_px(&apply_step(&refined, &step), &points)
                        >= rms_px(&refined, &points) - 1e-12
                );
            }
        }
        let of_exact = pose_from_plane(&exact, pp).unwrap().refine(&exact, pp);
        assert!(
            (of_exact.position_m - camera.base().position_m).norm() < 1e-6,
            "{of_exact:?}"
        );
    }

    #[test]
    fn exact_points_give_the_camera() {
        let pp = ImagePoint::new(950.0, 545.0);
        let base = base_at([5.0, -70.0, 21.0], pp);
        let camera = base.aim(24.0, -14.0, 2100.0);
        let ground = [
            [36.0, 20.16],
            [52.5, -20.16],
            [36.0, -20.16],
            [52.5, 20.16],
            [41.5, 0.0],
        ];
        let points: Vec<(Vec2, ImagePoint)> = ground
            .iter()
            .map(|&[x, y]| {
                (
                    Vec2::new(x, y),
                    camera.image_from_world(Vec3::new(x, y, 0.0)).unwrap(),
                )
            })
            .collect();
        for points in [&points[..4], &points[..]] {
            let pose = pose_from_plane(points, pp).unwrap();
            assert!(
                (pose.position_m - base.position_m).norm() < 1e-4,
                "{pose:?}"
            );
            assert!((pose.focal_px - 2100.0).abs() < 1e-3);
            assert!(angle_between(&pose.cam_from_world, &camera.cam_from_world()).degrees() < 1e-5);
        }
        assert!(matches!(
            pose_from_plane(&points[..3], pp),
            Err(PlanePoseError::Homography(_))
        ));
    }
}
