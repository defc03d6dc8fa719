//! Closes the window or opens another document without losing edits: the program waits for pending
//! writes, and asks the user if edits exist only in memory or another program has changed the
//! document.

use crate::app::App;
use crate::app::effect::Effect;
use crate::app::window_state::session::{Dialog, Leaving, Mode, Saving};

impl App {
    /// Handles the user's wish to close the window: aborts a drag or an edit of numbers, and closes
    /// the window as soon as everything is written.
    pub(in crate::app::update) fn close_requested(&mut self) {
        if let Mode::Dragging { .. } | Mode::Editing = self.session.mode {
            self.abort();
        }
        self.leave_document(Leaving::Close);
    }

    /// Leaves the document for something else, as soon as everything is written.
    ///
    /// * Nothing to write (read-only, no edits, or a copy has all edits): leaves at once.
    /// * Writing failed, the document was changed by another program, or the user repeats the wish
    ///   while writing takes its time: asks what to do with the edits.
    /// * Otherwise waits for the write.
    pub(super) fn leave_document(&mut self, leaving: Leaving) {
        self.forget_match_to_open();
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
        let is_repeated = self.session.disk.leaving.as_ref() == Some(&leaving);
        if is_repeated || self.is_unsaved() || is_changed_outside {
            self.stay();
            self.session.dialog = Some(Dialog::NotSaved(leaving));
        } else {
            if leaving != Leaving::Close {
                self.session.disk.opening = Some("Saving before opening…".to_owned());
            }
            self.session.disk.leaving = Some(leaving);
        }
        // Tries again to write; the reason of a failure may have gone, such as a full disk.
        self.save();
    }

    /// Handles the end of a write: every edit is on disk, in the document or the journal. Continues
    /// with what waited for that.
    ///
    /// Leaving waits for the answer to the last request to write the document itself, whose number
    /// is `document`, because another program may have replaced an earlier version.
    pub(super) fn go_on_leaving(&mut self, document: Option<u64>) {
        // If no wish to leave waits, the dialog may be open: its question was about edits that
        // could not be written before this write.
        let is_answered = document == Some(self.session.disk.save_requests);
        if self.session.disk.leaving.is_none() {
            self.leave_unsaved();
        } else if is_answered && let Some(leaving) = self.session.disk.leaving.take() {
            self.leave(leaving);
        }
    }

    /// Gives up leaving, and returns what the user wanted.
    pub(in crate::app::update) fn stay(&mut self) -> Option<Leaving> {
        let leaving = self.session.disk.leaving.take()?;
        if leaving != Leaving::Close {
            self.session.disk.opening = None;
        }
        Some(leaving)
    }

    /// If the dialog about unsaved edits is open: closes it and leaves, because the user accepts
    /// the loss or everything has been written meanwhile.
    pub(in crate::app::update) fn leave_unsaved(&mut self) {
        if let Some(Dialog::NotSaved(leaving)) = &self.session.dialog {
            let leaving = leaving.clone();
            self.session.dialog = None;
            self.leave(leaving);
        }
    }

    /// Starts what the user wanted.
    fn leave(&mut self, leaving: Leaving) {
        match leaving {
            Leaving::Close => self.effects.push(Effect::Close),
            Leaving::Open(opening) => self.begin_opening(opening),
        }
    }

    /// Whether edits exist only in memory, and not in a copy either.
    pub(super) fn is_unsaved(&self) -> bool {
        matches!(self.session.disk.saving, Saving::Failed { .. }) && !self.is_copied()
    }

    /// Whether a copy of the document contains every edit.
    fn is_copied(&self) -> bool {
        self.open
            .as_ref()
            .is_some_and(|open| self.session.disk.copied == Some(open.revision))
    }
}
