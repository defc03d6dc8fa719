//! Exact projection from the world to the picture and back.

use super::distortion::{UndistortError, distort, undistort};
use super::{CameraBase, PanTilt, Ptz, Radial};
use crate::geometry::{ImagePoint, Mat3, Vec2, Vec3};
use thiserror::Error;

/// Points whose depth is less than this fraction of their distance count as behind the camera.
pub const MIN_DEPTH: f64 = 1e-6;

/// Why a point has no image.
#[derive(Clone, Copy, Debug, PartialEq, Error)]
#[non_exhaustive]
pub enum ProjectError {
    /// The point is behind the camera, or beside it.
    #[error("the point is behind the camera (depth {depth} of its distance)")]
    BehindCamera {
        /// Depth along the optical axis as a share of the distance, −1 to 1.
        depth: f64,
    },
    /// The point lies beyond the radius at which the distortion model folds.
    #[error("the point lies beyond the fold of the distortion model (k1 = {k1})")]
    BeyondFold {
        /// The coefficient.
        k1: f64,
    },
}

/// The camera of one frame: a base with pan, tilt and focal length.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PtzCamera {
    base: CameraBase,
    ptz: Ptz,
    lens: Radial,
    cam_from_base: Mat3,
    cam_from_world: Mat3,
}

impl PtzCamera {
    /// The camera with a base and pan, tilt and focal length; the lens is that of the base's curve
    /// at this focal length.
    pub fn new(base: CameraBase, ptz: Ptz) -> Self {
        let cam_from_base = ptz.cam_from_base();
        let cam_from_world = cam_from_base * base.base_from_world;
        Self {
            base,
            ptz,
            lens: base.distortion.radial_at(ptz.focal_px),
            cam_from_base,
            cam_from_world,
        }
    }

    /// The camera opposite, turned by 180° about the middle of the field. From there a field that
    /// looks the same after half a turn gives the same picture.
    #[must_use]
    pub fn after_half_turn(&self) -> Self {
        let half_turn = Mat3::from_diagonal(&Vec3::new(-1.0, -1.0, 1.0));
        let turned = CameraBase {
            position_m: half_turn * self.base.position_m,
            base_from_world: self.base.base_from_world * half_turn,
            ..self.base
        };
        // Pan zero is along +y (the pan gauge), which is now behind the camera.
        let (turned, pan) = turned.in_pan_gauge();
        let ptz = Ptz {
            pan: self.ptz.pan + pan,
            ..self.ptz
        };
        Self::new(turned, ptz)
    }

    /// The base.
    pub const fn base(&self) -> &CameraBase {
        &self.base
    }

    /// Pan, tilt and focal length.
    pub const fn ptz(&self) -> Ptz {
        self.ptz
    }

    /// The radial distortion in use.
    pub const fn lens(&self) -> Radial {
        self.lens
    }

    /// Its first coefficient.
    pub const fn k1(&self) -> f64 {
        self.lens.k1
    }

    /// `Q_tilt` · `Q_pan`.
    pub const fn cam_from_base(&self) -> &Mat3 {
        &self.cam_from_base
    }

    /// `Q_tilt` · `Q_pan` · `base_from_world`.
    pub const fn cam_from_world(&self) -> Mat3 {
        self.cam_from_world
    }

    /// A world point in `cam`, m.
    pub fn cam_from_world_point(&self, point_in_world: Vec3) -> Vec3 {
        self.cam_from_base * self.base.base_from_world_point(point_in_world)
    }

    /// The image of a point given in `cam` (any scale).
    ///
    /// # Errors
    /// Behind the camera, or beyond the fold of the distortion model.
    pub fn image_from_cam(&self, point_in_cam: Vec3) -> Result<ImagePoint, ProjectError> {
        let ideal = self.ideal_from_cam(point_in_cam)?;
        Ok(self
            .base
            .principal_point
            .translate(distort(ideal, self.lens) * self.ptz.focal_px))
    }

    /// The ideal point on the plane z = 1 of `cam` of a point given in `cam` (any scale).
    ///
    /// # Errors
    /// Behind the camera, or beyond the fold of the distortion model.
    #[inline]
    pub(super) fn ideal_from_cam(&self, point_in_cam: Vec3) -> Result<Vec2, ProjectError> {
        let p = point_in_cam;
        let distance = p.norm();
        // Negated, so that NaN has no image either.
        if !(p.z > MIN_DEPTH * distance) {
            return Err(ProjectError::BehindCamera {
                depth: if distance > 0.0 { p.z / distance } else { 0.0 },
            });
        }
        let ideal = Vec2::new(p.x / p.z, p.y / p.z);
        // Beyond the fold the model maps the point back into the picture, where nothing shows it.
        if ideal.norm_squared() >= self.lens.fold_radius_squared() {
            return Err(ProjectError::BeyondFold { k1: self.lens.k1 });
        }
        Ok(ideal)
    }

    /// The ideal radius on the plane z = 1 of `cam` beyond which the distortion model folds and
    /// nothing has an image; infinite where it does not fold.
    pub fn fold_radius(&self) -> f64 {
        self.lens.fold_radius_squared().sqrt()
    }

    /// The calibration matrix K, from the plane z = 1 of `cam` to px, without distortion.
    pub fn calibration_matrix(&self) -> Mat3 {
        let (fx, at) = (self.ptz.focal_px, self.base.principal_point);
        let fy = fx * self.lens.pixel_aspect;
        Mat3::new(fx, 0.0, at.x, 0.0, fy, at.y, 0.0, 0.0, 1.0)
    }

    /// The image of a world point, px.
    ///
    /// # Errors
    /// Behind the camera, or beyond the fold of the distortion model.
    pub fn image_from_world(&self, point_in_world: Vec3) -> Result<ImagePoint, ProjectError> {
        self.image_from_cam(self.cam_from_world_point(point_in_world))
    }

    /// The image of a ray, px.
    ///
    /// # Errors
    /// Behind the camera, or beyond the fold of the distortion model.
    pub fn image_from_ray(&self, ray: PanTilt) -> Result<ImagePoint, ProjectError> {
        self.image_from_cam(self.cam_from_base * ray.direction())
    }

    /// The ideal point on the plane z = 1 of `cam` that an image point shows.
    ///
    /// # Errors
    /// The point lies beyond the fold of the distortion model.
    pub fn cam_plane_from_image(&self, point: ImagePoint) -> Result<Vec2, UndistortError> {
        undistort(
            point.offset_from(self.base.principal_point) / self.ptz.focal_px,
            self.lens,
        )
    }

    /// The unit direction in `cam` that an image point shows.
    ///
    /// # Errors
    /// The point lies beyond the fold of the distortion model.
    pub fn cam_from_image(&self, point: ImagePoint) -> Result<Vec3, UndistortError> {
        let ideal = self.cam_plane_from_image(point)?;
        Ok(Vec3::new(ideal.x, ideal.y, 1.0).normalize())
    }

    /// The ray that an image point shows.
    ///
    /// # Errors
    /// The point lies beyond the fold of the distortion model.
    pub fn ray_from_image(&self, point: ImagePoint) -> Result<PanTilt, UndistortError> {
        Ok(PanTilt::from_direction(
            self.cam_from_base.transpose() * self.cam_from_image(point)?,
        ))
    }

    /// The unit direction in `world` that an image point shows.
    ///
    /// # Errors
    /// The point lies beyond the fold of the distortion model.
    pub fn world_direction_from_image(&self, point: ImagePoint) -> Result<Vec3, UndistortError> {
        Ok(self.cam_from_world().transpose() * self.cam_from_image(point)?)
    }

    /// The intersection of the ray of an image point with the plane z = `height_m`, `world`, m;
    /// none where the ray does not meet it in front of the camera.
    pub fn plane_from_image(&self, point: ImagePoint, height_m: f64) -> Option<Vec3> {
        // A ray parallel to the plane has an infinite distance, one that points away a negative
        // one.
        let direction = self.world_direction_from_image(point).ok()?;
        let distance = (height_m - self.base.position_m.z) / direction.z;
        (distance.is_finite() && distance > 0.0)
            .then(|| self.base.position_m + direction * distance)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::camera::FocalCurve;
    use crate::geometry::Vec3;
    use crate::geometry::rotation::rotation_vector;
    use crate::testing::{SIZE, TestBase, base_at};
    use proptest::prelude::*;

    fn base(k1: f64) -> CameraBase {
        CameraBase {
            distortion: FocalCurve {
                at_focal_px: 2000.0,
                value: k1,
                per_1000_px: 0.0,
                ..FocalCurve::NONE
            },
            ..base_at([2.0, -60.0, 18.0], SIZE)
        }
    }

    #[test]
    fn after_half_a_turn_the_opposite_points_are_seen_where_they_were() {
        let camera = base(-0.1).aim(12.0, -8.0, 2400.0);
        let turned = camera.after_half_turn();
        let at = camera.image_from_world(Vec3::new(20.0, 5.0, 0.0)).unwrap();
        let opposite = turned.image_from_world(Vec3::new(-20.0, -5.0, 0.0));
        assert!(opposite.unwrap().distance_px(at) < 1e-9, "{opposite:?}");
        assert_eq!(turned.base().position_m, Vec3::new(-2.0, 60.0, 18.0));
    }

    #[test]
    fn the_centre_of_the_picture_shows_the_optical_axis() {
        let camera = base(-0.1).aim(12.0, -8.0, 2400.0);
        let ray = camera
            .ray_from_image(ImagePoint::new(960.0, 540.0))
            .unwrap();
        assert!(
            (ray.pan.degrees() - 12.0).abs() < 1e-12 && (ray.tilt.degrees() + 8.0).abs() < 1e-12
        );
    }

    #[test]
    fn pixels_that_are_not_square_multiply_y_behind_the_distortion() {
        let square = base(-0.1).aim(12.0, -8.0, 2400.0);
        let mut oblong = *square.base();
        oblong.distortion.pixel_aspect = 1.25;
        let oblong = PtzCamera::new(oblong, square.ptz());
        let point = Vec3::new(7.0, -12.0, 1.5);
        let [at, there] = [square, oblong].map(|camera| camera.image_from_world(point).unwrap());
        assert!((there.x - at.x).abs() < 1e-9);
        assert!((there.y - 540.0 - 1.25 * (at.y - 540.0)).abs() < 1e-9);
        let k = oblong.calibration_matrix();
        assert_eq!((k[(0, 0)], k[(1, 1)]), (2400.0, 3000.0));
    }

    #[test]
    fn right_of_the_axis_is_right_in_the_picture_and_up_is_up() {
        let camera = base(0.0).aim(0.0, -15.0, 2000.0);
        let middle = camera.image_from_world(Vec3::new(0.0, 0.0, 0.0)).unwrap();
        assert!(camera.image_from_world(Vec3::new(5.0, 0.0, 0.0)).unwrap().x > middle.x);
        assert!(camera.image_from_world(Vec3::new(0.0, 0.0, 2.0)).unwrap().y < middle.y);
        assert!(camera.image_from_world(Vec3::new(0.0, 5.0, 0.0)).unwrap().y < middle.y);
    }

    #[test]
    fn a_point_behind_the_camera_is_named() {
        let camera = base(0.0).aim(0.0, -15.0, 2000.0);
        let error = camera
            .image_from_world(Vec3::new(0.0, -120.0, 0.0))
            .unwrap_err();
        assert!(matches!(error, ProjectError::BehindCamera { depth } if depth < 0.0));
        assert!(camera.image_from_world(camera.base().position_m).is_err());
    }

    #[test]
    fn the_authors_rotation_convention_is_ours() {
        // One frame of the published sequence: R = Rx(tilt) · Ry(pan) · R_base (formats.md, section
        // 13).
        let base_from_world = crate::geometry::rotation::from_rotation_vector(Vec3::new(
            1.230319, 1.129962, -1.157628,
        ));
        let base = CameraBase::new(
            Vec3::new(114.32318, 1.114215, 6.375646),
            base_from_world,
            ImagePoint::new(640.5, 360.5),
        );
        let camera = base.aim(53.364_833_724_635_1, -5.866_202_476_869_829, 3733.765_356);
        let published = Vec3::new(
            1.617_735_862_435_805_6,
            0.445_567_365_524_574_3,
            -0.436_192_571_451_583_4,
        );
        assert!((rotation_vector(&camera.cam_from_world()) - published).norm() < 1e-6);
    }

    proptest! {
        #[test]
        fn every_point_of_the_picture_comes_back(
            x in 0.0..1920.0f64, y in 0.0..1080.0f64, pan in -40.0..40.0f64, tilt in -30.0..-5.0f64,
            focal in 1300.0..6000.0f64, k1 in -0.12..0.3f64, aspect in 0.7..2.0f64,
        ) {
            let mut base = base(k1);
            base.distortion.pixel_aspect = aspect;
            let camera = base.aim(pan, tilt, focal);
            let point = ImagePoint::new(x, y);
            let ray = camera.ray_from_image(point).unwrap();
            prop_assert!(camera.image_from_ray(ray).unwrap().distance_px(point) < 1e-8);
            if let Some(ground) = camera.plane_from_image(point, 0.0) {
                prop_assert!(ground.z.abs() < 1e-9);
                prop_assert!(camera.image_from_world(ground).unwrap().distance_px(point) < 1e-7);
            }
        }
    }
}
