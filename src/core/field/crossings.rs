//! Where two curves of a field meet.

use super::Curve;
use crate::geometry::{Vec2, Vec3};

/// Curves that miss each other by less than this meet, m: rules give their measures to the
/// centimetre.
const TOUCH_M: f64 = 0.005;

impl Curve {
    /// The points where it crosses or touches another curve of the ground, m; none of curves that
    /// share a stretch.
    pub fn crossings(&self, other: &Self) -> Vec<Vec3> {
        let endless = match (*self, *other) {
            (Self::Segment { from, to }, Self::Segment { from: a, to: b }) => {
                crossing_of_lines([from, to].map(|end| end.xy()), [a, b].map(|end| end.xy()))
            }
            (
                Self::Segment { from, to },
                Self::Arc {
                    centre, radius_m, ..
                },
            )
            | (
                Self::Arc {
                    centre, radius_m, ..
                },
                Self::Segment { from, to },
            ) => crossings_of_circle(centre.xy(), radius_m, from.xy(), (to - from).xy()),
            (
                Self::Arc {
                    centre, radius_m, ..
                },
                Self::Arc {
                    centre: other,
                    radius_m: of_other_m,
                    ..
                },
            ) => {
                // The common chord: the points of equal power with respect to both circles.
                let between = (other - centre).xy();
                let squared = between.norm_squared();
                let share = 0.5 + (radius_m.powi(2) - of_other_m.powi(2)) / (2.0 * squared);
                let on_chord = centre.xy() + between * share;
                let along = Vec2::new(-between.y, between.x);
                crossings_of_circle(centre.xy(), radius_m, on_chord, along)
            }
        };
        // Of those of the endless lines and circles, what lies on both pieces. Parallels, and
        // circles about one centre, give no finite point.
        let points = endless.into_iter().map(|at| Vec3::new(at.x, at.y, 0.0));
        points
            .filter(|at| at.iter().all(|part| part.is_finite()))
            .filter(|at| [self, other].iter().all(|of| of.distance_m(*at) < TOUCH_M))
            .collect()
    }
}

/// The crossing of two endless lines; none of parallel ones.
fn crossing_of_lines([a, b]: [Vec2; 2], [c, d]: [Vec2; 2]) -> Vec<Vec2> {
    let (along, other) = (b - a, d - c);
    // Cramer's rule; the area is 0 where they are parallel.
    let area = along.perp(&other);
    if area.abs() < 1e-9 * along.norm() * other.norm() {
        return Vec::new();
    }
    vec![a + along * ((c - a).perp(&other) / area)]
}

/// The crossings of a circle with an endless line; one where the line touches it.
fn crossings_of_circle(centre: Vec2, radius_m: f64, on_line: Vec2, along: Vec2) -> Vec<Vec2> {
    let along = along.normalize();
    let foot = on_line + along * (centre - on_line).dot(&along);
    let distance_m = (foot - centre).norm();
    if (distance_m - radius_m).abs() < TOUCH_M {
        return vec![foot];
    }
    // Not a number where the line passes the circle by: such points are dropped.
    let half_chord_m = (radius_m.powi(2) - distance_m.powi(2)).sqrt();
    [-half_chord_m, half_chord_m]
        .map(|step_m| foot + along * step_m)
        .to_vec()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::field::builtin;

    #[test]
    fn lines_of_a_soccer_field_meet_where_its_landmarks_are() {
        let field = builtin("soccer").unwrap().default_model().unwrap();
        let crossings = |one: &str, other: &str| {
            let [one, other] = [one, other].map(|id| field.line(id).unwrap());
            one.curve.crossings(&other.curve)
        };
        let landmark = |id: &str| field.landmark(id).unwrap().nominal_m;
        let corner = crossings("touchline_near", "goal_line_left");
        assert_eq!(corner.len(), 1);
        assert!((corner[0] - landmark("corner_near_left")).norm() < 1e-9);
        let halfway = crossings("halfway_line", "centre_circle");
        assert_eq!(halfway.len(), 2);
        assert!((halfway[0].y.abs() - 9.15).abs() < 1e-9 && halfway[0].y == -halfway[1].y);
        assert!(crossings("touchline_near", "touchline_far").is_empty());
        assert!(crossings("halfway_line", "goal_line_left").is_empty());
    }

    #[test]
    fn circles_meet_twice_touch_once_or_not_at_all() {
        let circle = |x, radius_m| Curve::Arc {
            centre: Vec3::new(x, 0.0, 0.0),
            radius_m,
            start: crate::geometry::Angle::default(),
            sweep: crate::geometry::Angle::from_degrees(360.0),
        };
        let count = |x, radius_m| circle(0.0, 2.0).crossings(&circle(x, radius_m)).len();
        assert_eq!(
            [count(3.0, 2.0), count(4.0, 2.0), count(5.0, 2.0)],
            [2, 1, 0]
        );
        assert_eq!(count(0.0, 2.0), 0, "the same circle");
    }
}
