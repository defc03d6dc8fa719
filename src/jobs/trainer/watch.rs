//! What a long piece of work asks now and then: whether to go on.

use super::desk::Desk;
use crate::app::{Doing, TrainerStatus};
use crate::proposals::{TrainingFrames, TrainingSet};
use std::ops::ControlFlow;
use std::sync::{Mutex, PoisonError};

/// Tells how far a piece of work has come, and ends it when it is not wanted any more.
pub(super) struct Watch<'a> {
    desk: &'a Desk,
    status: TrainerStatus,
    until: Until,
    /// The edition of the document that was looked at last.
    looked_at: Mutex<u64>,
}

/// What ends a piece of work, besides a pause.
pub(super) enum Until {
    /// Nothing.
    Done,
    /// Something of this is not taught any more: added references may wait.
    Unlearnt(TrainingSet),
    /// Something else is taught.
    Changed(TrainingSet),
}

impl<'a> Watch<'a> {
    pub(super) fn new(desk: &'a Desk, status: &TrainerStatus, edition: u64, until: Until) -> Self {
        Self { desk, status: status.clone(), until, looked_at: Mutex::new(edition) }
    }

    /// Tells what is being done; a break where it is to end.
    pub(super) fn tell(&self, doing: Doing) -> ControlFlow<()> {
        self.desk.report(&TrainerStatus { doing, ..self.status.clone() });
        if self.is_wanted() { ControlFlow::Continue(()) } else { ControlFlow::Break(()) }
    }

    /// Whether the work is to go on.
    pub(super) fn is_wanted(&self) -> bool {
        let mut looked_at = self.looked_at.lock().unwrap_or_else(PoisonError::into_inner);
        let news = self.desk.peek(|orders| {
            let document = (orders.edition != *looked_at).then(|| orders.document.clone()).flatten();
            (!orders.paused).then_some((orders.edition, document))
        });
        let Some(Some((edition, document))) = news else { return false };
        *looked_at = edition;
        let Some(document) = document else { return true };
        let taught = || TrainingSet::of(&document, &TrainingFrames::of_solved(&document).frames);
        let wanted = match &self.until {
            Until::Done => true,
            Until::Unlearnt(learning) => taught().contains(learning),
            Until::Changed(learning) => taught() == *learning,
        };
        if !wanted {
            // Every thread that asks must hear of it.
            *looked_at = u64::MAX;
        }
        wanted
    }
}
