//! The shape that a click shows (a landmark's point or a line's curve), and the residual of the
//! click under a camera.
//!
//! This is the only file of the solver that distinguishes points from curves. A point gives two
//! equations, a curve one; both give a residual of the same type.

use super::line::nearest_point;
use crate::camera::{PtzCamera, SHARED_COLUMNS, SIZE_COLUMN};
use crate::field::{Crown, FieldElement, FieldModel, Symmetry};
use crate::geometry::{ImagePoint, Vec2, Vec3};
use crate::solve::WorldCurve;
use nalgebra::{Matrix2, Matrix2x3, Matrix2x6, SMatrix};

/// What a click shows, in `world`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum ObservedShape {
    /// A point, m, the crown included: two equations.
    Point(Vec3),
    /// Some point of a curve: one equation. Straight lines extend beyond their ends, arcs are whole
    /// circles.
    Curve(WorldCurve),
}

/// How far a click is from a shape, px, and how that changes.
///
/// For a point it is the offset from the click to the point's image. For a curve the first number
/// is the signed distance of the click from the projected curve, positive on its left as the
/// picture shows it (y down), and the second is zero.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ShapeJacobian {
    /// The residual, px.
    pub value_px: Vec2,
    /// By pan (px/rad), tilt (px/rad), focal length (px/px).
    pub by_ptz: Matrix2x3<f64>,
    /// By position (px/m) and a rotation vector in `world` (px/rad) of the base.
    pub by_base: Matrix2x6<f64>,
    /// By k₁ alone, px.
    pub by_k1: Vec2,
    /// By a shift of the projected shape, such as a change of the principal point, px/px.
    pub by_image: Matrix2<f64>,
    /// By the point of the shape that was compared, px/m.
    pub by_world: Matrix2x3<f64>,
    /// That point: the point itself, or the nearest one of the curve; `world`, m.
    pub nearest_in_world: Vec3,
    /// The curve's parameter there; 0 for a point.
    pub parameter: f64,
}

impl ShapeJacobian {
    /// By all parameters that the frames share, in the order of the shared columns.
    pub fn by_shared(&self, camera: &PtzCamera) -> SMatrix<f64, 2, SHARED_COLUMNS> {
        by_shared(
            camera,
            &self.by_base,
            self.by_k1,
            &self.by_world,
            &self.by_image,
            self.nearest_in_world,
        )
    }
}

impl ObservedShape {
    /// The shape of a field's landmark, line or paint; none if the field has no such element.
    pub fn from_element(field: &FieldModel, element: FieldElement) -> Option<Self> {
        match element {
            FieldElement::Landmark(index) => field
                .landmarks
                .get(index)
                .map(|landmark| Self::Point(field.landmark_in_world(landmark))),
            FieldElement::Line(index) => field
                .lines
                .get(index)
                .map(|line| Self::Curve(WorldCurve::on_field(field, line.curve))),
            FieldElement::Paint(index) => field
                .lines
                .get(index)
                .map(|line| Self::Curve(WorldCurve::on_field(field, line.paint_centre))),
        }
    }

    /// How many equations a click on it gives.
    pub const fn equations(&self) -> usize {
        match self {
            Self::Point(_) => 2,
            Self::Curve(_) => 1,
        }
    }

    /// The point, m, `world`; none for a curve.
    pub const fn point(&self) -> Option<Vec3> {
        match self {
            Self::Point(at) => Some(*at),
            Self::Curve(_) => None,
        }
    }

    /// Whether its coordinates are finite.
    pub fn is_finite(&self) -> bool {
        let at = match self {
            Self::Point(at) => *at,
            Self::Curve(curve) => curve.at(0.5).at,
        };
        at.iter().all(|x| x.is_finite())
    }

    /// The offset (px) to a click from the image of the point, or from the nearest point of the
    /// curve's image; none where it has no image.
    pub fn offset_px(&self, camera: &PtzCamera, click: ImagePoint) -> Option<Vec2> {
        match self {
            Self::Point(at) => camera
                .image_from_world(*at)
                .ok()
                .map(|image| click.offset_from(image)),
            Self::Curve(curve) => {
                nearest_point(camera, curve, click).map(|nearest| nearest.offset_to(click))
            }
        }
    }

    /// The residual of a click, px: see [`ShapeJacobian`]. None where the shape has no image.
    #[inline]
    pub(in crate::solve) fn residual_px(
        &self,
        camera: &PtzCamera,
        click: ImagePoint,
    ) -> Option<Vec2> {
        match self {
            Self::Point(at) => camera
                .image_from_world(*at)
                .ok()
                .map(|image| image.offset_from(click)),
            Self::Curve(curve) => nearest_point(camera, curve, click)
                .map(|nearest| Vec2::new(nearest.distance_px(click), 0.0)),
        }
    }

    /// The residual and its derivatives by pan (px/rad), tilt (px/rad) and focal length (px/px):
    /// the part of [`Self::jacobian`] that a fit with a known base needs.
    #[inline]
    pub fn residual_by_ptz(
        &self,
        camera: &PtzCamera,
        click: ImagePoint,
    ) -> Option<(Vec2, Matrix2x3<f64>)> {
        match self {
            Self::Point(at) => {
                let (image, by_ptz) = camera.image_from_world_by_ptz(*at).ok()?;
                Some((image.offset_from(click), by_ptz))
            }
            Self::Curve(curve) => {
                let nearest = nearest_point(camera, curve, click)?;
                // The image of the nearest point moves with the camera; its component along the
                // normal changes the distance.
                let (_, by_ptz) = camera.image_from_world_by_ptz(nearest.in_world()).ok()?;
                Some((
                    Vec2::new(nearest.distance_px(click), 0.0),
                    nearest.by_image() * by_ptz,
                ))
            }
        }
    }

    /// The residual of a click with all its derivatives; none where the shape has no image.
    pub fn jacobian(&self, camera: &PtzCamera, click: ImagePoint) -> Option<ShapeJacobian> {
        // For a curve, `by_image` projects image derivatives onto the unit normal. That the nearest
        // point slides along the curve as the camera changes has no first-order effect on the
        // distance.
        let (nearest_in_world, parameter, value_px, by_image) = match self {
            Self::Point(at) => (*at, 0.0, None, Matrix2::identity()),
            Self::Curve(curve) => {
                let nearest = nearest_point(camera, curve, click)?;
                let value_px = Vec2::new(nearest.distance_px(click), 0.0);
                (
                    nearest.in_world(),
                    nearest.parameter(),
                    Some(value_px),
                    nearest.by_image(),
                )
            }
        };
        let here = camera.image_from_world_jacobian(nearest_in_world).ok()?;
        Some(ShapeJacobian {
            value_px: value_px.unwrap_or_else(|| here.point.offset_from(click)),
            by_ptz: by_image * here.by_ptz,
            by_base: by_image * here.by_base,
            by_k1: by_image * here.by_k1,
            by_image,
            by_world: by_image * here.by_world,
            nearest_in_world,
            parameter,
        })
    }

    /// The same shape on ground with another crown.
    #[must_use]
    pub(in crate::solve) fn change_crown(self, from: Crown, to: Crown) -> Self {
        match self {
            // A point is stored with its crown, a curve with the crown beside its nominal shape.
            Self::Point(mut at) => {
                at.z += to.ground_z(at.y) - from.ground_z(at.y);
                Self::Point(at)
            }
            Self::Curve(curve) => Self::Curve(curve.with_crown(to)),
        }
    }

    /// The point, or the curve's point at a parameter. The shape must be one on flat ground, m,
    /// `world`.
    pub(in crate::solve) fn nominal_at(&self, parameter: f64) -> Vec3 {
        match self {
            Self::Point(at) => *at,
            Self::Curve(curve) => curve.nominal().point_at(parameter),
        }
    }

    /// This shape moved by a fraction of the difference between two shapes of its kind.
    #[must_use]
    pub(in crate::solve) fn move_along(self, from: &Self, to: &Self, share: f64) -> Self {
        match (self, from, to) {
            (Self::Point(at), Self::Point(from), Self::Point(to)) => {
                Self::Point(at + (to - from) * share)
            }
            (Self::Curve(curve), Self::Curve(from), Self::Curve(to)) => {
                Self::Curve(curve.move_along(from.nominal(), to.nominal(), share))
            }
            (shape, ..) => shape,
        }
    }

    /// A point where a symmetry of the field puts it; none for a curve.
    pub(in crate::solve) fn mirror_point(&self, symmetry: Symmetry) -> Option<Self> {
        self.point().map(|at| Self::Point(symmetry.apply(at)))
    }
}

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
    for (axis, size) in base.sigma.size.iter().enumerate() {
        let motion = size.motion_at(point_in_world[axis], axis);
        by.set_column(SIZE_COLUMN + axis, &(by_world.column(axis) * motion));
    }
    by
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::camera::{CameraBase, FocalCurve, Ptz};
    use crate::field::builtin;
    use crate::geometry::Angle;
    use crate::geometry::rotation::from_rotation_vector;
    use crate::solve::fixtures::base;
    use std::collections::BTreeMap;

    const PTZ: Ptz = Ptz::from_degrees(-4.0, -15.0, 1910.0);

    fn shapes() -> Vec<ObservedShape> {
        let field = builtin("soccer")
            .unwrap()
            .model(&BTreeMap::new(), 0.2)
            .unwrap();
        let landmarks = ["centre_mark", "centre_circle_left", "post_far_left_top"]
            .map(|id| field.landmark_element(id));
        let lines = [
            "halfway_line",
            "touchline_far",
            "post_far_left",
            "centre_circle",
        ]
        .map(|id| field.line_element(id));
        let elements = landmarks.into_iter().chain(lines);
        elements
            .map(|element| ObservedShape::from_element(&field, element.unwrap()).unwrap())
            .collect()
    }

    #[test]
    fn every_group_of_derivatives_agrees_with_central_differences() {
        let click = ImagePoint::new(890.0, 420.0);
        for shape in shapes() {
            let at = |base: CameraBase, ptz: Ptz| {
                shape
                    .residual_px(&PtzCamera::new(base, ptz), click)
                    .unwrap()
            };
            let camera = PtzCamera::new(base(), PTZ);
            let here = shape.jacobian(&camera, click).unwrap();
            assert!((here.value_px - at(base(), PTZ)).norm() < 1e-9);
            let agrees = |analytic: Vec2, value: &dyn Fn(f64) -> Vec2, h: f64, what: &str| {
                let numeric = (value(h) - value(-h)) / (2.0 * h);
                let error = (analytic - numeric).norm();
                assert!(
                    error < 1e-5 * (1.0 + numeric.norm()),
                    "{shape:?}, {what}: {analytic} is not {numeric}"
                );
            };
            let radians = Angle::from_radians;
            let by_ptz = |column: usize| here.by_ptz.column(column).into_owned();
            agrees(
                by_ptz(0),
                &|h| {
                    at(
                        base(),
                        Ptz {
                            pan: PTZ.pan + radians(h),
                            ..PTZ
                        },
                    )
                },
                1e-6,
                "pan",
            );
            agrees(
                by_ptz(1),
                &|h| {
                    at(
                        base(),
                        Ptz {
                            tilt: PTZ.tilt + radians(h),
                            ..PTZ
                        },
                    )
                },
                1e-6,
                "tilt",
            );
            agrees(
                by_ptz(2),
                &|h| {
                    at(
                        base(),
                        Ptz {
                            focal_px: PTZ.focal_px + h,
                            ..PTZ
                        },
                    )
                },
                1e-3,
                "focal length",
            );
            for axis in 0..3 {
                let unit = Vec3::ith(axis, 1.0);
                let moved = |h: f64| CameraBase {
                    position_m: base().position_m + unit * h,
                    ..base()
                };
                let turned = |h: f64| CameraBase {
                    base_from_world: base().base_from_world * from_rotation_vector(unit * h),
                    ..base()
                };
                agrees(
                    here.by_base.column(axis).into_owned(),
                    &|h| at(moved(h), PTZ),
                    1e-5,
                    "position",
                );
                agrees(
                    here.by_base.column(3 + axis).into_owned(),
                    &|h| at(turned(h), PTZ),
                    1e-6,
                    "rotation",
                );
                if let ObservedShape::Point(world) = shape {
                    let raised = |h: f64| {
                        ObservedShape::Point(world + unit * h)
                            .residual_px(&camera, click)
                            .unwrap()
                    };
                    agrees(
                        here.by_world.column(axis).into_owned(),
                        &raised,
                        1e-5,
                        "world",
                    );
                }
            }
            let distorted = |h: f64| CameraBase {
                distortion: FocalCurve {
                    value: base().distortion.value + h,
                    ..base().distortion
                },
                ..base()
            };
            agrees(here.by_k1, &|h| at(distorted(h), PTZ), 1e-5, "k1");
            for (column, towards) in [Vec2::x(), Vec2::y()].into_iter().enumerate() {
                let shifted = |h: f64| CameraBase {
                    principal_point: base().principal_point.translate(towards * h),
                    ..base()
                };
                agrees(
                    here.by_image.column(column).into_owned(),
                    &|h| at(shifted(h), PTZ),
                    1e-4,
                    "image",
                );
            }
            let (value, quick) = shape.residual_by_ptz(&camera, click).unwrap();
            assert!((value - here.value_px).norm() < 1e-9 && (quick - here.by_ptz).norm() < 1e-9);
        }
    }

    #[test]
    fn the_offset_of_a_click_is_as_long_as_its_residual_and_a_move_along_a_way_ends_at_its_end() {
        let camera = PtzCamera::new(base(), PTZ);
        let click = ImagePoint::new(990.0, 520.0);
        for shape in shapes() {
            let (offset, residual) = (
                shape.offset_px(&camera, click).unwrap(),
                shape.residual_px(&camera, click).unwrap(),
            );
            assert!((offset.norm() - residual.norm()).abs() < 1e-6, "{shape:?}");
        }
        let template = builtin("soccer").unwrap();
        let small = template
            .model(&BTreeMap::from([("length_m".to_owned(), 100.0)]), 0.1)
            .unwrap();
        let large = template
            .model(&BTreeMap::from([("length_m".to_owned(), 101.0)]), 0.1)
            .unwrap();
        let middle = template
            .model(&BTreeMap::from([("length_m".to_owned(), 100.25)]), 0.1)
            .unwrap();
        for element in FieldElement::Landmark(0)
            .alike(&small)
            .chain(FieldElement::Line(0).alike(&small))
        {
            let [from, to, there] = [&small, &large, &middle]
                .map(|field| ObservedShape::from_element(field, element).unwrap());
            let moved = from.move_along(&from, &to, 0.25);
            for parameter in [0.0, 0.3, 1.0] {
                assert!(
                    (moved.nominal_at(parameter) - there.nominal_at(parameter)).norm() < 1e-9,
                    "{element:?}"
                );
            }
        }
    }
}
