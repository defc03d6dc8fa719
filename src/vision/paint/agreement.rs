//! How far a camera's lines and a picture's strokes agree, looked at both ways.

use super::directions::{direction_of, with_neighbours};
use super::strokes::{Shown, Strokes};
use touchline_core::camera::PtzCamera;
use touchline_core::field::FieldModel;
use touchline_core::geometry::{ImagePoint, ImageSize, Vec2};
use touchline_core::markings::{SampleOptions, sample_lines};

/// A stroke lies on a line within this, px at 1920 px width.
const NEAR_PX: f64 = 5.0;

/// Samples of a line are this far apart, px at 1920 px width.
const SPACING_PX: f64 = 4.0;

/// What strokes and predicted lines say about a camera.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Agreement {
    /// The share of the strokes that lie on predicted lines, 0 to 1.
    pub explained: f64,
    /// The share of the predicted lines on open ground that lie on strokes, 0 to 1.
    pub seen: f64,
}

/// The strokes of a picture, made ready to be compared with the lines of many cameras.
pub(super) struct PaintedCells<'a> {
    strokes: &'a Strokes,
    cells: DirectedCells,
}

impl<'a> PaintedCells<'a> {
    pub fn of(strokes: &'a Strokes) -> Self {
        let points = strokes.points.iter().map(|point| (point.at, point.normal));
        Self {
            strokes,
            cells: DirectedCells::of(strokes.size(), points),
        }
    }

    /// How far they agree with a camera's lines.
    pub fn agreement(&self, field: &FieldModel, camera: &PtzCamera) -> Agreement {
        let strokes = self.strokes;
        let size = strokes.size();
        let scale = size.scale_from_1920();
        let options = SampleOptions {
            spacing_px: SPACING_PX * scale,
            ..SampleOptions::default()
        };
        let samples = sample_lines(field, camera, size, &options);
        let predicted = DirectedCells::of(
            size,
            samples.iter().map(|sample| (sample.image, sample.normal)),
        );
        let open = samples
            .iter()
            .filter(|sample| strokes.shown(sample.image) != Shown::Other);
        Agreement {
            explained: share(
                strokes
                    .points
                    .iter()
                    .map(|point| predicted.holds(point.at, point.normal)),
            ),
            seen: share(open.map(|sample| self.cells.holds(sample.image, sample.normal))),
        }
    }
}

impl Agreement {
    /// Both at once: the product.
    #[must_use]
    pub fn both(&self) -> f64 {
        self.explained * self.seen
    }
}

/// The share of those that are true; 0 of none.
fn share(all: impl Iterator<Item = bool>) -> f64 {
    let (mut count, mut held) = (0_u32, 0_u32);
    for holds in all {
        count += 1;
        held += u32::from(holds);
    }
    f64::from(held) / f64::from(count.max(1))
}

/// The cells of a picture that lie near curves, each with the curves' directions, a bit each.
struct DirectedCells {
    cell_px: f64,
    columns: usize,
    rows: usize,
    directions: Vec<u8>,
}

impl DirectedCells {
    /// Near points of curves, given with their normals.
    fn of(size: ImageSize, points: impl Iterator<Item = (ImagePoint, Vec2)>) -> Self {
        let near_px = NEAR_PX * size.scale_from_1920();
        let cell_px = (0.5 * near_px).max(1.0);
        let count = |extent: u32| (f64::from(extent) / cell_px) as usize + 1;
        let (columns, rows) = (count(size.width), count(size.height));
        let mut cells = Self {
            cell_px,
            columns,
            rows,
            directions: vec![0; columns * rows],
        };
        for (at, normal) in points {
            let bits = with_neighbours(direction_of(normal))
                .into_iter()
                .fold(0, |bits, direction| bits | (1 << direction));
            for step in -2..=2 {
                if let Some(cell) = cells.cell(at.moved(normal * (f64::from(step) * cell_px))) {
                    cells.directions[cell] |= bits;
                }
            }
        }
        cells
    }

    fn cell(&self, at: ImagePoint) -> Option<usize> {
        let (column, row) = ((at.x / self.cell_px).floor(), (at.y / self.cell_px).floor());
        let inside =
            column >= 0.0 && row >= 0.0 && column < self.columns as f64 && row < self.rows as f64;
        inside.then(|| row as usize * self.columns + column as usize)
    }

    /// Whether a curve of about a normal's direction lies near a point.
    fn holds(&self, at: ImagePoint, normal: Vec2) -> bool {
        self.cell(at)
            .is_some_and(|cell| self.directions[cell] & (1 << direction_of(normal)) != 0)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::paint::GroundPicture;
    use crate::paint::drawn::{PICTURE, camera, soccer, truth};

    #[test]
    fn the_right_camera_agrees_both_ways_and_wrong_ones_do_not() {
        let (strokes, field) = (Strokes::of(&GroundPicture::new(&PICTURE, &[])), soccer());
        let painted = PaintedCells::of(&strokes);
        let right = painted.agreement(&field, &truth());
        assert!(right.explained > 0.55 && right.seen > 0.85, "{right:?}");
        for (pan_deg, tilt_deg, focal_px) in [
            (8.0, -14.0, 1500.0),
            (4.0, -17.0, 1500.0),
            (4.0, -14.0, 2200.0),
        ] {
            let wrong = painted.agreement(&field, &camera(pan_deg, tilt_deg, focal_px));
            assert!(wrong.both() < 0.3 * right.both(), "{wrong:?}");
        }
        let away = painted.agreement(&field, &camera(180.0, -14.0, 1500.0));
        assert_eq!((away.explained, away.seen, away.both()), (0.0, 0.0, 0.0));
    }
}
