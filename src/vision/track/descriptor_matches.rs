//! Descriptor matching between two frames: which features look like each other, and like no third
//! one.

use crate::features::{DESCRIPTOR_BYTES, Features};
use nalgebra::DMatrix;

/// Ratio test: the nearest descriptor must be closer than this factor times the second nearest
/// (Lowe: "Distinctive image features from scale-invariant keypoints", IJCV 60, 2004).
const RATIO: f32 = 0.8;

/// The pairs of features, by index, that are each other's nearest neighbour and pass the ratio test
/// in both directions.
pub(super) fn mutual_matches(
    first: &DescriptorColumns,
    second: &DescriptorColumns,
) -> Vec<(usize, usize)> {
    let mut forth = vec![Nearest::NONE; first.lengths.len()];
    let mut back = vec![Nearest::NONE; second.lengths.len()];
    // Squared distances are |a|² + |b|² − 2 aᵀb, so one matrix product gives all of them. The sums
    // of 128 products of bytes stay below 2²⁴, so `f32` represents them exactly. `tr_mul` would
    // compute one scalar product at a time.
    let products = first.descriptors.transpose() * &second.descriptors;
    // One pass over the products finds the two nearest neighbours in both directions.
    for (to, there) in back.iter_mut().enumerate() {
        let length = second.lengths[to];
        for ((from, here), product) in forth.iter_mut().enumerate().zip(products.column(to)) {
            let distance = first.lengths[from] + length - 2.0 * product;
            here.see(to, distance);
            there.see(from, distance);
        }
    }
    forth
        .iter()
        .enumerate()
        .filter_map(|(from, nearest)| {
            let to = nearest.distinctive_match()?;
            (back[to].distinctive_match() == Some(from)).then_some((from, to))
        })
        .collect()
}

/// Descriptors as the columns of a matrix, so that all distances to others follow from one matrix
/// product.
pub(super) struct DescriptorColumns {
    /// One in each column.
    descriptors: DMatrix<f32>,
    /// Their squared lengths.
    lengths: Vec<f32>,
}

impl DescriptorColumns {
    pub fn from_features(features: &Features) -> Self {
        let descriptors = DMatrix::from_fn(DESCRIPTOR_BYTES, features.len(), |row, index| {
            f32::from(features.descriptors[index].0[row])
        });
        let lengths = descriptors
            .column_iter()
            .map(|column| column.norm_squared())
            .collect();
        Self {
            descriptors,
            lengths,
        }
    }
}

/// The nearest neighbour so far, and the squared distances to it and to the second nearest, in
/// bytes².
#[derive(Clone, Copy)]
struct Nearest {
    best: usize,
    first: f32,
    second: f32,
}

impl Nearest {
    const NONE: Self = Self {
        best: usize::MAX,
        first: f32::INFINITY,
        second: f32::INFINITY,
    };

    /// Takes another neighbour into account; of equally near ones the first stays.
    fn see(&mut self, index: usize, distance: f32) {
        if distance < self.first {
            *self = Self {
                best: index,
                first: distance,
                second: self.first,
            };
        } else if distance < self.second {
            self.second = distance;
        }
    }

    /// The nearest neighbour if it passes the ratio test. Distances are squared, and so is the
    /// ratio. A single candidate passes: the second nearest is infinitely far away.
    fn distinctive_match(&self) -> Option<usize> {
        (self.best != usize::MAX && self.first < RATIO * RATIO * self.second).then_some(self.best)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::features::{Descriptor, Keypoint};
    use touchline_core::geometry::{ImagePoint, ImageSize};

    fn features(descriptors: Vec<Descriptor>) -> DescriptorColumns {
        let keypoint = Keypoint {
            point: ImagePoint::new(0.0, 0.0),
            size_px: 4.0,
            strength: 1.0,
        };
        let keypoints = vec![keypoint; descriptors.len()];
        DescriptorColumns::from_features(&Features {
            image_size: ImageSize::new(64, 36),
            keypoints,
            descriptors,
        })
    }

    fn descriptor(seed: u32) -> Descriptor {
        Descriptor(std::array::from_fn(|i| {
            ((seed * 7919 + 13).wrapping_mul(i as u32 * 31 + 17) >> 9) as u8
        }))
    }

    #[test]
    fn what_looks_alike_is_matched_and_what_has_a_rival_is_not() {
        let mut near = descriptor(2);
        near.0[5] = near.0[5].wrapping_add(3);
        let one = features(vec![descriptor(1), descriptor(2), descriptor(3)]);
        let other = features(vec![descriptor(9), near, descriptor(1)]);
        assert_eq!(mutual_matches(&one, &other), [(0, 2), (1, 1)]);
        let mut beside = descriptor(2);
        beside.0[70] = beside.0[70].wrapping_add(3);
        let twice = features(vec![near, beside, descriptor(1)]);
        assert_eq!(mutual_matches(&one, &twice), [(0, 2)], "two look alike");
        assert!(mutual_matches(&one, &features(Vec::new())).is_empty());
    }
}
