//! Another program's version of the document, and edits of other versions: joined with what is open, or kept apart.

use super::App;
use crate::app::Command;
use crate::app::OutsideChoice;
use crate::app::effect::Effect;
use crate::app::session::{Dialog, Level, Mode};
use crate::document::{Frame, Merged, Step, merge};
use crate::store::{OrphanEdits, Outside};
use std::path::{Path, PathBuf};

/// Conflicts that are named; the rest is counted.
const NAMED: usize = 3;

impl App {
    /// Another program wrote the document. Asked once; the row at the top keeps saying it.
    pub(super) fn changed_outside(&mut self, path: PathBuf) {
        self.session.closing = false;
        if self.session.changed_outside.replace(path).is_none() {
            self.session.dialog = Some(Dialog::ChangedOutside);
        }
    }

    pub(super) fn resolve_outside(&mut self, choice: OutsideChoice) {
        self.session.dialog = None;
        let Some(open) = &self.open else { return };
        match choice {
            OutsideChoice::Merge => self.effects.push(Effect::ReadOutside),
            OutsideChoice::Replace => self.effects.push(Effect::SaveOver),
            OutsideChoice::TakeTheirs => {
                self.session.opening = Some("Opening the other version…".to_owned());
                self.effects.push(Effect::Reopen(open.file.clone()));
            }
        }
    }

    /// Joins another program's changes with those made here; its version is set aside all the same.
    pub(super) fn merge_outside(&mut self, outside: &Outside) {
        let Some(open) = &self.open else { return };
        let merged = merge(&outside.base, &open.document, &outside.theirs);
        if self.take_merged(merged, "Merge another program's changes") {
            self.effects.push(Effect::SaveOver);
        }
    }

    /// Says what was set aside beside the document.
    pub(super) fn tell_orphans(&mut self) {
        let count: usize = self.session.orphans.iter().map(|orphan| orphan.edits.len()).sum();
        if count > 0 {
            let edits = if count == 1 { "1 edit".to_owned() } else { format!("{count} edits") };
            let text = format!("{edits} of another version of this document are set aside.");
            self.session.notify_with(Level::Warning, text, [("Look at them", Command::Orphans)]);
        }
    }

    /// Joins edits that were set aside with the document.
    pub(super) fn merge_orphan(&mut self, orphan: PathBuf, edits: &OrphanEdits) {
        let Some(open) = &self.open else { return };
        let merged = edits.merged_into(&open.document);
        if self.take_merged(merged, "Merge edits that were set aside") {
            self.effects.push(Effect::PutOrphanAway { orphan });
        }
    }

    pub(super) fn orphan_put_away(&mut self, orphan: &Path, renamed: &Path) {
        self.session.orphans.retain(|known| known.path != orphan);
        if self.session.orphans.is_empty() && self.session.dialog == Some(Dialog::Orphans) {
            self.session.dialog = None;
        }
        self.session.notify(Level::Info, format!("The edits are merged; their file is now {}.", renamed.display()));
    }

    /// Makes a joined document the open one, as one step of undo; the shown frame stays the same.
    fn take_merged(&mut self, merged: Merged, step: &str) -> bool {
        let shown = self.frame().map(Frame::name);
        if !self.begin_step(Step::on_document(step)) {
            return false;
        }
        let Some(open) = &mut self.open else { return false };
        *open.document = merged.document;
        let place = open.document.frames.iter().position(|frame| Some(frame.name()) == shown);
        let last = open.document.frames.len().saturating_sub(1);
        self.session.frame = place.unwrap_or(self.session.frame.min(last));
        self.session.mode = Mode::Idle;
        self.session.selected = None;
        self.session.frames_selected.clear();
        self.commit();
        if !merged.conflicts.is_empty() {
            let named: Vec<_> = merged.conflicts.iter().take(NAMED).map(String::as_str).collect();
            let more = merged.conflicts.len() - named.len();
            let more = if more > 0 { format!(" and {more} more") } else { String::new() };
            let text = format!("Changed on both sides, your version is kept: {}{more}.", named.join(", "));
            self.session.notify(Level::Warning, text);
        }
        true
    }
}
