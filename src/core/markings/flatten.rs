//! Approximates a field's curve by straight pieces in `cam`, as fine as the picture's resolution
//! requires.

use super::clip::{NEAR_M, Window, within_pyramid};
use crate::camera::PtzCamera;
use crate::field::{Curve, FieldModel};
use crate::geometry::{Mat3, Vec3};

/// Maximum depth of the bisection of a curve.
const MAX_DEPTH: u32 = 10;

/// Camera, window and tolerance for all curves of one picture.
pub struct Flattener<'a> {
    field: &'a FieldModel,
    window: &'a Window,
    cam_from_world: Mat3,
    origin_in_cam: Vec3,
    /// Upper bound of the motion of an image point per rotation of its ray, px/rad.
    px_per_radian: f64,
    tolerance_px: f64,
}

/// A point of a curve at parameter t.
#[derive(Clone, Copy)]
struct Knot {
    t: f64,
    nominal_y_m: f64,
    in_cam: Vec3,
}

impl<'a> Flattener<'a> {
    pub fn new(
        field: &'a FieldModel,
        camera: &PtzCamera,
        window: &'a Window,
        tolerance_px: f64,
    ) -> Self {
        // d(tan θ) = (1 + r²) dθ in the radial direction, times the largest slope of the distortion
        // up to the window's largest radius, in the direction in which pixels are denser.
        let radius_squared = window.ideal_radius * window.ideal_radius;
        let lens = camera.lens();
        let stretch = lens.greatest_slope(radius_squared) * lens.pixel_aspect.max(1.0);
        Self {
            field,
            window,
            cam_from_world: camera.cam_from_world(),
            origin_in_cam: camera.cam_from_world_point(Vec3::zeros()),
            px_per_radian: camera.ptz().focal_px * (1.0 + radius_squared) * stretch,
            tolerance_px,
        }
    }

    /// Calls `piece` for the visible straight pieces of a curve, in order, with their ends in
    /// `cam`, m.
    pub fn flatten(&self, curve: &Curve, piece: &mut impl FnMut(Vec3, Vec3)) {
        // Start with quarters of a circle: the chord of a whole circle is a point, and half a
        // circle may be visible although its chord is not.
        let parts = match curve {
            Curve::Segment { .. } => 1,
            Curve::Arc { sweep, .. } => (sweep.radians().abs() / std::f64::consts::FRAC_PI_2)
                .ceil()
                .clamp(1.0, 8.0) as u32,
        };
        let mut from = self.knot(curve, 0.0);
        for part in 1..=parts {
            let to = self.knot(curve, f64::from(part) / f64::from(parts));
            self.halve(curve, from, to, MAX_DEPTH, piece);
            from = to;
        }
    }

    fn knot(&self, curve: &Curve, t: f64) -> Knot {
        let nominal = curve.point_at(t);
        let in_world = self.field.world_from_nominal(nominal);
        Knot {
            t,
            nominal_y_m: nominal.y,
            in_cam: self.cam_from_world * in_world + self.origin_in_cam,
        }
    }

    /// Bisects the curve between two knots until the chord is within the tolerance in the picture.
    fn halve(
        &self,
        curve: &Curve,
        a: Knot,
        b: Knot,
        depth: u32,
        piece: &mut impl FnMut(Vec3, Vec3),
    ) {
        if !a
            .in_cam
            .iter()
            .chain(b.in_cam.iter())
            .all(|x| x.is_finite())
        {
            return;
        }
        // Discard a part that is invisible even if the curve deviates from its chord by `bend_m`.
        let bend_m = self.bend_m(curve, a, b);
        let Some(span) = within_pyramid(self.window, a.in_cam, b.in_cam, bend_m) else {
            return;
        };

        // The deviation divided by the smallest depth of the visible part is an angle. Times
        // px/rad, it is a distance in the picture.
        let [start_m, end_m] =
            [span.start, span.end].map(|t| a.in_cam.z + (b.in_cam.z - a.in_cam.z) * t);
        let nearest_m = (start_m.min(end_m) - bend_m).max(NEAR_M);
        if depth == 0 || bend_m / nearest_m * self.px_per_radian <= self.tolerance_px {
            piece(a.in_cam, b.in_cam);
            return;
        }
        let middle = self.knot(curve, a.t.midpoint(b.t));
        self.halve(curve, a, middle, depth - 1, piece);
        self.halve(curve, middle, b, depth - 1, piece);
    }

    /// Upper bound of the distance between the curve and its chord, m: (Δt)² / 8 · max |second
    /// derivative|. If the piece may cross the edge of the crown, where the ground has a kink, a
    /// term for it is added.
    fn bend_m(&self, curve: &Curve, a: Knot, b: Knot) -> f64 {
        let width_m = self.field.width_m;
        let crown_m = self.field.crown_m.abs();
        let (round, across_m) = match *curve {
            Curve::Segment { .. } => (0.0, (b.nominal_y_m - a.nominal_y_m).abs()),
            Curve::Arc {
                radius_m, sweep, ..
            } => {
                let turn = (sweep.radians() * (b.t - a.t)).abs();
                // By the angle θ, |r''| = r in the plane, and on the crown z = −4 c y² / w² it is
                // |z''| = 8 c / w² · |y'² + y y''|, with |y'|, |y''| ≤ r and |y| ≤ w / 2.
                let second = radius_m
                    + 8.0 * crown_m / (width_m * width_m) * radius_m * (radius_m + width_m / 2.0);
                (second * turn * turn / 8.0, radius_m * turn)
            }
        };
        if crown_m == 0.0 {
            return round;
        }
        // The crown bends a straight piece by |z''| / 8 = c (Δy / w)². At its edge the slope jumps by
        // 4 c / w; a kink deviates from the chord by at most a quarter of the jump times the length.
        let edge_m = width_m / 2.0;
        let at_the_edge = [a.nominal_y_m, b.nominal_y_m]
            .iter()
            .any(|y_m| (y_m.abs() - edge_m).abs() <= across_m);
        let crown = crown_m * (across_m / width_m).powi(2);
        round
            + crown
            + if at_the_edge {
                crown_m * across_m / width_m
            } else {
                0.0
            }
    }
}
