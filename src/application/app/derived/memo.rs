//! A value that is derived from the document when it is asked for, and not again before the
//! document changes.

use crate::app::Versioned;
use touchline_documents::document::Document;

/// A value that follows from a document.
pub(super) trait Follows: Default {
    /// Makes it what follows from `document`. It starts as the default; later it knows the document
    /// that it was updated with last.
    fn update(&mut self, document: &Document);
}

/// A value and the version of the document that it follows from.
#[derive(Clone, Debug, Default)]
pub(super) struct Memo<T> {
    value: T,
    version: Option<u64>,
}

impl<T: Follows> Memo<T> {
    /// The value for a document as it is now.
    pub(super) fn at(&mut self, document: &Versioned<Document>) -> &T {
        self.at_mut(document)
    }

    /// The same, for a value that keeps what it is asked for.
    pub(super) fn at_mut(&mut self, document: &Versioned<Document>) -> &mut T {
        let version = Some(document.version());
        if self.version != version {
            self.value.update(document);
            self.version = version;
        }
        &mut self.value
    }

    /// The value as it was asked for last.
    pub(super) const fn last(&self) -> &T {
        &self.value
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use touchline_documents::document::FieldSpec;

    /// Counts its updates.
    #[derive(Default)]
    struct Counted(usize);

    impl Follows for Counted {
        fn update(&mut self, _: &Document) {
            self.0 += 1;
        }
    }

    #[test]
    fn a_value_is_derived_once_for_each_version_and_not_before_it_is_asked_for() {
        let mut document = Versioned::new(Document::new(FieldSpec::new("soccer")));
        let mut memo = Memo::<Counted>::default();
        assert_eq!(memo.last().0, 0);
        assert_eq!((memo.at(&document).0, memo.at(&document).0), (1, 1));
        document.generator = "another".to_owned();
        document.generator = "a third".to_owned();
        assert_eq!(memo.last().0, 1, "nobody has asked");
        assert_eq!((memo.at(&document).0, memo.at(&document).0), (2, 2));
        document.keeping_version().generator = "a fourth".to_owned();
        assert_eq!(memo.at(&document).0, 2);
    }
}
