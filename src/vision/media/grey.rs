//! Grey pictures, at full or reduced size.

use super::Picture;
use touchline_core::geometry::{ImagePoint, ImageSize};

/// A grey picture.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct GreyPicture {
    /// Columns and rows after reduction.
    pub size: ImageSize,
    /// One byte per pixel, row by row from the top, no padding.
    pub values: Vec<u8>,
}

/// The weights of red, green and blue in 1/256 (BT.601).
const WEIGHTS: [u32; 3] = [77, 150, 29];

/// The brightness of a pixel in 1/256 of a grey level.
fn luma([red, green, blue, _]: [u8; 4]) -> u32 {
    WEIGHTS[0] * u32::from(red) + WEIGHTS[1] * u32::from(green) + WEIGHTS[2] * u32::from(blue)
}

/// The picture in grey, every block of `factor` × `factor` px averaged to one; columns and rows
/// that fill no block are dropped. A corner coordinate of the full picture is `factor` times that
/// of the reduced one.
pub fn grey_reduced(picture: &Picture, factor: u32) -> GreyPicture {
    let full = picture.size();
    if factor == 1 {
        // Fast path: no blocks to average.
        let values = picture
            .rgba()
            .as_chunks::<4>()
            .0
            .iter()
            .map(|pixel| ((128 + luma(*pixel)) / 256) as u8);
        return GreyPicture {
            size: full,
            values: values.collect(),
        };
    }
    let size = ImageSize::new(full.width / factor, full.height / factor);
    let (factor, width) = (factor as usize, size.width as usize);
    // `chunks_exact` drops the rows that fill no block, and the zip with `sums` the columns. A
    // picture without width has no bytes, but the length of a chunk must not be 0.
    let row_bytes = 4 * full.width as usize;
    // Sums are in 1/256 of a grey level and start at half the divisor, so that the division rounds.
    // A row of a block fits 32 bits, a whole block of more than 256 rows does not.
    let divisor = (factor * factor) as u64 * 256;
    let mut values = Vec::with_capacity(width * size.height as usize);
    let mut sums = vec![0u64; width];
    for block_row in picture
        .rgba()
        .chunks_exact((row_bytes * factor).max(1))
        .take(size.height as usize)
    {
        sums.fill(divisor / 2);
        for row in block_row.chunks_exact(row_bytes) {
            for (sum, block) in sums.iter_mut().zip(row.chunks_exact(4 * factor)) {
                let pixels = block.as_chunks::<4>().0.iter();
                *sum += u64::from(pixels.map(|pixel| luma(*pixel)).sum::<u32>());
            }
        }
        values.extend(sums.iter().map(|sum| (sum / divisor) as u8));
    }
    GreyPicture { size, values }
}

impl GreyPicture {
    /// The grey value at a point (corner convention, px of this picture), linear between the
    /// centres of the four pixels around it; points outside take the nearest pixel's. 0 for a
    /// picture without pixels.
    pub fn at(&self, point: ImagePoint) -> f64 {
        let width = self.size.width as usize;
        let (Some(right), Some(bottom)) = (
            width.checked_sub(1),
            (self.size.height as usize).checked_sub(1),
        ) else {
            return 0.0;
        };
        // Pixel centres are at half-integers in the corner convention.
        let x = (point.x - 0.5).clamp(0.0, right as f64);
        let y = (point.y - 0.5).clamp(0.0, bottom as f64);
        let (column, row) = (x as usize, y as usize);
        let (share_x, share_y) = (x - column as f64, y - row as f64);
        let (next_column, next_row) = ((column + 1).min(right), (row + 1).min(bottom));
        // Linear along both rows, then between them.
        let [above, below] = [row, next_row].map(|row| {
            f64::from(self.pixel(column, row)) * (1.0 - share_x)
                + f64::from(self.pixel(next_column, row)) * share_x
        });
        above * (1.0 - share_y) + below * share_y
    }

    /// The grey level of a pixel.
    ///
    /// # Panics
    /// If it lies below the picture.
    pub(super) fn pixel(&self, column: usize, row: usize) -> u8 {
        self.values[row * self.size.width as usize + column]
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn blocks_are_averaged_and_remainders_dropped() {
        let mut rgba = Vec::new();
        for value in [0u8, 10, 99, 20, 30, 99, 7, 7, 7] {
            rgba.extend([value, value, value, 255]);
        }
        let picture = Picture::new(ImageSize::new(3, 3), rgba).unwrap();
        let half = grey_reduced(&picture, 2);
        assert_eq!((half.size, half.values), (ImageSize::new(1, 1), vec![15]));
        assert_eq!(
            grey_reduced(&picture, 1).values,
            [0, 10, 99, 20, 30, 99, 7, 7, 7]
        );
        assert!(grey_reduced(&picture, 4).values.is_empty());
        let white = Picture::with_colour(ImageSize::new(300, 600), [255; 4]);
        assert_eq!(grey_reduced(&white, 300).values, [255; 2]);
    }

    #[test]
    fn between_pixel_centres_grey_is_linear_and_outside_it_is_the_borders() {
        let grey = GreyPicture {
            size: ImageSize::new(2, 2),
            values: vec![0, 100, 40, 200],
        };
        for (x, y, value) in [
            (0.5, 0.5, 0.0),
            (1.0, 0.5, 50.0),
            (0.5, 1.0, 20.0),
            (1.0, 1.0, 85.0),
            (9.0, -3.0, 100.0),
        ] {
            assert!(
                (grey.at(ImagePoint::new(x, y)) - value).abs() < 1e-12,
                "at {x}, {y}"
            );
        }
        assert!(
            GreyPicture {
                size: ImageSize::new(0, 0),
                values: Vec::new()
            }
            .at(ImagePoint::default())
                == 0.0
        );
    }
}
