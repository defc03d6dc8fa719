//! Edits that were set aside, as they are listed and as they are joined with a document.

use crate::document::{Document, Edit, Merged, graft, merge};
use std::path::PathBuf;

/// Edits that were set aside because they start from another document than the one beside them.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Orphan {
    /// Their journal, or what a window held.
    pub path: PathBuf,
    /// The names of its edits, oldest first.
    pub edits: Vec<String>,
}

/// The edits of an orphan, and the document they start from, where one of the versions beside the
/// document is it.
#[derive(Clone, Debug, PartialEq)]
pub struct OrphanEdits {
    /// The document that the edits start from.
    pub base: Option<Document>,
    /// The edits, oldest first.
    pub edits: Vec<Edit>,
}

impl OrphanEdits {
    /// Joins the edits with a document. Where it is not known what they start from, the frames that
    /// people edited take the place of those in the document.
    #[must_use]
    pub fn merged_into(&self, document: &Document) -> Merged {
        match self.document() {
            Some((base, ours)) => merge(base, &ours, document),
            None => graft(&self.edits, document),
        }
    }

    /// The document that the edits lead to; none where it is not known what they start from.
    pub fn result(&self) -> Option<Document> {
        self.document().map(|(_, ours)| ours)
    }

    /// The document that the edits start from, and the one they lead to as far as they fit.
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
