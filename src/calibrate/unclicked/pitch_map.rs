//! Painted lines of a field seen from above: how far each place is from the nearest.

use crate::field::{Curve, FieldModel};
use crate::geometry::Vec3;

/// The side of a cell, m.
const CELL_M: f64 = 0.25;

/// How far beyond the field the map reaches, m.
const BEYOND_M: f64 = 12.0;

/// The painted lines of a field, on flat ground.
pub(super) struct PitchMap {
    /// The painted curves, each with the number of its line in the field.
    curves: Vec<(usize, Curve)>,
    half_length_m: f64,
    half_width_m: f64,
    columns: usize,
    rows: usize,
    distances_m: Vec<f32>,
    /// The nearest curve of each cell.
    nearest: Vec<u16>,
}

/// The point of a line that is nearest to a place.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct OnLine {
    pub at: Vec3,
    /// Along the line, any length.
    pub tangent: Vec3,
    /// Which of the field's lines.
    pub line: usize,
}

impl PitchMap {
    pub fn of(field: &FieldModel) -> Self {
        let painted = field.lines.iter().enumerate().filter(|(_, line)| line.painted);
        let curves: Vec<(usize, Curve)> = painted.map(|(number, line)| (number, line.paint_centre)).collect();
        let (half_length_m, half_width_m) = (field.length_m / 2.0 + BEYOND_M, field.width_m / 2.0 + BEYOND_M);
        let columns = (2.0 * half_length_m / CELL_M).ceil() as usize;
        let rows = (2.0 * half_width_m / CELL_M).ceil() as usize;
        let (mut distances_m, mut nearest) = (Vec::with_capacity(columns * rows), Vec::with_capacity(columns * rows));
        for cell in 0..columns * rows {
            let x = (cell % columns) as f64 * CELL_M + CELL_M / 2.0 - half_length_m;
            let y = (cell / columns) as f64 * CELL_M + CELL_M / 2.0 - half_width_m;
            let place = Vec3::new(x, y, 0.0);
            let distance =
                |(_, curve): &(usize, Curve)| (curve.point_at(nearest_parameter(curve, place)) - place).norm();
            let best = curves.iter().map(distance).enumerate().min_by(|a, b| a.1.total_cmp(&b.1));
            let (curve, distance_m) = best.unwrap_or((0, f64::INFINITY));
            distances_m.push(distance_m as f32);
            nearest.push(curve as u16);
        }
        Self { curves, half_length_m, half_width_m, columns, rows, distances_m, nearest }
    }

    fn cell(&self, x_m: f64, y_m: f64) -> Option<usize> {
        let (column, row) = ((x_m + self.half_length_m) / CELL_M, (y_m + self.half_width_m) / CELL_M);
        let inside = column >= 0.0 && row >= 0.0 && column < self.columns as f64 && row < self.rows as f64;
        inside.then(|| row as usize * self.columns + column as usize)
    }

    /// The distance of a place from the nearest line, m; none far from the field.
    pub fn distance_m(&self, x_m: f64, y_m: f64) -> Option<f64> {
        self.cell(x_m, y_m).map(|cell| f64::from(self.distances_m[cell]))
    }

    /// The nearest point of a line; none far from the field.
    pub fn nearest(&self, place: Vec3) -> Option<OnLine> {
        let (line, curve) = self.curves.get(usize::from(self.nearest[self.cell(place.x, place.y)?]))?;
        let line = *line;
        let parameter = nearest_parameter(curve, Vec3::new(place.x, place.y, 0.0));
        Some(OnLine { at: curve.point_at(parameter), tangent: curve.tangent_at(parameter), line })
    }

    /// Points along all lines, about as far apart as stated, m.
    pub fn samples(&self, spacing_m: f64) -> impl Iterator<Item = OnLine> + '_ {
        self.curves.iter().flat_map(move |&(line, curve)| {
            let count = (curve.length_m() / spacing_m).ceil().max(1.0);
            (0..=count as usize).map(move |step| {
                let parameter = step as f64 / count;
                OnLine { at: curve.point_at(parameter), tangent: curve.tangent_at(parameter), line }
            })
        })
    }
}

/// The parameter of a curve's point nearest to a place of its plane, from 0 to 1.
fn nearest_parameter(curve: &Curve, place: Vec3) -> f64 {
    match *curve {
        Curve::Segment { from, to } => {
            let along = to - from;
            let length_squared = along.norm_squared();
            if length_squared > 0.0 { ((place - from).dot(&along) / length_squared).clamp(0.0, 1.0) } else { 0.0 }
        }
        Curve::Arc { centre, start, sweep, .. } => {
            let out = place - centre;
            let turn = std::f64::consts::TAU;
            let sign = if sweep.radians() < 0.0 { -1.0 } else { 1.0 };
            let extent = sweep.radians().abs();
            let from_start = (sign * (out.y.atan2(out.x) - start.radians())).rem_euclid(turn);
            if from_start <= extent {
                return from_start / extent;
            }
            // The nearer end.
            if from_start - extent < turn - from_start { 1.0 } else { 0.0 }
        }
    }
}
