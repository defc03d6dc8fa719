//! Where a picture is even: where the ground is seen, and neither players nor a crowd hide it.
//!
//! That a line is not shown says something only there.

use crate::paint::GroundPicture;
use touchline_core::geometry::ImagePoint;

/// Side of a block, px at 1920 px width.
const BLOCK_PX: f64 = 24.0;

/// Maximum mean slope of the brightness in an even block, grey levels / px. On two wooden floors it
/// is 1.6 to 2.2 in the median and at most 5 in nine of ten blocks without players; in crowds the
/// median is 5 to 10.
const MAX_SLOPE: f64 = 5.0;

/// Places between two points that are looked at.
const PLACES: u32 = 12;

/// The even blocks of a picture.
#[derive(Clone, Debug)]
pub struct EvenAreas {
    block_px: usize,
    columns: usize,
    is_even: Vec<bool>,
}

impl EvenAreas {
    /// Measures the slopes of a picture's brightness, block by block.
    pub fn detect(ground: &GroundPicture) -> Self {
        let grey = ground.grey();
        let [width, height] = [grey.size.width, grey.size.height].map(|side| side as usize);
        let block_px = (BLOCK_PX * grey.size.scale_from_1920()).max(4.0) as usize;
        let (columns, rows) = (width.div_ceil(block_px), height.div_ceil(block_px));
        let mut sums = vec![(0.0, 0.0); columns * rows];
        for y in (1..height.saturating_sub(1)).step_by(2) {
            for x in (1..width.saturating_sub(1)).step_by(2) {
                let at = y * width + x;
                let [left, right, above, below] =
                    [at - 1, at + 1, at - width, at + width].map(|at| f64::from(grey.values[at]));
                let (sum, count) = &mut sums[y / block_px * columns + x / block_px];
                *sum += 0.5 * (right - left).hypot(below - above);
                *count += 1.0;
            }
        }
        Self {
            block_px,
            columns,
            is_even: sums
                .iter()
                .map(|(sum, count)| *sum <= MAX_SLOPE * *count)
                .collect(),
        }
    }

    /// The share of the way between two points that is even.
    pub fn share_between(&self, from: ImagePoint, to: ImagePoint) -> f64 {
        let way = to.offset_from(from);
        let even = (0..PLACES).filter(|place| {
            let share = (f64::from(*place) + 0.5) / f64::from(PLACES);
            self.is_even_at(from.translate(way * share))
        });
        even.count() as f64 / f64::from(PLACES)
    }

    fn is_even_at(&self, at: ImagePoint) -> bool {
        let [column, row] = [at.x, at.y].map(|at| at as usize / self.block_px);
        column < self.columns
            && self
                .is_even
                .get(row * self.columns + column)
                .copied()
                .unwrap_or(false)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::media::Picture;
    use touchline_core::geometry::ImageSize;

    #[test]
    fn a_crowd_is_uneven_and_a_floor_is_not() {
        let size = ImageSize::new(960, 540);
        // Noise above, one colour below.
        let pixels = (0..size.width * size.height).flat_map(|pixel: u32| {
            let is_crowd = pixel / size.width < 270;
            let noise = (pixel.wrapping_mul(2_654_435_761) >> 24) as u8;
            let grey = if is_crowd { noise } else { 150 };
            [grey, grey, grey, 255]
        });
        let picture = Picture::new(size, pixels.collect()).unwrap();
        let even = EvenAreas::detect(&GroundPicture::new(&picture, &[]));
        let share = |from: f64, to: f64| {
            even.share_between(ImagePoint::new(400.0, from), ImagePoint::new(500.0, to))
        };
        assert_eq!([share(20.0, 240.0), share(300.0, 520.0)], [0.0, 1.0]);
        assert!((share(0.0, 540.0) - 0.5).abs() < 0.1);
        // Outside the picture nothing is seen.
        assert_eq!(share(600.0, 900.0), 0.0);
    }

    #[test]
    fn a_picture_without_pixels_is_nowhere_even() {
        let none = Picture::with_colour(ImageSize::new(0, 0), [0, 0, 0, 255]);
        let even = EvenAreas::detect(&GroundPicture::new(&none, &[]));
        let at = ImagePoint::new(0.0, 0.0);
        assert_eq!(even.share_between(at, at), 0.0);
    }
}
