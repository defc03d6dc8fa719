//! The history of a document as edits: replays the edits of a journal, and converts the history for
//! storage beside a saved document.

use super::edit::apply_all;
use crate::document::{
    Change, Document, Edit, EditKind, EditMismatch, History, Step, SuggestionChange, Undoable as _,
};
use serde::{Deserialize, Serialize};
use thiserror::Error;

/// A step, and the changes from one side of it to the other.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct StepEdit {
    /// The step of the user.
    pub step: Step,
    /// The changes, in the order in which they are applied.
    pub changes: Vec<Change>,
}

/// A step that does not fit the document to which the steps between lead.
#[derive(Clone, Debug, PartialEq, Eq, Error)]
#[error("“{name}” does not fit: {source}")]
pub struct StepMisfit {
    /// The step's name.
    pub name: String,
    /// Why it does not fit.
    pub source: EditMismatch,
}

impl StepEdit {
    fn between(from: &Document, to: &Document, step: &Step) -> Self {
        Self {
            step: step.clone(),
            changes: Edit::between(from, to, "").changes,
        }
    }
}

impl History<Document> {
    /// Updates the history for an edit from `before` to `after` (both without suggestions), as the
    /// history did in which the edit was made; `suggestions` is what it did to these. An edit that
    /// is not a step, or does not fit its step, clears the history if it changed the user's work,
    /// because nothing before it can be undone.
    pub fn follow(
        &mut self,
        [before, after]: [&Document; 2],
        suggestions: Vec<SuggestionChange>,
        name: String,
        kind: EditKind,
    ) {
        // Undo and redo are done on a copy of the state before, and must lead to the state after.
        // If they do not, the steps of this history are not those of the edit, and none of them can
        // be trusted.
        let mut state = before.clone();
        let is_followed = match kind {
            EditKind::NoStep => before.is_same_state(after),
            EditKind::Step { frame } => {
                let step = Step {
                    frame,
                    ..Step::on_document(name)
                };
                self.begin(before, step);
                self.commit_with(after, suggestions);
                true
            }
            EditKind::Continued => {
                // `commit` comes in any case: it closes the step that was resumed, and does nothing
                // if none was.
                let last = self.next_undo().cloned();
                let resumed = last.is_some_and(|step| self.resume(before, &step));
                self.commit_with(after, suggestions);
                resumed
            }
            EditKind::Undone => self.undo(&mut state).is_some() && state.is_same_state(after),
            EditKind::Redone => self.redo(&mut state).is_some() && state.is_same_state(after),
        };
        if !is_followed {
            self.clear();
        }
    }

    /// The undo steps of `document`, the current one, as edits: the last step first, each from the
    /// document after it to that before it.
    pub fn undo_edits<'a>(&'a self, document: &'a Document) -> impl Iterator<Item = StepEdit> + 'a {
        edits_along(document, self.done.iter().rev())
    }

    /// The redo steps of `document`, the current one, as edits: the next step first.
    pub fn redo_edits<'a>(&'a self, document: &'a Document) -> impl Iterator<Item = StepEdit> + 'a {
        edits_along(document, self.undone.iter().rev())
    }

    /// The history of `document` from the results of [`Self::undo_edits`] and [`Self::redo_edits`].
    /// If a step does not fit, the history ends before it, and the step is returned as well.
    pub fn from_edits(
        document: &Document,
        undo: Vec<StepEdit>,
        redo: Vec<StepEdit>,
    ) -> (Self, Option<StepMisfit>) {
        let mut history = Self::default();
        let mut misfit = None;
        // Steps to undo are walked from the document back: those beyond the limit are the oldest.
        let mut done = walk(document, undo, &mut misfit);
        done.truncate(Self::DEFAULT_LIMIT);
        history.done = done.into_iter().rev().collect();
        history.undone = walk(document, redo, &mut misfit)
            .into_iter()
            .rev()
            .collect();
        (history, misfit)
    }
}

/// The edits from a document along a sequence of states.
fn edits_along<'a>(
    document: &'a Document,
    states: impl Iterator<Item = &'a (Step, Document)> + 'a,
) -> impl Iterator<Item = StepEdit> + 'a {
    states.scan(document, |from, (step, to)| {
        let edit = StepEdit::between(from, to, step);
        *from = to;
        Some(edit)
    })
}

/// The states after each step in turn, up to the first one that does not fit.
fn walk(
    document: &Document,
    edits: Vec<StepEdit>,
    misfit: &mut Option<StepMisfit>,
) -> Vec<(Step, Document)> {
    let mut document = document.clone();
    let mut states = Vec::with_capacity(edits.len());
    for StepEdit { step, changes } in edits {
        if let Err(source) = apply_all(changes, &mut document) {
            misfit.get_or_insert(StepMisfit {
                name: step.name,
                source,
            });
            break;
        }
        states.push((step, document.clone()));
    }
    states
}
