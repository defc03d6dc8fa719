//! Closing the window or opening something else while edits are only in memory, or while another
//! program has changed the document: nothing goes unasked.

use super::App;
use crate::app::effect::Effect;
use crate::app::session::{Dialog, Leaving, Mode, Saving};

impl App {
    /// Closes the window once everything is written.
    pub(super) fn close_requested(&mut self) {
        if let Mode::Dragging { .. } | Mode::Editing = self.session.mode {
            self.abort();
        }
        self.leave_document(Leaving::Close);
    }

    /// Writes everything, then closes or opens something else; at once if there is nothing to
    /// write. Where it cannot be written, takes its time when asked again, or another program has
    /// changed the document, a dialog says what becomes of the edits.
    pub(super) fn leave_document(&mut self, leaving: Leaving) {
        let read_only = self
            .open
            .as_ref()
            .is_none_or(|open| open.read_only.is_some());
        let is_changed_outside = self.session.disk.changed_outside.is_some();
        if read_only
            || (self.session.disk.saving == Saving::Untouched && !is_changed_outside)
            || self.is_copied()
        {
            self.leave(leaving);
            return;
        }
        let is_asked_again = self.session.disk.leaving.as_ref() == Some(&leaving);
        if is_asked_again || self.is_unsaved() || is_changed_outside {
            self.stay();
            self.session.dialog = Some(Dialog::NotSaved(leaving));
        } else {
            if leaving != Leaving::Close {
                self.session.disk.opening = Some("Saving before opening…".to_owned());
            }
            self.session.disk.leaving = Some(leaving);
        }
        // The disk may have room again.
        self.save();
    }

    /// Every edit is on disk, in the document or in the journal: goes on with what waited for that.
    /// What waits for the document itself goes on when the last request to write it is answered:
    /// another program may have replaced what was written before.
    pub(super) fn go_on_leaving(&mut self, document: Option<u64>) {
        let is_answered = document == Some(self.session.disk.save_requests);
        if self.session.disk.leaving.is_none() {
            self.leave_unsaved();
        } else if is_answered && let Some(leaving) = self.session.disk.leaving.take() {
            self.leave(leaving);
        }
    }

    /// What was to be done next is not done, and returned.
    pub(super) fn stay(&mut self) -> Option<Leaving> {
        let leaving = self.session.disk.leaving.take()?;
        if leaving != Leaving::Close {
            self.session.disk.opening = None;
        }
        Some(leaving)
    }

    /// Does what the open dialog warns of, if it is that one.
    pub(super) fn leave_unsaved(&mut self) {
        if let Some(Dialog::NotSaved(leaving)) = &self.session.dialog {
            let leaving = leaving.clone();
            self.session.dialog = None;
            self.leave(leaving);
        }
    }

    fn leave(&mut self, leaving: Leaving) {
        match leaving {
            Leaving::Close => self.effects.push(Effect::Close),
            Leaving::Open(path) => self.begin_opening(path),
            Leaving::OpenDemo => self.begin_opening_demo(),
        }
    }

    /// Whether edits are only in memory, and in no copy either.
    pub(super) fn is_unsaved(&self) -> bool {
        matches!(self.session.disk.saving, Saving::Failed { .. }) && !self.is_copied()
    }

    /// Whether a copy elsewhere holds every edit.
    fn is_copied(&self) -> bool {
        self.open
            .as_ref()
            .is_some_and(|open| self.session.disk.copies.written == Some(open.revision))
    }
}
