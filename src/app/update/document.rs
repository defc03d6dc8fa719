//! Opening, saving and closing.

use super::App;
use super::Current;
use crate::app::OpenProject;
use crate::app::action::{Effect, Opened};
use crate::app::session::{Level, Mode, Question, Saving, Session};
use std::path::PathBuf;

impl App {
    pub(super) fn open_path(&mut self, path: PathBuf) {
        self.session.opening = Some(format!("Opening {}…", path.display()));
        self.effects.push(Effect::Open(path));
    }

    pub(super) fn opened(&mut self, opened: Opened) {
        self.effects.push(Effect::CancelEstimate);
        let panel = self.session.panel;
        let trainer = self.trainer_for_another();
        self.session = Session::default();
        self.session.trainer = trainer;
        self.session.panel = panel;
        for (level, text) in &opened.notices {
            self.session.notify(*level, text.clone());
        }
        if let Some(reason) = &opened.read_only {
            self.session.notify(Level::Warning, format!("Opened to look at only: {reason}"));
        }
        self.settings.remember(&opened.file);
        self.effects.push(Effect::SaveSettings);
        let Opened { document, folder, file, read_only, .. } = opened;
        let open = OpenProject::new(document, file, folder, read_only);
        // Go on where work is left.
        let first = open.document.frames.iter().position(|frame| crate::app::session::needs_me(frame));
        self.session.frame = first.unwrap_or(0);
        self.open = Some(open);
        self.current = Current::default();
        self.review = super::Review::default();
        self.quality = super::Quality::default();
        self.watched = None;
        self.gold_from = None;
    }

    pub(super) fn save(&mut self) {
        if self.open.as_ref().is_some_and(|open| open.history.is_open()) {
            self.commit();
        }
        let Some(open) = &self.open else { return };
        if open.read_only.is_none() {
            self.effects.push(Effect::Save);
        }
    }

    /// Takes the path that was asked for.
    pub(super) fn answer(&mut self, question: Question, path: PathBuf) {
        self.session.dialog = None;
        match (question, &self.open) {
            (Question::Project | Question::Folder | Question::Video, _) => self.open_path(path),
            (Question::CopyTo, Some(open)) => {
                self.effects.push(Effect::SaveCopy {
                    document: open.document.clone(),
                    from: open.folder.clone(),
                    folder: path,
                });
            }
            (Question::ExportTo, Some(open)) => {
                self.effects.push(Effect::Export {
                    document: open.document.to_dataset(),
                    from: open.folder.clone(),
                    file: path,
                });
            }
            (Question::CompareWith, Some(_)) => self.compare(path),
            (Question::CameraFrom, Some(_)) => self.effects.push(Effect::LoadCamera(path)),
            (_, None) => {}
        }
    }

    pub(super) fn saved(&mut self, revision: u64, at: String, whole: bool) {
        let newest = self.open.as_ref().map_or(0, |open| open.revision);
        if revision >= newest {
            self.session.saving = Saving::Saved { at };
            if self.session.closing && whole {
                self.effects.push(Effect::Close);
            }
        }
    }

    pub(super) fn save_failed(&mut self, message: String) {
        let since = match std::mem::take(&mut self.session.saving) {
            Saving::Saved { at } => Some(at),
            Saving::Failed { since, .. } => since,
            Saving::Untouched | Saving::Pending => None,
        };
        self.session.closing = false;
        self.session.saving = Saving::Failed { message, since };
    }

    /// Writes everything, then closes; at once if there is nothing to write.
    pub(super) fn close_requested(&mut self) {
        if let Mode::Dragging { .. } | Mode::Editing = self.session.mode {
            self.abort();
        }
        let nothing_to_write =
            self.session.saving == Saving::Untouched || self.open.as_ref().is_none_or(|open| open.read_only.is_some());
        if nothing_to_write {
            self.effects.push(Effect::Close);
            return;
        }
        if matches!(self.session.saving, Saving::Failed { .. }) && self.session.closing {
            // Asked twice although it was said that edits are only in memory.
            self.effects.push(Effect::Close);
            return;
        }
        self.session.closing = true;
        self.save();
    }
}
