//! The straight painted lines of a field that run along its axes.

use touchline_core::field::{Curve, FieldModel};
use touchline_core::geometry::Vec3;

/// Lines whose levels differ by at most this are one line with a gap, m.
const SAME_LEVEL_M: f64 = 0.03;

/// What lies within this share of the field's diagonal of a curve is a piece of it.
const NEAR_CURVE_SHARE: f64 = 0.015;

/// A painted line on the ground along an axis of the field.
pub struct GridLine {
    /// Its index in the field.
    pub line: usize,
    /// Its ends, `world`, m.
    pub ends_m: [Vec3; 2],
}

/// The lines along both axes of a field.
pub struct Grid {
    along_x: Vec<GridLine>,
    along_y: Vec<GridLine>,
    /// What is straight and no paint on the ground: nets, posts, boards.
    standing: Vec<GridLine>,
    /// Painted circles and arcs, pieces of which look straight.
    curves: Vec<Curve>,
    near_curve_m: f64,
}

impl Grid {
    pub fn of(field: &FieldModel) -> Self {
        let mut grid = Self {
            along_x: Vec::new(),
            along_y: Vec::new(),
            standing: Vec::new(),
            curves: Vec::new(),
            near_curve_m: NEAR_CURVE_SHARE * field.length_m.hypot(field.width_m),
        };
        for (line, of_field) in field.lines.iter().enumerate() {
            let Curve::Segment { from, to } = of_field.paint_centre else {
                grid.curves.push(of_field.paint_centre);
                continue;
            };
            let along = to - from;
            let line = GridLine {
                line,
                ends_m: [from, to],
            };
            if !of_field.painted || from.z != 0.0 || to.z != 0.0 {
                grid.standing.push(line);
            } else if along.y.abs() <= SAME_LEVEL_M {
                grid.along_x.push(line);
            } else if along.x.abs() <= SAME_LEVEL_M {
                grid.along_y.push(line);
            }
        }
        grid
    }

    /// Whether a point of the ground lies on a circle or an arc.
    pub fn is_on_curve(&self, at: Vec3) -> bool {
        self.curves
            .iter()
            .any(|curve| curve.distance_m(at) <= self.near_curve_m)
    }

    pub fn standing(&self) -> impl Iterator<Item = &GridLine> {
        self.standing.iter()
    }

    pub fn lines(&self) -> impl Iterator<Item = &GridLine> {
        self.along_x.iter().chain(&self.along_y)
    }

    /// The different x of the lines across the field and y of those along it, ascending, m.
    pub fn levels_m(&self) -> [Vec<f64>; 2] {
        [
            different(self.along_y.iter().map(|line| line.ends_m[0].x)),
            different(self.along_x.iter().map(|line| line.ends_m[0].y)),
        ]
    }
}

/// The different ones of some levels, ascending, m.
fn different(levels_m: impl Iterator<Item = f64>) -> Vec<f64> {
    let mut levels_m: Vec<f64> = levels_m.collect();
    levels_m.sort_by(f64::total_cmp);
    levels_m.dedup_by(|next, one| *next - *one <= SAME_LEVEL_M);
    levels_m
}

#[cfg(test)]
mod tests {
    use super::*;
    use touchline_core::field::builtin;

    #[test]
    fn a_tennis_court_has_four_lines_across_and_five_along() {
        let tennis = builtin("tennis").unwrap().default_model().unwrap();
        let [x, y] = Grid::of(&tennis).levels_m();
        assert_eq!((x.len(), y.len()), (4, 5), "{x:?} {y:?}");
        // The middles of the paint: 5 cm of 10 inside the baseline.
        assert!((x[0] + 11.885 - 0.05).abs() < 0.03, "{x:?}");
        assert!(y[2].abs() < 1e-9, "{y:?}");
    }

    #[test]
    fn the_three_point_line_of_a_basketball_court_is_a_curve() {
        let basketball = builtin("basketball_fiba").unwrap().default_model().unwrap();
        let grid = Grid::of(&basketball);
        // The middle of the basket is 1.575 m from the end line, the line 6.75 m from it.
        let on_line = Vec3::new(-14.0 + 1.575 + 6.72, 0.0, 0.0);
        assert!(grid.is_on_curve(on_line));
        assert!(!grid.is_on_curve(on_line + Vec3::new(0.8, 0.0, 0.0)));
    }
}
