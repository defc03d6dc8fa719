//! A thread that reads frames in the order of a queue. The owner replaces the queue whenever the
//! user moves to another frame.

use super::frame_orders::{Choice, DecoderReport, FrameMailbox, FrameOrders};
use super::worker::{Mailbox, WaitOutcome, Worker};
use super::{Wake, panic_message};
use std::io;
use std::ops::ControlFlow;
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::sync::Arc;
use touchline_core::progress::Progress;
use touchline_vision::media::{CountProgress, FrameRef, MediaError, Picture, ReadFrames};

/// Maximum number of waiting reports; beyond it the worker pauses.
const MAX_REPORTS: usize = 32;

/// Creates the reader on the worker's thread, once more after each panic. The progress decides
/// whether counting the frames of a long video continues.
pub(super) type MakeReader =
    Box<dyn Fn(Progress<'static, CountProgress>) -> Box<dyn ReadFrames> + Send>;

/// A thread that reads frames. Dropping it stops and joins the thread.
pub(super) struct FrameWorker {
    worker: Worker<FrameOrders, DecoderReport>,
    /// The mailbox of the worker that has priority.
    yields_to: Option<Arc<FrameMailbox>>,
}

impl FrameWorker {
    /// Starts the thread. It starts no frame while `yields_to` has one to read.
    pub(super) fn spawn(
        name: &str,
        wake: Wake,
        yields_to: Option<&Self>,
        make_reader: MakeReader,
    ) -> io::Result<Self> {
        let yields_to = yields_to.map(|first| Arc::clone(first.worker.mailbox()));
        let first = yields_to.clone();
        let mailbox = Mailbox::new(FrameOrders::default(), MAX_REPORTS, wake);
        let worker = Worker::spawn(name, mailbox, DecoderReport::Broken, move |mailbox| {
            WorkerThread {
                mailbox,
                yields_to: first,
                make_reader,
            }
            .work();
        })?;
        Ok(Self { worker, yields_to })
    }

    /// Replaces the queue. `choose` takes the reports that have arrived and returns which frames
    /// are wanted and which of them have to be read. Both happen under one lock, so that no frame
    /// is read twice.
    pub(super) fn replace_queue(&self, choose: impl FnOnce(Vec<DecoderReport>) -> Choice) {
        self.worker.mailbox().update(|state| {
            let choice = choose(state.reports.drain(..).collect());
            state.orders.replace(choice);
        });
    }

    /// Whether a frame is queued or being read.
    pub(super) fn is_pending(&self, frame: &FrameRef) -> bool {
        self.worker
            .mailbox()
            .look(|orders| orders.is_pending(frame))
    }

    /// Takes the reports that have arrived.
    pub(super) fn fetch_reports(&self) -> Vec<DecoderReport> {
        self.worker.mailbox().take_reports()
    }
}

impl Drop for FrameWorker {
    fn drop(&mut self) {
        let mailbox = self.worker.mailbox();
        mailbox.update(|state| state.orders.replace(Choice::default()));
        mailbox.begin_closing();
        if let Some(first) = &self.yields_to {
            // The thread may be waiting in the other worker's mailbox; make it check whether to
            // end.
            first.update(|_| ());
        }
    }
}

/// The thread's side.
struct WorkerThread<'a> {
    mailbox: &'a Arc<FrameMailbox>,
    yields_to: Option<Arc<FrameMailbox>>,
    make_reader: MakeReader,
}

impl WorkerThread<'_> {
    /// Reads frames until the owner drops the worker.
    fn work(self) {
        let mut reader = (self.make_reader)(self.counting());
        while let Some(frame) = self.next() {
            match catch_unwind(AssertUnwindSafe(|| {
                (reader.read(&frame), reader.take_notices())
            })) {
                Ok((result, notices)) => {
                    for notice in notices {
                        self.mailbox.report(DecoderReport::Notice(notice));
                    }
                    self.finish(frame, result);
                }
                Err(payload) => {
                    // The reader may be inconsistent after a panic: continue with a new one.
                    reader = (self.make_reader)(self.counting());
                    let report = DecoderReport::Panicked(frame, panic_message(payload.as_ref()));
                    self.mailbox.report_done(report, FrameOrders::finish);
                }
            }
        }
    }

    /// Waits for a frame to read, and until the worker with priority has none. `None` when the
    /// thread is to end.
    fn next(&self) -> Option<FrameRef> {
        loop {
            let is_there = self
                .mailbox
                .wait_for(None, |orders| (!orders.is_empty()).then_some(()));
            // The pick closure below locks this thread's own mailbox while the other one is locked.
            // Nothing locks the two in the opposite order, so that no deadlock is possible.
            if let (WaitOutcome::Order(()), Some(first)) = (is_there, &self.yields_to) {
                first.wait_for(None, |orders| {
                    (!orders.is_busy() || self.mailbox.is_closing()).then_some(())
                });
            }
            if self.mailbox.is_closing() {
                return None;
            }
            // The queue may have been emptied while this thread waited.
            if let Some(frame) = self.mailbox.update(|state| state.orders.begin()) {
                return Some(frame);
            }
        }
    }

    fn finish(&self, frame: FrameRef, result: Result<Picture, MediaError>) {
        match result {
            // Only `counting` below stops a read. That is no failure of the frame, so nothing is
            // reported.
            Err(MediaError::Stopped { .. }) => self.mailbox.update(|state| state.orders.give_up()),
            result => self
                .mailbox
                .report_done(DecoderReport::Frame(frame, result), FrameOrders::finish),
        }
    }

    /// Reports the progress of counting, and cancels it when no frame of the file is wanted any
    /// more.
    fn counting(&self) -> Progress<'static, CountProgress> {
        let mailbox = Arc::clone(self.mailbox);
        Progress::new(move |progress| {
            if mailbox.is_closing() || !mailbox.look(FrameOrders::is_reading_wanted) {
                return ControlFlow::Break(());
            }
            mailbox.report_instead(DecoderReport::Counting(progress), |before| {
                matches!(before, DecoderReport::Counting(_))
            });
            ControlFlow::Continue(())
        })
    }
}
