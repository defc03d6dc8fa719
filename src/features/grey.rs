//! A picture in grey, at full or reduced size.

use crate::geometry::ImageSize;
use crate::media::Picture;

/// Grey values, rows from the top.
pub(super) struct GreyPicture {
    /// Columns and rows after reduction.
    pub size: ImageSize,
    /// One byte a pixel, no padding.
    pub values: Vec<u8>,
}

/// The weights of red, green and blue in 1/256 (BT.601).
const WEIGHTS: [u32; 3] = [77, 150, 29];

/// The picture in grey, every block of `factor` × `factor` px averaged to one; columns and rows that fill no block are
/// dropped. A corner coordinate of the full picture is `factor` times that of the reduced one.
pub(super) fn grey_reduced(picture: &Picture, factor: u32) -> GreyPicture {
    let full = picture.size();
    let size = ImageSize::new(full.width / factor, full.height / factor);
    let (factor, width) = (factor as usize, size.width as usize);
    let row_bytes = 4 * full.width as usize;
    let divisor = (factor * factor) as u32 * 256;
    let mut values = Vec::with_capacity(width * size.height as usize);
    let mut sums = vec![0u32; width];
    for block_row in picture.rgba().chunks_exact((row_bytes * factor).max(1)).take(size.height as usize) {
        sums.fill(divisor / 2);
        for row in block_row.chunks_exact(row_bytes) {
            for (sum, block) in sums.iter_mut().zip(row.chunks_exact(4 * factor)) {
                for pixel in block.as_chunks::<4>().0 {
                    *sum += WEIGHTS[0] * u32::from(pixel[0])
                        + WEIGHTS[1] * u32::from(pixel[1])
                        + WEIGHTS[2] * u32::from(pixel[2]);
                }
            }
        }
        values.extend(sums.iter().map(|sum| (sum / divisor) as u8));
    }
    GreyPicture { size, values }
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
        assert_eq!(grey_reduced(&picture, 1).values, [0, 10, 99, 20, 30, 99, 7, 7, 7]);
        assert!(grey_reduced(&picture, 4).values.is_empty());
    }
}
