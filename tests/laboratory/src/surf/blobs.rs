//! Detection: blobs are maxima of the Hessian's determinant over place and scale.
//!
//! The Gaussian's second derivatives are approximated by sums over boxes, so that a filter of any
//! size costs the same, and the scale grows with the filter instead of with a smoothed picture.

use super::integral::Integral;
use nalgebra::{Matrix3, Vector3};

/// The filters' sizes, px, by octave. They grow by a whole number of pixels for each of the three
/// lobes; the samples of an octave are twice as far apart as those of the one before.
const OCTAVES: [[usize; LAYERS]; 4] = [
    [9, 15, 21, 27],
    [15, 27, 39, 51],
    [27, 51, 75, 99],
    [51, 99, 147, 195],
];
const LAYERS: usize = 4;

/// The scale of the smallest filter, of 9 px: the standard deviation of the Gaussian that it
/// approximates, px.
const SCALE_PER_PX: f64 = 1.2 / 9.0;

/// Weight of the mixed derivative, which makes up for the boxes' difference from a Gaussian.
const MIXED: f64 = 0.9;

/// A blob, in px of the reduced picture, corner convention.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Blob {
    pub x: f64,
    pub y: f64,
    /// The standard deviation of the Gaussian whose derivatives found it, px.
    pub scale: f64,
    /// The determinant, of grey values from 0 to 1.
    pub strength: f64,
}

/// The determinants of one filter, sampled on the octave's grid. 0 where the filter reaches beyond
/// the picture.
struct Layer {
    /// Number of samples in a row.
    columns: usize,
    values: Vec<f64>,
}

/// Finds all blobs of a picture, octave by octave, layer by layer and row by row.
pub fn find_blobs(grey: &Integral) -> Vec<Blob> {
    let mut blobs = Vec::new();
    for (octave, sizes) in OCTAVES.iter().enumerate() {
        let step = 1 << octave;
        // A maximum needs three layers, which must fit into the picture.
        if sizes[2] > grey.width().min(grey.height()) {
            break;
        }
        let layers = sizes.map(|size| filter_picture(grey, size, step));
        for middle in 1..LAYERS - 1 {
            let Some(three) = layers[middle - 1..].first_chunk::<3>() else {
                continue;
            };
            // The largest of the three filters fits at the samples that are compared.
            let half = sizes[middle + 1] / 2;
            let rows = comparable_range(grey.height(), half, step);
            for (row, column) in rows.flat_map(|row| {
                comparable_range(grey.width(), half, step).map(move |column| (row, column))
            }) {
                if let Some(offset) = locate_maximum(three, row, column) {
                    // A pixel's centre is half a pixel from its corner.
                    let place = |sample: usize, off: f64| (sample as f64 + off) * step as f64 + 0.5;
                    let growth = (sizes[middle + 1] - sizes[middle]) as f64;
                    blobs.push(Blob {
                        x: place(column, offset.x),
                        y: place(row, offset.y),
                        scale: SCALE_PER_PX * (sizes[middle] as f64 + offset.z * growth),
                        strength: three[1].at(row, column),
                    });
                }
            }
        }
    }
    blobs
}

/// The samples along an axis at which a filter of this half width fits, and at their neighbours.
fn comparable_range(extent: usize, half: usize, step: usize) -> std::ops::Range<usize> {
    let first = half.div_ceil(step) + 1;
    let last = extent.saturating_sub(1 + half) / step;
    first..last
}

/// Computes the determinants of a filter at every `step`-th pixel.
fn filter_picture(grey: &Integral, size: usize, step: usize) -> Layer {
    let (columns, rows) = (grey.width().div_ceil(step), grey.height().div_ceil(step));
    let half = size / 2;
    let mut values = vec![0.0; columns * rows];
    for row in 0..rows {
        for column in 0..columns {
            let (x, y) = (column * step, row * step);
            let fits = |at: usize, extent: usize| at >= half && at + half < extent;
            if fits(x, grey.width()) && fits(y, grey.height()) {
                values[row * columns + column] = determinant(grey, size, x, y);
            }
        }
    }
    Layer { columns, values }
}

/// The determinant of the Hessian at a pixel, from boxes that fit into the picture.
fn determinant(grey: &Integral, size: usize, x: usize, y: usize) -> f64 {
    let (half, lobe) = (size / 2, size / 3);
    let around = |middle: usize, reach: usize| [middle - reach, middle + reach + 1];
    // Three lobes in a row, weighted 1, −2, 1: all of them, less three times the middle one. They
    // are as long as two lobes less a pixel.
    let long = lobe - 1;
    let xx = grey.sum(around(x, half), around(y, long))
        - 3.0 * grey.sum(around(x, lobe / 2), around(y, long));
    let yy = grey.sum(around(x, long), around(y, half))
        - 3.0 * grey.sum(around(x, long), around(y, lobe / 2));
    // Four square lobes, a pixel apart.
    let [before_x, after_x] = [[x - lobe, x], [x + 1, x + 1 + lobe]];
    let [before_y, after_y] = [[y - lobe, y], [y + 1, y + 1 + lobe]];
    let xy = grey.sum(before_x, before_y) + grey.sum(after_x, after_y)
        - grey.sum(after_x, before_y)
        - grey.sum(before_x, after_y);
    // Per pixel of the filter, so that the responses of all sizes compare.
    let unit = (size * size) as f64 * grey.white();
    let [xx, yy, xy] = [xx, yy, xy].map(|sum| sum / unit);
    xx * yy - (MIXED * xy).powi(2)
}

impl Layer {
    fn at(&self, row: usize, column: usize) -> f64 {
        self.values[row * self.columns + column]
    }
}

/// Where the maximum near a sample of the middle layer lies, in samples from it: x, y and layer.
/// None if the sample is not the largest of its 26 neighbours.
fn locate_maximum(layers: &[Layer; 3], row: usize, column: usize) -> Option<Vector3<f64>> {
    let value = layers[1].at(row, column);
    // Most samples fail here, before any neighbour is looked at.
    if !(value > 0.0) {
        return None;
    }
    let mut cube = [[[0.0; 3]; 3]; 3];
    for (number, layer) in layers.iter().enumerate() {
        for (line, values) in cube[number].iter_mut().enumerate() {
            let start = (row + line - 1) * layer.columns + column - 1;
            values.copy_from_slice(&layer.values[start..start + 3]);
        }
    }
    // A blob between two pixels may have equal samples; the first of them is the maximum.
    let flat = cube.as_flattened().as_flattened();
    let (before, after) = (&flat[..13], &flat[14..]);
    let is_largest =
        before.iter().all(|other| *other < value) && after.iter().all(|other| *other <= value);
    if !is_largest {
        return None;
    }
    fit_quadratic(&cube)
}

/// The maximum of the quadratic function through a sample and its neighbours (M. Brown, D. Lowe,
/// "Invariant features from interest point groups", BMVC 2002). `cube` is indexed by layer, row and
/// column. None if it lies more than a sample away, where the fit says nothing.
fn fit_quadratic(cube: &[[[f64; 3]; 3]; 3]) -> Option<Vector3<f64>> {
    // The value at an offset (x, y, layer).
    let at = |offset: [i32; 3]| {
        let [column, row, layer] = offset.map(|step| (step + 1) as usize);
        cube[layer][row][column]
    };
    let unit = |axis: usize| std::array::from_fn(|other| i32::from(other == axis));
    let add = |a: [i32; 3], b: [i32; 3], sign: i32| -> [i32; 3] {
        std::array::from_fn(|axis| a[axis] + sign * b[axis])
    };
    let zero = [0; 3];
    let gradient =
        Vector3::from_fn(|axis, _| (at(unit(axis)) - at(add(zero, unit(axis), -1))) / 2.0);
    let hessian = Matrix3::from_fn(|one, other| {
        let (one, other) = (unit(one), unit(other));
        if one == other {
            return at(one) - 2.0 * at(zero) + at(add(zero, one, -1));
        }
        let same = at(add(one, other, 1)) + at(add(add(zero, one, -1), other, -1));
        let opposite = at(add(one, other, -1)) + at(add(other, one, -1));
        (same - opposite) / 4.0
    });
    let offset = hessian.lu().solve(&-gradient)?;
    offset.iter().all(|off| off.abs() <= 1.0).then_some(offset)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_fit_finds_the_maximum_of_a_quadratic_function() {
        let maximum = Vector3::new(0.3, -0.2, 0.4);
        let curve = Matrix3::new(2.0, 0.3, -0.1, 0.3, 1.5, 0.2, -0.1, 0.2, 1.0);
        let mut cube = [[[0.0; 3]; 3]; 3];
        for (layer, plane) in cube.iter_mut().enumerate() {
            for (row, line) in plane.iter_mut().enumerate() {
                for (column, value) in line.iter_mut().enumerate() {
                    let at = Vector3::new(column as f64, row as f64, layer as f64);
                    let off = at.add_scalar(-1.0) - maximum;
                    *value = 5.0 - (off.transpose() * curve * off).x;
                }
            }
        }
        let found = fit_quadratic(&cube).unwrap();
        assert!((found - maximum).norm() < 1e-12, "{found}");
        assert_eq!(fit_quadratic(&[[[1.0; 3]; 3]; 3]), None);
    }

    #[test]
    fn filters_are_compared_where_they_and_their_neighbours_fit() {
        for extent in 0..120 {
            for (half, step) in [(7, 1), (10, 1), (13, 2), (19, 2), (37, 4), (49, 8)] {
                let fits = |sample: usize| sample * step >= half && sample * step + half < extent;
                for sample in 0..extent + 2 {
                    let expected = sample > 0 && (sample - 1..=sample + 1).all(fits);
                    let is_compared = comparable_range(extent, half, step).contains(&sample);
                    assert_eq!(is_compared, expected, "{extent} {half} {step} {sample}");
                }
            }
        }
    }
}
