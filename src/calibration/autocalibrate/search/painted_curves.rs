//! The painted curves of a flat field: which of them lie nearest to a point, and how far away.
//!
//! The search looks up the nearest curves hundreds of millions of times, so [`CurveGrid`] holds
//! them for each cell of a grid.

use touchline_core::field::{Curve, FieldModel};
use touchline_core::geometry::{Vec2, Vec3};

/// Side of a cell on a soccer pitch, m. The search reads cells in random order; at this size those
/// of a whole field fit into the cache of a core.
const CELL_M: f64 = 0.5;

/// How far beyond a soccer pitch the map reaches, m.
const BEYOND_M: f64 = 12.0;

/// A point this far beyond the end of a line still counts as beside it, on a soccer pitch, m.
const OVERSHOOT_M: f64 = 2.0;

/// Number of kinds of curves: lines along the field, lines across it, and arcs.
///
/// A low camera sees the ground so foreshortened that the line nearest on the ground is rarely the
/// nearest in the picture. The latter is, however, one of the nearest of each kind, so the grid
/// stores one curve of each.
const KINDS: usize = 3;

/// The nearest curve of each kind, as an index into the painted curves of a field.
pub type NearOfKinds = [Option<u16>; KINDS];

/// The nearest curves to the cell centres of a grid over the field and its surroundings.
pub struct CurveGrid {
    half_length_m: f64,
    half_width_m: f64,
    cell_m: f64,
    columns: usize,
    rows: usize,
    near: Vec<NearOfKinds>,
}

impl CurveGrid {
    /// The grid of the painted curves of a field of some size relative to a soccer pitch, each with
    /// the index of its line.
    pub fn new(field: &FieldModel, curves: &[(usize, Curve)], relative_size: f64) -> Self {
        let [cell_m, beyond_m] = [CELL_M, BEYOND_M].map(|length_m| length_m * relative_size);
        let (half_length_m, half_width_m) = (
            field.length_m / 2.0 + beyond_m,
            field.width_m / 2.0 + beyond_m,
        );
        let columns = (2.0 * half_length_m / cell_m).ceil() as usize;
        let rows = (2.0 * half_width_m / cell_m).ceil() as usize;
        // Brute force over all curves for each cell centre.
        let near = (0..columns * rows)
            .map(|cell| {
                let x = (cell % columns) as f64 * cell_m + cell_m / 2.0 - half_length_m;
                let y = (cell / columns) as f64 * cell_m + cell_m / 2.0 - half_width_m;
                nearest_of(curves, Vec3::new(x, y, 0.0), relative_size)
            })
            .collect();
        Self {
            half_length_m,
            half_width_m,
            cell_m,
            columns,
            rows,
            near,
        }
    }

    /// The nearest curves to the cell that contains a ground point; none outside the grid.
    #[inline]
    pub fn near(&self, place: Vec3) -> Option<NearOfKinds> {
        let (column, row) = (
            (place.x + self.half_length_m) / self.cell_m,
            (place.y + self.half_width_m) / self.cell_m,
        );
        let inside =
            column >= 0.0 && row >= 0.0 && column < self.columns as f64 && row < self.rows as f64;
        inside.then(|| self.near[row as usize * self.columns + column as usize])
    }
}

/// The nearest curve of each kind to a point of the flat field, which has some size relative to a
/// soccer pitch.
pub fn nearest_of(curves: &[(usize, Curve)], place: Vec3, relative_size: f64) -> NearOfKinds {
    let mut nearest: [Option<(f64, u16)>; KINDS] = [None; KINDS];
    for (number, (_, curve)) in (0_u16..).zip(curves) {
        // Of equally near curves the first stays.
        let near = &mut nearest[kind_of(curve)];
        if let Some(distance_m) = across_m(curve, place, OVERSHOOT_M * relative_size)
            && near.is_none_or(|(nearest_m, _)| distance_m < nearest_m)
        {
            *near = Some((distance_m, number));
        }
    }
    nearest.map(|near| near.map(|(_, number)| number))
}

/// A curve without its ends.
#[derive(Clone, Copy)]
pub enum Endless {
    Line {
        /// Unit.
        along: Vec2,
        /// Signed distance of the line from the origin, m.
        offset_m: f64,
    },
    Circle {
        centre: Vec2,
        radius_m: f64,
    },
}

impl Endless {
    pub fn from_curve(curve: &Curve) -> Self {
        match *curve {
            Curve::Segment { from, .. } => {
                let along = direction(curve, from);
                Self::Line {
                    along,
                    offset_m: along.perp(&from.xy()),
                }
            }
            Curve::Arc {
                centre, radius_m, ..
            } => Self::Circle {
                centre: centre.xy(),
                radius_m,
            },
        }
    }

    /// The signed distance of a point from the curve, m, and the unit tangent at its foot.
    #[inline]
    pub fn across(&self, place: Vec2) -> (f64, Vec2) {
        match *self {
            Self::Line { along, offset_m } => (along.perp(&place) - offset_m, along),
            Self::Circle { centre, radius_m } => {
                let out = place - centre;
                let range_m = out.norm();
                (
                    range_m - radius_m,
                    Vec2::new(-out.y, out.x) / range_m.max(1e-9),
                )
            }
        }
    }
}

/// The index of a curve's kind ([`KINDS`]).
fn kind_of(curve: &Curve) -> usize {
    match *curve {
        Curve::Segment { from, to } if (to.x - from.x).abs() >= (to.y - from.y).abs() => 0,
        Curve::Segment { .. } => 1,
        Curve::Arc { .. } => 2,
    }
}

/// The unit tangent of a curve at its point nearest to `place`, on the flat field. Axis-parallel
/// lines, which are most, get it without rounding.
fn direction(curve: &Curve, place: Vec3) -> Vec2 {
    let along = match *curve {
        Curve::Segment { from, to } if from.y == to.y => return Vec2::x(),
        Curve::Segment { from, to } if from.x == to.x => return Vec2::y(),
        Curve::Segment { from, to } => (to - from).xy(),
        Curve::Arc { centre, .. } => Vec2::new(centre.y - place.y, place.x - centre.x),
    };
    along.try_normalize(0.0).unwrap_or_default()
}

/// The unsigned distance of a point across a curve, m; none more than `overshoot_m` beyond its
/// ends.
fn across_m(curve: &Curve, place: Vec3, overshoot_m: f64) -> Option<f64> {
    // The offset from the nearest point is perpendicular to the curve unless that point is an end;
    // its part along the curve is then the distance beyond the end.
    let nearest = curve.point_at(nearest_parameter(curve, place));
    let off = (place - nearest).xy();
    let along = direction(curve, nearest);
    (off.dot(&along).abs() <= overshoot_m).then(|| off.perp(&along).abs())
}

/// The parameter, from 0 to 1, of the point of a curve nearest to a point of its plane.
pub fn nearest_parameter(curve: &Curve, place: Vec3) -> f64 {
    match *curve {
        Curve::Segment { from, to } => {
            let along = to - from;
            let length_squared = along.norm_squared();
            if length_squared > 0.0 {
                ((place - from).dot(&along) / length_squared).clamp(0.0, 1.0)
            } else {
                0.0
            }
        }
        Curve::Arc {
            centre,
            start,
            sweep,
            ..
        } => {
            // The angle from the start of the arc in its own direction, in [0, 2π).
            let out = place - centre;
            let turn = std::f64::consts::TAU;
            let sign = if sweep.radians() < 0.0 { -1.0 } else { 1.0 };
            let extent = sweep.radians().abs();
            let from_start = (sign * (out.y.atan2(out.x) - start.radians())).rem_euclid(turn);
            if from_start <= extent {
                return from_start / extent;
            }
            // Outside the arc: the end that is nearer by angle.
            if from_start - extent < turn - from_start {
                1.0
            } else {
                0.0
            }
        }
    }
}
