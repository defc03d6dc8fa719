//! The panorama that the search places: directions of paint, where ground was seen, and how far
//! each direction lies from paint.

use std::collections::BTreeSet;
use touchline_core::geometry::{Vec3, subsample};
use touchline_vision::paint::GroundDirections;

/// What the search knows: the directions of paint in `panorama`, and where ground was seen.
pub struct Panorama {
    /// At most one direction in each cell of a grid over the viewing sphere.
    pub directions: Vec<Vec3>,
    pub seen: GroundDirections,
    painted: PaintedSphere,
}

/// The distance from each direction below the horizon to the nearest paint: a distance transform on
/// a grid over pan and tilt.
struct PaintedSphere {
    columns: usize,
    rows: usize,
    /// Distance to the nearest paint, in cells and rounded down; [`FARTHEST`] where there is none
    /// nearer.
    off: Vec<u8>,
}

/// Side of a cell in pan and in tilt, degrees.
const CELL_DEG: f64 = 0.05;

/// Distances are computed up to this number of cells.
const FARTHEST: u8 = 24;

impl PaintedSphere {
    fn from_directions(directions: &[Vec3]) -> Self {
        let (columns, rows) = ((360.0 / CELL_DEG) as usize, (90.0 / CELL_DEG) as usize);
        let mut sphere = Self {
            columns,
            rows,
            off: vec![FARTHEST; columns * rows],
        };
        let painted: BTreeSet<(usize, usize)> = directions
            .iter()
            .filter_map(|direction| sphere.cell(*direction))
            .collect();
        let reach = isize::from(FARTHEST);
        // A brute-force distance transform: each painted cell lowers the distances of the cells
        // around it. It runs once per focal scale and reaches FARTHEST cells.
        for (column, row) in painted {
            for dy in -reach..=reach {
                let y = row as isize + dy;
                if y < 0 || y >= rows as isize {
                    continue;
                }
                for dx in -reach..=reach {
                    // Pan is periodic; tilt ends at the horizon and at the nadir.
                    let x = (column as isize + dx).rem_euclid(columns as isize);
                    let off = f64::from((dx * dx + dy * dy) as i32)
                        .sqrt()
                        .min(f64::from(FARTHEST)) as u8;
                    let known = &mut sphere.off[y as usize * columns + x as usize];
                    *known = off.min(*known);
                }
            }
        }
        sphere
    }

    /// The column (pan from −180°) and row (angle below the horizon) of a direction; none at or
    /// above the horizon.
    fn cell(&self, direction: Vec3) -> Option<(usize, usize)> {
        let (pan_deg, down_deg) = pan_and_fall_deg(direction);
        (down_deg > 0.0).then(|| {
            (
                ((pan_deg + 180.0) / CELL_DEG) as usize % self.columns,
                ((down_deg / CELL_DEG) as usize).min(self.rows - 1),
            )
        })
    }

    /// Whether paint lies within an angle of a direction.
    fn is_within(&self, direction: Vec3, within_deg: f64) -> bool {
        let off = self
            .cell(direction)
            .map(|(column, row)| self.off[row * self.columns + column]);
        off.is_some_and(|off| off < FARTHEST && f64::from(off) * CELL_DEG <= within_deg)
    }
}

impl Panorama {
    /// From all directions of paint. The distances to paint are computed from all of them; only as
    /// many as the search needs are kept as samples.
    pub fn new(all: &[Vec3], seen: GroundDirections) -> Self {
        const KEPT: usize = 1500;
        const APART_DEG: f64 = 0.2;
        // Keep the first direction in each cell: lines that many frames show would otherwise
        // outweigh the rest of the paint.
        let mut taken = BTreeSet::new();
        let spread: Vec<Vec3> = all
            .iter()
            .filter(|direction| {
                let (pan_deg, down_deg) = pan_and_fall_deg(**direction);
                taken.insert((
                    (down_deg / APART_DEG).round() as i64,
                    (pan_deg / APART_DEG).round() as i64,
                ))
            })
            .copied()
            .collect();
        let directions = subsample(spread, KEPT).collect();
        let painted = PaintedSphere::from_directions(all);
        Self {
            directions,
            seen,
            painted,
        }
    }

    /// Whether paint lies within an angle of a direction. Angles of [`FARTHEST`] cells and more
    /// count as too far.
    pub fn is_paint_within(&self, direction: Vec3, within_deg: f64) -> bool {
        self.painted.is_within(direction, within_deg)
    }
}

/// The pan of a direction, from the y axis towards the x axis, and its angle below the horizon,
/// degrees.
fn pan_and_fall_deg(direction: Vec3) -> (f64, f64) {
    let down = (-direction.z).atan2(direction.x.hypot(direction.y));
    let pan = direction.x.atan2(direction.y);
    (pan.to_degrees(), down.to_degrees())
}
