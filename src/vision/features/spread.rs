//! A grid over the picture: limits the number of features and keeps them spread.

use super::Keypoint;
use std::collections::{BTreeMap, BTreeSet};
#[cfg(feature = "opencv")]
use touchline_core::geometry::PixelBox;
use touchline_core::geometry::{ImagePoint, ImageSize};

/// Columns and rows of the grid over the picture.
const GRID: (usize, usize) = (8, 5);

/// A cell is filled up to this many times its even share before surplus features are used.
const CELL_SHARES: usize = 4;

/// The indices of at most `max_count` features. A cell of the grid gets at most four times its even
/// share of them, unless the other cells have too few features. In order of strength, then of
/// index; surplus features of full cells come last.
pub fn spread(keypoints: &[Keypoint], size: ImageSize, max_count: usize) -> Vec<usize> {
    let mut order: Vec<usize> = (0..keypoints.len()).collect();
    order.sort_by(|&a, &b| {
        keypoints[b]
            .strength
            .total_cmp(&keypoints[a].strength)
            .then(a.cmp(&b))
    });
    if order.len() <= max_count {
        return order;
    }
    // Without a quota, a textured crowd would take all features and leave none near the field.
    let quota = (CELL_SHARES * max_count).div_ceil(GRID.0 * GRID.1);
    let mut in_cell = [0usize; GRID.0 * GRID.1];
    let (mut kept, mut surplus) = (Vec::with_capacity(max_count), Vec::new());
    for index in order {
        let cell = &mut in_cell[cell_in_grid(keypoints[index].point, size, GRID)];
        if *cell < quota {
            *cell += 1;
            kept.push(index);
        } else {
            surplus.push(index);
        }
    }
    // Surplus features fill what the quota has left empty.
    kept.extend(surplus);
    kept.truncate(max_count);
    kept
}

/// At most `max_count` features that lie in none of the masks, as [`spread`] chooses them.
#[cfg(feature = "opencv")]
pub(super) fn spread_unmasked<D: Copy>(
    found: impl IntoIterator<Item = (Keypoint, D)>,
    masks: &[PixelBox],
    size: ImageSize,
    max_count: usize,
) -> (Vec<Keypoint>, Vec<D>) {
    // Masked features are dropped before spreading, so that they take no other feature's share.
    let (keypoints, descriptors): (Vec<Keypoint>, Vec<D>) = found
        .into_iter()
        .filter(|(keypoint, _)| !masks.iter().any(|mask| mask.contains(keypoint.point)))
        .unzip();
    spread(&keypoints, size, max_count)
        .into_iter()
        .map(|index| (keypoints[index], descriptors[index]))
        .unzip()
}

// Grids of equal cells over a picture: how widely points are spread, and which lie together.
//
// Points are counted by the cells that they occupy. So an object with many points in one place,
// such as a graphic or a board, does not look as wide as the scene.

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
    use touchline_core::geometry::ImagePoint;

    fn keypoint(x: f64, strength: f32) -> Keypoint {
        Keypoint {
            point: ImagePoint::new(x, 50.0),
            size_px: 2.0,
            strength,
        }
    }

    #[test]
    fn a_crowded_corner_does_not_take_everything() {
        let size = ImageSize::new(800, 500);
        let strong = (0..900).map(|i| keypoint(10.0, 1000.0 + i as f32));
        let weak = (0..100).map(|i| keypoint(700.0, i as f32));
        let keypoints: Vec<_> = strong.chain(weak).collect();
        let kept = spread(&keypoints, size, 400);
        let far = kept
            .iter()
            .filter(|&&i| keypoints[i].point.x > 600.0)
            .count();
        assert_eq!((kept.len(), far), (400, 40));
        assert_eq!(kept[0], 899, "the strongest first");
        assert_eq!(
            spread(&keypoints[..30], size, 400).len(),
            30,
            "few are all kept"
        );
    }

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
