//! A request as `jobs` runs it, and the context that its work receives.

use super::{Breakdown, Cancellation, Failure, Operation, Report, RequestId, Running};
use std::any::Any;
use std::fmt;
use std::io;
use std::ops::ControlFlow;
use std::sync::Arc;
use touchline_core::progress::Progress;
use touchline_vision::media::ReadFrames;

/// A request to be run on a thread of its own. The type of its operation is erased, so that `jobs`
/// depends on no operation.
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
    /// Wraps an operation into the half that the application keeps and the half that `jobs` runs.
    /// Both share the operation and the cancellation flag.
    pub(in crate::app) fn new<O: Operation>(id: RequestId, operation: O) -> (Running<O>, Self) {
        let (operation, cancellation) = (Arc::new(operation), Cancellation::default());
        let running = Running::new(id, Arc::clone(&operation), cancellation.clone());
        let input: Arc<dyn Any + Send + Sync> = Arc::clone(&operation) as _;
        let of_job = cancellation.clone();
        // The types are known only here. Both closures make reports that carry them, so that `jobs`
        // and the runner need not know them.
        let run = move |decoders: &dyn Decoders, send: &(dyn Fn(Report) + Sync)| {
            let send = |progress| send(Report::from_progress::<O>(id, progress));
            let context = Context {
                decoders,
                cancellation: &of_job,
                send: &send,
            };
            Report::from_result::<O>(id, operation.run(&context).map_err(Failure::Failed))
        };
        (
            running,
            Self {
                id,
                name: O::NAME,
                operation: input,
                cancellation,
                run: Arc::new(run),
                fail: |id, breakdown| Report::from_result::<O>(id, Err(Failure::Broken(breakdown))),
            },
        )
    }

    /// The number of the request.
    pub const fn id(&self) -> RequestId {
        self.id
    }

    /// The name of the operation; also the name of its thread.
    pub const fn name(&self) -> &'static str {
        self.name
    }

    /// The operation, if it is an `O`. For tests, which check what was started.
    pub fn operation<O: Operation>(&self) -> Option<&O> {
        self.operation.downcast_ref()
    }

    /// Does the work of an `O` on the calling thread. For tests, which report one result in several
    /// situations.
    #[cfg(feature = "testing")]
    pub fn output<O: Operation>(
        &self,
        decoders: &dyn Decoders,
    ) -> Option<Result<O::Output, O::Error>> {
        let context = Context {
            decoders,
            cancellation: &self.cancellation,
            send: &|_| (),
        };
        Some(self.operation::<O>()?.run(&context))
    }

    /// Whether the application has dropped the request.
    pub fn is_cancelled(&self) -> bool {
        self.cancellation.is_cancelled()
    }

    /// Cancels the request, for instance when the window closes.
    pub fn cancel(&self) {
        self.cancellation.cancel();
    }

    /// Does the work on the calling thread. Passes progress to `send` and returns the result.
    pub fn run(&self, decoders: &dyn Decoders, send: &(dyn Fn(Report) + Sync)) -> Report {
        (self.run)(decoders, send)
    }

    /// The report to return if the work panicked.
    pub fn panic_report(&self, message: String) -> Report {
        (self.fail)(self.id, Breakdown::Panicked(message))
    }

    /// The report to return if the system could not start a thread.
    pub fn not_started(&self, error: &io::Error) -> Report {
        (self.fail)(self.id, Breakdown::NotStarted(error.to_string()))
    }
}

/// Request numbers are unique, so two jobs with one number are the same request.
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

/// Where the work gets its pictures from; implemented by `jobs`.
pub trait Decoders: Sync {
    /// Opens a reader with a decoder of its own. The reader shares a cache with the window: it uses
    /// frames that the window has decoded, and shares its own.
    fn open_reader(&self) -> Box<dyn ReadFrames>;

    /// Pauses briefly while the window waits for the picture that it shows, because both need the
    /// same processor.
    fn give_way_to_window(&self);
}

/// What the work of one request may use: pictures, progress, cancellation. It may be shared between
/// threads of the work.
pub struct Context<'a, P> {
    decoders: &'a dyn Decoders,
    cancellation: &'a Cancellation,
    send: &'a (dyn Fn(P) + Sync),
}

impl<P> Context<'_, P> {
    /// Opens a reader of the document's frames, with a decoder of its own. Opening one costs a
    /// seek, so keep it.
    pub fn open_reader(&self) -> Box<dyn ReadFrames> {
        self.decoders.open_reader()
    }

    /// Pauses briefly while the window waits for the picture that it shows.
    pub fn give_way_to_window(&self) {
        self.decoders.give_way_to_window();
    }

    /// Reports progress, and returns `Break` if the request has been cancelled. Reports may be
    /// dropped while earlier ones are still queued.
    pub fn report(&self, progress: P) -> ControlFlow<()> {
        (self.send)(progress);
        self.check()
    }

    /// [`Self::report`] in the form that the library's functions take.
    pub fn progress(&self) -> Progress<'_, P> {
        Progress::new(|progress| self.report(progress))
    }

    /// Returns `Break` if the request has been cancelled.
    pub fn check(&self) -> ControlFlow<()> {
        if self.cancellation.is_cancelled() {
            ControlFlow::Break(())
        } else {
            ControlFlow::Continue(())
        }
    }
}
