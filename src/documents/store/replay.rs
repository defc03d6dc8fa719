//! Applies the journal's edits to the document of the file, and restores the steps of earlier
//! sessions.

use super::history_file::{HistoryFile, HistoryLeftOut};
use super::journal::{DocumentHash, PendingEdits};
use crate::document::{Document, Edit, EditMismatch, History};

/// A document while the journal's edits are applied to it.
pub(super) struct Replay {
    pub document: Document,
    /// The document without suggestions, on which undo and redo work.
    edited: Document,
    pub history: History<Document>,
    /// The names of the applied edits.
    pub edits: Vec<String>,
    /// Why the steps of earlier sessions are left out, if they are.
    pub left_out: Option<HistoryLeftOut>,
}

impl Replay {
    /// Starts from the document as it is in its file.
    pub fn new(document: Document) -> Self {
        let edited = document.without_suggestions();
        Self {
            document,
            edited,
            history: History::default(),
            edits: Vec::new(),
            left_out: None,
        }
    }

    /// Applies the edits that the document with this hash lacks. The steps of `file` are restored
    /// at the state from which they start: the file's document, or one that the journal announced.
    /// Stops at an edit that does not apply, with its name and the mismatch.
    pub fn through(
        &mut self,
        pending: PendingEdits,
        hash: &DocumentHash,
        file: Option<&HistoryFile>,
    ) -> Result<(), (String, EditMismatch)> {
        let PendingEdits { edits, announced } = pending;
        // The number of edits after which the document is the one that the steps start from. The
        // latest announcement wins: the history was written just after it.
        let steps_at = file.and_then(|file| {
            let announced = announced
                .iter()
                .rev()
                .find(|(_, to_come)| file.starts_from(to_come));
            announced
                .map(|(edits, _)| *edits)
                .or_else(|| file.starts_from(hash).then_some(0))
        });
        if file.is_some() && steps_at.is_none() {
            self.left_out = Some(HistoryLeftOut::OtherDocument);
        }
        // The steps, if they start from the document after `made` edits.
        let steps = |made: usize| file.filter(|_| steps_at == Some(made));
        let count = edits.len();
        for (made, edit) in edits.into_iter().enumerate() {
            self.take_steps(steps(made));
            let name = edit.name.clone();
            self.make(edit).map_err(|misfit| (name.clone(), misfit))?;
            self.edits.push(name);
        }
        self.take_steps(steps(count));
        Ok(())
    }

    /// Applies an edit, as a new step of the history. Nothing changes if it does not apply.
    fn make(&mut self, edit: Edit) -> Result<(), EditMismatch> {
        // Undo works on the document without suggestions, while edits are made on the one of the
        // file. Both are brought forward; the state before shows which frames the edit changed.
        let (before, name, kind) = (self.document.clone(), edit.name.clone(), edit.kind.clone());
        edit.apply(&mut self.document)?;
        let edited = self
            .document
            .without_suggestions_since(&before, &self.edited);
        let suggestions = self.document.suggestion_changes_since(&before);
        self.history
            .follow([&self.edited, &edited], suggestions, name, kind);
        self.edited = edited;
        Ok(())
    }

    /// Replaces the history by the steps of earlier sessions, if there is a file with them.
    fn take_steps(&mut self, file: Option<&HistoryFile>) {
        if let Some(file) = file {
            (self.history, self.left_out) = file.history(&self.edited);
        }
    }
}
