//! Reports the progress of a long step and decides whether it continues.

use super::mailbox::TrainerMailbox;
use crate::app::{TrainerActivity, TrainerStatus};
use std::ops::ControlFlow;
use std::sync::{Mutex, PoisonError};
use touchline_calibration::proposals::{TrainingFrames, TrainingSet};
use touchline_documents::document::Document;

/// Reports the progress of a step and ends it when its result is no longer needed.
pub(super) struct Watch<'a> {
    mailbox: &'a TrainerMailbox,
    status: TrainerStatus,
    until: StopCondition,
    /// The edition of the document that was checked last; a mutex because the step's threads share
    /// it.
    looked_at: Mutex<u64>,
}

/// What ends a step, besides a pause and closing.
pub(super) enum StopCondition {
    /// Nothing else.
    Done,
    /// A sample of this training set was changed or withdrawn. Added ones do not end the step.
    Unlearnt(TrainingSet),
    /// The training set differs from this one in any way.
    Changed(TrainingSet),
}

impl<'a> Watch<'a> {
    pub(super) fn new(
        mailbox: &'a TrainerMailbox,
        status: &TrainerStatus,
        edition: u64,
        until: StopCondition,
    ) -> Self {
        Self {
            mailbox,
            status: status.clone(),
            until,
            looked_at: Mutex::new(edition),
        }
    }

    /// Reports what is being done; answers `Break` if the step is to end.
    pub(super) fn notify(&self, doing: TrainerActivity) -> ControlFlow<()> {
        self.mailbox.report(&TrainerStatus {
            doing,
            ..self.status.clone()
        });
        if self.is_wanted() {
            ControlFlow::Continue(())
        } else {
            ControlFlow::Break(())
        }
    }

    /// Whether the step is to continue. Looks at a new document only once.
    pub(super) fn is_wanted(&self) -> bool {
        let mut looked_at = self
            .looked_at
            .lock()
            .unwrap_or_else(PoisonError::into_inner);
        let news = self.mailbox.peek(|orders| {
            let document = (orders.edition != *looked_at)
                .then(|| orders.document.clone())
                .flatten();
            (!orders.paused).then_some((orders.edition, document))
        });
        let Some(Some((edition, document))) = news else {
            return false;
        };
        *looked_at = edition;
        let Some(document) = document else {
            return true;
        };
        let wanted = match &self.until {
            StopCondition::Done => true,
            StopCondition::Unlearnt(learning) => current_training_set(&document).contains(learning),
            StopCondition::Changed(learning) => current_training_set(&document) == *learning,
        };
        if !wanted {
            // The answer is cached by edition: make the other threads of the step compare again,
            // and stop.
            *looked_at = u64::MAX;
        }
        wanted
    }
}

/// What a forest would be trained with now: the training samples of all solved frames.
fn current_training_set(document: &Document) -> TrainingSet {
    let training_frames = TrainingFrames::from_solved_frames(document);
    TrainingSet::from_frames(document, &training_frames.frames)
}
