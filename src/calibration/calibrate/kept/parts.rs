//! The finished parts of one long piece of work, kept as they come.

use super::{Kept, from_bytes, to_bytes};
#[cfg(test)]
use std::{cell::RefCell, collections::BTreeMap};

/// Keeps the finished parts of one piece of work, by name. Whoever asks has done the same work with
/// the same inputs before.
pub(crate) trait KeepParts {
    /// The bytes of a part that was kept.
    fn recall(&self, part: &str) -> Option<Vec<u8>>;

    /// Keeps the bytes of a part. Where that is not possible, it is made again the next time.
    fn keep(&self, part: &str, bytes: &[u8]);
}

impl dyn KeepParts + '_ {
    /// A part that was kept; else it is made, and kept if it is whole.
    ///
    /// # Errors
    /// It cannot be made.
    pub(crate) fn part<T: Kept, E>(
        &self,
        name: &str,
        make: impl FnOnce() -> Result<T, E>,
        is_whole: impl FnOnce() -> bool,
    ) -> Result<T, E> {
        if let Some(part) = self.recall(name).and_then(|bytes| from_bytes(&bytes)) {
            return Ok(part);
        }
        let part = make()?;
        if is_whole() {
            self.keep(name, &to_bytes(&part));
        }
        Ok(part)
    }
}

/// Keeps nothing.
pub(crate) struct NothingKept;

impl KeepParts for NothingKept {
    fn recall(&self, _: &str) -> Option<Vec<u8>> {
        None
    }

    fn keep(&self, _: &str, _: &[u8]) {}
}

/// Keeps parts in memory, and counts those that are recalled.
#[cfg(test)]
#[derive(Default)]
pub(crate) struct KeptInMemory {
    pub kept: RefCell<BTreeMap<String, Vec<u8>>>,
    pub recalled: RefCell<Vec<String>>,
}

#[cfg(test)]
impl KeepParts for KeptInMemory {
    fn recall(&self, part: &str) -> Option<Vec<u8>> {
        let kept = self.kept.borrow().get(part).cloned()?;
        self.recalled.borrow_mut().push(part.to_owned());
        Some(kept)
    }

    fn keep(&self, part: &str, bytes: &[u8]) {
        let bytes = bytes.to_vec();
        self.kept.borrow_mut().insert(part.to_owned(), bytes);
    }
}
