//! Analytic derivatives of the projection.

use super::{ProjectError, PtzCamera};
use crate::geometry::{ImagePoint, Vec2, Vec3};
use nalgebra::{Matrix2x3, Matrix2x6};

/// An image point and its derivatives.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ProjectionJacobian {
    /// The image point, px.
    pub point: ImagePoint,
    /// By pan (px/rad), tilt (px/rad) and focal length (px/px). The change of k₁ with the focal
    /// length is included.
    pub by_ptz: Matrix2x3<f64>,
    /// By the base: position x, y, z (px/m), then a rotation vector in `world` applied before the
    /// base rotation, `base_from_world · exp([ω]×)` (px/rad).
    pub by_base: Matrix2x6<f64>,
    /// By the world point (px/m).
    pub by_world: Matrix2x3<f64>,
    /// By k₁ (px), with k₂ = α k₁² following.
    pub by_k1: Vec2,
}

/// The image of a direction and its derivatives.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct DirectionJacobian {
    /// The image point, px.
    pub point: ImagePoint,
    /// By pan (px/rad), tilt (px/rad) and focal length (px/px). The change of k₁ with the focal
    /// length is included.
    pub by_ptz: Matrix2x3<f64>,
    /// By the direction in `base` (px per its unit).
    pub by_direction: Matrix2x3<f64>,
}

impl PtzCamera {
    /// The image of a direction in `base` (any length but zero) and its derivatives.
    ///
    /// # Errors
    /// Behind the camera, or beyond the fold of the distortion model.
    #[inline]
    pub fn image_from_direction_jacobian(
        &self,
        direction_in_base: Vec3,
    ) -> Result<DirectionJacobian, ProjectError> {
        let in_cam = self.cam_from_base() * direction_in_base;
        let (point, by_cam, by_focal_fixed_k1, by_k1) = self.image_from_cam_jacobian(in_cam)?;
        let by_ptz = self.by_ptz(direction_in_base, in_cam, &by_cam, by_focal_fixed_k1, by_k1);
        Ok(DirectionJacobian {
            point,
            by_ptz,
            by_direction: by_cam * self.cam_from_base(),
        })
    }

    /// The image of a world point and its derivatives.
    ///
    /// # Errors
    /// Behind the camera, or beyond the fold of the distortion model.
    #[inline]
    pub fn image_from_world_jacobian(
        &self,
        point_in_world: Vec3,
    ) -> Result<ProjectionJacobian, ProjectError> {
        let offset = point_in_world - self.base().position_m;
        let in_base = self.base().base_from_world * offset;
        let in_cam = self.cam_from_base() * in_base;
        let (point, by_cam, by_focal_fixed_k1, by_k1) = self.image_from_cam_jacobian(in_cam)?;
        let by_ptz = self.by_ptz(in_base, in_cam, &by_cam, by_focal_fixed_k1, by_k1);

        let by_world = by_cam * self.cam_from_world();
        // A rotation by ω moves the point by ω × offset, and r · (ω × offset) = (offset × r) · ω
        // for a row r of `by_world`. A shift of the camera acts like the opposite shift of the
        // point.
        let [x, y] = [0, 1].map(|row| offset.cross(&by_world.row(row).transpose()));
        let mut by_base = Matrix2x6::zeros();
        for axis in 0..3 {
            by_base.set_column(axis, &-by_world.column(axis));
            by_base.set_column(3 + axis, &Vec2::new(x[axis], y[axis]));
        }
        Ok(ProjectionJacobian {
            point,
            by_ptz,
            by_base,
            by_world,
            by_k1,
        })
    }

    /// The image of a world point and its derivatives by pan (px/rad), tilt (px/rad) and focal
    /// length (px/px): the part of
    /// [`Self::image_from_world_jacobian`] that a fit with a fixed base needs, at half its cost.
    ///
    /// # Errors
    /// Behind the camera, or beyond the fold of the distortion model.
    #[inline]
    pub fn image_from_world_by_ptz(
        &self,
        point_in_world: Vec3,
    ) -> Result<(ImagePoint, Matrix2x3<f64>), ProjectError> {
        let in_base = self.base().base_from_world * (point_in_world - self.base().position_m);
        let in_cam = self.cam_from_base() * in_base;
        let (point, by_cam, by_focal_fixed_k1, by_k1) = self.image_from_cam_jacobian(in_cam)?;
        Ok((
            point,
            self.by_ptz(in_base, in_cam, &by_cam, by_focal_fixed_k1, by_k1),
        ))
    }

    /// The derivatives by pan, tilt and focal length; the last one includes dk₁/df.
    #[inline]
    fn by_ptz(
        &self,
        in_base: Vec3,
        in_cam: Vec3,
        by_cam: &Matrix2x3<f64>,
        by_focal_fixed_k1: Vec2,
        by_k1: Vec2,
    ) -> Matrix2x3<f64> {
        // d(Q_pan b)/dθ = Q_pan (−b_z, 0, b_x); d(Q_tilt p)/dφ = (0, p_z, −p_y) in cam.
        let by_pan = by_cam * (self.cam_from_base() * Vec3::new(-in_base.z, 0.0, in_base.x));
        let by_tilt = by_cam * Vec3::new(0.0, in_cam.z, -in_cam.y);
        let by_focal = by_focal_fixed_k1 + by_k1 * self.base().distortion.slope_per_px();
        Matrix2x3::from_columns(&[by_pan, by_tilt, by_focal])
    }

    /// The image of a point in `cam`; its derivatives by that point, by the focal length at fixed
    /// k₁, and by k₁ with k₂ = α k₁² following.
    ///
    /// # Errors
    /// Behind the camera, or beyond the fold of the distortion model.
    #[inline]
    pub fn image_from_cam_jacobian(
        &self,
        point_in_cam: Vec3,
    ) -> Result<(ImagePoint, Matrix2x3<f64>, Vec2, Vec2), ProjectError> {
        let ideal = self.ideal_from_cam(point_in_cam)?;
        let (focal_px, lens) = (self.ptz().focal_px, self.lens());
        let radius_squared = ideal.norm_squared();
        // Chain rule: `cam` → ideal point (x/z, y/z) → distorted point → px. The image is linear in
        // the focal length where k₁ is fixed, with the distorted point as its derivative.
        let stretch = lens.stretch(radius_squared);
        let distorted = lens.pixels_from_square(ideal * stretch);
        let by_ideal = lens.by_ideal(ideal);
        let ideal_by_cam = Matrix2x3::new(1.0, 0.0, -ideal.x, 0.0, 1.0, -ideal.y) / point_in_cam.z;
        Ok((
            self.base().principal_point.translate(distorted * focal_px),
            by_ideal * ideal_by_cam * focal_px,
            distorted,
            lens.pixels_from_square(ideal)
                * (self
                    .base()
                    .distortion
                    .stretch_by_k1(focal_px, radius_squared)
                    * focal_px),
        ))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::camera::{CameraBase, FocalCurve, Ptz};
    use crate::geometry::Angle;
    use crate::geometry::rotation::from_rotation_vector;
    use crate::testing::{TestBase, turned_base};

    fn camera(k2_per_k1_squared: f64) -> PtzCamera {
        let base = CameraBase {
            distortion: FocalCurve {
                at_focal_px: 2000.0,
                value: -0.16,
                per_1000_px: 0.21,
                k2_per_k1_squared,
                pixel_aspect: 0.8,
            },
            ..turned_base(
                [3.0, -62.0, 17.0],
                [5.0, -1.0, 0.7],
                ImagePoint::new(955.0, 543.0),
            )
        };
        base.aim(-14.0, -13.0, 2310.0)
    }

    fn difference(f: impl Fn(f64) -> ImagePoint, step: f64) -> Vec2 {
        (f(step).offset_from(ImagePoint::default()) - f(-step).offset_from(ImagePoint::default()))
            / (2.0 * step)
    }

    #[test]
    fn every_group_of_parameters_agrees_with_central_differences() {
        let worlds = [
            Vec3::new(-10.0, 8.0, 0.0),
            Vec3::new(-25.0, -20.0, 2.44),
            Vec3::new(4.0, 30.0, 0.0),
        ];
        let cameras = [0.0, 0.5, 2.0].map(camera);
        for (camera, world) in cameras
            .iter()
            .flat_map(|camera| worlds.map(|world| (camera, world)))
        {
            let at = camera.image_from_world_jacobian(world).unwrap();
            assert!(
                at.point
                    .distance_px(camera.image_from_world(world).unwrap())
                    < 1e-9
            );
            let (base, ptz) = (*camera.base(), camera.ptz());
            let project =
                |base, ptz, world| PtzCamera::new(base, ptz).image_from_world(world).unwrap();
            let radians = Angle::from_radians;
            let pan = difference(
                |h| {
                    project(
                        base,
                        Ptz {
                            pan: ptz.pan + radians(h),
                            ..ptz
                        },
                        world,
                    )
                },
                1e-6,
            );
            let tilt = difference(
                |h| {
                    project(
                        base,
                        Ptz {
                            tilt: ptz.tilt + radians(h),
                            ..ptz
                        },
                        world,
                    )
                },
                1e-6,
            );
            let focal = difference(
                |h| {
                    project(
                        base,
                        Ptz {
                            focal_px: ptz.focal_px + h,
                            ..ptz
                        },
                        world,
                    )
                },
                1e-3,
            );
            for (column, numeric) in [pan, tilt, focal].into_iter().enumerate() {
                let error = (at.by_ptz.column(column) - numeric).norm();
                assert!(
                    error < 1e-6 * (1.0 + numeric.norm()),
                    "ptz column {column}: {error}"
                );
            }
            for axis in 0..3 {
                let unit = Vec3::ith(axis, 1.0);
                let moved = difference(|h| project(base, ptz, world + unit * h), 1e-4);
                assert!((at.by_world.column(axis) - moved).norm() < 1e-6 * (1.0 + moved.norm()));
                let shifted = |h: f64| CameraBase {
                    position_m: base.position_m + unit * h,
                    ..base
                };
                let position = difference(|h| project(shifted(h), ptz, world), 1e-4);
                assert!(
                    (at.by_base.column(axis) - position).norm() < 1e-6 * (1.0 + position.norm())
                );
                let turned = |h: f64| CameraBase {
                    base_from_world: base.base_from_world * from_rotation_vector(unit * h),
                    ..base
                };
                let rotation = difference(|h| project(turned(h), ptz, world), 1e-6);
                assert!(
                    (at.by_base.column(3 + axis) - rotation).norm()
                        < 1e-6 * (1.0 + rotation.norm())
                );
            }
            let direction = base.base_from_world * (world - base.position_m);
            let seen = camera.image_from_direction_jacobian(direction).unwrap();
            assert_eq!((seen.point, seen.by_ptz), (at.point, at.by_ptz));
            assert!(
                (seen.by_direction * base.base_from_world - at.by_world).norm()
                    < 1e-9 * at.by_world.norm()
            );
            let lens = |h: f64| CameraBase {
                distortion: FocalCurve {
                    value: base.distortion.value + h,
                    ..base.distortion
                },
                ..base
            };
            let k1 = difference(|h| project(lens(h), ptz, world), 1e-6);
            assert!((at.by_k1 - k1).norm() < 1e-6 * (1.0 + k1.norm()));
        }
    }
}
