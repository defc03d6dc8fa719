//! A frame reduced to a size at which only large structures remain; shot boundaries are detected on
//! it.

use crate::media::Picture;
use std::ops::Range;

/// Columns of a miniature.
const WIDTH: usize = 64;
/// Rows of a miniature.
const HEIGHT: usize = 36;
/// Pixels sampled per side of a cell; their mean is the value of the cell.
const SAMPLES: usize = 6;
/// Largest shift tried, in columns and rows of a miniature of half the size.
const COARSE_SHIFT: (i32, i32) = (8, 4);

/// A frame reduced to 64 × 36 cells of red, green and blue, whatever its shape.
#[derive(Clone, Debug, PartialEq)]
pub struct Miniature {
    /// Red, green and blue of each cell, 0 to 255, row by row from the top.
    cells: Vec<[f32; 3]>,
}

impl Miniature {
    /// Reduces a picture to cells.
    pub fn from_picture(picture: &Picture) -> Self {
        let (width, height) = (
            picture.size().width as usize,
            picture.size().height as usize,
        );
        let rgba = picture.rgba();
        let (columns, rows) = (
            part_centres(width, WIDTH * SAMPLES),
            part_centres(height, HEIGHT * SAMPLES),
        );
        // The mean of 6 × 6 samples per cell; a full average would visit every pixel of every
        // frame.
        let mut cells = Vec::with_capacity(WIDTH * HEIGHT);
        for rows in rows.chunks_exact(SAMPLES) {
            for columns in columns.chunks_exact(SAMPLES) {
                let mut sum = [0u32; 3];
                for row in rows {
                    for column in columns {
                        let at = 4 * (row * width + column);
                        for (sum, value) in
                            sum.iter_mut().zip(rgba.get(at..at + 3).unwrap_or_default())
                        {
                            *sum += u32::from(*value);
                        }
                    }
                }
                cells.push(sum.map(|sum| sum as f32 / (SAMPLES * SAMPLES) as f32));
            }
        }
        Self { cells }
    }

    /// The difference of two miniatures under the shift that fits best: mean absolute difference
    /// per colour channel, 0 to 255.
    ///
    /// A panning camera shifts its picture, which is no cut; after the shift little difference
    /// remains.
    pub fn difference(&self, other: &Self) -> f32 {
        // Exhaustive search at half the size, then refinement by one cell at full size: 153 and 9
        // comparisons, where full size alone would take 561 of four times as many cells. A shift of
        // one cell at half the size is two at full size; the refinement covers those in between.
        let (small, small_other) = (self.halve(), other.halve());
        let half = (WIDTH / 2, HEIGHT / 2);
        let shifts = (-COARSE_SHIFT.0..=COARSE_SHIFT.0)
            .flat_map(|right| (-COARSE_SHIFT.1..=COARSE_SHIFT.1).map(move |down| (right, down)));
        let coarse = shifts
            .map(|shift| (shift, shifted_difference(&small, &small_other, half, shift)))
            .min_by(|(_, a), (_, b)| a.total_cmp(b))
            .map_or((0, 0), |(shift, _)| shift);
        let fine = (-1..=1).flat_map(|right| {
            (-1..=1).map(move |down| (2 * coarse.0 + right, 2 * coarse.1 + down))
        });
        fine.map(|shift| shifted_difference(&self.cells, &other.cells, (WIDTH, HEIGHT), shift))
            .fold(f32::INFINITY, f32::min)
    }

    /// Mean absolute difference from the mean of two others, without a shift; small in a cross-fade
    /// from one to the other.
    pub fn difference_from_blend(&self, before: &Self, after: &Self) -> f32 {
        // Midway through a cross-fade a frame is the mean of both pictures, colour by colour.
        let blended = before.cells.iter().zip(&after.cells);
        let sum: f32 = self
            .cells
            .iter()
            .zip(blended)
            .map(|(cell, (a, b))| {
                (0..3)
                    .map(|colour| (cell[colour] - 0.5 * (a[colour] + b[colour])).abs())
                    .sum::<f32>()
            })
            .sum();
        sum / (3 * self.cells.len()) as f32
    }

    /// Mean absolute deviation of the cells from their mean, per colour channel; zero for a picture
    /// of one colour.
    pub fn contrast(&self) -> f32 {
        let count = self.cells.len() as f32;
        let mean =
            (0..3).map(|colour| self.cells.iter().map(|cell| cell[colour]).sum::<f32>() / count);
        let deviations = mean.enumerate().map(|(colour, mean)| {
            self.cells
                .iter()
                .map(|cell| (cell[colour] - mean).abs())
                .sum::<f32>()
        });
        deviations.sum::<f32>() / (3.0 * count)
    }

    /// The mean of each square of 2 × 2 cells, row by row.
    fn halve(&self) -> Vec<[f32; 3]> {
        let mut half = Vec::with_capacity(self.cells.len() / 4);
        for rows in self.cells.chunks_exact(2 * WIDTH) {
            for column in (0..WIDTH).step_by(2) {
                let four = [
                    rows[column],
                    rows[column + 1],
                    rows[WIDTH + column],
                    rows[WIDTH + column + 1],
                ];
                half.push(
                    [0, 1, 2].map(|colour| four.iter().map(|cell| cell[colour]).sum::<f32>() / 4.0),
                );
            }
        }
        half
    }
}

/// The pixels in the centres of `parts` equal parts of a side.
fn part_centres(side_px: usize, parts: usize) -> Vec<usize> {
    (0..parts)
        .map(|part| (2 * part + 1) * side_px / (2 * parts))
        .collect()
}

/// Mean absolute difference per colour channel over the overlap, where cell (x, y) of `one` lies on
/// (x + right, y + down) of `other`.
fn shifted_difference(
    one: &[[f32; 3]],
    other: &[[f32; 3]],
    (width, height): (usize, usize),
    (right, down): (i32, i32),
) -> f32 {
    let (columns, rows) = (overlap(width, right), overlap(height, down));
    let count = 3 * columns.len() * rows.len();
    let mut sum = 0.0;
    // The cells of a row are adjacent, so each row of the overlap is one slice of both miniatures.
    for row in rows {
        let start = row * width + columns.start;
        let beside = row.saturating_add_signed(down as isize) * width
            + columns.start.saturating_add_signed(right as isize);
        let (one, other) = (
            &one[start..start + columns.len()],
            &other[beside..beside + columns.len()],
        );
        for (a, b) in one.iter().zip(other) {
            sum += (a[0] - b[0]).abs() + (a[1] - b[1]).abs() + (a[2] - b[2]).abs();
        }
    }
    sum / count as f32
}

/// The columns, or rows, of a miniature that overlap another one which is shifted against it;
/// `side` is their number.
fn overlap(side: usize, shift: i32) -> Range<usize> {
    // With a negative shift the first columns lie before the other's first one, with a positive one
    // the last columns behind its last.
    let (from, cut) = (shift.min(0).unsigned_abs() as usize, shift.max(0) as usize);
    from..side - cut
}
