//! A frame reduced to a size at which only large structures remain; shot boundaries are detected on
//! it.

use super::detail::{Detail, HEIGHT, WIDTH};
use crate::media::Picture;
use std::cell::OnceCell;
use std::ops::Range;

/// Pixels sampled per side of a cell; their mean is the value of the cell.
const SAMPLES: usize = 6;
/// Largest shift tried, in columns and rows of a miniature of half the size.
const COARSE_SHIFT: (i32, i32) = (8, 4);
/// Zooms tried beside none. A camera changes its focal length by up to a third in half a second.
const ZOOMS: [f32; 6] = [0.72, 0.81, 0.9, 1.1, 1.22, 1.35];

/// A frame reduced to 64 × 36 cells of red, green and blue, whatever its shape.
#[derive(Clone, Debug, PartialEq)]
pub struct Miniature {
    /// Red, green and blue of each cell, 0 to 255, row by row from the top.
    cells: Vec<[f32; 3]>,
    detail: OnceCell<Detail>,
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
        Self::from_cells(cells)
    }

    fn from_cells(cells: Vec<[f32; 3]>) -> Self {
        Self {
            cells,
            detail: OnceCell::new(),
        }
    }

    /// The detail of the picture; computed once.
    pub fn detail(&self) -> &Detail {
        self.detail.get_or_init(|| {
            let cells = self.cells.iter();
            let luminance = cells.map(|cell| cell.iter().sum::<f32>() / 3.0);
            Detail::new(&luminance.collect::<Vec<f32>>())
        })
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

    /// Mean absolute difference per colour channel without a shift, 0 to 255.
    pub fn plain_difference(&self, other: &Self) -> f32 {
        let sum: f32 = self
            .cells
            .iter()
            .zip(&other.cells)
            .map(|(a, b)| cell_difference(a, b))
            .sum();
        sum / self.cells.len() as f32
    }

    /// As [`Miniature::difference`], also under the zoom that fits best: the smallest difference
    /// from the other miniature scaled about its middle.
    pub fn difference_over_zoom(&self, other: &Self) -> f32 {
        ZOOMS
            .iter()
            .map(|zoom| self.difference(&other.scale(*zoom)))
            .fold(self.difference(other), f32::min)
    }

    /// The share α of `after` in the mixture (1 − α) `before` + α `after` that is nearest to this
    /// picture, by least squares; 0 for two equal pictures.
    ///
    /// What moves within the pictures hardly disturbs α, because it has little in common with the
    /// difference of the two.
    pub fn share_of(&self, before: &Self, after: &Self) -> f32 {
        let (mut along, mut length) = (0.0, 0.0);
        for ((cell, a), b) in self.cells.iter().zip(&before.cells).zip(&after.cells) {
            for colour in 0..3 {
                let change = b[colour] - a[colour];
                along += (cell[colour] - a[colour]) * change;
                length += change * change;
            }
        }
        if length > 0.0 { along / length } else { 0.0 }
    }

    /// The share of cells that look like `after` rather than like `before`, 0 to 1, of those in
    /// which the two differ by more than `levels` grey levels.
    pub fn share_of_cells(&self, before: &Self, after: &Self, levels: f32) -> f32 {
        let cells = self.cells.iter().zip(&before.cells).zip(&after.cells);
        let (mut like_after, mut count) = (0, 0);
        for ((cell, a), b) in cells.filter(|((_, a), b)| cell_difference(a, b) > levels) {
            count += 1;
            like_after += usize::from(cell_difference(cell, b) < cell_difference(cell, a));
        }
        like_after as f32 / count.max(1) as f32
    }

    /// Mean absolute difference per colour channel from the mixture of two others with the share
    /// `share` of `after`: small in a dissolve.
    pub fn difference_from_mixture(&self, before: &Self, after: &Self, share: f32) -> f32 {
        let mixed =
            before.cells.iter().zip(&after.cells).map(|(a, b)| {
                [0, 1, 2].map(|colour| (1.0 - share) * a[colour] + share * b[colour])
            });
        let differences = self
            .cells
            .iter()
            .zip(mixed)
            .map(|(cell, mixed)| cell_difference(cell, &mixed));
        differences.sum::<f32>() / self.cells.len() as f32
    }

    /// Mean over the cells of the difference from the nearer one of two others: small in a wipe,
    /// in which each cell shows one of the two pictures.
    pub fn difference_from_either(&self, before: &Self, after: &Self) -> f32 {
        let nearer = before.cells.iter().zip(&after.cells);
        let differences = self
            .cells
            .iter()
            .zip(nearer)
            .map(|(cell, (a, b))| cell_difference(cell, a).min(cell_difference(cell, b)));
        differences.sum::<f32>() / self.cells.len() as f32
    }

    /// The share of cells that differ by more than `levels` grey levels, 0 to 1.
    pub fn share_of_changed_cells(&self, other: &Self, levels: f32) -> f32 {
        let pairs = self.cells.iter().zip(&other.cells);
        let changed = pairs.filter(|(a, b)| cell_difference(a, b) > levels);
        changed.count() as f32 / self.cells.len() as f32
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

    /// The miniature enlarged by a factor about its middle; at a factor below 1 the outermost cells
    /// are repeated.
    fn scale(&self, factor: f32) -> Self {
        let source = |at: usize, side: usize| {
            let middle = 0.5 * (side as f32 - 1.0);
            let from = middle + (at as f32 - middle) / factor;
            (from.round().max(0.0) as usize).min(side - 1)
        };
        let columns: Vec<usize> = (0..WIDTH).map(|column| source(column, WIDTH)).collect();
        let cells = (0..HEIGHT).flat_map(|row| {
            let row = WIDTH * source(row, HEIGHT);
            columns.iter().map(move |column| row + column)
        });
        Self::from_cells(cells.map(|cell| self.cells[cell]).collect())
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

/// Mean absolute difference of two cells per colour channel.
fn cell_difference(a: &[f32; 3], b: &[f32; 3]) -> f32 {
    ((a[0] - b[0]).abs() + (a[1] - b[1]).abs() + (a[2] - b[2]).abs()) / 3.0
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
