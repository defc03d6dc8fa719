//! What a patch looks like: 128 bytes.

/// How many numbers a SIFT descriptor has, a byte each.
pub const DESCRIPTOR_BYTES: usize = 128;

/// The Euclidean length of a descriptor, up to rounding: OpenCV scales SIFT to it before it rounds to bytes.
pub const DESCRIPTOR_NORM: f32 = 512.0;

/// The square of the largest distance of two descriptors, for descriptors of unit length: those that share no entry.
pub const MAX_SQUARED_DISTANCE: f32 = 2.0;

/// A SIFT descriptor, as bytes; its length is [`DESCRIPTOR_NORM`].
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub struct Descriptor(pub [u8; DESCRIPTOR_BYTES]);

impl Descriptor {
    /// The squared distance of two descriptors, each taken as of unit length: 0 to [`MAX_SQUARED_DISTANCE`].
    #[must_use]
    pub fn squared_distance(&self, other: &Self) -> f32 {
        squared_byte_distance(&self.0, &other.0) as f32 / (DESCRIPTOR_NORM * DESCRIPTOR_NORM)
    }

    /// A descriptor from OpenCV's numbers (0 to 255, whole).
    #[must_use]
    pub fn plain(values: &[f32; DESCRIPTOR_BYTES]) -> Self {
        Self(values.map(|value| value.round().clamp(0.0, 255.0) as u8))
    }

    /// The square roots of the shares of OpenCV's numbers, scaled to [`DESCRIPTOR_NORM`].
    #[must_use]
    pub fn root(values: &[f32; DESCRIPTOR_BYTES]) -> Self {
        let sum: f32 = values.iter().map(|value| value.max(0.0)).sum();
        let scale = if sum > 0.0 { DESCRIPTOR_NORM * DESCRIPTOR_NORM / sum } else { 0.0 };
        Self(values.map(|value| (value.max(0.0) * scale).sqrt().round().min(255.0) as u8))
    }
}

/// The squared Euclidean distance in bytes. Sums of 16 differences at a time, a shape that compilers turn into SIMD.
fn squared_byte_distance(a: &[u8; DESCRIPTOR_BYTES], b: &[u8; DESCRIPTOR_BYTES]) -> u32 {
    let mut sum = 0i32;
    for (a, b) in a.as_chunks::<16>().0.iter().zip(b.as_chunks::<16>().0) {
        for (&a, &b) in a.iter().zip(b) {
            let difference = i32::from(i16::from(a) - i16::from(b));
            sum += difference * difference;
        }
    }
    sum.unsigned_abs()
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
        assert_eq!(squared_byte_distance(&[255; 128], &[0; 128]), 128 * 255 * 255);
    }

    #[test]
    fn rooted_descriptors_have_the_same_length() {
        let mut values = [0.0; DESCRIPTOR_BYTES];
        for (i, value) in values.iter_mut().enumerate() {
            *value = (i * 37 % 90) as f32;
        }
        let root = Descriptor::root(&values);
        let length = root.0.iter().map(|&v| f32::from(v).powi(2)).sum::<f32>().sqrt();
        assert!((length - DESCRIPTOR_NORM).abs() < 4.0, "{length}");
        assert_eq!(Descriptor::root(&[0.0; DESCRIPTOR_BYTES]), Descriptor([0; DESCRIPTOR_BYTES]));
        assert_eq!(Descriptor::plain(&values).0[..4], [0, 37, 74, 21]);
    }
}
