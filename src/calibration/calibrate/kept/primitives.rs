//! Numbers, texts, lists and matrices as bytes.

use super::Kept;
use nalgebra::SMatrix;
use std::collections::BTreeMap;
use std::ops::Range;

impl Kept for f64 {
    fn write(&self, bytes: &mut Vec<u8>) {
        bytes.extend(self.to_bits().to_le_bytes());
    }

    fn read(bytes: &mut &[u8]) -> Option<Self> {
        Some(Self::from_bits(u64::from_le_bytes(
            *bytes.split_off(..8)?.first_chunk()?,
        )))
    }
}

impl Kept for f32 {
    fn write(&self, bytes: &mut Vec<u8>) {
        bytes.extend(self.to_bits().to_le_bytes());
    }

    fn read(bytes: &mut &[u8]) -> Option<Self> {
        Some(Self::from_bits(u32::from_le_bytes(
            *bytes.split_off(..4)?.first_chunk()?,
        )))
    }
}

impl Kept for u64 {
    fn write(&self, bytes: &mut Vec<u8>) {
        bytes.extend(self.to_le_bytes());
    }

    fn read(bytes: &mut &[u8]) -> Option<Self> {
        Some(Self::from_le_bytes(*bytes.split_off(..8)?.first_chunk()?))
    }
}

impl Kept for u8 {
    fn write(&self, bytes: &mut Vec<u8>) {
        bytes.push(*self);
    }

    fn read(bytes: &mut &[u8]) -> Option<Self> {
        bytes.split_off_first().copied()
    }
}

impl Kept for u32 {
    fn write(&self, bytes: &mut Vec<u8>) {
        u64::from(*self).write(bytes);
    }

    fn read(bytes: &mut &[u8]) -> Option<Self> {
        u64::read(bytes)?.try_into().ok()
    }
}

impl Kept for usize {
    fn write(&self, bytes: &mut Vec<u8>) {
        (*self as u64).write(bytes);
    }

    fn read(bytes: &mut &[u8]) -> Option<Self> {
        u64::read(bytes)?.try_into().ok()
    }
}

impl Kept for bool {
    fn write(&self, bytes: &mut Vec<u8>) {
        u8::from(*self).write(bytes);
    }

    fn read(bytes: &mut &[u8]) -> Option<Self> {
        match u8::read(bytes)? {
            0 => Some(false),
            1 => Some(true),
            _ => None,
        }
    }
}

impl Kept for String {
    fn write(&self, bytes: &mut Vec<u8>) {
        self.len().write(bytes);
        bytes.extend(self.as_bytes());
    }

    fn read(bytes: &mut &[u8]) -> Option<Self> {
        let length = usize::read(bytes)?;
        let text = bytes.split_off(..length)?;
        Self::from_utf8(text.to_vec()).ok()
    }
}

impl<T: Kept> Kept for Option<T> {
    fn write(&self, bytes: &mut Vec<u8>) {
        self.is_some().write(bytes);
        if let Some(value) = self {
            value.write(bytes);
        }
    }

    fn read(bytes: &mut &[u8]) -> Option<Self> {
        Some(if bool::read(bytes)? {
            Some(T::read(bytes)?)
        } else {
            None
        })
    }
}

impl<T: Kept> Kept for Vec<T> {
    fn write(&self, bytes: &mut Vec<u8>) {
        self.len().write(bytes);
        for value in self {
            value.write(bytes);
        }
    }

    fn read(bytes: &mut &[u8]) -> Option<Self> {
        // The list grows as its values are read: a damaged length takes no memory.
        let length = usize::read(bytes)?;
        let mut values = Self::with_capacity(length.min(bytes.len()));
        for _ in 0..length {
            values.push(T::read(bytes)?);
        }
        Some(values)
    }
}

impl<K: Kept + Ord, V: Kept> Kept for BTreeMap<K, V> {
    fn write(&self, bytes: &mut Vec<u8>) {
        self.len().write(bytes);
        for (key, value) in self {
            key.write(bytes);
            value.write(bytes);
        }
    }

    fn read(bytes: &mut &[u8]) -> Option<Self> {
        Some(Vec::<(K, V)>::read(bytes)?.into_iter().collect())
    }
}

impl<A: Kept, B: Kept> Kept for (A, B) {
    fn write(&self, bytes: &mut Vec<u8>) {
        self.0.write(bytes);
        self.1.write(bytes);
    }

    fn read(bytes: &mut &[u8]) -> Option<Self> {
        Some((A::read(bytes)?, B::read(bytes)?))
    }
}

impl Kept for Range<usize> {
    fn write(&self, bytes: &mut Vec<u8>) {
        (self.start, self.end).write(bytes);
    }

    fn read(bytes: &mut &[u8]) -> Option<Self> {
        let (start, end) = Kept::read(bytes)?;
        Some(start..end)
    }
}

impl<T: Kept + Copy + Default, const N: usize> Kept for [T; N] {
    fn write(&self, bytes: &mut Vec<u8>) {
        for value in self {
            value.write(bytes);
        }
    }

    fn read(bytes: &mut &[u8]) -> Option<Self> {
        let mut values = [T::default(); N];
        for value in &mut values {
            *value = T::read(bytes)?;
        }
        Some(values)
    }
}

impl<const R: usize, const C: usize> Kept for SMatrix<f64, R, C> {
    fn write(&self, bytes: &mut Vec<u8>) {
        for value in self {
            value.write(bytes);
        }
    }

    fn read(bytes: &mut &[u8]) -> Option<Self> {
        let mut values = Self::zeros();
        for value in &mut values {
            *value = f64::read(bytes)?;
        }
        Some(values)
    }
}

#[cfg(test)]
mod tests {
    use crate::calibrate::kept::{from_bytes, to_bytes};
    use std::collections::BTreeMap;

    type Value = (
        Vec<Option<f64>>,
        (BTreeMap<usize, String>, (bool, Vec<u32>)),
    );

    #[test]
    fn values_come_back_to_the_bit_and_damaged_bytes_give_none() {
        let named = BTreeMap::from([(3, "höher".to_owned()), (9, String::new())]);
        let numbers = vec![Some(f64::INFINITY), None, Some(-0.0), Some(0.1)];
        let value: Value = (numbers, (named, (true, vec![7, u32::MAX])));
        let bytes = to_bytes(&value);
        let read: Value = from_bytes(&bytes).unwrap();
        assert_eq!(read, value);
        assert_eq!(read.0[2].map(f64::to_bits), Some((-0.0_f64).to_bits()));
        for length in 0..bytes.len() {
            assert_eq!(from_bytes::<Value>(&bytes[..length]), None, "{length}");
        }
        let mut longer = bytes.clone();
        longer.push(0);
        assert_eq!(from_bytes::<Value>(&longer), None);
        // A length that no memory holds.
        assert_eq!(from_bytes::<Vec<u64>>(&[255; 8]), None);
    }
}
