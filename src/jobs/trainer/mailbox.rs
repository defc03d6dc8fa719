//! The mailbox between the trainer and its owner: the newest orders and the waiting reports.

use super::super::Wake;
use super::TrainerReport;
use crate::app::{TrainerOrder, TrainerStatus};
use crate::document::{Document, FrameId};
use crate::proposals::{Proposal, UsedFeatures};
use std::sync::{Condvar, Mutex, MutexGuard, PoisonError};
use std::time::{Duration, Instant};

/// Proposals that may wait to be fetched; the trainer pauses then.
const MOST_PROPOSALS: usize = 1024;

/// The shortest time between two progress reports.
const TELL_EVERY: Duration = Duration::from_millis(200);

/// One lock guards all of it.
pub(super) struct TrainerMailbox {
    state: Mutex<State>,
    changed: Condvar,
    wake: Wake,
}

#[derive(Default)]
struct State {
    orders: Orders,
    stop: bool,
    status: Option<TrainerStatus>,
    /// The last status that was left here.
    last: TrainerStatus,
    told: Option<Instant>,
    proposals: Vec<Proposal>,
    features: Option<UsedFeatures>,
}

/// The current orders of the trainer.
#[derive(Clone, Default)]
pub(super) struct Orders {
    /// The newest document.
    pub(super) document: Option<Document>,
    /// Counts documents.
    pub(super) edition: u64,
    /// The frame that is shown.
    pub(super) frame: Option<FrameId>,
    /// The features of the shown frame are wanted.
    pub(super) features: bool,
    /// It rests.
    pub(super) paused: bool,
    /// Counts all orders.
    pub(super) number: u64,
}

/// The owner's side.
impl TrainerMailbox {
    pub(super) fn new(wake: Wake) -> Self {
        Self { state: Mutex::default(), changed: Condvar::new(), wake }
    }

    pub(super) fn take_order(&self, order: TrainerOrder) {
        let mut state = self.lock();
        let orders = &mut state.orders;
        orders.number += 1;
        let replaced = match order {
            TrainerOrder::Document(document) => {
                orders.edition += 1;
                orders.document.replace(*document)
            }
            TrainerOrder::Frame(frame) => {
                orders.frame = Some(frame);
                None
            }
            TrainerOrder::Features(wanted) => {
                orders.features = wanted;
                None
            }
            TrainerOrder::Pause(paused) => {
                orders.paused = paused;
                None
            }
        };
        drop(state);
        // Letting go of a document may take a while.
        drop(replaced);
        self.changed.notify_all();
    }

    pub(super) fn fetch_reports(&self) -> Vec<TrainerReport> {
        let mut state = self.lock();
        let proposals = std::mem::take(&mut state.proposals);
        let (status, features) = (state.status.take(), state.features.take());
        drop(state);
        self.changed.notify_all();
        // Those of two forests are two reports: among themselves the later ones would make the earlier ones stale.
        let by_forest = proposals.chunk_by(|a, b| a.generation == b.generation);
        let proposals = by_forest.map(|proposals| TrainerReport::Proposals(proposals.to_vec()));
        let features = features.map(|used| TrainerReport::Features(Box::new(used)));
        proposals.chain(features).chain(status.map(|status| TrainerReport::Status(Box::new(status)))).collect()
    }

    pub(super) fn stop(&self) {
        self.lock().stop = true;
        self.changed.notify_all();
    }
}

/// The trainer's side.
impl TrainerMailbox {
    /// The newest orders; none when it is time to end.
    pub(super) fn orders(&self) -> Option<Orders> {
        let state = self.lock();
        (!state.stop).then(|| state.orders.clone())
    }

    /// Looks at the orders without copying them; none when it is time to end.
    pub(super) fn peek<T>(&self, look: impl FnOnce(&Orders) -> T) -> Option<T> {
        let state = self.lock();
        (!state.stop).then(|| look(&state.orders))
    }

    /// Waits for an order after that of a number, but not beyond a time.
    pub(super) fn wait(&self, number: u64, until: Option<Instant>) {
        let same = |state: &mut State| state.orders.number == number && !state.stop;
        let state = self.lock();
        match until {
            None => drop(self.changed.wait_while(state, same)),
            Some(until) => {
                let left = until.saturating_duration_since(Instant::now());
                drop(self.changed.wait_timeout_while(state, left, same));
            }
        }
    }

    /// Leaves a status in place of the one before. Mere progress is told now and then.
    pub(super) fn report(&self, status: &TrainerStatus) {
        let mut state = self.lock();
        if state.last == *status {
            return;
        }
        let mere_progress = state.last.doing.is_kind_of(status.doing)
            && TrainerStatus { doing: status.doing, ..state.last.clone() } == *status;
        if mere_progress && state.told.is_some_and(|told| told.elapsed() < TELL_EVERY) {
            return;
        }
        state.told = Some(Instant::now());
        state.last.clone_from(status);
        state.status = Some(status.clone());
        drop(state);
        (self.wake)();
    }

    /// Leaves what was made of features, in place of what was left before.
    pub(super) fn show_features(&self, used: UsedFeatures) {
        self.lock().features = Some(used);
        (self.wake)();
    }

    /// Leaves proposals; waits for room.
    pub(super) fn propose(&self, proposals: Vec<Proposal>) {
        if proposals.is_empty() {
            return;
        }
        let full = |state: &mut State| state.proposals.len() >= MOST_PROPOSALS && !state.stop;
        let mut state = self.changed.wait_while(self.lock(), full).unwrap_or_else(PoisonError::into_inner);
        state.proposals.extend(proposals);
        drop(state);
        (self.wake)();
    }

    /// No code that holds the lock can panic half-way.
    fn lock(&self) -> MutexGuard<'_, State> {
        self.state.lock().unwrap_or_else(PoisonError::into_inner)
    }
}
