//! A request as `jobs` sees it, and what its work is given.

use super::{Breakdown, Cancellation, Failure, Operation, Report, RequestId, Running};
use std::any::Any;
use std::fmt;
use std::io;
use std::ops::ControlFlow;
use std::sync::Arc;
use touchline_core::progress::Progress;
use touchline_vision::media::ReadFrames;

/// A request that is to be run on a thread of its own. Which operation it is stays inside.
#[derive(Clone)]
pub struct Job {
    id: RequestId,
    name: &'static str,
    operation: Arc<dyn Any + Send + Sync>,
    cancellation: Cancellation,
    run: Arc<RunJob>,
    fail: fn(RequestId, Breakdown) -> Report,
}

type RunJob = dyn Fn(&dyn Decoders, &(dyn Fn(Report) + Sync)) -> Report + Send + Sync;

impl Job {
    /// A request, as the application keeps it and as `jobs` runs it.
    pub(in crate::app) fn new<O: Operation>(id: RequestId, operation: O) -> (Running<O>, Self) {
        let (operation, cancellation) = (Arc::new(operation), Cancellation::default());
        let running = Running::new(id, Arc::clone(&operation), cancellation.clone());
        let input: Arc<dyn Any + Send + Sync> = Arc::clone(&operation) as _;
        let asked = cancellation.clone();
        let run = move |decoders: &dyn Decoders, send: &(dyn Fn(Report) + Sync)| {
            let send = |progress| send(Report::of_progress::<O>(id, progress));
            let context = Context {
                decoders,
                cancellation: &asked,
                send: &send,
            };
            Report::of_end::<O>(id, operation.run(&context).map_err(Failure::Failed))
        };
        let fail = |id, breakdown| Report::of_end::<O>(id, Err(Failure::Broken(breakdown)));
        (
            running,
            Self {
                id,
                name: O::NAME,
                operation: input,
                cancellation,
                run: Arc::new(run),
                fail,
            },
        )
    }

    /// The number of the request.
    #[must_use]
    pub const fn id(&self) -> RequestId {
        self.id
    }

    /// The name of its operation.
    #[must_use]
    pub const fn name(&self) -> &'static str {
        self.name
    }

    /// What is to be done, where that is of this kind: for tests, which look at what was started.
    #[must_use]
    pub fn operation<O: Operation>(&self) -> Option<&O> {
        self.operation.downcast_ref()
    }

    /// Whether nobody waits for it any more.
    #[must_use]
    pub fn is_cancelled(&self) -> bool {
        self.cancellation.is_cancelled()
    }

    /// Ends it early, as when the window closes.
    pub fn cancel(&self) {
        self.cancellation.cancel();
    }

    /// Does the work here and now. How far it has come goes to `send`; what came of it is returned.
    #[must_use]
    pub fn run(&self, decoders: &dyn Decoders, send: &(dyn Fn(Report) + Sync)) -> Report {
        (self.run)(decoders, send)
    }

    /// The report in place of a result where the work panicked.
    #[must_use]
    pub fn panicked(&self, message: String) -> Report {
        (self.fail)(self.id, Breakdown::Panicked(message))
    }

    /// The report in place of a result where the system gave no thread.
    #[must_use]
    pub fn not_started(&self, error: &io::Error) -> Report {
        (self.fail)(self.id, Breakdown::NotStarted(error.to_string()))
    }
}

/// Requests are numbered: two jobs of one number are one.
impl PartialEq for Job {
    fn eq(&self, other: &Self) -> bool {
        self.id == other.id
    }
}

impl fmt::Debug for Job {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{} {:?}", self.name, self.id)
    }
}

/// Where the work gets its pictures from; `jobs` lends them.
pub trait Decoders: Sync {
    /// A reader with a decoder of its own. It takes frames that the window has decoded already and
    /// offers the window its own.
    fn open_reader(&self) -> Box<dyn ReadFrames>;

    /// Pauses for a moment while the window waits for the picture that it shows: both would take
    /// the same processor.
    fn give_way_to_window(&self);
}

/// What the work of one request is given of the world outside. Any thread of the work may use it.
pub struct Context<'a, P> {
    decoders: &'a dyn Decoders,
    cancellation: &'a Cancellation,
    send: &'a (dyn Fn(P) + Sync),
}

impl<P> Context<'_, P> {
    /// A reader of the document's frames. Its decoder is the work's own: opening one costs a seek,
    /// so open one and keep it.
    #[must_use]
    pub fn open_reader(&self) -> Box<dyn ReadFrames> {
        self.decoders.open_reader()
    }

    /// Pauses for a moment while the window waits for the picture that it shows.
    pub fn give_way_to_window(&self) {
        self.decoders.give_way_to_window();
    }

    /// Reports how far the work has come, and says whether to go on. A report may be lost where
    /// others still wait to be taken.
    pub fn report(&self, progress: P) -> ControlFlow<()> {
        (self.send)(progress);
        self.check()
    }

    /// The progress of the work, for the functions that do it.
    #[must_use]
    pub fn progress(&self) -> Progress<'_, P> {
        Progress::new(|progress| self.report(progress))
    }

    /// Whether to go on: a break once the request has been cancelled.
    pub fn check(&self) -> ControlFlow<()> {
        if self.cancellation.is_cancelled() {
            ControlFlow::Break(())
        } else {
            ControlFlow::Continue(())
        }
    }
}
