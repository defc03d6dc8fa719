//! Edits that were set aside: the entry in a list, and the content that is merged with a document.

use crate::document::{Document, Edit, Merged, graft, merge_newer};
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
    /// that the user edited replace those in the document. Of a frame that both changed the one
    /// with more edits stays, and it is named.
    pub fn merge_with(&self, document: &Document) -> Merged {
        match self.document() {
            Some((base, ours)) => merge_newer(base, &ours, document),
            None => graft(&self.edits, document),
        }
    }

    /// The document to which the edits lead; none if the base is unknown.
    pub fn result(&self) -> Option<Document> {
        self.document().map(|(_, ours)| ours)
    }

    /// The base, and the document to which the edits lead. From the first edit that does not apply
    /// on, their frames alone are taken, as where the base is unknown.
    fn document(&self) -> Option<(&Document, Document)> {
        let base = self.base.as_ref()?;
        let mut ours = base.clone();
        for (index, edit) in self.edits.iter().enumerate() {
            if let Err(misfit) = edit.clone().apply(&mut ours) {
                log::warn!("{}: {misfit}", edit.name);
                // Both states of a frame are of the same person, so that neither is a conflict.
                ours = graft(&self.edits[index..], &ours).document;
                break;
            }
        }
        Some((base, ours))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::testing::{document, names_and_comments};

    /// The edit that gives the last frame of a document a comment.
    fn comment_on_last(before: &Document, comment: &str) -> Edit {
        let mut after = before.clone();
        let last = after.frames.len() - 1;
        after.frames[last].comment = Some(comment.to_owned());
        Edit::between(before, &after, "Comment")
    }

    #[test]
    fn frames_of_edits_behind_one_that_does_not_apply_are_not_lost() {
        let base = document(&["a", "b"]);
        let edits = OrphanEdits {
            base: Some(base.clone()),
            edits: vec![
                comment_on_last(&document(&["a"]), " one"),
                comment_on_last(&document(&["a", "b", "unknown"]), " two"),
                comment_on_last(&base, " three"),
            ],
        };
        let wanted = ["a one", "b three", "unknown two"];
        assert_eq!(names_and_comments(&edits.result().unwrap()), wanted);
        let merged = edits.merge_with(&base);
        assert_eq!(names_and_comments(&merged.document), wanted);
        assert_eq!(merged.conflicts, [""; 0]);
    }
}
