//! SIFT keypoints, and their descriptors as 128 bytes.

use touchline_core::geometry::{ImagePoint, ImageSize};

/// Number of elements of a SIFT descriptor, one byte each.
pub const DESCRIPTOR_BYTES: usize = 128;

/// Euclidean norm of a descriptor, up to rounding. OpenCV scales SIFT to it before it rounds to
/// bytes.
pub const DESCRIPTOR_NORM: f32 = 512.0;

/// Maximum squared distance of two descriptors of unit norm: that of descriptors without a common
/// non-zero element.
pub const MAX_SQUARED_DISTANCE: f32 = 2.0;

/// Maximum squared distance of two descriptors of the same thing, both of unit norm.
pub const MAX_MATCH_SQUARED_DISTANCE: f32 = 0.2;

/// A SIFT descriptor, as bytes, of norm [`DESCRIPTOR_NORM`]. Aligned to cache lines.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
#[repr(align(64))]
pub struct Descriptor(pub [u8; DESCRIPTOR_BYTES]);

impl Descriptor {
    /// Squared distance of two descriptors, each scaled to unit norm: 0 to
    /// [`MAX_SQUARED_DISTANCE`].
    pub fn squared_distance(&self, other: &Self) -> f32 {
        self.squared_byte_distance(other) as f32 / (DESCRIPTOR_NORM * DESCRIPTOR_NORM)
    }

    /// Squared distance of two descriptors in bytes, written in a form that compilers turn into
    /// SIMD.
    #[inline(always)]
    #[allow(
        clippy::inline_always,
        reason = "searches are compiled for the processor at hand, with all they inline"
    )]
    pub fn squared_byte_distance(&self, other: &Self) -> u32 {
        let mut sum = 0i32;
        for (&a, &b) in self.0.iter().zip(&other.0) {
            let difference = i16::from(a) - i16::from(b);
            sum += i32::from(difference) * i32::from(difference);
        }
        sum.unsigned_abs()
    }

    /// Converts OpenCV's numbers (0 to 255, whole).
    pub fn plain(values: &[f32; DESCRIPTOR_BYTES]) -> Self {
        Self(values.map(|value| value.round().clamp(0.0, 255.0) as u8))
    }

    /// Converts OpenCV's numbers to `RootSIFT`: the square roots of the L1-normalised elements,
    /// scaled to [`DESCRIPTOR_NORM`] (Arandjelović and Zisserman, CVPR 2012).
    pub fn root(values: &[f32; DESCRIPTOR_BYTES]) -> Self {
        let sum: f32 = values.iter().map(|value| value.max(0.0)).sum();
        let scale = if sum > 0.0 {
            DESCRIPTOR_NORM * DESCRIPTOR_NORM / sum
        } else {
            0.0
        };
        Self(values.map(|value| (value.max(0.0) * scale).sqrt().round().min(255.0) as u8))
    }
}

/// Bytes of a [`Sketch`].
const SKETCH_BYTES: usize = DESCRIPTOR_BYTES / GROUP;
/// Number of bytes of a descriptor that one byte of its sketch represents.
const GROUP: usize = 4;

/// A quarter of a descriptor: the means of groups of four bytes.
///
/// Descriptors of the same patch differ in single cells, outliers in whole regions. The distance of
/// two sketches therefore excludes most outliers with a quarter of the memory traffic.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[repr(align(32))]
pub struct Sketch([u8; SKETCH_BYTES]);

impl Sketch {
    /// The sketch of a descriptor. A group is one gradient direction in a 2 × 2 block of cells.
    pub fn from_descriptor(descriptor: &Descriptor) -> Self {
        Self(std::array::from_fn(|at| {
            // A descriptor has 4 × 4 cells of 8 directions, index = (row · 4 + column) · 8 +
            // direction. `corner` is a direction in the top left cell of a block; the others are
            // one column (8), one row (32) and both (40) away.
            let corner = at / 16 * 64 + at / 8 % 2 * 16 + at % 8;
            let sum: u16 = [0, 8, 32, 40]
                .iter()
                .map(|cell| u16::from(descriptor.0[corner + cell]))
                .sum();
            ((sum + GROUP as u16 / 2) / GROUP as u16) as u8
        }))
    }

    /// Lower bound, but for rounding, of the squared distance of the two descriptors in bytes.
    ///
    /// Four differences with the sum d have a sum of squares of at least d² / 4 (Cauchy–Schwarz).
    /// With the difference of means m = d / 4 this is 4 m², summed over all groups. Means are
    /// rounded, so a group may appear one further apart than it is.
    #[inline(always)]
    #[allow(
        clippy::inline_always,
        reason = "searches are compiled for the processor at hand, with all they inline"
    )]
    pub fn squared_byte_distance(&self, other: &Self) -> u32 {
        // Two loops, because SIMD has an absolute difference of bytes.
        let differences: [u8; SKETCH_BYTES] =
            std::array::from_fn(|at| self.0[at].abs_diff(other.0[at]));
        let mut sum = 0i32;
        for difference in differences {
            let difference = i16::from(difference);
            sum += i32::from(difference) * i32::from(difference);
        }
        GROUP as u32 * sum.unsigned_abs()
    }

    /// The first byte.
    pub const fn first(&self) -> u8 {
        self.0[0]
    }
}

/// Position, size and strength of a feature.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Keypoint {
    /// Position, px of the full picture, corner convention.
    pub point: ImagePoint,
    /// Diameter of the patch, px of the full picture.
    pub size_px: f32,
    /// The detector's response; larger is stronger.
    pub strength: f32,
}

/// The features of a picture, the strongest first.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Features {
    /// The size of the full picture, px.
    pub image_size: ImageSize,
    /// Positions, sizes and strengths.
    pub keypoints: Vec<Keypoint>,
    /// One descriptor for each keypoint.
    pub descriptors: Vec<Descriptor>,
}

impl Features {
    /// Number of features.
    pub const fn len(&self) -> usize {
        self.keypoints.len()
    }

    /// Whether the picture has no features.
    pub const fn is_empty(&self) -> bool {
        self.keypoints.is_empty()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn distances_are_those_of_unit_vectors() {
        let mut a = Descriptor([0; DESCRIPTOR_BYTES]);
        let mut b = a;
        for i in 0..8 {
            a.0[i] = 181;
            b.0[64 + i] = 181;
        }
        assert_eq!(a.squared_distance(&a), 0.0);
        assert!((a.squared_distance(&b) - MAX_SQUARED_DISTANCE).abs() < 1e-3);
        let (full, empty) = (
            Descriptor([255; DESCRIPTOR_BYTES]),
            Descriptor([0; DESCRIPTOR_BYTES]),
        );
        assert_eq!(full.squared_byte_distance(&empty), 128 * 255 * 255);
    }

    #[test]
    fn sketches_say_hardly_more_than_descriptors() {
        let descriptor = |seed: u32| {
            Descriptor(std::array::from_fn(|i| {
                ((seed * 7919 + 1).wrapping_mul(i as u32 * 31 + 17) >> 9) as u8
            }))
        };
        let mut tight = 0;
        for seed in 0..200 {
            let (a, b) = (descriptor(seed), descriptor(seed / 2 + 1000));
            let (estimated, exact) = (
                Sketch::from_descriptor(&a).squared_byte_distance(&Sketch::from_descriptor(&b)),
                a.squared_byte_distance(&b),
            );
            // (√estimated − √rounding)² ≤ exact, where rounding is four for each group.
            let rounding = f64::from((GROUP * SKETCH_BYTES) as u32).sqrt();
            assert!(
                (f64::from(estimated).sqrt() - rounding) <= f64::from(exact).sqrt(),
                "{estimated} of {exact}"
            );
            tight += u32::from(estimated > exact / 10);
        }
        assert!(tight > 100, "and they do say something: {tight} of 200");
        let (dark, bright) = (
            Descriptor([0; DESCRIPTOR_BYTES]),
            Descriptor([255; DESCRIPTOR_BYTES]),
        );
        assert_eq!(
            Sketch::from_descriptor(&dark).squared_byte_distance(&Sketch::from_descriptor(&bright)),
            128 * 255 * 255
        );
        let mut cells = Descriptor([0; DESCRIPTOR_BYTES]);
        for cell in [10, 11, 14, 15] {
            cells.0[cell * 8 + 5] = 100;
        }
        let apart =
            Sketch::from_descriptor(&cells).squared_byte_distance(&Sketch::from_descriptor(&dark));
        assert_eq!(
            apart,
            4 * 100 * 100,
            "the cells of the last corner are one group"
        );
    }

    #[test]
    fn rooted_descriptors_have_the_same_length() {
        let mut values = [0.0; DESCRIPTOR_BYTES];
        for (i, value) in values.iter_mut().enumerate() {
            *value = (i * 37 % 90) as f32;
        }
        let root = Descriptor::root(&values);
        let length = root
            .0
            .iter()
            .map(|&v| f32::from(v).powi(2))
            .sum::<f32>()
            .sqrt();
        assert!((length - DESCRIPTOR_NORM).abs() < 4.0, "{length}");
        assert_eq!(
            Descriptor::root(&[0.0; DESCRIPTOR_BYTES]),
            Descriptor([0; DESCRIPTOR_BYTES])
        );
        assert_eq!(Descriptor::plain(&values).0[..4], [0, 37, 74, 21]);
    }
}
