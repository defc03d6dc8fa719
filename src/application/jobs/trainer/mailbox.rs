//! The orders of the trainer, and its reports.

use super::TrainerReport;
use crate::app::{AnswerKey, TrainerActivity, TrainerOrder, TrainerStatus, TrainerWishes};
use crate::jobs::worker::Mailbox;
use std::ops::ControlFlow;
use std::sync::{Arc, Mutex, PoisonError};
use std::time::{Duration, Instant};
use touchline_calibration::proposals::{
    Proposal, RefusedForests, TrackedProposal, TrainingFrames, TrainingSet, UsedFeatures,
};
use touchline_documents::document::Document;

/// Minimum time between two reports of mere progress.
const TELL_EVERY: Duration = Duration::from_millis(200);

/// The current orders.
#[derive(Clone, Default)]
pub(super) struct Orders {
    /// The newest document.
    pub(super) document: Option<Document>,
    /// Number of documents received so far.
    pub(super) edition: u64,
    /// Answers that earlier documents came to show since the orders were last taken.
    pub(super) shown_before: Vec<AnswerKey>,
    /// Answers that the newest document came to show since then.
    pub(super) shown: Vec<AnswerKey>,
    /// Answers that the user discarded since then.
    pub(super) refused: Vec<RefusedForests>,
    /// How the trainer works.
    pub(super) wishes: TrainerWishes,
    /// Number of orders received so far.
    pub(super) number: u64,
}

impl Orders {
    /// Applies an order; returns the document that it replaces.
    pub(super) fn take_in(&mut self, order: TrainerOrder) -> Option<Document> {
        self.number += 1;
        match order {
            TrainerOrder::Document(document) => {
                self.edition += 1;
                // The trainer must tell answers that this document may lack from those that it came
                // to show after it was sent.
                self.shown_before.append(&mut self.shown);
                return self.document.replace(*document);
            }
            TrainerOrder::Shown(keys) => self.shown.extend(keys),
            TrainerOrder::Refused(refused) => self.refused.push(refused),
            TrainerOrder::Wishes(wishes) => self.wishes = wishes,
        }
        None
    }

    /// A copy of the current orders. Lists are moved out, so that each entry is returned once.
    fn take(&mut self) -> Self {
        let shown_before = std::mem::take(&mut self.shown_before);
        let (shown, refused) = (
            std::mem::take(&mut self.shown),
            std::mem::take(&mut self.refused),
        );
        Self {
            shown_before,
            shown,
            refused,
            ..self.clone()
        }
    }
}

/// The trainer's side of the mailbox. Any thread of the trainer may report.
pub(super) struct TrainerMailbox {
    mailbox: Arc<Mailbox<Orders, TrainerReport>>,
    last_report: Mutex<LastReport>,
}

/// The last reported status and its time.
#[derive(Default)]
struct LastReport {
    /// The status without the estimated remaining time.
    status: TrainerStatus,
    at: Option<Instant>,
    /// The first report of the current step and its time, from which the remaining time is
    /// estimated.
    begun: Option<(TrainerActivity, Instant)>,
}

/// Whether `later` is progress of the same step as `earlier`.
fn is_part_of(earlier: TrainerActivity, later: TrainerActivity) -> bool {
    let done = |doing: TrainerActivity| doing.share().map_or(0, |share| share.done);
    earlier.is_kind_of(later) && done(earlier) <= done(later)
}

impl TrainerMailbox {
    pub(super) fn new(mailbox: Arc<Mailbox<Orders, TrainerReport>>) -> Self {
        Self {
            mailbox,
            last_report: Mutex::default(),
        }
    }

    /// Reads the current orders; `None` when the thread is to end.
    pub(super) fn peek<T>(&self, look: impl FnOnce(&Orders) -> T) -> Option<T> {
        (!self.mailbox.is_closing()).then(|| self.mailbox.look(look))
    }

    /// Takes the current orders; `None` when the thread is to end.
    pub(super) fn take_orders(&self) -> Option<Orders> {
        (!self.mailbox.is_closing()).then(|| self.mailbox.update(|state| state.orders.take()))
    }

    /// Waits for an order other than that of `number`, at most until a time.
    pub(super) fn wait(&self, number: u64, until: Option<Instant>) {
        self.mailbox
            .wait_for(until, |orders| (orders.number != number).then_some(()));
    }

    /// Replaces the status report. Mere progress is reported at most every [`TELL_EVERY`].
    pub(super) fn report(&self, status: &TrainerStatus) {
        let mut last_report = self
            .last_report
            .lock()
            .unwrap_or_else(PoisonError::into_inner);
        if last_report.status == *status {
            return;
        }
        // Mere progress: the two differ in nothing but the numbers of the same activity.
        let mere_progress = last_report.status.doing.is_kind_of(status.doing)
            && TrainerStatus {
                doing: status.doing,
                ..last_report.status.clone()
            } == *status;
        if mere_progress && last_report.at.is_some_and(|at| at.elapsed() < TELL_EVERY) {
            return;
        }
        // Estimate the remaining time from the first report of this step.
        let now = Instant::now();
        let begun = last_report
            .begun
            .filter(|(doing, _)| is_part_of(*doing, status.doing))
            .unwrap_or((status.doing, now));
        *last_report = LastReport {
            status: status.clone(),
            at: Some(now),
            begun: Some(begun),
        };
        let left = status.doing.estimate_time_left(begun.0, now - begun.1);
        let report = TrainerReport::Status(Box::new(TrainerStatus {
            left,
            ..status.clone()
        }));
        self.mailbox
            .report_instead(report, |before| matches!(before, TrainerReport::Status(_)));
    }

    /// Replaces the report about features.
    pub(super) fn show_features(&self, used: UsedFeatures) {
        let report = TrainerReport::Features(Box::new(used));
        self.mailbox.report_instead(report, |before| {
            matches!(before, TrainerReport::Features(_))
        });
    }

    /// Reports propagated cameras; blocks until there is room.
    pub(super) fn carry(&self, tracked: Vec<TrackedProposal>) {
        self.mailbox.report(TrainerReport::Tracked(tracked));
    }

    /// Reports proposals of one forest; blocks until there is room.
    pub(super) fn propose(&self, proposals: Vec<Proposal>) {
        self.mailbox.report(TrainerReport::Proposals(proposals));
    }
}

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
            (!orders.wishes.paused).then_some((orders.edition, document))
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
