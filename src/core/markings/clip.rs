//! Clips straight pieces to the visible part: in `cam` to the near plane, the window's sides and
//! the fold of the lens; in `image` to the frame.

use crate::camera::PtzCamera;
use crate::geometry::{ImagePoint, ImageSize, Vec2, Vec3};

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

/// Minimum depth of drawn lines, m.
pub const NEAR_M: f64 = 0.05;
/// The maximum radius of drawn lines, as a fraction of the radius at which the distortion model
/// folds.
const FOLD_SHARE: f64 = 1.0 - 1e-4;

/// The rectangle of the picture to draw in, and bounds of its preimage on the undistorted plane.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Window {
    /// The first corner of the frame with its margin, px.
    pub min: ImagePoint,
    /// The opposite corner, px.
    pub max: ImagePoint,
    /// Minimum visible ideal x and y.
    pub ideal_min: Vec2,
    /// Maximum visible ideal x and y.
    pub ideal_max: Vec2,
    /// Maximum ideal radius that is visible and has an image.
    pub ideal_radius: f64,
}

impl Window {
    /// The window of a camera's picture. None if the camera has NaN or infinite parameters.
    pub fn new(camera: &PtzCamera, size: ImageSize, margin_px: f64) -> Option<Self> {
        if !(camera.ptz().is_finite() && camera.base().is_finite() && margin_px.is_finite()) {
            return None;
        }
        let min = ImagePoint::new(-margin_px, -margin_px);
        let max = ImagePoint::new(
            f64::from(size.width) + margin_px,
            f64::from(size.height) + margin_px,
        );
        if !(min.x < max.x && min.y < max.y) {
            return None;
        }
        // The lens scales a radius by a factor that depends on the radius alone. So the extremes of
        // the ideal coordinates on an edge can lie only at its ends, at its point nearest to the
        // principal point, and where the factor is smallest.
        let principal = camera.base().principal_point;
        let (near_x, near_y) = (
            principal.x.clamp(min.x, max.x),
            principal.y.clamp(min.y, max.y),
        );
        let on_edges = [min.y, near_y, max.y]
            .into_iter()
            .flat_map(|y| [ImagePoint::new(min.x, y), ImagePoint::new(max.x, y)])
            .chain([min.y, max.y].map(|y| ImagePoint::new(near_x, y)))
            .chain(most_shrunk(camera, min, max));
        let fold = camera.fold_radius() * FOLD_SHARE;
        let mut window = Self {
            min,
            max,
            ideal_min: Vec2::repeat(0.0),
            ideal_max: Vec2::repeat(0.0),
            ideal_radius: 0.0,
        };
        let (mut low, mut high) = (Vec2::repeat(f64::INFINITY), Vec2::repeat(f64::NEG_INFINITY));
        for point in on_edges {
            // A point beyond the fold has no ray. Then the fold bounds the window.
            if let Ok(ideal) = camera.cam_plane_from_image(point) {
                window.ideal_radius = window.ideal_radius.max(ideal.norm());
                (low, high) = (low.inf(&ideal), high.sup(&ideal));
            } else {
                window.ideal_radius = fold;
                (low, high) = (Vec2::repeat(-fold), Vec2::repeat(fold));
            }
        }
        // The square around the visible disc may be smaller than what the edges reach.
        window.ideal_radius = window.ideal_radius.min(fold);
        let disc = Vec2::repeat(window.ideal_radius);
        (window.ideal_min, window.ideal_max) = (low.sup(&-disc), high.inf(&disc));
        (window.ideal_radius > 0.0).then_some(window)
    }
}

/// The points of a rectangle's edges at the radius where the lens's factor is smallest. None if
/// there is no such radius.
fn most_shrunk(
    camera: &PtzCamera,
    min: ImagePoint,
    max: ImagePoint,
) -> impl Iterator<Item = ImagePoint> {
    // In a picture with square pixels that radius is a circle about the principal point, which
    // meets each edge at up to two points. A radius of NaN makes all of them NaN, which the filter
    // drops.
    let (lens, principal) = (camera.lens(), camera.base().principal_point);
    let squared = lens.narrowest_radius_squared();
    let radius_px = squared.map_or(f64::NAN, |squared| {
        squared.sqrt() * lens.stretch(squared) * camera.ptz().focal_px
    });
    let upright = [min.x, max.x].into_iter().flat_map(move |x| {
        let half = half_chord_px(radius_px, x - principal.x);
        [-half, half].map(|y| ImagePoint::new(x, principal.y + y * lens.pixel_aspect))
    });
    let level = [min.y, max.y].into_iter().flat_map(move |y| {
        let half = half_chord_px(radius_px, (y - principal.y) / lens.pixel_aspect);
        [principal.x - half, principal.x + half].map(|x| ImagePoint::new(x, y))
    });
    upright
        .chain(level)
        .filter(move |p| (min.x..=max.x).contains(&p.x) && (min.y..=max.y).contains(&p.y))
}

/// Half of the chord of a circle at a distance from its centre, px; NaN, which lies in no range, if
/// the circle does not reach there.
fn half_chord_px(radius_px: f64, offset_px: f64) -> f64 {
    (radius_px * radius_px - offset_px * offset_px).sqrt()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::camera::{CameraBase, FocalCurve, Ptz};
    use crate::geometry::Vec2;
    use crate::testing::{SIZE, base_at};
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

    fn camera(distortion: FocalCurve, focal_px: f64) -> PtzCamera {
        let base = base_at([0.0; 3], SIZE);
        PtzCamera::new(
            CameraBase { distortion, ..base },
            Ptz::from_degrees(0.0, 0.0, focal_px),
        )
    }

    #[test]
    fn the_window_holds_every_point_of_the_picture() {
        let without_k2 = [(0.0, 2000.0), (-0.1, 1500.0), (0.3, 1500.0), (-0.4, 900.0)];
        let with_k2 = [(-0.25, 900.0, 2.0), (-0.25, 900.0, 0.5), (0.3, 1500.0, 2.0)];
        for (k1, focal_px, k2_per_k1_squared) in without_k2
            .map(|(k1, px)| (k1, px, 0.0))
            .into_iter()
            .chain(with_k2)
        {
            let camera = camera(
                FocalCurve {
                    k2_per_k1_squared,
                    ..FocalCurve::constant(k1)
                },
                focal_px,
            );
            let window = Window::new(&camera, ImageSize::new(1920, 1080), 4.0).unwrap();
            for step in 0..4000 {
                let (x, y) = (f64::from(step % 80) * 24.3, f64::from(step / 80) * 22.0);
                let Ok(ideal) = camera.cam_plane_from_image(ImagePoint::new(x, y)) else {
                    continue;
                };
                assert!(
                    ideal.norm() <= window.ideal_radius + 1e-12 || k1 < 0.0,
                    "k1 {k1}: {ideal}"
                );
                if ideal.norm() <= window.ideal_radius {
                    assert!(
                        ideal >= window.ideal_min - Vec2::repeat(1e-12),
                        "k1 {k1}: {ideal}"
                    );
                    assert!(
                        ideal <= window.ideal_max + Vec2::repeat(1e-12),
                        "k1 {k1}: {ideal}"
                    );
                }
            }
        }
    }

    #[test]
    fn a_camera_of_nan_has_no_window() {
        assert_eq!(
            Window::new(
                &camera(FocalCurve::constant(f64::NAN), 2000.0),
                ImageSize::new(1920, 1080),
                4.0
            ),
            None
        );
        assert_eq!(
            Window::new(
                &camera(FocalCurve::NONE, f64::NAN),
                ImageSize::new(1920, 1080),
                4.0
            ),
            None
        );
        assert_eq!(
            Window::new(&camera(FocalCurve::NONE, 2000.0), ImageSize::new(0, 0), 0.0),
            None
        );
    }
}
