//! Description: sums of Haar wavelets on a grid around a blob.

use super::blobs::Blob;
use super::integral::Integral;
use touchline::features::{DESCRIPTOR_BYTES, DESCRIPTOR_NORM, Descriptor};

/// Cells along a side of the window, samples along a side of a cell, and numbers of a cell.
const CELLS: usize = 4;
const CELL_SAMPLES: usize = 5;
const CELL_NUMBERS: usize = 4;
/// Samples along a side of the window. They are one scale apart.
const SAMPLES: usize = CELLS * CELL_SAMPLES;
/// Number of numbers of a descriptor.
const NUMBERS: usize = CELLS * CELLS * CELL_NUMBERS;

/// Standard deviation of the Gaussian that weighs the samples, scales.
const WEIGHT_SIGMA: f64 = 3.3;

/// The byte of 0: numbers are of either sign.
const ZERO: f64 = 128.0;

/// The byte of 1, less that of 0: numbers beyond ±0.70 are cut off, and hardly any is so
/// large. With 512, the norm of SIFT's bytes, that would be ±0.25, which the sums of the four
/// cells in the middle often exceed, because they have the most weight.
const UNIT: f64 = 181.0;

/// Squared distances of the stored descriptors, relative to those of descriptors of unit length: an
/// eighth. A gate for unit descriptors is multiplied by it.
pub const SQUARED_SCALE: f32 = (UNIT as f32 / DESCRIPTOR_NORM) * (UNIT as f32 / DESCRIPTOR_NORM);

/// The descriptor of a blob: 64 numbers in the first 64 bytes, the others constant. None if its
/// surroundings are even or outside the picture.
///
/// The sign of the blob (bright or dark) is not compared: the publication uses it for speed.
pub fn describe(grey: &Integral, blob: &Blob) -> Option<Descriptor> {
    let numbers = sum_wavelets(grey, blob);
    let norm = numbers
        .iter()
        .map(|number| number * number)
        .sum::<f64>()
        .sqrt();
    // An even surrounding, or one outside the picture, has no direction to compare. NaN is refused,
    // too.
    if !(norm > 0.0) {
        return None;
    }
    let mut bytes = [ZERO as u8; DESCRIPTOR_BYTES];
    for (byte, number) in bytes.iter_mut().zip(numbers) {
        *byte = (ZERO + UNIT * number / norm).round().clamp(0.0, 255.0) as u8;
    }
    Some(Descriptor(bytes))
}

/// For each cell, row by row: the sums of dx, |dx|, dy and |dy| over its samples.
fn sum_wavelets(grey: &Integral, blob: &Blob) -> [f64; NUMBERS] {
    // The samples' distances from the blob along an axis, in scales, and their weights.
    let offsets: [f64; SAMPLES] =
        std::array::from_fn(|sample| sample as f64 + 0.5 - SAMPLES as f64 / 2.0);
    let weights = offsets.map(|off| (-(off / WEIGHT_SIGMA).powi(2) / 2.0).exp());
    let mut numbers = [0.0; NUMBERS];
    for (row, (off_y, weight_y)) in offsets.iter().zip(weights).enumerate() {
        for (column, (off_x, weight_x)) in offsets.iter().zip(weights).enumerate() {
            let middle = [blob.x + off_x * blob.scale, blob.y + off_y * blob.scale];
            let Some([dx, dy]) = wavelets(grey, middle, blob.scale) else {
                continue;
            };
            let weight = weight_x * weight_y;
            // The cell of the 4 × 4 grid in which the sample lies. A sample counts in its own cell
            // alone.
            let cell = row / CELL_SAMPLES * CELLS + column / CELL_SAMPLES;
            let of_cell = &mut numbers[CELL_NUMBERS * cell..][..CELL_NUMBERS];
            let added = [dx, dx.abs(), dy, dy.abs()];
            for (number, added) in of_cell.iter_mut().zip(added) {
                *number += weight * added;
            }
        }
    }
    numbers
}

/// The differences right less left and lower less upper of a square of two scales around a point.
/// None if the square reaches beyond the picture, where nothing is known.
fn wavelets(grey: &Integral, middle: [f64; 2], scale: f64) -> Option<[f64; 2]> {
    // Half the side. In the corner convention a square of even side has its middle between pixels.
    let half = scale.round().max(1.0);
    let edges = |middle: f64, extent: usize| {
        let middle = middle.round();
        let inside = middle >= half && middle + half <= extent as f64;
        inside.then(|| [middle - half, middle, middle + half].map(|edge| edge as usize))
    };
    let [left, x, right] = edges(middle[0], grey.width())?;
    let [top, y, bottom] = edges(middle[1], grey.height())?;
    let dx = grey.sum([x, right], [top, bottom]) - grey.sum([left, x], [top, bottom]);
    let dy = grey.sum([left, right], [y, bottom]) - grey.sum([left, right], [top, y]);
    Some([dx, dy])
}
