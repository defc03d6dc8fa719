//! From a document as its file has it to what its journal and the steps of earlier sessions make of
//! it.

use super::history_file::{HistoryFile, HistoryLeftOut};
use super::journal::{DocumentHash, PendingEdits};
use crate::document::{Document, Edit, EditMismatch, History};

/// A document on its way through its journal.
pub(super) struct Replay {
    pub document: Document,
    /// The same without suggestions: undo goes back and forth in it.
    edited: Document,
    pub history: History<Document>,
    /// The names of the edits that were made.
    pub edits: Vec<String>,
    /// Why steps of earlier sessions are left out.
    pub left_out: Option<HistoryLeftOut>,
}

impl Replay {
    /// A document as its file has it.
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

    /// Makes the edits that a document of this hash lacks, with the steps of earlier sessions where
    /// the document is reached that they start from. An edit that does not fit ends it.
    pub fn through(
        &mut self,
        pending: PendingEdits,
        hash: &DocumentHash,
        file: Option<&HistoryFile>,
    ) -> Result<(), (String, EditMismatch)> {
        let PendingEdits { edits, announced } = pending;
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

    /// Makes an edit in the document, and takes it for what it is to undo and redo. Nothing changes
    /// if it does not fit.
    fn make(&mut self, edit: Edit) -> Result<(), EditMismatch> {
        let (before, name, kind) = (self.document.clone(), edit.name.clone(), edit.kind.clone());
        edit.apply(&mut self.document)?;
        let edited = self
            .document
            .without_suggestions_since(&before, &self.edited);
        self.history.follow(&self.edited, &edited, name, kind);
        self.edited = edited;
        Ok(())
    }

    fn take_steps(&mut self, file: Option<&HistoryFile>) {
        if let Some(file) = file {
            (self.history, self.left_out) = file.history(&self.edited);
        }
    }
}
