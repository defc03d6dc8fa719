//! Closing the window or opening something else while edits are only in memory: nothing goes unasked.

use super::App;
use crate::app::effect::Effect;
use crate::app::session::{Dialog, Leaving, Mode, Saving};

impl App {
    /// Writes everything, then closes; at once if there is nothing to write. Where it cannot be written, or takes its time
    /// when asked again, a dialog says what would be lost.
    pub(super) fn close_requested(&mut self) {
        if let Mode::Dragging { .. } | Mode::Editing = self.session.mode {
            self.abort();
        }
        let read_only = self.open.as_ref().is_none_or(|open| open.read_only.is_some());
        if read_only || self.session.saving == Saving::Untouched || self.is_copied() {
            self.effects.push(Effect::Close);
            return;
        }
        if self.session.closing || self.is_unsaved() || self.session.changed_outside.is_some() {
            self.session.closing = false;
            self.session.dialog = Some(Dialog::NotSaved(Leaving::Close));
        } else {
            self.session.closing = true;
        }
        // The disk may have room again.
        self.save();
    }

    /// Asks before edits are lost to what is about to happen; false where none would be.
    pub(super) fn asks_before(&mut self, leaving: Leaving) -> bool {
        let asks = self.is_unsaved();
        if asks {
            self.session.dialog = Some(Dialog::NotSaved(leaving));
        }
        asks
    }

    /// Every edit is on disk, in the document or in the journal: goes on with what waited for that. A window that closes
    /// waits for the document itself.
    pub(super) fn go_on_leaving(&mut self, whole: bool) {
        if !self.session.closing {
            self.leave_unsaved();
        } else if whole {
            self.leave(Leaving::Close);
        }
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
        matches!(self.session.saving, Saving::Failed { .. }) && !self.is_copied()
    }

    /// Whether a copy elsewhere holds every edit.
    fn is_copied(&self) -> bool {
        self.open.as_ref().is_some_and(|open| self.session.copies.written == Some(open.revision))
    }
}
