//! Where the application keeps a request while it runs, its number, and how it is cancelled.

use super::Operation;
use std::fmt;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};

/// The number of a request. The application counts all of its requests with one counter, so that
/// none repeats, whatever is opened or closed in between.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, PartialOrd, Ord)]
pub struct RequestId(u64);

impl RequestId {
    /// Counts one up and returns the new number.
    pub(in crate::app) const fn advance(&mut self) -> Self {
        self.0 += 1;
        *self
    }
}

/// Whether a request has been cancelled: shared by the application, which cancels, and the thread,
/// which asks.
#[derive(Clone, Debug, Default)]
pub(super) struct Cancellation(Arc<AtomicBool>);

impl Cancellation {
    pub(super) fn cancel(&self) {
        // Nothing else is published with the flag: the thread only has to see it soon.
        self.0.store(true, Ordering::Relaxed);
    }

    pub(super) fn is_cancelled(&self) -> bool {
        self.0.load(Ordering::Relaxed)
    }
}

/// The request of one kind of operation that is running, if any. Replacing or dropping it cancels
/// it.
pub struct Slot<O: Operation>(Option<Running<O>>);

/// A request that has been started and not yet taken over. It cannot be copied: dropping it cancels
/// it.
pub struct Running<O: Operation> {
    id: RequestId,
    operation: Arc<O>,
    progress: Option<O::Progress>,
    cancellation: Cancellation,
}

impl<O: Operation> Drop for Running<O> {
    fn drop(&mut self) {
        self.cancellation.cancel();
    }
}

impl<O: Operation> Running<O> {
    pub(super) const fn new(id: RequestId, operation: Arc<O>, cancellation: Cancellation) -> Self {
        Self {
            id,
            operation,
            progress: None,
            cancellation,
        }
    }

    /// The number of the request.
    #[must_use]
    pub const fn id(&self) -> RequestId {
        self.id
    }

    /// What is being done.
    #[must_use]
    pub fn operation(&self) -> &O {
        &self.operation
    }

    /// How far it has come; none before it says so.
    #[must_use]
    pub const fn progress(&self) -> Option<&O::Progress> {
        self.progress.as_ref()
    }
}

impl<O: Operation> Slot<O> {
    /// The request that is running.
    #[must_use]
    pub const fn running(&self) -> Option<&Running<O>> {
        self.0.as_ref()
    }

    /// Whether one is.
    #[must_use]
    pub const fn is_running(&self) -> bool {
        self.0.is_some()
    }

    /// Cancels what is running; whether anything was.
    pub(in crate::app) fn cancel(&mut self) -> bool {
        self.0.take().is_some()
    }

    /// Keeps a request that has been started; the one before is cancelled.
    pub(in crate::app) fn replace(&mut self, running: Running<O>) {
        self.0 = Some(running);
    }

    /// Notes how far the request of this number has come; nothing where it is no longer running.
    pub(super) fn set_progress(&mut self, id: RequestId, progress: O::Progress) {
        if let Some(running) = self.0.as_mut().filter(|running| running.id == id) {
            running.progress = Some(progress);
        }
    }

    /// Whether the request of this number is running.
    pub(super) fn is_running_as(&self, id: RequestId) -> bool {
        self.0.as_ref().is_some_and(|running| running.id == id)
    }

    /// Empties the slot and returns the operation of the request of this number; none where it is
    /// no longer running.
    pub(super) fn finish(&mut self, id: RequestId) -> Option<Arc<O>> {
        Some(Arc::clone(
            &self.0.take_if(|running| running.id == id)?.operation,
        ))
    }
}

impl<O: Operation> Default for Slot<O> {
    fn default() -> Self {
        Self(None)
    }
}

impl<O: Operation> fmt::Debug for Slot<O> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_tuple("Slot").field(&self.0).finish()
    }
}

impl<O: Operation> fmt::Debug for Running<O> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{} {:?}: {:?}", O::NAME, self.id, self.progress)
    }
}
