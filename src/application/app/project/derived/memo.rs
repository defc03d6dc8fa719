//! A value derived from the document on request, and again only after the document has changed.

use crate::app::Versioned;
use touchline_documents::document::Document;

/// A value that can be computed from a document.
pub(super) trait Follows: Default {
    /// Updates the value for `document`. The value starts as the default; later it is the value for
    /// the document of the previous update, so that only the differences need work.
    fn update(&mut self, document: &Document);
}

/// A value and the version of the document for which it was computed.
#[derive(Clone, Debug, Default)]
pub(super) struct Memo<T> {
    value: T,
    version: Option<u64>,
}

impl<T: Follows> Memo<T> {
    /// The value for the present document.
    pub(super) fn at(&mut self, document: &Versioned<Document>) -> &T {
        self.at_mut(document)
    }

    /// The same with write access, for a value that extends itself on request.
    pub(super) fn at_mut(&mut self, document: &Versioned<Document>) -> &mut T {
        let version = Some(document.version());
        if self.version != version {
            self.value.update(document);
            self.version = version;
        }
        &mut self.value
    }

    /// The value at the last request.
    pub(super) const fn last(&self) -> &T {
        &self.value
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use touchline_documents::testing::soccer_document;

    /// Counts its updates.
    #[derive(Default)]
    struct Counted(usize);

    impl Follows for Counted {
        fn update(&mut self, _: &Document) {
            self.0 += 1;
        }
    }

    #[test]
    fn a_value_is_derived_once_for_each_version_and_not_before_it_is_requested() {
        let mut document = Versioned::new(soccer_document());
        let mut memo = Memo::<Counted>::default();
        assert_eq!(memo.last().0, 0);
        assert_eq!((memo.at(&document).0, memo.at(&document).0), (1, 1));
        document.generator = "another".to_owned();
        document.generator = "a third".to_owned();
        assert_eq!(memo.last().0, 1, "not requested yet");
        assert_eq!((memo.at(&document).0, memo.at(&document).0), (2, 2));
        document.keeping_version().generator = "a fourth".to_owned();
        assert_eq!(memo.at(&document).0, 2);
    }
}
