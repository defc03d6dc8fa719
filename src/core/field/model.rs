//! A field of one venue: a template with its parameters filled in.

use crate::geometry::{Angle, Vec3, distance_from_segment};
use serde::Serialize;
use std::collections::BTreeMap;
use std::fmt;
use std::sync::Arc;

macro_rules! name_type {
    ($(#[$doc:meta])* $name:ident) => {
        $(#[$doc])*
        #[derive(Clone, PartialEq, Eq, PartialOrd, Ord, Hash, Serialize)]
        #[serde(transparent)]
        pub struct $name(Arc<str>);

        impl $name {
            /// The name as the document writes it.
            pub fn as_str(&self) -> &str {
                &self.0
            }
        }

        impl From<&str> for $name {
            fn from(name: &str) -> Self {
                Self(name.into())
            }
        }

        impl fmt::Display for $name {
            fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
                f.write_str(&self.0)
            }
        }

        impl fmt::Debug for $name {
            fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
                write!(f, "{:?}", &*self.0)
            }
        }
    };
}

name_type! {
    /// The name of a landmark, such as `centre_mark`; unique within a template.
    LandmarkId
}
name_type! {
    /// The name of a line, such as `halfway_line`; unique within a template.
    LineId
}

/// A point of the field that can be clicked, on the ground or above it.
#[derive(Clone, Debug, PartialEq)]
pub struct Landmark {
    /// Its name in documents.
    pub id: LandmarkId,
    /// The label for the user: "Centre mark".
    pub label: String,
    /// Two to four letters to type: "cm".
    pub code: String,
    /// Its position by the rules, `world`, m, without the crown.
    pub nominal_m: Vec3,
    /// The click noise: 1-σ of a click in px at 1920 px width.
    pub click_sigma_px: f64,
    /// The part of the click noise that comes from the landmark's position on the ground, not from
    /// clicking: paint is wide, and pitches are not painted to the centimetre. It remains however
    /// exactly a point is placed. 1-σ, px at 1920 px width.
    pub place_sigma_px: f64,
    /// The diameter of the spot painted around it, m; none where there is no spot.
    pub spot_diameter_m: Option<f64>,
    /// Whether no paint marks it: a point along a curve, defined by a direction on the ground. In a
    /// picture it is not where the curve looks widest, so it can be found only with a known camera.
    pub is_unmarked: bool,
}

impl Landmark {
    /// Whether it lies on the ground by the rules, and is not the top of a post.
    pub fn is_on_ground(&self) -> bool {
        self.nominal_m.z == 0.0
    }
}

/// The fraction of a template's click variance `σ²` that comes from clicking; the rest comes from
/// the landmark's position (see `calibrate`'s own noise).
pub const CLICKING_SHARE: f64 = 0.5;

/// A straight marking, circle, arc or post on which a click can lie.
#[derive(Clone, Debug, PartialEq)]
pub struct FieldLine {
    /// Its name in documents.
    pub id: LineId,
    /// The label for the user: "Halfway line".
    pub label: String,
    /// Two to four letters to type.
    pub code: String,
    /// Its curve by the rules.
    pub curve: Curve,
    /// The width of the paint (or of the post), m.
    pub width_m: f64,
    /// Which edge of the paint the nominal line is; used only for painting, drawing to scale and
    /// aligning to paint.
    pub edge: PaintEdge,
    /// The centre line of the paint (or of the post): `curve` moved by half the width according to
    /// `edge`.
    pub paint_centre: Curve,
    /// Whether it is painted on the ground; false for posts, crossbars, nets and boards.
    pub painted: bool,
    /// Length of the dashes and of the gaps between them, m; none for a whole line. Rules say
    /// seldom where the first dash begins: as drawn here, a line begins and ends with a whole one.
    pub dash_m: Option<[f64; 2]>,
}

impl FieldLine {
    /// The share of its length that has paint, 0 to 1.
    pub fn painted_share(&self) -> f64 {
        self.dash_m
            .map_or(1.0, |[dash_m, gap_m]| dash_m / (dash_m + gap_m))
    }

    /// Its nominal curve or the centre of its paint in pieces: the dashes, or the whole.
    pub fn pieces(&self, curve: &Curve) -> impl Iterator<Item = Curve> + use<> {
        let (number, period, share) = match self.dash_m {
            Some([dash_m, gap_m]) => {
                let period_m = dash_m + gap_m;
                // n dashes have n − 1 gaps between them.
                // The nearest whole number of dashes, all lengths stretched alike to fit.
                let number = ((curve.length_m() + gap_m) / period_m).round().max(1.0);
                let period = period_m / (number * period_m - gap_m);
                (number, period, dash_m / period_m)
            }
            None => (1.0, 1.0, 1.0),
        };
        let curve = *curve;
        (0..number as usize).map(move |piece| {
            // Parameters of the curve, which its length is proportional to.
            let from = piece as f64 * period;
            curve.part(from, from + period * share)
        })
    }
}

/// Which edge of the paint a nominal line is.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum PaintEdge {
    /// The paint is centred on the nominal line.
    #[default]
    Centre,
    /// The nominal line is the paint's outer edge: the paint belongs to the area that the line
    /// bounds.
    Outer,
    /// The nominal line is the paint's inner edge: the paint lies around the area.
    Inner,
}

/// A curve in `world`, m, nominal (without the crown).
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Curve {
    /// A straight piece.
    Segment {
        /// One end.
        from: Vec3,
        /// The other end.
        to: Vec3,
    },
    /// A circle or a part of one, in a horizontal plane.
    Arc {
        /// The centre.
        centre: Vec3,
        /// The radius, m.
        radius_m: f64,
        /// The direction of the first point, from +x towards +y.
        start: Angle,
        /// The angle from the first to the last point, positive from +x towards +y; 360° is a
        /// circle.
        sweep: Angle,
    },
}

impl PaintEdge {
    /// Its name in templates.
    pub const fn name(self) -> &'static str {
        match self {
            Self::Centre => "centre",
            Self::Outer => "outer",
            Self::Inner => "inner",
        }
    }

    /// The distance of the paint's centre line from the nominal line towards the inside, in widths.
    pub const fn inward_shift(self) -> f64 {
        match self {
            Self::Centre => 0.0,
            Self::Outer => 0.5,
            Self::Inner => -0.5,
        }
    }
}

impl Curve {
    /// The point at parameter `t`: 0 is the first end, 1 the last; values outside go beyond the
    /// ends.
    pub fn point_at(&self, t: f64) -> Vec3 {
        match *self {
            Self::Segment { from, to } => from + (to - from) * t,
            Self::Arc {
                centre,
                radius_m,
                start,
                sweep,
            } => {
                let (sin, cos) = (start + sweep * t).sin_cos();
                centre + Vec3::new(cos, sin, 0.0) * radius_m
            }
        }
    }

    /// The part between two parameters.
    fn part(&self, from_t: f64, to_t: f64) -> Self {
        match *self {
            Self::Segment { .. } => Self::Segment {
                from: self.point_at(from_t),
                to: self.point_at(to_t),
            },
            Self::Arc {
                centre,
                radius_m,
                start,
                sweep,
            } => Self::Arc {
                centre,
                radius_m,
                start: start + sweep * from_t,
                sweep: sweep * (to_t - from_t),
            },
        }
    }

    /// d(point)/dt, m.
    pub fn tangent_at(&self, t: f64) -> Vec3 {
        match *self {
            Self::Segment { from, to } => to - from,
            Self::Arc {
                radius_m,
                start,
                sweep,
                ..
            } => {
                let (sin, cos) = (start + sweep * t).sin_cos();
                Vec3::new(-sin, cos, 0.0) * (radius_m * sweep.radians())
            }
        }
    }

    /// The length, m.
    pub fn length_m(&self) -> f64 {
        match *self {
            Self::Segment { from, to } => (to - from).norm(),
            Self::Arc {
                radius_m, sweep, ..
            } => radius_m * sweep.radians().abs(),
        }
    }

    /// The distance of a point from the nearest point of the curve, m.
    pub fn distance_m(&self, point: Vec3) -> f64 {
        match *self {
            Self::Segment { from, to } => distance_from_segment(point, [from, to]),
            Self::Arc {
                centre,
                radius_m,
                start,
                sweep,
            } => {
                // Within the angles of the arc the nearest point is on the radius; otherwise it is
                // an end. The angle from the start is counted in the sense of the sweep. Out of the
                // arc's plane the distance is the hypotenuse of both parts.
                let offset = point - centre;
                let turned =
                    (offset.y.atan2(offset.x) - start.radians()) * sweep.radians().signum();
                if turned.rem_euclid(std::f64::consts::TAU) <= sweep.radians().abs() {
                    return (offset.xy().norm() - radius_m).hypot(offset.z);
                }
                [0.0, 1.0]
                    .map(|end| (point - self.point_at(end)).norm())
                    .into_iter()
                    .fold(f64::INFINITY, f64::min)
            }
        }
    }

    /// A circle: it has no ends.
    pub fn is_closed(&self) -> bool {
        // The tolerance covers the conversion of 360° to radians.
        matches!(self, Self::Arc { sweep, .. } if (sweep.radians().abs() - std::f64::consts::TAU).abs() < 1e-9)
    }
}

/// The field of one venue.
#[derive(Clone, Debug, PartialEq)]
pub struct FieldModel {
    /// The template's name: "soccer".
    pub template: String,
    /// The parameters that the template takes, filled in, such as `length_m`.
    pub params: BTreeMap<String, f64>,
    /// Extent along x, m: the playing area.
    pub length_m: f64,
    /// Extent along y, m.
    pub width_m: f64,
    /// How much the middle is higher than the touchlines, m.
    pub crown_m: f64,
    /// Every landmark, in the template's order.
    pub landmarks: Vec<Landmark>,
    /// Every line, in the template's order.
    pub lines: Vec<FieldLine>,
    /// The click noise of lines: 1-σ of a click across the line in px at 1920 px width.
    pub line_click_sigma_px: f64,
}

impl FieldModel {
    /// A landmark by name.
    pub fn landmark(&self, id: &str) -> Option<&Landmark> {
        self.landmarks
            .iter()
            .find(|landmark| landmark.id.as_str() == id)
    }

    /// A line by name.
    pub fn line(&self, id: &str) -> Option<&FieldLine> {
        self.lines.iter().find(|line| line.id.as_str() == id)
    }

    /// A landmark's place in `world`, m, the crown included.
    pub fn landmark_in_world(&self, landmark: &Landmark) -> Vec3 {
        self.world_from_nominal(landmark.nominal_m)
    }
}

/// Points nearer to each other than this coincide, m.
const SAME_PLACE_M: f64 = 1e-6;

/// Whether two points coincide.
pub(super) fn same_place(a: Vec3, b: Vec3) -> bool {
    (a - b).norm() <= SAME_PLACE_M
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::field::builtin;

    #[test]
    fn a_dashed_line_begins_and_ends_with_a_dash() {
        let field = builtin("handball").unwrap().default_model().unwrap();
        let dashed = field.lines.iter().filter(|line| line.dash_m.is_some());
        let mut count = 0;
        for line in dashed {
            assert!((line.painted_share() - 0.5).abs() < 1e-12);
            let pieces: Vec<Curve> = line.pieces(&line.curve).collect();
            let (first, last) = (pieces[0], pieces[pieces.len() - 1]);
            assert!((first.point_at(0.0) - line.curve.point_at(0.0)).norm() < 1e-9);
            assert!((last.point_at(1.0) - line.curve.point_at(1.0)).norm() < 1e-9);
            for (dash, next) in pieces.iter().zip(&pieces[1..]) {
                let gap_m = (next.point_at(0.0) - dash.point_at(1.0)).norm();
                // Stretched to fit: by less than one dash in ten.
                assert!((dash.length_m() - 0.15).abs() < 0.015 && (gap_m - 0.15).abs() < 0.015);
                assert!(line.curve.distance_m(dash.point_at(0.5)) < 1e-9);
            }
            count += 1;
        }
        assert_eq!(count, 6, "two ends, each straight and with two arcs");
        let whole = &field.lines[0];
        assert_eq!(
            whole.pieces(&whole.curve).collect::<Vec<_>>(),
            [whole.curve.part(0.0, 1.0)]
        );
    }

    #[test]
    fn the_distance_from_a_curve_is_that_of_its_nearest_point() {
        let segment = Curve::Segment {
            from: Vec3::new(-3.0, 1.0, 0.0),
            to: Vec3::new(5.0, 2.0, 0.0),
        };
        let arc = |start, sweep| Curve::Arc {
            centre: Vec3::new(2.0, -1.0, 0.0),
            radius_m: 4.0,
            start: Angle::from_degrees(start),
            sweep: Angle::from_degrees(sweep),
        };
        for curve in [
            segment,
            arc(0.0, 360.0),
            arc(30.0, 100.0),
            arc(-20.0, -250.0),
        ] {
            for at in [
                (0.0, 0.0, 0.0),
                (9.0, 3.0, 0.0),
                (2.0, -1.5, 0.3),
                (-7.0, 1.0, 0.0),
                (3.0, -6.0, 0.0),
            ] {
                let at = Vec3::new(at.0, at.1, at.2);
                let sampled = (0..=20_000)
                    .map(|step| (at - curve.point_at(f64::from(step) / 20_000.0)).norm());
                let nearest_m = sampled.fold(f64::INFINITY, f64::min);
                assert!(
                    (curve.distance_m(at) - nearest_m).abs() < 1e-3,
                    "{curve:?} from {at}"
                );
            }
        }
    }
}
