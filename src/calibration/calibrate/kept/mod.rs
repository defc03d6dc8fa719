//! Values as bytes, to keep finished work on disk.
//!
//! Work that is taken up again must give the same document as work in one run, so that a value has
//! to come back to the bit, infinities included. JSON writes angles in degrees and has no
//! infinities. The bytes are read by the program that wrote them and by no other, so that they
//! have no version; each value takes its struct apart field by field, and a field that is added
//! does not compile until it is kept, too.

mod cameras;
mod features;
mod paint;
mod parts;
mod primitives;

#[cfg(test)]
pub(crate) use parts::KeptInMemory;
pub(crate) use parts::{KeepParts, NothingKept};

/// A value that is written as bytes and read back as the same value.
pub(crate) trait Kept: Sized {
    /// Appends the value.
    fn write(&self, bytes: &mut Vec<u8>);

    /// Takes the value from the front of the bytes; none if they are not such a value.
    fn read(bytes: &mut &[u8]) -> Option<Self>;
}

/// The bytes of a value.
pub(crate) fn to_bytes(value: &impl Kept) -> Vec<u8> {
    let mut bytes = Vec::new();
    value.write(&mut bytes);
    bytes
}

/// The value that all of these bytes are.
pub(crate) fn from_bytes<T: Kept>(mut bytes: &[u8]) -> Option<T> {
    let value = T::read(&mut bytes)?;
    bytes.is_empty().then_some(value)
}

/// Keeps a struct field by field, in the given order.
macro_rules! kept {
    ($($type:ty { $($field:ident),+ $(,)? })+) => {$(
        impl $crate::calibrate::kept::Kept for $type {
            fn write(&self, bytes: &mut Vec<u8>) {
                let Self { $($field),+ } = self;
                $($crate::calibrate::kept::Kept::write($field, bytes);)+
            }

            fn read(bytes: &mut &[u8]) -> Option<Self> {
                $(let $field = $crate::calibrate::kept::Kept::read(bytes)?;)+
                Some(Self { $($field),+ })
            }
        }
    )+};
}
pub(crate) use kept;
