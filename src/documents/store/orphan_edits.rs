//! Edits that were set aside: the entry in a list, and the content that is merged with a document.

use crate::document::{Document, Edit, Merged, graft, merge};
use std::path::PathBuf;

/// Edits that were set aside because they start from a document other than the present one.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Orphan {
    /// Their file: a journal, or an own version.
    pub path: PathBuf,
    /// The names of the edits, oldest first.
    pub edits: Vec<String>,
}

/// The content of an orphan.
#[derive(Clone, Debug, PartialEq)]
pub struct OrphanEdits {
    /// The document from which the edits start; none if it is not among the versions beside the
    /// document.
    pub base: Option<Document>,
    /// The edits, oldest first.
    pub edits: Vec<Edit>,
}

impl OrphanEdits {
    /// Merges the edits with a document: a three-way merge if the base is known. Otherwise frames
    /// that the user edited replace those in the document.
    #[must_use]
    pub fn merge_with(&self, document: &Document) -> Merged {
        match self.document() {
            Some((base, ours)) => merge(base, &ours, document),
            None => graft(&self.edits, document),
        }
    }

    /// The document to which the edits lead; none if the base is unknown.
    pub fn result(&self) -> Option<Document> {
        self.document().map(|(_, ours)| ours)
    }

    /// The base, and the document to which the edits lead. Edits from the first that does not apply
    /// are left out.
    fn document(&self) -> Option<(&Document, Document)> {
        let base = self.base.as_ref()?;
        let mut ours = base.clone();
        for edit in &self.edits {
            if let Err(misfit) = edit.clone().apply(&mut ours) {
                log::warn!("{}: {misfit}", edit.name);
                break;
            }
        }
        Some((base, ours))
    }
}
