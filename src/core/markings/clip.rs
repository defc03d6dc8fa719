//! Clips straight pieces to the visible part: in `cam` to the near plane, the window's sides and
//! the fold of the lens; in `image` to the frame.

use super::window::{NEAR_M, Window};
use crate::geometry::{ImagePoint, Vec3};

/// The remaining part of a straight piece, as fractions of its length from 0 to 1.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Span {
    /// Its start.
    pub start: f64,
    /// Its end, not before `start`.
    pub end: f64,
}

impl Span {
    /// The whole piece.
    pub const WHOLE: Self = Self {
        start: 0.0,
        end: 1.0,
    };

    /// Keeps the part where `at_0 + (at_1 − at_0) t` is not negative.
    fn keep(self, at_0: f64, at_1: f64) -> Option<Self> {
        if at_0 >= 0.0 && at_1 >= 0.0 {
            return Some(self);
        }
        if !(at_0 >= 0.0 || at_1 >= 0.0) {
            return None;
        }
        // One end is inside and the other outside, so the difference is not zero.
        let crossing = at_0 / (at_0 - at_1);
        let (start, end) = if at_0 < 0.0 {
            (self.start.max(crossing), self.end)
        } else {
            (self.start, self.end.min(crossing))
        };
        (start <= end).then_some(Self { start, end })
    }
}

/// The part of the piece from `a` to `b` (`cam`, m) that lies in the window's pyramid, enlarged by
/// `slack_m` on all sides.
pub fn within_pyramid(window: &Window, a: Vec3, b: Vec3, slack_m: f64) -> Option<Span> {
    let mut span = Span::WHOLE.keep(a.z - NEAR_M + slack_m, b.z - NEAR_M + slack_m)?;
    // A side is a plane through the camera, x = bound · z. The distance from it is (x − bound · z)
    // / √(1 + bound²), hence the factor on the slack.
    for (axis, bound, sign) in [
        (0, window.ideal_min.x, 1.0),
        (0, window.ideal_max.x, -1.0),
        (1, window.ideal_min.y, 1.0),
        (1, window.ideal_max.y, -1.0),
    ] {
        let slack = slack_m * (1.0 + bound * bound).sqrt();
        let [at_a, at_b] = [a, b].map(|point| sign * (point[axis] - bound * point.z) + slack);
        span = span.keep(at_a, at_b)?;
    }
    Some(span)
}

/// The part of a span in front of the camera that lies in the cone of the ideal radius, that is
/// within the fold.
pub fn within_cone(window: &Window, a: Vec3, b: Vec3, span: Span) -> Option<Span> {
    let radius_squared = window.ideal_radius * window.ideal_radius;
    let along = b - a;
    let [starts_inside, ends_inside] = [span.start, span.end].map(|t| {
        let p = a + along * t;
        cone_form(radius_squared, p, p) >= 0.0
    });
    if starts_inside && ends_inside {
        return Some(span);
    }
    // The cone in front of the camera is convex, so the remaining part is one span, bounded by the
    // roots of the quadratic form along the piece.
    let square = cone_form(radius_squared, along, along);
    let half_linear = cone_form(radius_squared, a, along);
    let constant = cone_form(radius_squared, a, a);
    let discriminant = half_linear * half_linear - square * constant;
    if !(discriminant >= 0.0) || square == 0.0 {
        return None;
    }
    let root = discriminant.sqrt();
    let (first, second) = (
        (-half_linear - root) / square,
        (-half_linear + root) / square,
    );
    let (first, second) = (first.min(second), first.max(second));
    // A negative leading coefficient: inside between the roots. A positive one: inside beyond them,
    // where one side belongs to the cone behind the camera.
    let (start, end) = if square < 0.0 {
        (span.start.max(first), span.end.min(second))
    } else if starts_inside {
        (span.start, span.end.min(first))
    } else if ends_inside {
        (span.start.max(second), span.end)
    } else {
        return None;
    };
    (start <= end).then_some(Span { start, end })
}

/// The bilinear form of the cone x² + y² = R² z²: R² `p_z q_z − p_x q_x − p_y q_y`, which is not
/// negative for p = q inside the cone.
fn cone_form(radius_squared: f64, p: Vec3, q: Vec3) -> f64 {
    radius_squared * p.z * q.z - p.x * q.x - p.y * q.y
}

/// The part of the piece from `a` to `b` (`image`, px) that lies in the window's frame (Liang,
/// Barsky 1984).
pub fn within_frame(window: &Window, a: ImagePoint, b: ImagePoint) -> Option<Span> {
    Span::WHOLE
        .keep(a.x - window.min.x, b.x - window.min.x)?
        .keep(window.max.x - a.x, window.max.x - b.x)?
        .keep(a.y - window.min.y, b.y - window.min.y)?
        .keep(window.max.y - a.y, window.max.y - b.y)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::Vec2;
    use proptest::prelude::*;

    fn window(radius: f64) -> Window {
        Window {
            min: ImagePoint::new(0.0, 0.0),
            max: ImagePoint::new(100.0, 50.0),
            ideal_min: Vec2::new(-0.5, -0.3),
            ideal_max: Vec2::new(0.5, 0.3),
            ideal_radius: radius,
        }
    }

    proptest! {
        #[test]
        fn what_is_kept_is_inside_and_what_is_cut_is_outside(
            a in prop::array::uniform3(-20.0..20.0f64), b in prop::array::uniform3(-20.0..20.0f64), radius in 0.2..0.6f64,
        ) {
            let (a, b) = (Vec3::from(a), Vec3::from(b));
            let window = window(radius);
            let kept = within_pyramid(&window, a, b, 0.0).and_then(|span| within_cone(&window, a, b, span));
            for step in 0..=200 {
                let t = f64::from(step) / 200.0;
                let p = a + (b - a) * t;
                let ideal = Vec2::new(p.x / p.z, p.y / p.z);
                let room = (p.z - NEAR_M)
                    .min(0.5 - ideal.x.abs())
                    .min(0.3 - ideal.y.abs())
                    .min(radius - ideal.norm());
                let is_kept = kept.is_some_and(|span| span.start <= t && t <= span.end);
                if room > 1e-9 {
                    prop_assert!(is_kept, "cut at {t} with room {room}");
                } else if room < -1e-9 {
                    prop_assert!(!is_kept, "kept at {t} with room {room}");
                }
            }
        }
    }
}
