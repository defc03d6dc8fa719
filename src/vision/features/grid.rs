//! Grids of equal cells over a picture: how widely points are spread, and which lie together.
//!
//! Points are counted by the cells that they occupy. So an object with many points in one place,
//! such as a graphic or a board, does not look as wide as the scene.

use std::collections::{BTreeMap, BTreeSet};
use touchline_core::geometry::{ImagePoint, ImageSize};

/// The index of the cell that contains a point, row by row from the top left. A point outside the
/// picture has the nearest cell.
pub(crate) fn cell_in_grid(
    at: ImagePoint,
    size: ImageSize,
    (columns, rows): (usize, usize),
) -> usize {
    cell_along(at.y, size.height, rows) * columns + cell_along(at.x, size.width, columns)
}

/// The index of the cell that contains a position along one side of the picture.
fn cell_along(position_px: f64, side_px: u32, cells: usize) -> usize {
    let cell = position_px / f64::from(side_px.max(1)) * cells as f64;
    (cell.max(0.0) as usize).min(cells - 1)
}

/// The number of cells that contain a point.
pub(crate) fn count_cells(
    points: impl Iterator<Item = ImagePoint>,
    size: ImageSize,
    grid: (usize, usize),
) -> usize {
    let cells = points.map(|at| cell_in_grid(at, size, grid));
    cells.collect::<BTreeSet<_>>().len()
}

/// Joins the contents of cells that touch, diagonals included, by flood fill. Cells are given by
/// row and column.
pub(super) fn join_touching_cells<T>(mut cells: BTreeMap<(i64, i64), Vec<T>>) -> Vec<Vec<T>> {
    // Cells leave the map as they join a group, hence each is visited once. An ordered map makes
    // the groups come topmost first, and the same in every run.
    let mut groups = Vec::new();
    while let Some((first, mut group)) = cells.pop_first() {
        let mut open = vec![first];
        while let Some((row, column)) = open.pop() {
            for neighbour in (row - 1..=row + 1)
                .flat_map(|row| (column - 1..=column + 1).map(move |column| (row, column)))
            {
                if let Some(members) = cells.remove(&neighbour) {
                    group.extend(members);
                    open.push(neighbour);
                }
            }
        }
        groups.push(group);
    }
    groups
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn points_in_one_cell_count_once() {
        let size = ImageSize::new(120, 70);
        let points = [(1.0, 1.0), (9.0, 9.0), (11.0, 1.0), (119.0, 69.0)]
            .map(|(x, y)| ImagePoint::new(x, y));
        let cells = points.map(|at| cell_in_grid(at, size, (12, 7)));
        assert_eq!(cells, [0, 0, 1, 83]);
        assert_eq!(count_cells(points.into_iter(), size, (12, 7)), 3);
        let outside = ImagePoint::new(500.0, -3.0);
        assert_eq!(cell_in_grid(outside, size, (12, 7)), 11);
    }

    #[test]
    fn cells_that_touch_at_a_corner_are_joined() {
        let cells = [
            ((0, 0), vec!['a']),
            ((1, 1), vec!['b']),
            ((3, 0), vec!['c']),
        ];
        assert_eq!(
            join_touching_cells(cells.into()),
            [vec!['a', 'b'], vec!['c']]
        );
    }
}
