//! Directions of lines in a picture, quantised, and the cells of a grid over it.

use touchline_core::geometry::{ImagePoint, Vec2};

/// Number of bins over half a turn: a line and its reverse have one direction.
pub(in crate::paint) const DIRECTIONS: usize = 8;

/// The bin of a normal, counted from x towards y. Bin 0 is centred on the x axis.
pub(super) fn direction_of(normal: Vec2) -> usize {
    // atan2 spans a whole turn, −8 to 8 steps. The remainder maps opposite normals to one bin.
    let steps =
        (normal.y.atan2(normal.x) / std::f64::consts::PI * DIRECTIONS as f64).round() as i32;
    steps.rem_euclid(DIRECTIONS as i32) as usize
}

/// A direction and its two neighbours.
pub(super) fn with_neighbours(direction: usize) -> [usize; 3] {
    [DIRECTIONS - 1, 0, 1].map(|turn| (direction + turn) % DIRECTIONS)
}

/// The index, row by row from the top, of the cell that contains a point. None outside a grid of
/// this many columns and rows of square cells.
pub(super) fn cell_at(at: ImagePoint, cell_px: f64, [columns, rows]: [usize; 2]) -> Option<usize> {
    // Compared as floats: as an integer, a small negative number is 0. A point on the right border
    // has the column `columns`; its index would be that of a cell of the next row.
    let (column, row) = ((at.x / cell_px).floor(), (at.y / cell_px).floor());
    let inside = column >= 0.0 && row >= 0.0 && column < columns as f64 && row < rows as f64;
    inside.then(|| row as usize * columns + column as usize)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_normal_and_its_opposite_are_one_direction() {
        for step in 0..32 {
            let (y, x) = (f64::from(step) * 0.2 + 0.05).sin_cos();
            let direction = direction_of(Vec2::new(x, y));
            assert_eq!(direction, direction_of(Vec2::new(-x, -y)));
            assert!(with_neighbours(direction).contains(&direction));
        }
        assert_eq!(
            (
                direction_of(Vec2::new(1.0, 0.01)),
                direction_of(Vec2::new(0.0, 1.0))
            ),
            (0, 4)
        );
        assert_eq!(with_neighbours(0), [7, 0, 1]);
    }

    #[test]
    fn only_points_within_the_grid_have_a_cell() {
        let cell = |x: f64, y: f64| cell_at(ImagePoint::new(x, y), 4.0, [3, 2]);
        assert_eq!((cell(0.0, 0.0), cell(11.9, 7.9)), (Some(0), Some(5)));
        for (x, y) in [(12.0, 0.0), (0.0, 8.0), (-0.1, 0.0), (f64::NAN, 0.0)] {
            assert_eq!(cell(x, y), None, "{x}, {y}");
        }
    }
}
