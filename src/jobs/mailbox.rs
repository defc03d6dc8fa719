//! The mailbox between a worker and its owner: the queue, the frame being read, and the reports that wait to be fetched.

use super::queue::next_place;
use crate::media::{CountProgress, FrameRef, MediaError, Notice, Picture};
use std::collections::{BTreeSet, VecDeque};
use std::sync::{Condvar, Mutex, MutexGuard, PoisonError};

/// How many reports may wait to be fetched before the worker pauses.
const MAX_REPORTS: usize = 32;

/// A worker's report.
#[derive(Debug)]
pub(super) enum WorkReport {
    /// A frame of the queue is done.
    Frame(FrameRef, Result<Picture, MediaError>),
    /// Reading a frame panicked with this message.
    Panicked(FrameRef, String),
    /// The frames of a video are being counted.
    Counting(CountProgress),
    /// Something the user should know.
    Notice(Notice),
}

/// Where a worker finds its queue and leaves its reports. One lock guards all of it, so that a frame is at every
/// moment either to be read, being read, or reported.
#[derive(Default)]
pub(super) struct FrameMailbox {
    state: Mutex<State>,
    changed: Condvar,
}

#[derive(Default)]
struct State {
    queue: VecDeque<FrameRef>,
    reading: Option<Reading>,
    /// Where the reader stands, as far as is known.
    last_read: Option<FrameRef>,
    reports: VecDeque<WorkReport>,
    stop: bool,
}

struct Reading {
    frame: FrameRef,
    /// Frames of its file are still asked for.
    is_wanted: bool,
}

/// The owner's side.
impl FrameMailbox {
    /// Replaces the queue. `choose` is given the reports that have arrived and returns the frames wanted and, of
    /// these, the ones to be read; each is read once, the one being read is not read again.
    pub(super) fn replace_queue(&self, choose: impl FnOnce(Vec<WorkReport>) -> Choice) {
        let mut state = self.lock();
        let Choice { wanted, missing } = choose(state.reports.drain(..).collect());
        let reading = state.reading.as_ref().map(|reading| reading.frame.clone());
        let mut chosen = BTreeSet::new();
        state.queue = missing
            .into_iter()
            .filter(|frame| reading.as_ref() != Some(frame) && chosen.insert(frame.clone()))
            .collect();
        if let Some(reading) = &mut state.reading {
            reading.is_wanted = wanted.iter().any(|frame| frame.path() == reading.frame.path());
        }
        drop(state);
        self.changed.notify_all();
    }

    /// The reports that have arrived since they were fetched last.
    pub(super) fn fetch_reports(&self) -> Vec<WorkReport> {
        let reports = self.lock().reports.drain(..).collect();
        self.changed.notify_all();
        reports
    }

    /// Whether a frame is being read or waits to be.
    pub(super) fn is_pending(&self, frame: &FrameRef) -> bool {
        let state = self.lock();
        state.queue.contains(frame) || state.reading.as_ref().is_some_and(|reading| reading.frame == *frame)
    }

    /// Tells the worker to end after the frame being read.
    pub(super) fn stop(&self) {
        let mut state = self.lock();
        state.stop = true;
        state.queue.clear();
        drop(state);
        self.changed.notify_all();
    }

    /// Makes those who wait here look again at what they wait for.
    pub(super) fn wake_waiting(&self) {
        // With the lock taken once, nobody is between looking and waiting.
        drop(self.lock());
        self.changed.notify_all();
    }
}

/// What the owner wants now.
pub(super) struct Choice {
    /// All frames of interest.
    pub(super) wanted: Vec<FrameRef>,
    /// Those to be read, the most urgent first.
    pub(super) missing: Vec<FrameRef>,
}

/// The worker's side.
impl FrameMailbox {
    /// The next frame to read, waiting for one, and for the worker that goes first; none when it is time to stop.
    pub(super) fn take(&self, yields_to: Option<&Self>) -> Option<FrameRef> {
        loop {
            drop(self.wait_while(|state| state.queue.is_empty() && !state.stop));
            if let Some(first) = yields_to {
                drop(first.wait_while(|state| state.is_busy() && !self.lock().stop));
            }
            let mut state = self.lock();
            if state.stop {
                return None;
            }
            // The queue may have been emptied in the meantime.
            let place = next_place(&state.queue, state.last_read.as_ref());
            if let Some(frame) = place.and_then(|place| state.queue.remove(place)) {
                state.last_read = Some(frame.clone());
                state.reading = Some(Reading { frame: frame.clone(), is_wanted: true });
                return Some(frame);
            }
        }
    }

    /// Leaves the report of the frame being read; waits for room.
    pub(super) fn finish(&self, report: WorkReport) {
        let mut state = self.wait_while(|state| state.reports.len() >= MAX_REPORTS && !state.stop);
        state.reports.push_back(report);
        state.reading = None;
        drop(state);
        self.changed.notify_all();
    }

    /// Leaves the frame being read unread; it comes first again if somebody has asked for it meanwhile.
    pub(super) fn give_up(&self) {
        let mut state = self.lock();
        if let Some(reading) = state.reading.take().filter(|reading| reading.is_wanted) {
            state.queue.push_front(reading.frame);
        }
        drop(state);
        self.changed.notify_all();
    }

    /// Leaves a report on the way.
    pub(super) fn report(&self, report: WorkReport) {
        self.lock().reports.push_back(report);
    }

    /// Leaves a report of progress in place of the one before.
    pub(super) fn report_progress(&self, progress: CountProgress) {
        let mut state = self.lock();
        state.reports.retain(|report| !matches!(report, WorkReport::Counting(_)));
        state.reports.push_back(WorkReport::Counting(progress));
    }

    /// Whether the frame being read may take longer.
    pub(super) fn is_reading_wanted(&self) -> bool {
        let state = self.lock();
        !state.stop && state.reading.as_ref().is_none_or(|reading| reading.is_wanted)
    }

    /// No code that holds the lock can panic half-way, so that the state is whole even when the lock is poisoned.
    fn lock(&self) -> MutexGuard<'_, State> {
        self.state.lock().unwrap_or_else(PoisonError::into_inner)
    }

    fn wait_while(&self, mut condition: impl FnMut(&State) -> bool) -> MutexGuard<'_, State> {
        self.changed.wait_while(self.lock(), |state| condition(state)).unwrap_or_else(PoisonError::into_inner)
    }
}

impl State {
    fn is_busy(&self) -> bool {
        let has_work = self.reading.is_some() || !self.queue.is_empty();
        has_work && !self.stop
    }
}
