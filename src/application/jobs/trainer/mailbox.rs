//! What the trainer is to do, and how it reports.

use super::TrainerReport;
use crate::app::{AnswerKey, Doing, TrainerOrder, TrainerStatus};
use crate::jobs::worker::Mailbox;
use std::sync::{Arc, Mutex, PoisonError};
use std::time::{Duration, Instant};
use touchline_calibration::proposals::{CarriedProposal, Proposal, RefusedForests, UsedFeatures};
use touchline_documents::document::{Document, FrameId};

/// The shortest time between two progress reports.
const TELL_EVERY: Duration = Duration::from_millis(200);

/// The current orders of the trainer.
#[derive(Clone, Default)]
pub(super) struct Orders {
    /// The newest document.
    pub(super) document: Option<Document>,
    /// Counts documents.
    pub(super) edition: u64,
    /// Answers that documents before the newest came to show since the orders were taken last.
    pub(super) shown_before: Vec<AnswerKey>,
    /// Answers that the newest document has come to show since then.
    pub(super) shown: Vec<AnswerKey>,
    /// Forests that were refused since then.
    pub(super) refused: Vec<RefusedForests>,
    /// The frame that is shown.
    pub(super) frame: Option<FrameId>,
    /// The features of the shown frame are wanted.
    pub(super) features: bool,
    /// It rests.
    pub(super) paused: bool,
    /// Proposals are snapped to the painted lines.
    pub(super) snapping: bool,
    /// Counts all orders.
    pub(super) number: u64,
}

impl Orders {
    /// Takes an order in; returns the document that it replaces.
    pub(super) fn take_in(&mut self, order: TrainerOrder) -> Option<Document> {
        self.number += 1;
        match order {
            TrainerOrder::Document(document) => {
                self.edition += 1;
                self.shown_before.append(&mut self.shown);
                return self.document.replace(*document);
            }
            TrainerOrder::Shown(keys) => self.shown.extend(keys),
            TrainerOrder::Refused(refused) => self.refused.push(refused),
            TrainerOrder::Frame(frame) => self.frame = Some(frame),
            TrainerOrder::Features(wanted) => self.features = wanted,
            TrainerOrder::Pause(paused) => self.paused = paused,
            TrainerOrder::Snap(snapping) => self.snapping = snapping,
        }
        None
    }

    /// The current orders. What came since they were taken last is handed out once.
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

/// The trainer's side of its mailbox; any of its threads may report.
pub(super) struct TrainerMailbox {
    mailbox: Arc<Mailbox<Orders, TrainerReport>>,
    told: Mutex<Told>,
}

/// The last status that was reported, and when.
#[derive(Default)]
struct Told {
    /// Without the time that is left.
    status: TrainerStatus,
    at: Option<Instant>,
    /// What was begun, and when.
    begun: Option<(Doing, Instant)>,
}

/// Whether work has gone on from an earlier state to a later one.
fn is_part_of(earlier: Doing, later: Doing) -> bool {
    let done = |doing: Doing| doing.share().map_or(0, |share| share.done);
    earlier.is_kind_of(later) && done(earlier) <= done(later)
}

impl TrainerMailbox {
    pub(super) fn new(mailbox: Arc<Mailbox<Orders, TrainerReport>>) -> Self {
        Self {
            mailbox,
            told: Mutex::default(),
        }
    }

    /// Looks at the newest orders; none when it is time to end.
    pub(super) fn peek<T>(&self, look: impl FnOnce(&Orders) -> T) -> Option<T> {
        (!self.mailbox.is_closing()).then(|| self.mailbox.look(look))
    }

    /// Takes the newest orders; none when it is time to end.
    pub(super) fn take_orders(&self) -> Option<Orders> {
        (!self.mailbox.is_closing()).then(|| self.mailbox.update(|state| state.orders.take()))
    }

    /// Waits for an order after that of a number, but not beyond a time.
    pub(super) fn wait(&self, number: u64, until: Option<Instant>) {
        self.mailbox
            .wait_for(until, |orders| (orders.number != number).then_some(()));
    }

    /// Leaves a status in place of the one before. Mere progress is reported now and then.
    pub(super) fn report(&self, status: &TrainerStatus) {
        let mut told = self.told.lock().unwrap_or_else(PoisonError::into_inner);
        if told.status == *status {
            return;
        }
        let mere_progress = told.status.doing.is_kind_of(status.doing)
            && TrainerStatus {
                doing: status.doing,
                ..told.status.clone()
            } == *status;
        if mere_progress && told.at.is_some_and(|at| at.elapsed() < TELL_EVERY) {
            return;
        }
        let now = Instant::now();
        let begun = told
            .begun
            .filter(|(doing, _)| is_part_of(*doing, status.doing))
            .unwrap_or((status.doing, now));
        *told = Told {
            status: status.clone(),
            at: Some(now),
            begun: Some(begun),
        };
        let left = status.doing.left_since(begun.0, now - begun.1);
        let report = TrainerReport::Status(Box::new(TrainerStatus {
            left,
            ..status.clone()
        }));
        self.mailbox
            .report_instead(report, |before| matches!(before, TrainerReport::Status(_)));
    }

    /// Leaves what was made of features, in place of what was left before.
    pub(super) fn show_features(&self, used: UsedFeatures) {
        let report = TrainerReport::Features(Box::new(used));
        self.mailbox.report_instead(report, |before| {
            matches!(before, TrainerReport::Features(_))
        });
    }

    /// Leaves cameras that were carried; waits for room.
    pub(super) fn carry(&self, carried: Vec<CarriedProposal>) {
        self.mailbox.report(TrainerReport::Carried(carried));
    }

    /// Leaves the proposals of one forest; waits for room.
    pub(super) fn propose(&self, proposals: Vec<Proposal>) {
        self.mailbox.report(TrainerReport::Proposals(proposals));
    }
}
