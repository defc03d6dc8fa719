//! A thread that reads frames in the order of an queue, which its owner replaces whenever the user moves.

use super::mailbox::{FrameMailbox, WorkReport};
use super::{Wake, panic_message};
use crate::media::{CountProgress, FrameRef, MediaError, Picture, ReadFrames};
use std::io;
use std::ops::ControlFlow;
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::sync::Arc;
use std::thread::JoinHandle;

/// Makes the reader of a worker's thread, again after a panic. The watch decides whether a long count goes on.
pub(super) type MakeReader = Box<dyn Fn(CountWatch) -> Box<dyn ReadFrames> + Send>;

/// Asked now and then during a long count.
pub(super) type CountWatch = Box<dyn FnMut(CountProgress) -> ControlFlow<()>>;

/// A thread that reads frames. Dropping it stops and joins the thread.
pub(super) struct FrameWorker {
    mailbox: Arc<FrameMailbox>,
    thread: Option<JoinHandle<()>>,
    /// The mailbox of a worker with priority.
    yields_to: Option<Arc<FrameMailbox>>,
}

impl FrameWorker {
    /// Starts the thread. While `yields_to` has something to do, this worker starts no frame.
    pub(super) fn spawn(name: &str, wake: Wake, yields_to: Option<&Self>, make_reader: MakeReader) -> io::Result<Self> {
        let mailbox = Arc::new(FrameMailbox::default());
        let yields_to = yields_to.map(|first| Arc::clone(&first.mailbox));
        let worker_thread =
            WorkerThread { mailbox: Arc::clone(&mailbox), yields_to: yields_to.clone(), wake, make_reader };
        let thread = std::thread::Builder::new().name(name.to_owned()).spawn(move || worker_thread.work())?;
        Ok(Self { mailbox, thread: Some(thread), yields_to })
    }

    /// The thread's mailbox.
    pub(super) fn mailbox(&self) -> &FrameMailbox {
        &self.mailbox
    }
}

impl Drop for FrameWorker {
    fn drop(&mut self) {
        self.mailbox.stop();
        if let Some(first) = &self.yields_to {
            first.wake_waiting();
        }
        if let Some(thread) = self.thread.take() {
            // Panics of the reader have been turned into reports.
            let _ = thread.join();
        }
    }
}

/// The thread's side.
struct WorkerThread {
    mailbox: Arc<FrameMailbox>,
    yields_to: Option<Arc<FrameMailbox>>,
    wake: Wake,
    make_reader: MakeReader,
}

impl WorkerThread {
    fn work(self) {
        let mut reader = (self.make_reader)(self.watch());
        while let Some(frame) = self.mailbox.take(self.yields_to.as_deref()) {
            match catch_unwind(AssertUnwindSafe(|| (reader.read(&frame), reader.take_notices()))) {
                Ok((result, notices)) => {
                    for notice in notices {
                        self.mailbox.report(WorkReport::Notice(notice));
                    }
                    self.finish(frame, result);
                }
                Err(payload) => {
                    reader = (self.make_reader)(self.watch());
                    self.mailbox.finish(WorkReport::Panicked(frame, panic_message(payload.as_ref())));
                }
            }
            (self.wake)();
        }
    }

    fn finish(&self, frame: FrameRef, result: Result<Picture, MediaError>) {
        match result {
            Err(MediaError::Stopped { .. }) => self.mailbox.give_up(),
            result => self.mailbox.finish(WorkReport::Frame(frame, result)),
        }
    }

    fn watch(&self) -> CountWatch {
        let (mailbox, wake) = (Arc::clone(&self.mailbox), Arc::clone(&self.wake));
        Box::new(move |progress| {
            if !mailbox.is_reading_wanted() {
                return ControlFlow::Break(());
            }
            mailbox.report_progress(progress);
            wake();
            ControlFlow::Continue(())
        })
    }
}
