//! Keeps the background trainer up to date with the document and the settings.

use super::App;
use crate::app::effect::Effect;
use crate::app::trainer::{AnswerKey, TrainerOrder, TrainerState, TrainerStatus, TrainerWishes};
use touchline_documents::document::{Change, Edit};

impl App {
    /// Why there is no trainer for the open document. None if there is one.
    pub fn no_trainer(&self) -> Option<&'static str> {
        let Some(open) = &self.open else {
            return Some("No document is open.");
        };
        if cfg!(not(feature = "opencv")) {
            return Some("This program was built without OpenCV and cannot find features.");
        }
        open.read_only
            .is_some()
            .then_some("The document is read-only.")
    }

    /// Sends the trainer what has changed since the last orders: the settings, the shown frame, and
    /// the document. Nothing is sent during an open step.
    pub(super) fn notify_trainer(&mut self) {
        if self.no_trainer().is_some() {
            return;
        }
        let Some(open) = self.open.as_ref().filter(|open| !open.history.is_open()) else {
            return;
        };
        let trainer = &mut self.session.trainer;
        let version = Some(open.document.version());
        // Each order is sent only if it tells the trainer something new. A new trainer starts
        // unpaused.
        let wishes = TrainerWishes {
            frame: open.frame(self.session.frame).map(|frame| frame.id.clone()),
            features: trainer.show_features,
            paused: trainer.paused,
            snapping: self.settings.snap_suggestions,
        };
        if trainer.sent != wishes {
            trainer.sent = wishes.clone();
            self.effects
                .push(Effect::Trainer(TrainerOrder::Wishes(wishes)));
        }
        if trainer.sent_version != version {
            trainer.sent_version = version;
            self.effects
                .push(Effect::Trainer(TrainerOrder::Document(Box::new(
                    (*open.document).clone(),
                ))));
        }
    }

    /// Whether the trainer has the present document.
    pub(super) fn trainer_knows_document(&self) -> bool {
        let version = self.open.as_ref().map(|open| open.document.version());
        version.is_some() && self.session.trainer.sent_version == version
    }

    /// Informs the trainer that the document now shows some of its answers. The trainer must have
    /// had the document before; since nothing else changed, the document itself need not be sent.
    pub(super) fn notify_shown_answers(&mut self, edit: &Edit, generation: u64, is_tracked: bool) {
        let keys = edit.changes.iter().filter_map(|change| match change {
            Change::Frame { id, revision, .. } => Some(AnswerKey {
                frame: id.clone(),
                revision: *revision,
                generation,
                is_tracked,
            }),
            _ => None,
        });
        let shown = keys.collect();
        self.session.trainer.sent_version = self.open.as_ref().map(|open| open.document.version());
        self.effects
            .push(Effect::Trainer(TrainerOrder::Shown(shown)));
    }

    /// Stores the trainer's status.
    pub(super) fn trainer_reported(&mut self, status: TrainerStatus) {
        self.session.trainer.status = status;
    }

    /// Pauses or resumes the trainer.
    pub(super) const fn pause_trainer(&mut self) {
        let trainer = &mut self.session.trainer;
        trainer.paused = !trainer.paused;
    }

    /// Shows or hides the features of the shown frame.
    pub(super) fn show_features(&mut self) {
        let trainer = &mut self.session.trainer;
        trainer.show_features = !trainer.show_features;
        trainer.features = None;
    }

    /// The part of the trainer's state that survives when another document is opened.
    pub(super) fn trainer_for_another(&self) -> TrainerState {
        TrainerState {
            paused: self.session.trainer.paused,
            ..TrainerState::default()
        }
    }
}
