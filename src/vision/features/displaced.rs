//! Whether the content of two pictures is displaced between them, by block matching.
//!
//! Edges alone do not show this: those of long lines and boards stay in place while a camera pans
//! slowly along them. Blocks of the first picture are searched in the second by normalised cross
//! correlation, around their own position. Each block compares the best correlation near its
//! position with the best one farther off.

use super::reduced::{EdgeKind, ReducedPicture};

/// Further reduction of the pictures in which blocks are compared.
const STEP: usize = 4;

/// Columns and rows of blocks.
const BLOCKS: (usize, usize) = (8, 5);

/// Maximum displacement that is searched, px of the coarse picture.
const REACH: isize = 10;

/// Smaller displacements count as none, px of the coarse picture: a sixtieth of its width.
const MIN_DISPLACEMENT: isize = 2;

/// A block decides if one of its two correlations exceeds the other by this.
const CLEARER: f32 = 0.05;

/// Minimum standard deviation of a block's brightness, grey levels.
const LEAST_CONTRAST: f32 = 2.0;

/// Minimum number of blocks that decide.
const MIN_DECIDING_BLOCKS: usize = 4;

/// Maximum share of the deciding blocks that have not moved although the camera has: those of
/// graphics, and those around the fixed point of a zoom.
const MOST_STAYING: f32 = 1.0 / 3.0;

/// The brightness of a picture that is reduced twice.
#[derive(Clone, Debug)]
pub(super) struct CoarsePicture {
    width: usize,
    height: usize,
    grey: Vec<f32>,
}

impl CoarsePicture {
    pub fn new(picture: &ReducedPicture) -> Self {
        let (width, height) = (picture.width / STEP, picture.height / STEP);
        let cells = (0..height).flat_map(|row| (0..width).map(move |column| (column, row)));
        let weight = 1.0 / (STEP * STEP) as f32;
        Self {
            width,
            height,
            grey: cells
                .map(|(column, row)| weight * cell_sum(picture, column, row))
                .collect(),
        }
    }

    /// Whether the content lies elsewhere in another picture of the same size: displaced sideways
    /// for upright edges, vertically for level ones. None if too few blocks decide, as after a wide
    /// turn.
    pub fn is_displaced(&self, other: &Self, kind: EdgeKind) -> Option<bool> {
        let (mut moved, mut stayed) = (0_usize, 0_usize);
        for block in self.blocks() {
            let Some([near, far]) = block.correlations(self, other, kind) else {
                continue;
            };
            // Both correlations are of the same block, so that its own texture favours neither.
            moved += usize::from(far > near + CLEARER);
            stayed += usize::from(near > far + CLEARER);
        }
        // Blocks without texture, and those that fit equally well at both, do not decide.
        let decided = moved + stayed;
        (decided >= MIN_DECIDING_BLOCKS).then_some((stayed as f32) <= MOST_STAYING * decided as f32)
    }

    fn blocks(&self) -> impl Iterator<Item = Block> {
        let (width, height) = (self.width / BLOCKS.0, self.height / BLOCKS.1);
        let places = (0..BLOCKS.1).flat_map(|row| (0..BLOCKS.0).map(move |column| (column, row)));
        places.map(move |(column, row)| Block {
            left: column * width,
            top: row * height,
            width,
            height,
        })
    }

    /// The part of a row that a block covers when displaced by some px. None if it reaches beyond
    /// the picture.
    fn row_of(&self, block: &Block, row: usize, (right, down): (isize, isize)) -> Option<&[f32]> {
        let left = block.left.checked_add_signed(right)?;
        let row = (block.top + row)
            .checked_add_signed(down)
            .filter(|row| *row < self.height)?;
        let start = row * self.width + left;
        (left + block.width <= self.width).then(|| &self.grey[start..start + block.width])
    }
}

/// The sum of the brightness in the square of [`STEP`] px that becomes one pixel of the coarse
/// picture.
fn cell_sum(picture: &ReducedPicture, column: usize, row: usize) -> f32 {
    let rows = (row * STEP..(row + 1) * STEP).map(|row| row * picture.width + column * STEP);
    rows.map(|start| picture.grey[start..start + STEP].iter().sum::<f32>())
        .sum()
}

/// A rectangle of the coarse picture.
struct Block {
    left: usize,
    top: usize,
    width: usize,
    height: usize,
}

impl Block {
    /// The best correlation with another picture near the block's own position, and the best one
    /// farther off along the axis that moves edges of this kind. None if the block has too little
    /// contrast.
    fn correlations(
        &self,
        one: &CoarsePicture,
        other: &CoarsePicture,
        kind: EdgeKind,
    ) -> Option<[f32; 2]> {
        // Mean and contrast of the block itself, computed once for all displacements.
        let count = (self.width * self.height) as f32;
        let own = (0..self.height)
            .filter_map(|row| one.row_of(self, row, (0, 0)))
            .flatten();
        let mean = own.clone().sum::<f32>() / count;
        let contrast = (own.map(|grey| (grey - mean).powi(2)).sum::<f32>() / count).sqrt();
        if count == 0.0 || contrast < LEAST_CONTRAST {
            return None;
        }
        // Both axes are searched, since a pan is seldom level in the picture; only the displacement
        // along one axis decides which of the two a correlation counts for.
        let mut best = [0.0_f32; 2];
        for down in -REACH..=REACH {
            for right in -REACH..=REACH {
                let off = match kind {
                    EdgeKind::Upright => right,
                    EdgeKind::Level => down,
                };
                let is_far = usize::from(off.abs() >= MIN_DISPLACEMENT);
                if let Some(correlation) =
                    self.correlation(one, other, (right, down), mean, contrast)
                {
                    best[is_far] = best[is_far].max(correlation);
                }
            }
        }
        Some(best)
    }

    /// Normalised cross correlation, −1 to 1, with the block displaced by `by` in the other
    /// picture. None outside it, or if there is too little contrast there.
    fn correlation(
        &self,
        one: &CoarsePicture,
        other: &CoarsePicture,
        by: (isize, isize),
        mean: f32,
        contrast: f32,
    ) -> Option<f32> {
        let (mut sum, mut squares, mut shared) = (0.0_f32, 0.0_f32, 0.0_f32);
        for row in 0..self.height {
            let (own, there) = (one.row_of(self, row, (0, 0))?, other.row_of(self, row, by)?);
            for (own, there) in own.iter().zip(there) {
                // Subtracting a common mean keeps the sums small; the difference of large squares
                // would lose digits in f32.
                let there = there - mean;
                sum += there;
                squares += there * there;
                shared += (own - mean) * there;
            }
        }
        // Where the other picture has hardly any contrast, the quotient would be noise.
        let count = (self.width * self.height) as f32;
        let of_other = (squares / count - (sum / count).powi(2)).max(0.0).sqrt();
        (of_other >= 0.5 * LEAST_CONTRAST).then(|| shared / (count * contrast * of_other))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use touchline_core::geometry::ImageSize;

    /// Blotches in all directions that lie this far to the right and down; a part of the picture
    /// stands.
    fn picture(right: f32, down: f32, standing: usize) -> CoarsePicture {
        let (width, height) = (480, 270);
        let grey = |column: usize, row: usize| {
            let (x, y) = if row < standing {
                (column as f32, row as f32)
            } else {
                (column as f32 - right, row as f32 - down)
            };
            let waves = [
                (0.11, 0.05),
                (0.07, -0.13),
                (-0.031, 0.19),
                (0.23, 0.17),
                (0.151, -0.063),
            ];
            110.0
                + waves
                    .iter()
                    .map(|(by_x, by_y)| 9.0 * (by_x * x + by_y * y).sin())
                    .sum::<f32>()
        };
        let grey = (0..height)
            .flat_map(|row| (0..width).map(move |column| grey(column, row)))
            .collect();
        let size = ImageSize::new(width as u32, height as u32);
        CoarsePicture::new(&ReducedPicture {
            size,
            step: 1,
            width,
            height,
            grey,
        })
    }

    #[test]
    fn each_axis_tells_what_moved_along_it() {
        let first = picture(0.0, 0.0, 0);
        for (right, down, upright, level) in [
            (0.0, 0.0, false, false),
            (3.0, 2.0, false, false),
            (13.0, 0.0, true, false),
            (0.0, -13.0, false, true),
            (-25.0, 14.0, true, true),
        ] {
            let moved =
                EdgeKind::ALL.map(|kind| first.is_displaced(&picture(right, down, 0), kind));
            assert_eq!(moved, [Some(upright), Some(level)], "{right} {down}");
        }
    }

    #[test]
    fn a_graphic_does_not_hold_a_picture_in_its_place() {
        let moved = picture(0.0, 0.0, 54).is_displaced(&picture(20.0, 0.0, 54), EdgeKind::Upright);
        assert_eq!(moved, Some(true), "a fifth of the picture stands");
    }

    #[test]
    fn pictures_without_contrast_and_tiny_ones_tell_nothing() {
        let flat = |width: usize, height: usize| {
            let size = ImageSize::new(width as u32, height as u32);
            CoarsePicture::new(&ReducedPicture {
                size,
                step: 1,
                width,
                height,
                grey: vec![90.0; width * height],
            })
        };
        for (width, height) in [(480, 270), (8, 4), (1, 1)] {
            assert_eq!(
                flat(width, height).is_displaced(&flat(width, height), EdgeKind::Upright),
                None
            );
        }
    }
}
