//! The uncertainty of a solution in the picture: 1-σ of the overlay at a pixel, at a point of the
//! world and at the corners. Errors of the shared base and those of the frame's own clicks go
//! together here, because both move the overlay.

use super::{FAR_M, Uncertainty};
use crate::camera::{PtzCamera, SHARED_COLUMNS, SIZE_COLUMN};
use crate::geometry::{ImagePoint, ImageSize, Vec2, Vec3};
use crate::solve::observations::shape::by_shared;
use nalgebra::{Matrix2, Matrix2x3, SMatrix};

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
    pub fn sigma_px(&self) -> f64 {
        self.clicks_px.hypot(self.base_px)
    }

    /// Whether more of the variance comes from the base than from the clicks: further clicks in
    /// this frame gain little.
    pub fn is_from_base(&self) -> bool {
        self.base_px > self.clicks_px
    }
}

/// The Jacobians of one overlay point by the camera's parameters, independent of their uncertainty.
#[derive(Clone, Copy, Debug)]
pub(in crate::solve) struct OverlayPoint {
    pub(super) by_ptz: Matrix2x3<f64>,
    pub(super) by_base: SMatrix<f64, 2, SHARED_COLUMNS>,
    /// The pixel by the point's own x and y in `world`, px/m.
    pub(super) image_by_ground: Matrix2<f64>,
}

impl OverlayPoint {
    /// The overlay point of a world point; none where it has no image.
    pub(super) fn at_world(camera: &PtzCamera, point_in_world: Vec3) -> Option<Self> {
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
            image_by_ground: here.by_world.fixed_columns::<2>(0).into_owned(),
        })
    }

    /// The overlay point of what a pixel shows ([`world_point_from_image`]).
    pub(super) fn at_pixel(camera: &PtzCamera, pixel: ImagePoint) -> Option<Self> {
        Self::at_world(camera, world_point_from_image(camera, pixel)?)
    }
}

/// Overlay points on a regular grid over the picture. If at least four of them lie on ground near
/// the camera, only those are returned, because clicks lie on the field.
pub(super) fn all_over(camera: &PtzCamera, image_size: ImageSize) -> Vec<OverlayPoint> {
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

impl Uncertainty {
    /// Covariance (px²) of the overlay at a world point; none where the point has no image.
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
    pub fn overlay_at(&self, camera: &PtzCamera, pixel: ImagePoint) -> Option<Matrix2<f64>> {
        self.overlay_at_world(camera, world_point_from_image(camera, pixel)?)
    }

    /// 1-σ of the overlay at a pixel, px: the root of the covariance's trace, an RMS distance.
    pub fn overlay_sigma_px(&self, camera: &PtzCamera, pixel: ImagePoint) -> Option<f64> {
        OverlayPoint::at_pixel(camera, pixel).map(|point| self.sigma_px(&point))
    }

    /// The largest [`Self::overlay_sigma_px`] of the frame's four corners; a corner beyond the fold
    /// of the distortion model is moved towards the principal point until it has a ray. Infinite
    /// where that gives no corner a ray: nothing is known of such an overlay.
    pub fn worst_corner_sigma_px(&self, camera: &PtzCamera, image_size: ImageSize) -> f64 {
        self.worst_sigma_px(&corners(camera, image_size))
    }

    /// The same as documents state it, which cannot express that it is infinite: none then.
    pub fn corner_sigma_px_if_known(
        &self,
        camera: &PtzCamera,
        image_size: ImageSize,
    ) -> Option<f64> {
        Some(self.worst_corner_sigma_px(camera, image_size)).filter(|sigma_px| sigma_px.is_finite())
    }

    /// Where the 1-σ at the frame's worst corner comes from.
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
    pub(in crate::solve::outcome) fn worst_sigma_px(&self, points: &[Option<OverlayPoint>]) -> f64 {
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
    pub(super) fn sigma_px(&self, point: &OverlayPoint) -> f64 {
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
            // L is lower triangular but for the size, so the sum starts at the diagonal.
            let first = if column < SIZE_COLUMN { column } else { 0 };
            let rows =
                (first..SHARED_COLUMNS).map(|row| by_base[row] * self.base_root[(row, column)]);
            let moved = rows.fold(Vec2::zeros(), |sum, by_row| sum + by_row);
            variances += moved.component_mul(&moved);
        }
        // Rounding may leave the sum for a nearly singular covariance slightly negative; `clamp`
        // keeps one that is not a number.
        variances.sum().clamp(0.0, f64::INFINITY).sqrt()
    }

    /// M L: how the overlay at a point moves, in px, for one σ of each independent component of the
    /// base error, when pan, tilt and focal length respond to it by K.
    pub(super) fn by_base_in_sigmas(
        &self,
        point: &OverlayPoint,
    ) -> SMatrix<f64, 2, SHARED_COLUMNS> {
        (point.by_base - point.by_ptz * self.by_base) * self.base_root
    }
}
