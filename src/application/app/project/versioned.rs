//! A value with a version number, for the invalidation of values derived from it.

use std::ops::{Deref, DerefMut};

/// A value with a version. Mutable access raises the version, so a value that was derived from one
/// version is valid until the version changes. A clone of the inner value has no version.
#[derive(Debug)]
pub struct Versioned<T> {
    value: T,
    version: u64,
}

impl<T> Versioned<T> {
    /// A value at version 0.
    pub const fn new(value: T) -> Self {
        Self { value, version: 0 }
    }

    /// The version. It grows whenever the value may have changed, and never decreases.
    pub const fn version(&self) -> u64 {
        self.version
    }
}

impl<T> Versioned<T> {
    /// Raises the version, because something else that derived values depend on has changed.
    pub(super) const fn raise_version(&mut self) {
        self.version += 1;
    }

    /// Mutable access that keeps the version: only for parts from which nothing is derived.
    pub(super) const fn keeping_version(&mut self) -> &mut T {
        &mut self.value
    }
}

impl<T> Deref for Versioned<T> {
    type Target = T;
    fn deref(&self) -> &T {
        &self.value
    }
}

impl<T> DerefMut for Versioned<T> {
    fn deref_mut(&mut self) -> &mut T {
        self.raise_version();
        &mut self.value
    }
}

#[cfg(test)]
mod tests {
    use super::Versioned;

    #[test]
    fn writing_raises_the_version_and_reading_does_not() {
        let mut value = Versioned::new(vec![1]);
        assert_eq!((value.len(), value.version()), (1, 0));
        value.push(2);
        assert_eq!((value.version(), value.clone()), (1, vec![1, 2]));
        *value = Vec::new();
        assert_eq!(value.version(), 2);
    }
}
