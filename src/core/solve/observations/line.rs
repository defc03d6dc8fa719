//! The point of a projected line, circle or arc that is nearest to a click.
//!
//! Distortion and crown are included, so the residual is exact. Because the offset from the nearest
//! point is perpendicular to the curve, a small motion of that point along the curve changes
//! nothing: the derivative of the signed distance n · (click − p) is −n · ∂p/∂(parameters) at the
//! nearest point.

use super::world_curve::{CurvePoint, WorldCurve};
use crate::camera::PtzCamera;
use crate::field::Curve;
use crate::geometry::{ImagePoint, Mat3, Vec2, Vec3};
use nalgebra::Matrix2;

/// A point of a curve in the world and in the picture.
#[derive(Clone, Copy)]
pub(super) struct Nearest {
    parameter: f64,
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

impl Nearest {
    /// The point, `world`, m.
    pub const fn in_world(&self) -> Vec3 {
        self.curve.at
    }

    /// The curve's parameter there.
    pub const fn parameter(&self) -> f64 {
        self.parameter
    }

    /// From the point's image to a click, px.
    pub fn offset_to(&self, click: ImagePoint) -> Vec2 {
        click.offset_from(self.image.at)
    }

    /// The signed distance of the click from the projected curve, px; positive on the left of the
    /// curve's direction as the picture shows it (y down).
    pub fn distance_px(&self, click: ImagePoint) -> f64 {
        self.normal().dot(&self.offset_to(click))
    }

    /// The derivative of (signed distance, 0) by the point's image, px/px.
    pub fn by_image(&self) -> Matrix2<f64> {
        let normal = self.normal();
        Matrix2::new(-normal.x, -normal.y, 0.0, 0.0)
    }

    /// The unit normal of the projected curve, to its left.
    fn normal(&self) -> Vec2 {
        let along = self.image.first;
        Vec2::new(along.y, -along.x) / along.norm()
    }
}

/// The point of the projected curve nearest to a click: the best of evenly spaced samples, then
/// Newton on (p(t) − click) · p'(t) = 0, halving steps that lead away.
pub(super) fn nearest_point(
    camera: &PtzCamera,
    curve: &WorldCurve,
    click: ImagePoint,
) -> Option<Nearest> {
    const SEGMENT_SAMPLES: u32 = 8;
    const ARC_SAMPLES: u32 = 24;
    const STEPS: usize = 40;
    /// Steps along the picture's curve shorter than this end the search, px.
    const ENOUGH_PX: f64 = 1e-11;

    // Start at the nearest of evenly spaced samples, because the distance to a projected circle or
    // a distorted line may have several minima. Samples without an image (behind the camera) are
    // skipped.
    let projection = CurveProjection::new(camera);
    let samples = match curve.nominal() {
        Curve::Segment { .. } => SEGMENT_SAMPLES,
        Curve::Arc { .. } => ARC_SAMPLES,
    };
    let squared_px = |image: ImagePoint| image.offset_from(click).norm_squared();
    let (_, start) = (0..=samples)
        .map(|sample| f64::from(sample) / f64::from(samples))
        .filter_map(|t| Some((squared_px(projection.image(curve.point_at(t))?), t)))
        .min_by(|a, b| a.0.total_cmp(&b.0))?;

    // Newton's method on the derivative of half the squared distance, (p − click) · p'. Its second
    // derivative is |p'|² + (p − click) · p''. Where that is small or negative, far from the
    // minimum, |p'|² alone (Gauss–Newton) still gives a descent direction.
    let mut nearest = projection.at(curve, start)?;
    let mut squared = squared_px(nearest.image.at);
    for _ in 0..STEPS {
        let ImageCurvePoint { at, first, second } = nearest.image;
        let offset = at.offset_from(click);
        let speed_squared = first.norm_squared();
        let curvature = speed_squared + offset.dot(&second);
        let slope = offset.dot(&first);
        let mut step = -slope
            / if curvature > 0.1 * speed_squared {
                curvature
            } else {
                speed_squared
            };
        if !step.is_finite() {
            return None;
        }
        // Halve the step until the distance does not grow; stop when the step is below rounding.
        let mut moved = false;
        while step.abs() * speed_squared.sqrt() > ENOUGH_PX {
            if let Some(next) = projection.at(curve, nearest.parameter + step) {
                let next_squared = squared_px(next.image.at);
                if next_squared <= squared {
                    (squared, nearest, moved) = (next_squared, next, true);
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
    cam_from_world: Mat3,
}

impl<'a> CurveProjection<'a> {
    fn new(camera: &'a PtzCamera) -> Self {
        Self {
            camera,
            cam_from_world: camera.cam_from_world(),
        }
    }

    /// A point in `cam`, m.
    fn in_cam(&self, at: Vec3) -> Vec3 {
        self.cam_from_world * (at - self.camera.base().position_m)
    }

    fn image(&self, at: Vec3) -> Option<ImagePoint> {
        self.camera.image_from_cam(self.in_cam(at)).ok()
    }

    fn at(&self, curve: &WorldCurve, t: f64) -> Option<Nearest> {
        let curve = curve.at(t);
        let q = self.in_cam(curve.at);
        let at = self.camera.image_from_cam(q).ok()?;
        let (q1, q2) = (
            self.cam_from_world * curve.first,
            self.cam_from_world * curve.second,
        );
        // Ideal point i = (q_x, q_y) / q_z and its derivatives, then d = i (1 + k₁ i·i + k₂
        // (i·i)²).
        let ideal = q.xy() / q.z;
        let ideal1 = (q1.xy() - ideal * q1.z) / q.z;
        let ideal2 = (q2.xy() - ideal * q2.z - ideal1 * (2.0 * q1.z)) / q.z;
        let lens = self.camera.lens();
        let squared = ideal.norm_squared();
        let squared1 = 2.0 * ideal.dot(&ideal1);
        let squared2 = 2.0 * (ideal1.norm_squared() + ideal.dot(&ideal2));
        // The stretch is a function of r² = i·i, so its derivatives by t follow by the chain rule
        // from those of r².
        let by_squared = lens.k1 + 2.0 * lens.k2 * squared;
        let stretch = lens.stretch(squared);
        let stretch1 = by_squared * squared1;
        let stretch2 = by_squared * squared2 + 2.0 * lens.k2 * squared1 * squared1;
        let focal_px = self.camera.ptz().focal_px;
        let first = (ideal1 * stretch + ideal * stretch1) * focal_px;
        let second = (ideal2 * stretch + ideal1 * (2.0 * stretch1) + ideal * stretch2) * focal_px;
        let [first, second] = [first, second].map(|by_t| lens.pixels_from_square(by_t));
        Some(Nearest {
            parameter: t,
            curve,
            image: ImageCurvePoint { at, first, second },
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::camera::Ptz;
    use crate::field::FieldModel;
    use crate::geometry::Angle;
    use crate::solve::fixtures::base;

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

    const PTZ: Ptz = Ptz::from_degrees(-4.0, -15.0, 1910.0);

    fn curves() -> [WorldCurve; 4] {
        let field = field(0.2);
        let halfway = Curve::Segment {
            from: Vec3::new(0.0, -34.0, 0.0),
            to: Vec3::new(0.0, 34.0, 0.0),
        };
        let touchline = Curve::Segment {
            from: Vec3::new(-52.5, 34.0, 0.0),
            to: Vec3::new(52.5, 34.0, 0.0),
        };
        let post = Curve::Segment {
            from: Vec3::new(-12.0, 3.66, 0.0),
            to: Vec3::new(-12.0, 3.66, 2.44),
        };
        let circle = Curve::Arc {
            centre: Vec3::zeros(),
            radius_m: 9.15,
            start: Angle::ZERO,
            sweep: Angle::from_degrees(360.0),
        };
        [halfway, touchline, post, circle].map(|curve| WorldCurve::on_field(&field, curve))
    }

    #[test]
    fn the_nearest_point_is_nearer_than_ten_thousand_others() {
        let camera = PtzCamera::new(base(), PTZ);
        for curve in curves() {
            for click in [
                [700.0, 300.0],
                [1020.0, 700.0],
                [1300.0, 450.0],
                [950.0, 480.0],
            ]
            .map(ImagePoint::from)
            {
                let found = nearest_point(&camera, &curve, click).unwrap();
                let distance_px = found.distance_px(click).abs();
                assert!(
                    (distance_px - found.offset_to(click).norm()).abs() < 1e-6,
                    "not perpendicular"
                );
                let projection = CurveProjection::new(&camera);
                let least = (-5000..15_000)
                    .filter_map(|step| projection.at(&curve, f64::from(step) / 10_000.0))
                    .map(|point| point.image.at.distance_px(click))
                    .fold(f64::INFINITY, f64::min);
                assert!(distance_px <= least + 1e-9, "{distance_px} vs {least}");
            }
        }
    }

    #[test]
    fn a_click_on_the_curve_has_no_residual_and_one_on_its_left_a_positive_one() {
        let camera = PtzCamera::new(base(), PTZ);
        let halfway = curves()[0];
        let on = camera.image_from_world(halfway.at(0.4).at).unwrap();
        let distance_px = |click: ImagePoint| {
            nearest_point(&camera, &halfway, click)
                .unwrap()
                .distance_px(click)
        };
        assert!(distance_px(on).abs() < 1e-9);
        // The halfway line runs away from the camera, up the picture; its left is the picture's
        // left.
        let left = distance_px(on.translate(Vec2::new(-5.0, 0.0)));
        assert!(left > 4.5, "{left}");
    }
}
