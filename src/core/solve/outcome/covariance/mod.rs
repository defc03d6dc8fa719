//! How far a solution is to be trusted: covariance of pan, tilt, focal length, and 1-σ of the
//! overlay at a pixel.
//!
//! To first order the estimate errs by A (n − `J_b` δb), with click noise n, base error δb and the
//! estimator's own gain A = (Jᵀ W J)⁻¹ Jᵀ W. The overlay at a pixel p is drawn with the nominal
//! base, so it errs by `J_p` A n + (`J_pb` − `J_p` A `J_b`) δb. With K = A `J_b` and M = `J_pb` −
//! `J_p` K:
//!
//! - pan, tilt, focal: σ² A Aᵀ + K `Σ_b` Kᵀ;
//! - overlay at p: σ² `J_p` A Aᵀ `J_pᵀ` + M `Σ_b` Mᵀ.
//!
//! W weighs each click by its own σ⁻². The alternative, the inverse of σ² I + `J_b Σ_b J_bᵀ`, is
//! the same where the base is exact. Where the base is uncertain, it improves pan, tilt and focal
//! length by a few per cent, but attributes part of the misfit to a base error, while the overlay
//! is still drawn with the nominal base. The lines then miss the points that were clicked (with 0.5
//! m of base error by 8–16 px instead of 3–6 px). It is therefore not used.

mod ground;
mod overlay;

pub use ground::GroundError;
pub use overlay::CornerSigma;
pub(in crate::solve) use overlay::{OverlayPoint, corners};

use crate::camera::{CameraBase, FocalCurve, PtzCamera, SHARED_COLUMNS};
use crate::geometry::{ImagePoint, ImageSize, Mat3, Vec2, Vec3};
use crate::solve::{Observation, PtzPrior, SolveError};
use nalgebra::{Matrix2x3, SMatrix};
use overlay::all_over;

/// Normal equations worse conditioned than this, in (rad, rad, log f), leave a direction open.
const MAX_CONDITION: f64 = 1e12;

/// Depth assumed for the overlay at a pixel that shows no ground, m.
const FAR_M: f64 = 1e5;

/// The covariance of a frame's solution, with the parts of click noise and base error kept apart.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Uncertainty {
    /// σ² A Aᵀ: the clicks' part, in (pan rad, tilt rad, focal px).
    pub clicks: Mat3,
    /// K: how the solution follows an error of the base: position (m), a rotation vector in `world`
    /// (rad), k₁, its slope per 1000 px, crown (m), principal point (px), length and width of the
    /// field (m).
    pub by_base: SMatrix<f64, 3, SHARED_COLUMNS>,
    /// L: L Lᵀ is the covariance of the base and of the size in the same coordinates.
    pub base_root: SMatrix<f64, SHARED_COLUMNS, SHARED_COLUMNS>,
}

impl Uncertainty {
    /// The uncertainty of a solution, from the observations and the prior that determined it.
    ///
    /// # Errors
    /// [`SolveError::Undetermined`] if they leave a combination of the parameters undetermined.
    pub fn from_observations(
        camera: &PtzCamera,
        observations: &[Observation],
        prior: Option<&PtzPrior>,
    ) -> Result<Self, SolveError> {
        let mut information = Mat3::zeros();
        let mut cross = SMatrix::zeros();
        // The prior acts like one more observation: its information enters Jᵀ W J, and its known
        // dependence on the base enters Jᵀ W `J_b`.
        if let Some(prior) = prior {
            information += prior.information(camera.ptz().focal_px);
            cross += information * prior.by_base;
        }
        for observation in observations {
            if let Some(here) = observation.shape.jacobian(camera, observation.image) {
                add(
                    &mut information,
                    &mut cross,
                    &here.by_ptz,
                    &here.by_shared(camera),
                    observation.sigma_px.powi(-2),
                );
            }
        }

        // (Jᵀ W J)⁻¹ equals σ² A Aᵀ, since each weight is that observation's own σ⁻²; (Jᵀ W J)⁻¹ Jᵀ
        // W `J_b` is K.
        let inverse = invert_information(&information, camera.ptz().focal_px)?;
        Ok(Self {
            clicks: inverse,
            by_base: inverse * cross,
            base_root: camera.base().sigma.root(),
        })
    }

    /// The uncertainty of a camera with a given covariance of (pan rad, tilt rad, focal px) for an
    /// exact base. Its response K to an error of the base is that of a camera solved from clicks
    /// spread over the whole picture with the same base.
    ///
    /// # Errors
    /// [`SolveError::Undetermined`] if the picture shows too little.
    pub fn from_covariance(
        camera: &PtzCamera,
        covariance: Mat3,
        image_size: ImageSize,
    ) -> Result<Self, SolveError> {
        let (mut information, mut cross) = (Mat3::zeros(), SMatrix::zeros());
        for point in all_over(camera, image_size) {
            add(
                &mut information,
                &mut cross,
                &point.by_ptz,
                &point.by_base,
                1.0,
            );
        }
        let by_base = invert_information(&information, camera.ptz().focal_px)? * cross;
        Ok(Self {
            clicks: covariance,
            by_base,
            base_root: camera.base().sigma.root(),
        })
    }

    /// [`Self::from_covariance`] with the covariance in the units of documents: (pan deg, tilt deg, focal
    /// px).
    ///
    /// # Errors
    /// [`SolveError::Undetermined`] if the picture shows too little.
    pub fn from_own(
        camera: &PtzCamera,
        own_covariance_deg: &Mat3,
        image_size: ImageSize,
    ) -> Result<Self, SolveError> {
        Self::from_covariance(
            camera,
            covariance_in_radians(own_covariance_deg),
            image_size,
        )
    }

    /// Covariance of (pan rad, tilt rad, focal px), the base's part included.
    pub fn ptz_covariance(&self) -> Mat3 {
        let by_sigma = self.by_base * self.base_root;
        self.clicks + by_sigma * by_sigma.transpose()
    }

    /// Covariance of (pan deg, tilt deg, focal px), as documents hold it.
    pub fn ptz_covariance_deg(&self) -> Mat3 {
        covariance_in_degrees(&self.ptz_covariance())
    }

    /// Covariance of (pan deg, tilt deg, focal px) from the frame's own evidence, for an exact
    /// base. Documents store it beside the total, because the base's part cannot be subtracted
    /// afterwards: the difference of two nearly equal matrices is seldom positive definite.
    pub fn own_covariance_deg(&self) -> Mat3 {
        covariance_in_degrees(&self.clicks)
    }

    /// The increase of the expected χ² of the given observations that the base's uncertainty
    /// causes: the sum of |(`J_b` − J K) L|² / σ² over the observations.
    pub fn base_misfit(&self, camera: &PtzCamera, observations: &[Observation]) -> f64 {
        if self.base_root.iter().all(|entry| *entry == 0.0) {
            return 0.0;
        }
        observations
            .iter()
            .filter_map(|observation| self.base_misfit_of(camera, observation))
            .sum()
    }

    /// The part of one observation in [`Self::base_misfit`]; none where its shape has no image.
    fn base_misfit_of(&self, camera: &PtzCamera, observation: &Observation) -> Option<f64> {
        let here = observation.shape.jacobian(camera, observation.image)?;
        let squares =
            ((here.by_shared(camera) - here.by_ptz * self.by_base) * self.base_root).norm_squared();
        Some(squares / (observation.sigma_px * observation.sigma_px))
    }

    /// The same uncertainty for an exact base.
    #[must_use]
    pub fn with_exact_base(self) -> Self {
        Self {
            base_root: SMatrix::zeros(),
            ..self
        }
    }

    /// The uncertainty after one more landmark click with noise `sigma_px` at a pixel. None where
    /// the pixel has no ray.
    pub fn with_click_at(
        &self,
        camera: &PtzCamera,
        pixel: ImagePoint,
        sigma_px: f64,
    ) -> Option<Self> {
        let click = OverlayPoint::at_pixel(camera, pixel)?;
        // Recover Jᵀ W J and Jᵀ W `J_b` from their solved forms (Jᵀ W J)⁻¹ and K, then add the rows
        // of the new click.
        let mut information = self.clicks.try_inverse()?;
        let mut cross = information * self.by_base;
        add(
            &mut information,
            &mut cross,
            &click.by_ptz,
            &click.by_base,
            sigma_px.powi(-2),
        );
        let clicks = invert_information(&information, camera.ptz().focal_px).ok()?;
        Some(Self {
            clicks,
            by_base: clicks * cross,
            base_root: self.base_root,
        })
    }
}

/// Adds the rows of one click to Jᵀ W J and Jᵀ W `J_b`.
fn add(
    information: &mut Mat3,
    cross: &mut SMatrix<f64, 3, SHARED_COLUMNS>,
    by_ptz: &Matrix2x3<f64>,
    by_base: &SMatrix<f64, 2, SHARED_COLUMNS>,
    weight: f64,
) {
    let weighted = by_ptz.transpose() * weight;
    *information += weighted * by_ptz;
    *cross += weighted * by_base;
}

/// The inverse of Jᵀ W J in (rad, rad, px), if its condition number in (rad, rad, log f) is at most
/// [`MAX_CONDITION`].
fn invert_information(information: &Mat3, focal_px: f64) -> Result<Mat3, SolveError> {
    // df = f d(log f): in log f the three parameters have comparable scales, and the condition
    // number does not depend on the unit of the focal length.
    let scale = Mat3::from_diagonal(&Vec3::new(1.0, 1.0, focal_px));
    let scaled = scale * information * scale;
    let inverse = scaled
        .try_inverse()
        .filter(|inverse| inverse.iter().all(|x| x.is_finite()));
    // The product of the Frobenius norms bounds the condition number from above, without
    // eigenvalues.
    let condition = inverse.map_or(f64::INFINITY, |inverse| scaled.norm() * inverse.norm());
    match inverse {
        // Symmetric again after rounding, and back in px.
        Some(inverse) if condition <= MAX_CONDITION => {
            Ok(scale * (inverse + inverse.transpose()) * scale * 0.5)
        }
        _ => Err(SolveError::Undetermined { condition }),
    }
}

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
fn covariance_in_degrees(covariance: &Mat3) -> Mat3 {
    let degree = 1f64.to_degrees();
    let scale = Mat3::from_diagonal(&Vec3::new(degree, degree, 1.0));
    scale * covariance * scale
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::camera::{
        BaseSigma, CameraBase, FocalCurve, Ptz, SHARED_PARAMETERS, SharedCovariance, SharedError,
        SizeError,
    };
    use crate::solve::fixtures::base;
    use crate::testing::{SIZE, TestBase, base_at};

    /// Errors of which most go together.
    fn together() -> SharedCovariance {
        let mixed = SharedCovariance::from_fn(|row, column| {
            if row == column {
                0.3
            } else {
                (row as f64 - 1.7) * 0.4
            }
        });
        let sigmas = [0.1, 0.4, 0.2, 2e-3, 1e-3, 0.02, 0.05, 0.04, 12.0, 9.0];
        let scale = SharedCovariance::from_diagonal(&SharedError::from_row_slice(&sigmas));
        scale * mixed * mixed.transpose() * scale
    }

    /// The columns of the shared parameters, without that of the pan gauge.
    fn without_gauge<const ROWS: usize>(
        columns: &SMatrix<f64, ROWS, SHARED_COLUMNS>,
    ) -> SMatrix<f64, ROWS, SHARED_PARAMETERS> {
        SMatrix::from_fn(|row, column| columns[(row, if column < 5 { column } else { column + 1 })])
    }

    fn uncertainty(sigma: &BaseSigma) -> (PtzCamera, Uncertainty) {
        let camera = PtzCamera::new(
            CameraBase {
                sigma: *sigma,
                ..base()
            },
            Ptz::from_degrees(-12.0, -9.0, 2300.0),
        );
        let uncertainty = Uncertainty::from_covariance(&camera, Mat3::zeros(), SIZE).unwrap();
        (camera, uncertainty)
    }

    /// A camera with a lens that has no ray, not even near the middle of the picture.
    fn camera_without_rays() -> PtzCamera {
        let base = base().bent(-1e4);
        base.aim(-12.0, -9.0, 2300.0)
    }

    #[test]
    fn an_overlay_without_a_ray_is_unknown_and_not_certain() {
        let known = uncertainty(&BaseSigma::default()).1;
        let without_rays = camera_without_rays();
        let sigma_px = known.worst_corner_sigma_px(&without_rays, SIZE);
        assert_eq!(sigma_px, f64::INFINITY);
        assert_eq!(known.corner_sigma_px_if_known(&without_rays, SIZE), None);
        let (camera, _) = uncertainty(&BaseSigma::default());
        let unknown = Uncertainty {
            clicks: Mat3::repeat(f64::NAN),
            ..known
        };
        assert_eq!(unknown.worst_corner_sigma_px(&camera, SIZE), f64::INFINITY);
        let worst = unknown.worst_corner(&camera, SIZE).unwrap();
        assert!(
            worst.clicks_px.is_nan() && !worst.is_from_base(),
            "{worst:?}"
        );
        assert_eq!(known.worst_corner_sigma_px(&camera, SIZE), 0.0);
    }

    #[test]
    fn errors_of_the_base_go_together_in_the_overlay() {
        let covariance = together();
        let (camera, known) = uncertainty(&BaseSigma::from_covariance(&covariance, 68.0));
        for pixel in [
            ImagePoint::new(40.0, 1000.0),
            ImagePoint::new(960.0, 540.0),
            ImagePoint::new(1900.0, 600.0),
        ] {
            let point = OverlayPoint::at_pixel(&camera, pixel).unwrap();
            let moves = without_gauge(&(point.by_base - point.by_ptz * known.by_base));
            let expected = moves * covariance * moves.transpose();
            let overlay = known.overlay_at(&camera, pixel).unwrap();
            assert!(
                (overlay - expected).amax() < 1e-9 * expected.amax(),
                "{overlay} {expected}"
            );
            let sigma_px = known.overlay_sigma_px(&camera, pixel).unwrap();
            assert!(
                (sigma_px.powi(2) - expected.trace()).abs() < 1e-9 * expected.trace(),
                "{sigma_px}"
            );
        }
        let by_base = without_gauge(&known.by_base);
        let expected = by_base * covariance * by_base.transpose();
        assert!((known.ptz_covariance() - expected).amax() < 1e-9 * expected.amax());
        assert_eq!(known.with_exact_base().ptz_covariance(), Mat3::zeros());
    }

    #[test]
    fn errors_that_make_up_for_each_other_are_less_than_each_by_itself() {
        // Farther off and looking less steeply: the overlay hardly shows it.
        let (camera, alone) = uncertainty(&BaseSigma {
            position_m: Vec3::new(0.0, 0.4, 0.0),
            rotation: Vec3::new(1.6e-3, 0.0, 0.0),
            ..BaseSigma::default()
        });
        let [less, more] = [-0.95, 0.95].map(|share| {
            let mut covariance = SharedCovariance::zeros();
            (covariance[(1, 1)], covariance[(3, 3)]) = (0.4_f64.powi(2), 1.6e-3_f64.powi(2));
            covariance[(1, 3)] = share * 0.4 * 1.6e-3;
            covariance[(3, 1)] = covariance[(1, 3)];
            uncertainty(&BaseSigma::from_covariance(&covariance, 68.0))
                .1
                .worst_corner_sigma_px(&camera, SIZE)
        });
        let alone = alone.worst_corner_sigma_px(&camera, SIZE);
        assert!(
            less.min(more) < alone && alone < less.max(more),
            "{less} {alone} {more}"
        );
    }

    #[test]
    fn four_points_leave_a_camera_uncertain_whatever_its_lens() {
        let folded = camera_without_rays();
        let plain = CameraBase {
            distortion: FocalCurve::NONE,
            ..base()
        };
        let plain = PtzCamera::new(plain, folded.ptz());
        let [found, expected] =
            [&folded, &plain].map(|camera| covariance_of_four_points(camera, SIZE, 4.0));
        assert!(
            expected[(0, 0)] > 0.0 && found == expected,
            "{found} {expected}"
        );
    }

    /// A camera that was solved from clicks on the circle, on a pitch of which one length is open.
    fn of_open_length(error: SizeError) -> (PtzCamera, Uncertainty) {
        let sigma = BaseSigma {
            size: [error, SizeError::default()],
            ..BaseSigma::default()
        };
        let camera = base_at([0.0, -60.0, 18.0], SIZE).aim(0.0, -14.0, 1200.0);
        let camera = PtzCamera::new(
            CameraBase {
                sigma,
                ..*camera.base()
            },
            camera.ptz(),
        );
        let clicks = [[0.0, 9.15], [0.0, -9.15], [9.15, 0.0], [-9.15, 0.0]].map(|[x, y]| {
            let at = Vec3::new(x, y, 0.0);
            Observation::from_point(at, camera.image_from_world(at).unwrap(), 1e-3, 0)
        });
        let known = Uncertainty::from_observations(&camera, &clicks, None).unwrap();
        (camera, known)
    }

    #[test]
    fn an_end_that_was_not_seen_is_off_by_half_of_the_lengths_error() {
        let error = SizeError {
            still_m: 9.15,
            end_m: 32.35,
            ..SizeError::alone(4.0)
        };
        let (camera, known) = of_open_length(error);
        let sigma_px = |x: f64| {
            let covariance = known
                .overlay_at_world(&camera, Vec3::new(x, 0.0, 0.0))
                .unwrap();
            covariance.trace().sqrt()
        };
        let px_of_2_m = |x: f64| {
            let [one, other] = [x - 1.0, x + 1.0].map(|x| Vec3::new(x, 0.0, 0.0));
            let seen = [one, other].map(|at| camera.image_from_world(at).unwrap());
            seen[0].offset_from(seen[1]).norm()
        };
        assert!((sigma_px(41.5) / px_of_2_m(41.5) - 1.0).abs() < 0.01);
        assert!((sigma_px(-36.0) / px_of_2_m(-36.0) - 1.0).abs() < 0.01);
        // What was seen, and ground without a line that the length moves, are drawn where they are.
        assert!(sigma_px(0.0) < 0.01 && sigma_px(20.0) < 0.01);
        // On the ground a place is so many metres from the middle, whatever the length is.
        let at_end = known
            .ground_error(&camera, Vec3::new(41.5, 0.0, 0.0))
            .unwrap();
        assert!(at_end.sigma_m() < 0.01, "{at_end:?}");
    }

    #[test]
    fn a_base_that_goes_with_one_end_draws_the_rest_as_far_off() {
        let mut error = SizeError {
            still_m: 9.15,
            end_m: 32.35,
            ..SizeError::alone(4.0)
        };
        error.base_by_m[0] = 0.5;
        let base = base_at([0.0, -60.0, 18.0], SIZE);
        let sigma = BaseSigma {
            size: [error, SizeError::default()],
            ..BaseSigma::default()
        };
        let camera = CameraBase { sigma, ..base }.aim(0.0, -14.0, 1200.0);
        // Not turned with what it sees, as by clicks on both sides.
        let known = Uncertainty {
            clicks: Mat3::zeros(),
            by_base: SMatrix::zeros(),
            base_root: sigma.root(),
        };
        let sigma_px = |x: f64| {
            let covariance = known
                .overlay_at_world(&camera, Vec3::new(x, 0.0, 0.0))
                .unwrap();
            covariance.trace().sqrt()
        };
        let px_per_m = 1200.0 / 60.0_f64.hypot(18.0);
        assert!(sigma_px(41.5) < 1e-9 && sigma_px(25.0) < 1e-9);
        assert!((sigma_px(0.0) / (2.0 * px_per_m) - 1.0).abs() < 0.05);
        assert!(sigma_px(-41.5) > 1.5 * sigma_px(0.0), "twice as far off");
        assert!(
            known
                .ground_error(&camera, Vec3::zeros())
                .unwrap()
                .sigma_m()
                > 1.9
        );
    }
}
