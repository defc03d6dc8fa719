//! Who hears how far a long piece of work has come, and decides whether it goes on.

use super::mailbox::TrainerMailbox;
use crate::app::{Doing, TrainerStatus};
use std::ops::ControlFlow;
use std::sync::{Mutex, PoisonError};
use touchline_calibration::proposals::{TrainingFrames, TrainingSet};

/// Reports the progress of a piece of work, and ends it when it is no longer wanted.
pub(super) struct Watch<'a> {
    mailbox: &'a TrainerMailbox,
    status: TrainerStatus,
    until: Until,
    /// The edition of the document that was looked at last.
    looked_at: Mutex<u64>,
}

/// What ends a piece of work, besides a pause.
pub(super) enum Until {
    /// Nothing.
    Done,
    /// Part of this training set was withdrawn; added references may wait.
    Unlearnt(TrainingSet),
    /// The training set changed.
    Changed(TrainingSet),
}

impl<'a> Watch<'a> {
    pub(super) fn new(
        mailbox: &'a TrainerMailbox,
        status: &TrainerStatus,
        edition: u64,
        until: Until,
    ) -> Self {
        Self {
            mailbox,
            status: status.clone(),
            until,
            looked_at: Mutex::new(edition),
        }
    }

    /// Reports what is being done; a break if it is to end.
    pub(super) fn tell(&self, doing: Doing) -> ControlFlow<()> {
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

    /// Whether the work is to go on.
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
        let taught = || TrainingSet::of(&document, &TrainingFrames::of_solved(&document).frames);
        let wanted = match &self.until {
            Until::Done => true,
            Until::Unlearnt(learning) => taught().contains(learning),
            Until::Changed(learning) => taught() == *learning,
        };
        if !wanted {
            // Every other thread that asks must stop, too.
            *looked_at = u64::MAX;
        }
        wanted
    }
}
