//! A thread that reads frames in the order of an agenda, which its owner replaces whenever the user moves.

use super::desk::{Desk, WorkReport};
use super::{Wake, panic_message};
use crate::media::{CountProgress, FrameRef, MediaError, Picture, ReadFrames};
use std::io;
use std::ops::ControlFlow;
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::sync::Arc;
use std::thread::JoinHandle;

/// What makes the reader of a worker's thread, again after a panic. It takes what a long count asks whether to go on.
pub(super) type MakeReader = Box<dyn Fn(Watch) -> Box<dyn ReadFrames> + Send>;

/// Asked now and then during a long count.
pub(super) type Watch = Box<dyn FnMut(CountProgress) -> ControlFlow<()>>;

/// A thread that reads frames. Dropping it stops and joins the thread.
pub(super) struct FrameWorker {
    desk: Arc<Desk>,
    thread: Option<JoinHandle<()>>,
    /// The desk of a worker that goes first.
    yields_to: Option<Arc<Desk>>,
}

impl FrameWorker {
    /// Starts the thread. While `yields_to` has something to do, this worker starts no frame.
    pub(super) fn spawn(name: &str, wake: Wake, yields_to: Option<&Self>, make_reader: MakeReader) -> io::Result<Self> {
        let desk = Arc::new(Desk::default());
        let yields_to = yields_to.map(|first| Arc::clone(&first.desk));
        let clerk = Clerk { desk: Arc::clone(&desk), yields_to: yields_to.clone(), wake, make_reader };
        let thread = std::thread::Builder::new().name(name.to_owned()).spawn(move || clerk.work())?;
        Ok(Self { desk, thread: Some(thread), yields_to })
    }

    /// What the thread works from.
    pub(super) fn desk(&self) -> &Desk {
        &self.desk
    }
}

impl Drop for FrameWorker {
    fn drop(&mut self) {
        self.desk.stop();
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
struct Clerk {
    desk: Arc<Desk>,
    yields_to: Option<Arc<Desk>>,
    wake: Wake,
    make_reader: MakeReader,
}

impl Clerk {
    fn work(self) {
        let mut reader = (self.make_reader)(self.watch());
        while let Some(frame) = self.desk.take(self.yields_to.as_deref()) {
            match catch_unwind(AssertUnwindSafe(|| (reader.read(&frame), reader.take_notices()))) {
                Ok((result, notices)) => {
                    for notice in notices {
                        self.desk.report(WorkReport::Notice(notice));
                    }
                    self.finish(frame, result);
                }
                Err(payload) => {
                    reader = (self.make_reader)(self.watch());
                    self.desk.finish(WorkReport::Panicked(frame, panic_message(payload.as_ref())));
                }
            }
            (self.wake)();
        }
    }

    fn finish(&self, frame: FrameRef, result: Result<Picture, MediaError>) {
        match result {
            Err(MediaError::Stopped { .. }) => self.desk.give_up(),
            result => self.desk.finish(WorkReport::Frame(frame, result)),
        }
    }

    fn watch(&self) -> Watch {
        let (desk, wake) = (Arc::clone(&self.desk), Arc::clone(&self.wake));
        Box::new(move |progress| {
            if !desk.is_reading_wanted() {
                return ControlFlow::Break(());
            }
            desk.report_progress(progress);
            wake();
            ControlFlow::Continue(())
        })
    }
}
