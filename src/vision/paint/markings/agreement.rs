//! Agreement of a camera's lines with a picture's markings, in both directions: which markings lie
//! on lines, and which lines show markings.

use super::marking_pixels::{MarkingPixels, PixelContent};
use super::persistent::{cell_at, direction_of, with_neighbours};
use touchline_core::camera::PtzCamera;
use touchline_core::field::FieldModel;
use touchline_core::geometry::{ImagePoint, ImageSize, Vec2};
use touchline_core::markings::{SampleOptions, sample_lines};

/// Maximum distance between a marking and its line, px at 1920 px width.
const NEAR_PX: f64 = 5.0;

/// Distance between samples of a line, px at 1920 px width.
const SPACING_PX: f64 = 4.0;

/// Agreement of the markings of a picture with the lines of a camera.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Agreement {
    /// Share of the marking pixels that lie on predicted lines, 0 to 1.
    pub explained: f64,
    /// Share of the predicted lines on open ground that lie on markings, 0 to 1.
    pub seen: f64,
}

/// The markings of a picture, prepared for comparison with many cameras.
pub(in crate::paint) struct PaintedCells<'a> {
    marking_pixels: &'a MarkingPixels,
    cells: DirectedCells,
}

impl<'a> PaintedCells<'a> {
    pub fn from_marking_pixels(marking_pixels: &'a MarkingPixels) -> Self {
        let points = marking_pixels
            .points
            .iter()
            .map(|point| (point.at, point.normal));
        Self {
            marking_pixels,
            cells: DirectedCells::rasterise(marking_pixels.size(), points),
        }
    }

    /// The agreement with a camera's lines.
    pub fn agreement(&self, field: &FieldModel, camera: &PtzCamera) -> Agreement {
        let marking_pixels = self.marking_pixels;
        let size = marking_pixels.size();
        let scale = size.scale_from_1920();
        let options = SampleOptions {
            spacing_px: SPACING_PX * scale,
            ..SampleOptions::default()
        };
        let samples = sample_lines(field, camera, size, &options);
        // The same test in both directions: rasterise one set with its directions, look up the
        // other. It costs one pass over each set for every camera, where the nearest neighbour of
        // every point would cost their product.
        let predicted = DirectedCells::rasterise(
            size,
            samples.iter().map(|sample| (sample.image, sample.normal)),
        );
        // Lines behind players or outside the ground are not expected to be seen.
        let open = samples
            .iter()
            .filter(|sample| marking_pixels.classify(sample.image) != PixelContent::Other);
        Agreement {
            explained: share(
                marking_pixels
                    .points
                    .iter()
                    .map(|point| predicted.holds(point.at, point.normal)),
            ),
            seen: share(open.map(|sample| self.cells.holds(sample.image, sample.normal))),
        }
    }
}

impl Agreement {
    /// The product of both shares: high only if both are. A camera that predicts few lines may have
    /// all of them on markings, one that predicts many explains most markings.
    pub fn both(&self) -> f64 {
        self.explained * self.seen
    }
}

/// The share of values that are true; 0 if there are none.
fn share(all: impl Iterator<Item = bool>) -> f64 {
    let (count, number) = all.fold((0_u32, 0_u32), |(count, number), is_true| {
        (count + 1, number + u32::from(is_true))
    });
    f64::from(number) / f64::from(count.max(1))
}

/// Cells of a picture near curves. Each cell has one bit for each direction of a curve.
struct DirectedCells {
    cell_px: f64,
    /// Columns and rows.
    grid: [usize; 2],
    directions: Vec<u8>,
}

impl DirectedCells {
    /// Rasterises points of curves, given with their normals.
    fn rasterise(size: ImageSize, points: impl Iterator<Item = (ImagePoint, Vec2)>) -> Self {
        let near_px = NEAR_PX * size.scale_from_1920();
        let cell_px = (0.5 * near_px).max(1.0);
        // One more than fits, so that a marking on the right or lower border has a cell.
        let grid =
            [size.width, size.height].map(|side_px| (f64::from(side_px) / cell_px) as usize + 1);
        let mut cells = Self {
            cell_px,
            grid,
            directions: vec![0; grid[0] * grid[1]],
        };
        for (at, normal) in points {
            // The direction and its neighbours, so that a look-up does not fail at the border of
            // two bins.
            let bits = with_neighbours(direction_of(normal))
                .into_iter()
                .fold(0, |bits, direction| bits | (1 << direction));
            // Cells are half of [`NEAR_PX`] wide: two steps along the normal to both sides. Nothing
            // is added along the curve. Samples of a line are 1.6 cells apart, so that about a
            // third of the cells along a level line stay empty and `explained` is that much too
            // low: 0.61 instead of 0.99 for the true camera of the drawn picture in the tests. The
            // limits of `FindOptions` were measured with it (`tests/benches/paint.md`).
            for step in -2..=2 {
                let beside = at.translate(normal * (f64::from(step) * cell_px));
                if let Some(cell) = cell_at(beside, cell_px, grid) {
                    cells.directions[cell] |= bits;
                }
            }
        }
        cells
    }

    /// Whether a curve of about this direction lies near a point.
    fn holds(&self, at: ImagePoint, normal: Vec2) -> bool {
        cell_at(at, self.cell_px, self.grid)
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
        let (marking_pixels, field) = (
            MarkingPixels::detect(&GroundPicture::new(&PICTURE, &[])),
            soccer(),
        );
        let painted = PaintedCells::from_marking_pixels(&marking_pixels);
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
