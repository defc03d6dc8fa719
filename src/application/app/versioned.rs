//! A value that counts how often it may have changed.

use std::ops::{Deref, DerefMut};

/// A value with a version: whoever takes it to write to it raises the version, so what was derived
/// from one version holds until there is another. A copy of the value is a plain one: it has no
/// version.
#[derive(Debug)]
pub struct Versioned<T> {
    value: T,
    version: u64,
}

impl<T> Versioned<T> {
    /// A value nobody has changed yet.
    #[must_use]
    pub const fn new(value: T) -> Self {
        Self { value, version: 0 }
    }

    /// Grows whenever the value may have changed, and never comes back.
    #[must_use]
    pub const fn version(&self) -> u64 {
        self.version
    }
}

impl<T> Versioned<T> {
    /// Something else that is derived from has changed.
    pub(super) const fn raise_version(&mut self) {
        self.version += 1;
    }

    /// The value, to change what nothing is derived from: the version stays.
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
