//! The integral image: the sum of grey values over any box in four look-ups.

use touchline::media::Picture;

/// The weights of red, green and blue in 1/256 (BT.601), as for SIFT.
const WEIGHTS: [u32; 3] = [77, 150, 29];

/// The largest grey value of a pixel, in the unit of the sums.
const WHITE: f64 = 255.0 * 256.0;

/// Sums of grey values over the boxes from the top left corner.
///
/// All sums are whole numbers far below 2⁵³, so `f64` holds them exactly: where the picture is even
/// or symmetric, so are the filters' responses, to the last bit.
pub struct Integral {
    /// Columns and rows of the reduced picture.
    width: usize,
    height: usize,
    /// Row by row; one column and one row more than the picture.
    sums: Vec<f64>,
    /// The sum of a white pixel.
    white: f64,
}

impl Integral {
    /// Sums a picture in grey, reduced by a whole factor. Columns and rows that fill no block are
    /// dropped.
    pub fn from_picture(picture: &Picture, factor: u32) -> Self {
        let (full, factor) = (picture.size(), factor.max(1) as usize);
        let full_width = full.width as usize;
        let (width, height) = (full_width / factor, full.height as usize / factor);
        // A picture has four bytes a pixel, so that no remainder is left.
        let pixels = picture.rgba().as_chunks::<4>().0;
        let mut sums = vec![0.0; (width + 1) * (height + 1)];
        for row in 0..height {
            let mut of_row = 0.0;
            for column in 0..width {
                // A reduced pixel is the sum of its block, not the mean: sums of whole numbers stay
                // exact.
                for line in factor * row..factor * (row + 1) {
                    let block = &pixels[line * full_width + factor * column..][..factor];
                    let grey: u32 = block.iter().map(|pixel| weigh(*pixel)).sum();
                    of_row += f64::from(grey);
                }
                // The sum of the row so far, on top of everything above.
                let above = sums[row * (width + 1) + column + 1];
                sums[(row + 1) * (width + 1) + column + 1] = above + of_row;
            }
        }
        Self {
            width,
            height,
            sums,
            white: WHITE * (factor * factor) as f64,
        }
    }

    /// Number of columns.
    pub const fn width(&self) -> usize {
        self.width
    }

    /// Number of rows.
    pub const fn height(&self) -> usize {
        self.height
    }

    /// The sum of a white pixel.
    pub const fn white(&self) -> f64 {
        self.white
    }

    /// The sum over columns `left..right` and rows `top..bottom`, which lie inside the picture.
    pub fn sum(&self, [left, right]: [usize; 2], [top, bottom]: [usize; 2]) -> f64 {
        let at = |column: usize, row: usize| self.sums[row * (self.width + 1) + column];
        at(right, bottom) - at(left, bottom) - at(right, top) + at(left, top)
    }
}

/// The grey value of a pixel, in 1/256 of a grey level.
fn weigh([red, green, blue, _]: [u8; 4]) -> u32 {
    WEIGHTS[0] * u32::from(red) + WEIGHTS[1] * u32::from(green) + WEIGHTS[2] * u32::from(blue)
}

#[cfg(test)]
mod tests {
    use super::*;
    use touchline::geometry::ImageSize;

    #[test]
    fn boxes_are_summed_and_reduced_pixels_are_blocks() {
        let pixels = (0..35u8).flat_map(|value| [value, value, value, 255]);
        let picture = Picture::new(ImageSize::new(7, 5), pixels.collect()).unwrap();
        let full = Integral::from_picture(&picture, 1);
        // Columns 2 and 3 of rows 1 to 3.
        let sum = f64::from(9 + 10 + 16 + 17 + 23 + 24);
        assert_eq!(full.sum([2, 4], [1, 4]), 256.0 * sum);
        assert_eq!(full.sum([3, 3], [0, 5]), 0.0);
        let half = Integral::from_picture(&picture, 2);
        assert_eq!((half.width(), half.height()), (3, 2));
        assert_eq!(half.sum([1, 2], [1, 2]), full.sum([2, 4], [2, 4]));
        assert_eq!(half.white(), 4.0 * full.white());
    }
}
