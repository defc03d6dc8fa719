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

use crate::camera::{CameraBase, FocalCurve, PtzCamera, SHARED_COLUMNS};
use crate::geometry::{ImagePoint, ImageSize, Mat3, Vec2, Vec3};
use crate::solve::observations::shared_columns::by_shared;
use crate::solve::{Observation, PtzPrior, SolveError};
use nalgebra::{Matrix2, Matrix2x3, SMatrix};

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
    /// (rad), k₁, its slope per 1000 px, crown (m), principal point (px).
    pub by_base: SMatrix<f64, 3, SHARED_COLUMNS>,
    /// L: L Lᵀ is the covariance of the base in the same coordinates.
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
    #[must_use]
    pub fn ptz_covariance(&self) -> Mat3 {
        let by_sigma = self.by_base * self.base_root;
        self.clicks + by_sigma * by_sigma.transpose()
    }

    /// Covariance of (pan deg, tilt deg, focal px), as documents hold it.
    #[must_use]
    pub fn ptz_covariance_deg(&self) -> Mat3 {
        covariance_in_degrees(&self.ptz_covariance())
    }

    /// Covariance of (pan deg, tilt deg, focal px) from the frame's own evidence, for an exact
    /// base. Documents store it beside the total, because the base's part cannot be subtracted
    /// afterwards: the difference of two nearly equal matrices is seldom positive definite.
    #[must_use]
    pub fn own_covariance_deg(&self) -> Mat3 {
        covariance_in_degrees(&self.clicks)
    }

    /// The increase of the expected χ² of the given observations that the base's uncertainty
    /// causes: the sum of |(`J_b` − J K) L|² / σ² over the observations.
    #[must_use]
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

    /// Covariance (px²) of the overlay at a world point; none where the point has no image.
    #[must_use]
    pub fn overlay_at_world(
        &self,
        camera: &PtzCamera,
        point_in_world: Vec3,
    ) -> Option<Matrix2<f64>> {
        let point = OverlayPoint::at_world(camera, point_in_world)?;
        let by_base = self.by_base_in_sigmas(&point);
        Some(point.by_ptz * self.clicks * point.by_ptz.transpose() + by_base * by_base.transpose())
    }

    /// Covariance (px²) of the overlay at a pixel: at the ground point that it shows, or at a
    /// distant point above the horizon. None beyond the fold of the distortion model.
    #[must_use]
    pub fn overlay_at(&self, camera: &PtzCamera, pixel: ImagePoint) -> Option<Matrix2<f64>> {
        self.overlay_at_world(camera, world_point_from_image(camera, pixel)?)
    }

    /// 1-σ of the overlay at a pixel, px: the root of the covariance's trace, an RMS distance.
    #[must_use]
    pub fn overlay_sigma_px(&self, camera: &PtzCamera, pixel: ImagePoint) -> Option<f64> {
        OverlayPoint::at_pixel(camera, pixel).map(|point| self.sigma_px(&point))
    }

    /// The largest [`Self::overlay_sigma_px`] of the frame's four corners; a corner beyond the fold
    /// of the distortion model is moved towards the principal point until it has a ray. Infinite
    /// where that gives no corner a ray: nothing is known of such an overlay.
    #[must_use]
    pub fn worst_corner_sigma_px(&self, camera: &PtzCamera, image_size: ImageSize) -> f64 {
        self.worst_sigma_px(&corners(camera, image_size))
    }

    /// The same as documents state it, which cannot express that it is infinite: none then.
    #[must_use]
    pub fn corner_sigma_px_if_known(
        &self,
        camera: &PtzCamera,
        image_size: ImageSize,
    ) -> Option<f64> {
        Some(self.worst_corner_sigma_px(camera, image_size)).filter(|sigma_px| sigma_px.is_finite())
    }

    /// Where the 1-σ at the frame's worst corner comes from.
    #[must_use]
    pub fn worst_corner(&self, camera: &PtzCamera, image_size: ImageSize) -> Option<CornerSigma> {
        let corners = image_size
            .corners()
            .into_iter()
            .zip(corners(camera, image_size))
            .filter_map(|(corner, point)| Some(self.corner_sigma(corner, &point?)));
        corners.max_by(|a, b| a.sigma_px().total_cmp(&b.sigma_px()))
    }

    /// The 1-σ at a corner, px, split by cause; `point` is the overlay point there.
    fn corner_sigma(&self, corner: ImagePoint, point: &OverlayPoint) -> CornerSigma {
        // Rounding may leave the trace of a nearly singular covariance slightly negative; `clamp`
        // keeps one that is not a number, where `max` would state certainty.
        let by_clicks = point.by_ptz * self.clicks * point.by_ptz.transpose();
        let by_base = self.by_base_in_sigmas(point);
        CornerSigma {
            corner,
            clicks_px: by_clicks.trace().clamp(0.0, f64::INFINITY).sqrt(),
            base_px: by_base.norm(),
        }
    }

    /// The largest 1-σ of the overlay at some points, px; infinite without a point, and where one
    /// is not a number.
    pub(super) fn worst_sigma_px(&self, points: &[Option<OverlayPoint>]) -> f64 {
        // `f64::max` ignores NaN, and the result would state certainty.
        points
            .iter()
            .flatten()
            .map(|point| self.sigma_px(point))
            .map(|sigma_px| {
                if sigma_px.is_nan() {
                    f64::INFINITY
                } else {
                    sigma_px
                }
            })
            .reduce(f64::max)
            .unwrap_or(f64::INFINITY)
    }

    /// 1-σ of the overlay at a point, px.
    fn sigma_px(&self, point: &OverlayPoint) -> f64 {
        // The trace of σ² `J_p` A Aᵀ `J_pᵀ`, column by column. x and y are computed side by side as
        // a vector, because this is evaluated at every pixel of a heat map.
        let by_ptz: [Vec2; 3] =
            std::array::from_fn(|column| point.by_ptz.column(column).into_owned());
        let mut variances = Vec2::zeros();
        for (column, by) in by_ptz.iter().enumerate() {
            let clicks = self.clicks.fixed_view::<3, 1>(0, column);
            let covariance = by_ptz[0] * clicks[0] + by_ptz[1] * clicks[1] + by_ptz[2] * clicks[2];
            variances += covariance.component_mul(by);
        }

        // M = `J_pb` − `J_p` K, column by column.
        let by_base: [Vec2; SHARED_COLUMNS] = std::array::from_fn(|column| {
            let follows = self.by_base.fixed_view::<3, 1>(0, column);
            point.by_base.column(column)
                - (by_ptz[0] * follows[0] + by_ptz[1] * follows[1] + by_ptz[2] * follows[2])
        });

        // The trace of M L (M L)ᵀ.
        for column in 0..SHARED_COLUMNS {
            // L is lower triangular, so the sum starts at the diagonal.
            let rows =
                (column..SHARED_COLUMNS).map(|row| by_base[row] * self.base_root[(row, column)]);
            let moved = rows.fold(Vec2::zeros(), |sum, by_row| sum + by_row);
            variances += moved.component_mul(&moved);
        }
        // Rounding may leave the sum for a nearly singular covariance slightly negative; `clamp`
        // keeps one that is not a number.
        variances.sum().clamp(0.0, f64::INFINITY).sqrt()
    }

    /// M L: how the overlay at a point moves, in px, for one σ of each independent component of the
    /// base error, when pan, tilt and focal length respond to it by K.
    fn by_base_in_sigmas(&self, point: &OverlayPoint) -> SMatrix<f64, 2, SHARED_COLUMNS> {
        (point.by_base - point.by_ptz * self.by_base) * self.base_root
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
    #[must_use]
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

/// The 1-σ of the overlay at the worst corner of a frame, split by cause.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct CornerSigma {
    /// Which corner, px.
    pub corner: ImagePoint,
    /// The part that click noise causes, given the positions of the clicks, px.
    pub clicks_px: f64,
    /// The part that the uncertainty of the base causes, px.
    pub base_px: f64,
}

impl CornerSigma {
    /// The root sum of squares of both parts, px.
    #[must_use]
    pub fn sigma_px(&self) -> f64 {
        self.clicks_px.hypot(self.base_px)
    }

    /// Whether more of the variance comes from the base than from the clicks: further clicks in
    /// this frame gain little.
    #[must_use]
    pub fn is_from_base(&self) -> bool {
        self.base_px > self.clicks_px
    }
}

/// The Jacobians of one overlay point by the camera's parameters, independent of their uncertainty.
#[derive(Clone, Copy, Debug)]
pub(in crate::solve) struct OverlayPoint {
    by_ptz: Matrix2x3<f64>,
    by_base: SMatrix<f64, 2, SHARED_COLUMNS>,
}

impl OverlayPoint {
    /// The overlay point of a world point; none where it has no image.
    fn at_world(camera: &PtzCamera, point_in_world: Vec3) -> Option<Self> {
        let here = camera.image_from_world_jacobian(point_in_world).ok()?;
        let by_image = Matrix2::identity();
        let by_base = by_shared(
            camera,
            &here.by_base,
            here.by_k1,
            &here.by_world,
            &by_image,
            point_in_world,
        );
        Some(Self {
            by_ptz: here.by_ptz,
            by_base,
        })
    }

    /// The overlay point of what a pixel shows ([`world_point_from_image`]).
    fn at_pixel(camera: &PtzCamera, pixel: ImagePoint) -> Option<Self> {
        Self::at_world(camera, world_point_from_image(camera, pixel)?)
    }
}

/// A covariance of (pan deg, tilt deg, focal px), as documents hold it, in (pan rad, tilt rad,
/// focal px).
#[must_use]
pub fn covariance_in_radians(covariance_deg: &Mat3) -> Mat3 {
    let radian = 1f64.to_radians();
    let scale = Mat3::from_diagonal(&Vec3::new(radian, radian, 1.0));
    scale * covariance_deg * scale
}

/// The covariance of (pan rad, tilt rad, focal px) of a camera that is known by four points
/// half-way to the picture's corners, each to `sigma_px`; the base taken as exact. A lens that has
/// no rays there is left out of account.
#[must_use]
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

/// Overlay points on a regular grid over the picture. If at least four of them lie on ground near
/// the camera, only those are returned, because clicks lie on the field.
fn all_over(camera: &PtzCamera, image_size: ImageSize) -> Vec<OverlayPoint> {
    /// No field extends farther from the camera than this, m.
    const FIELD_M: f64 = 200.0;
    const COLUMNS: u32 = 5;
    const ROWS: u32 = 4;
    let grid = (0..COLUMNS).flat_map(|column| (0..ROWS).map(move |row| (column, row)));
    let shown: Vec<Vec3> = grid
        .filter_map(|(column, row)| {
            let pixel = image_size.cell_centre([column, row], [COLUMNS, ROWS]);
            world_point_from_image(camera, pixel)
        })
        .collect();
    // Four points give eight equations for three parameters, so a direction is not left open by
    // the choice.
    let near = shown
        .iter()
        .filter(|at| (*at - camera.base().position_m).norm() <= FIELD_M);
    let some = if near.clone().nth(3).is_some() {
        near.collect::<Vec<_>>()
    } else {
        shown.iter().collect()
    };
    some.into_iter()
        .filter_map(|at| OverlayPoint::at_world(camera, *at))
        .collect()
}

/// The frame's four corners, each moved towards the principal point in steps of 10 % until it has a
/// ray; none if it never has.
pub(in crate::solve) fn corners(
    camera: &PtzCamera,
    image_size: ImageSize,
) -> [Option<OverlayPoint>; 4] {
    let middle = camera.base().principal_point;
    image_size.corners().map(|corner| {
        (0..10).find_map(|step| {
            let towards = corner.offset_from(middle) * (1.0 - 0.1 * f64::from(step));
            OverlayPoint::at_pixel(camera, middle.translate(towards))
        })
    })
}

/// The point in `world` that a pixel shows: on the plane z = 0, at most [`FAR_M`] deep, or at the
/// depth [`FAR_M`] above the horizon. None beyond the fold of the distortion model.
fn world_point_from_image(camera: &PtzCamera, pixel: ImagePoint) -> Option<Vec3> {
    // The direction has z = 1 in `cam`, so multiples of it are depths along the optical axis, m.
    let ideal = camera.cam_plane_from_image(pixel).ok()?;
    let direction = camera
        .cam_from_world()
        .tr_mul(&Vec3::new(ideal.x, ideal.y, 1.0));
    let to_ground = -camera.base().position_m.z / direction.z;
    let depth_m = if to_ground > 0.0 {
        to_ground.min(FAR_M)
    } else {
        FAR_M
    };
    Some(camera.base().position_m + direction * depth_m)
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

#[cfg(test)]
mod tests {
    use super::*;
    use crate::camera::{BaseSigma, Ptz, SHARED_PARAMETERS, SharedCovariance, SharedError};
    use crate::solve::fixtures::base;

    const SIZE: ImageSize = ImageSize::new(1920, 1080);

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
        let base = CameraBase {
            distortion: FocalCurve::constant(-1e4),
            ..base()
        };
        PtzCamera::new(base, Ptz::from_degrees(-12.0, -9.0, 2300.0))
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
}
