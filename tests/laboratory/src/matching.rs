//! Exact nearest neighbours of descriptors by brute force, computed as a matrix product.
//!
//! ‖a − b‖² = ‖a‖² + ‖b‖² − 2 a·b. The scalar products of all pairs are one product of two
//! matrices, for which nalgebra has an optimised kernel (`matrixmultiply`). Entries are bytes and
//! no sum exceeds 2²⁴, so that f32 represents every sum exactly: the neighbours are those of a
//! direct search, to the last bit. OpenCV's `BFMatcher` sums squared differences instead.

use nalgebra::DMatrix;
use touchline::features::{DESCRIPTOR_BYTES, DESCRIPTOR_NORM, Descriptor};

/// Descriptors as rows of a matrix, with their squared norms.
#[derive(Clone, Debug)]
pub struct DescriptorRows {
    matrix: DMatrix<f32>,
    squared: Vec<f32>,
}

impl DescriptorRows {
    /// Converts descriptors.
    #[must_use]
    pub fn from_descriptors(descriptors: &[Descriptor]) -> Self {
        // nalgebra stores columns, but takes rows here, one for each descriptor.
        let values = descriptors
            .iter()
            .flat_map(|descriptor| descriptor.0.map(f32::from));
        let matrix = DMatrix::from_row_iterator(descriptors.len(), DESCRIPTOR_BYTES, values);
        let squared = descriptors
            .iter()
            .map(|descriptor| {
                descriptor
                    .0
                    .iter()
                    .map(|value| f32::from(*value).powi(2))
                    .sum()
            })
            .collect();
        Self { matrix, squared }
    }

    /// Number of descriptors.
    #[must_use]
    pub const fn len(&self) -> usize {
        self.squared.len()
    }

    /// Whether there are no descriptors.
    #[must_use]
    pub const fn is_empty(&self) -> bool {
        self.squared.is_empty()
    }
}

/// The nearest and second-nearest feature of a reference.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Nearest {
    /// Index of the nearest feature in the reference.
    pub feature: usize,
    /// Its squared distance, for descriptors of unit length.
    pub squared_distance: f32,
    /// The squared distance of the second-nearest feature.
    pub second: f32,
}

/// For each feature of a picture, the nearest one of a reference. Empty if the reference has no
/// features.
#[must_use]
pub fn nearest(query: &DescriptorRows, reference: &DescriptorRows) -> Vec<Nearest> {
    if reference.is_empty() {
        return Vec::new();
    }
    // 128 products of two bytes are below 2²³, and ‖b‖² − 2 a·b stays within ±2²⁴: all exact in
    // `f32`.
    let products = &reference.matrix * query.matrix.transpose();
    // Bytes are descriptors of unit length times the norm.
    let unit = DESCRIPTOR_NORM * DESCRIPTOR_NORM;
    let of_feature = |(number, products): (usize, &[f32])| {
        let mut best = Nearest {
            feature: 0,
            squared_distance: f32::INFINITY,
            second: f32::INFINITY,
        };
        for (feature, (product, squared)) in products.iter().zip(&reference.squared).enumerate() {
            let distance = squared - 2.0 * product;
            // A strict comparison: of equal distances the first feature is the nearest.
            if distance < best.squared_distance {
                best = Nearest {
                    feature,
                    squared_distance: distance,
                    second: best.squared_distance,
                };
            } else if distance < best.second {
                best.second = distance;
            }
        }
        // ‖a‖² is common to all distances of a feature, so it is added only now.
        let own = query.squared[number];
        let whole = |distance: f32| (distance + own) / unit;
        Nearest {
            squared_distance: whole(best.squared_distance),
            second: whole(best.second),
            ..best
        }
    };
    // Each column belongs to one feature of the picture, and the columns lie one after the other.
    products
        .as_slice()
        .chunks_exact(reference.len())
        .enumerate()
        .map(of_feature)
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::setting::rng;
    use rand::RngExt;

    #[test]
    fn neighbours_are_those_of_a_plain_search() {
        let mut draw = rng(1, [2, 3]);
        // Large entries are rare, as in SIFT, and the norm is that of a real descriptor.
        let mut descriptors = |count: usize| -> Vec<Descriptor> {
            let one = |_| {
                let values = std::array::from_fn(|_| draw.random_range(0.0f32..1.0).powi(4));
                Descriptor::root(&values)
            };
            (0..count).map(one).collect()
        };
        let (query, reference) = (descriptors(40), descriptors(90));
        let found = nearest(
            &DescriptorRows::from_descriptors(&query),
            &DescriptorRows::from_descriptors(&reference),
        );
        assert_eq!(found.len(), query.len());
        for (descriptor, found) in query.iter().zip(found) {
            let mut distances: Vec<(f32, usize)> = reference
                .iter()
                .enumerate()
                .map(|(at, other)| (descriptor.squared_distance(other), at))
                .collect();
            distances.sort_by(|a, b| a.0.total_cmp(&b.0));
            assert_eq!((found.squared_distance, found.feature), distances[0]);
            assert_eq!(found.second, distances[1].0);
        }
        assert_eq!(
            nearest(
                &DescriptorRows::from_descriptors(&query),
                &DescriptorRows::from_descriptors(&[])
            ),
            []
        );
    }
}
