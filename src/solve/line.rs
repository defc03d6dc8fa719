//! The distance of a click from a projected line, circle or arc, and its derivatives.
//!
//! The nearest point of the projected curve is found with distortion and crown in it, so the residual is exact. Because
//! the offset from the nearest point is perpendicular to the curve, a small motion of that point along the curve changes
//! nothing: the derivative of the signed distance n · (click − p) is −n · ∂p/∂(parameters) at the nearest point.

use super::observation::{CurvePoint, WorldCurve};
use crate::camera::PtzCamera;
use crate::field::Curve;
use crate::geometry::{ImagePoint, Vec2, Vec3};
use nalgebra::{Matrix1x3, Matrix1x6};

/// A click against a projected curve.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct LineResidual {
    /// From the nearest point of the projected curve to the click, px.
    pub offset_px: Vec2,
    /// The unit normal of the projected curve, to its left.
    pub across: Vec2,
    /// The signed length of the offset; positive on the left of the curve's direction as the picture shows it (y down).
    pub distance_px: f64,
    /// By pan (px/rad), tilt (px/rad), focal length (px/px).
    pub by_ptz: Matrix1x3<f64>,
    /// By position (px/m) and a rotation vector in `world` (px/rad) of the base.
    pub by_base: Matrix1x6<f64>,
    /// By k₁ alone, px.
    pub by_k1: f64,
    /// By the nearest world point, px/m.
    pub by_world: Matrix1x3<f64>,
    /// The nearest point of the curve, `world`, m.
    pub nearest_in_world: Vec3,
}

/// A click against a projected curve; none where no part of the curve near the click has an image.
pub(crate) fn line_residual(camera: &PtzCamera, curve: &WorldCurve, click: ImagePoint) -> Option<LineResidual> {
    let nearest = nearest_point(camera, curve, click)?;
    let here = camera.image_from_world_jacobian(nearest.curve.at).ok()?;
    let along = nearest.image.first;
    let normal = Vec2::new(along.y, -along.x) / along.norm();
    let offset_px = click.offset_from(here.point);
    let towards = -normal.transpose();
    Some(LineResidual {
        offset_px,
        across: normal,
        distance_px: normal.dot(&offset_px),
        by_ptz: towards * here.by_ptz,
        by_base: towards * here.by_base,
        by_k1: -normal.dot(&here.by_k1),
        by_world: towards * here.by_world,
        nearest_in_world: nearest.curve.at,
    })
}

/// The signed distance alone (see [`LineResidual::distance_px`]).
pub(crate) fn line_distance_px(camera: &PtzCamera, curve: &WorldCurve, click: ImagePoint) -> Option<f64> {
    let nearest = nearest_point(camera, curve, click)?;
    let along = nearest.image.first;
    let offset = click.offset_from(nearest.image.at);
    Some(Vec2::new(along.y, -along.x).dot(&offset) / along.norm())
}

/// A point of a curve in the world and in the picture.
#[derive(Clone, Copy)]
struct Nearest {
    curve: CurvePoint,
    image: ImageCurvePoint,
}

/// A point of a projected curve and its derivatives by the curve's parameter, px.
#[derive(Clone, Copy)]
struct ImageCurvePoint {
    at: ImagePoint,
    first: Vec2,
    second: Vec2,
}

/// The point of the projected curve nearest to a click: the best of evenly spaced samples, then Newton on
/// (p(t) − click) · p'(t) = 0, halving steps that lead away.
fn nearest_point(camera: &PtzCamera, curve: &WorldCurve, click: ImagePoint) -> Option<Nearest> {
    const SEGMENT_SAMPLES: u32 = 8;
    const ARC_SAMPLES: u32 = 24;
    const STEPS: usize = 40;
    /// Steps along the picture's curve shorter than this end the search, px.
    const ENOUGH_PX: f64 = 1e-11;

    let projection = CurveProjection::new(camera);
    let samples = match curve.nominal() {
        Curve::Segment { .. } => SEGMENT_SAMPLES,
        Curve::Arc { .. } => ARC_SAMPLES,
    };
    let mut best: Option<(f64, f64, Nearest)> = None;
    for sample in 0..=samples {
        let t = f64::from(sample) / f64::from(samples);
        let Some(here) = projection.at(curve, t) else { continue };
        let distance = here.image.at.distance_px(click);
        if best.is_none_or(|(_, least, _)| distance < least) {
            best = Some((t, distance, here));
        }
    }
    let (mut t, mut distance, mut nearest) = best?;
    for _ in 0..STEPS {
        let ImageCurvePoint { at, first, second } = nearest.image;
        let offset = at.offset_from(click);
        let speed_squared = first.norm_squared();
        let curvature = speed_squared + offset.dot(&second);
        let slope = offset.dot(&first);
        let mut step = -slope / if curvature > 0.1 * speed_squared { curvature } else { speed_squared };
        if !step.is_finite() {
            return None;
        }
        let mut moved = false;
        while step.abs() * speed_squared.sqrt() > ENOUGH_PX {
            if let Some(next) = projection.at(curve, t + step) {
                let next_distance = next.image.at.distance_px(click);
                if next_distance <= distance {
                    (t, distance, nearest, moved) = (t + step, next_distance, next, true);
                    break;
                }
            }
            step *= 0.5;
        }
        if !moved {
            break;
        }
    }
    (nearest.image.first.norm_squared() > 0.0).then_some(nearest)
}

/// Projects points of curves with their first and second derivatives.
struct CurveProjection<'a> {
    camera: &'a PtzCamera,
    cam_from_world: crate::geometry::Mat3,
}

impl<'a> CurveProjection<'a> {
    fn new(camera: &'a PtzCamera) -> Self {
        Self { camera, cam_from_world: camera.cam_from_world() }
    }

    fn at(&self, curve: &WorldCurve, t: f64) -> Option<Nearest> {
        let curve = curve.at(t);
        let q = self.cam_from_world * (curve.at - self.camera.base().position_m);
        let at = self.camera.image_from_cam(q).ok()?;
        let (q1, q2) = (self.cam_from_world * curve.first, self.cam_from_world * curve.second);
        // Ideal point i = (q_x, q_y) / q_z and its derivatives, then d = i (1 + k₁ i·i).
        let ideal = q.xy() / q.z;
        let ideal1 = (q1.xy() - ideal * q1.z) / q.z;
        let ideal2 = (q2.xy() - ideal * q2.z - ideal1 * (2.0 * q1.z)) / q.z;
        let k1 = self.camera.k1();
        let stretch = 1.0 + k1 * ideal.norm_squared();
        let stretch1 = 2.0 * k1 * ideal.dot(&ideal1);
        let stretch2 = 2.0 * k1 * (ideal1.norm_squared() + ideal.dot(&ideal2));
        let focal_px = self.camera.ptz().focal_px;
        let first = (ideal1 * stretch + ideal * stretch1) * focal_px;
        let second = (ideal2 * stretch + ideal1 * (2.0 * stretch1) + ideal * stretch2) * focal_px;
        Some(Nearest { curve, image: ImageCurvePoint { at, first, second } })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::camera::{BaseAngles, CameraBase, FocalCurve, Ptz};
    use crate::field::FieldModel;
    use crate::geometry::Angle;
    use crate::geometry::rotation::from_rotation_vector;

    fn field(crown_m: f64) -> FieldModel {
        FieldModel {
            template: "soccer".into(),
            params: std::collections::BTreeMap::new(),
            length_m: 105.0,
            width_m: 68.0,
            crown_m,
            landmarks: Vec::new(),
            lines: Vec::new(),
            line_click_sigma_px: 2.0,
        }
    }

    fn base() -> CameraBase {
        CameraBase {
            distortion: FocalCurve { at_focal_px: 2000.0, value: -0.06, per_1000_px: 0.21 },
            ..CameraBase::new(
                Vec3::new(3.0, -62.0, 17.0),
                BaseAngles { roll: Angle::from_degrees(0.7), ..BaseAngles::default() }.base_from_world(),
                ImagePoint::new(955.0, 543.0),
            )
        }
    }

    const PTZ: Ptz = Ptz::from_degrees(-4.0, -15.0, 1910.0);

    fn curves() -> [WorldCurve; 4] {
        let field = field(0.2);
        let halfway = Curve::Segment { from: Vec3::new(0.0, -34.0, 0.0), to: Vec3::new(0.0, 34.0, 0.0) };
        let touchline = Curve::Segment { from: Vec3::new(-52.5, 34.0, 0.0), to: Vec3::new(52.5, 34.0, 0.0) };
        let post = Curve::Segment { from: Vec3::new(-12.0, 3.66, 0.0), to: Vec3::new(-12.0, 3.66, 2.44) };
        let circle =
            Curve::Arc { centre: Vec3::zeros(), radius_m: 9.15, start: Angle::ZERO, sweep: Angle::from_degrees(360.0) };
        [halfway, touchline, post, circle].map(|curve| WorldCurve::on_field(&field, curve))
    }

    #[test]
    fn the_nearest_point_is_nearer_than_ten_thousand_others() {
        let camera = PtzCamera::new(base(), PTZ);
        for curve in curves() {
            for click in [[700.0, 300.0], [1020.0, 700.0], [1300.0, 450.0], [950.0, 480.0]].map(ImagePoint::from) {
                let found = line_residual(&camera, &curve, click).unwrap();
                assert!((found.distance_px.abs() - found.offset_px.norm()).abs() < 1e-6, "not perpendicular");
                let projection = CurveProjection::new(&camera);
                let least = (-5000..15_000)
                    .filter_map(|step| projection.at(&curve, f64::from(step) / 10_000.0))
                    .map(|point| point.image.at.distance_px(click))
                    .fold(f64::INFINITY, f64::min);
                assert!(found.distance_px.abs() <= least + 1e-9, "{} vs {least}", found.distance_px);
                let alone = line_distance_px(&camera, &curve, click).unwrap();
                assert!((found.distance_px - alone).abs() < 1e-9);
            }
        }
    }

    #[test]
    fn a_click_on_the_curve_has_no_residual_and_one_on_its_left_a_positive_one() {
        let camera = PtzCamera::new(base(), PTZ);
        let halfway = curves()[0];
        let on = camera.image_from_world(halfway.at(0.4).at).unwrap();
        assert!(line_distance_px(&camera, &halfway, on).unwrap().abs() < 1e-9);
        // The halfway line runs away from the camera, up the picture; its left is the picture's left.
        let left = line_distance_px(&camera, &halfway, on.moved(Vec2::new(-5.0, 0.0))).unwrap();
        assert!(left > 4.5, "{left}");
    }

    #[test]
    fn derivatives_agree_with_central_differences() {
        let difference = |f: &dyn Fn(f64) -> f64, h: f64| (f(h) - f(-h)) / (2.0 * h);
        for curve in curves() {
            for click in [ImagePoint::new(890.0, 420.0), ImagePoint::new(1100.0, 560.0)] {
                let at =
                    |base: CameraBase, ptz: Ptz| line_distance_px(&PtzCamera::new(base, ptz), &curve, click).unwrap();
                let here = line_residual(&PtzCamera::new(base(), PTZ), &curve, click).unwrap();
                let radians = Angle::from_radians;
                let numeric = [
                    difference(&|h| at(base(), Ptz { pan: PTZ.pan + radians(h), ..PTZ }), 1e-6),
                    difference(&|h| at(base(), Ptz { tilt: PTZ.tilt + radians(h), ..PTZ }), 1e-6),
                    difference(&|h| at(base(), Ptz { focal_px: PTZ.focal_px + h, ..PTZ }), 1e-3),
                ];
                for (column, numeric) in numeric.into_iter().enumerate() {
                    let error = (here.by_ptz[column] - numeric).abs();
                    assert!(error < 1e-5 * (1.0 + numeric.abs()), "ptz {column}: {error}");
                }
                for axis in 0..3 {
                    let unit = Vec3::ith(axis, 1.0);
                    let shifted = |h: f64| CameraBase { position_m: base().position_m + unit * h, ..base() };
                    let turned = |h: f64| CameraBase {
                        base_from_world: base().base_from_world * from_rotation_vector(unit * h),
                        ..base()
                    };
                    let position = difference(&|h| at(shifted(h), PTZ), 1e-4);
                    let rotation = difference(&|h| at(turned(h), PTZ), 1e-6);
                    assert!((here.by_base[axis] - position).abs() < 1e-5 * (1.0 + position.abs()));
                    assert!((here.by_base[3 + axis] - rotation).abs() < 1e-5 * (1.0 + rotation.abs()));
                }
                let lens = |h: f64| CameraBase {
                    distortion: FocalCurve { value: base().distortion.value + h, ..base().distortion },
                    ..base()
                };
                let by_k1 = difference(&|h| at(lens(h), PTZ), 1e-5);
                assert!((here.by_k1 - by_k1).abs() < 1e-5 * (1.0 + by_k1.abs()), "{} {by_k1}", here.by_k1);
            }
        }
    }
}
