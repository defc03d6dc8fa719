//! The slot of a request while it runs, the number of a request, and its cancellation.

use super::Operation;
use std::fmt;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};

/// The number of a request. One counter serves the whole run of the program, so numbers never
/// repeat, even after another document is opened.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, PartialOrd, Ord)]
pub struct RequestId(u64);

impl RequestId {
    /// Increments the number and returns it.
    pub(in crate::app) const fn advance(&mut self) -> Self {
        self.0 += 1;
        *self
    }
}

/// Whether a request has been cancelled. Shared by the application, which sets it, and the thread,
/// which reads it.
#[derive(Clone, Debug, Default)]
pub(super) struct Cancellation(Arc<AtomicBool>);

impl Cancellation {
    pub(super) fn cancel(&self) {
        // Relaxed: the flag publishes no other data, and the thread only has to see it soon.
        self.0.store(true, Ordering::Relaxed);
    }

    pub(super) fn is_cancelled(&self) -> bool {
        self.0.load(Ordering::Relaxed)
    }
}

/// The running request of one kind of operation, if any. Replacing or dropping it cancels it.
pub struct Slot<O: Operation>(Option<Running<O>>);

/// A request that was started and whose result has not been taken over. Not `Clone`, because
/// dropping it cancels the work.
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
    pub const fn id(&self) -> RequestId {
        self.id
    }

    /// The operation, with its inputs.
    pub fn operation(&self) -> &O {
        &self.operation
    }

    /// The last reported progress; none before the first report.
    pub const fn progress(&self) -> Option<&O::Progress> {
        self.progress.as_ref()
    }
}

impl<O: Operation> Slot<O> {
    /// The running request, if any.
    pub const fn running(&self) -> Option<&Running<O>> {
        self.0.as_ref()
    }

    /// Whether a request is running.
    pub const fn is_running(&self) -> bool {
        self.0.is_some()
    }

    /// Cancels the running request. Returns whether there was one.
    pub(in crate::app) fn cancel(&mut self) -> bool {
        self.0.take().is_some()
    }

    /// Keeps a request that was just started, and cancels the previous one.
    pub(in crate::app) fn replace(&mut self, running: Running<O>) {
        self.0 = Some(running);
    }

    /// Stores the progress of the request `id`. Does nothing if that request no longer runs.
    pub(super) fn set_progress(&mut self, id: RequestId, progress: O::Progress) {
        if let Some(running) = self.0.as_mut().filter(|running| running.id == id) {
            running.progress = Some(progress);
        }
    }

    /// Whether the request `id` is running.
    pub(super) fn is_running_as(&self, id: RequestId) -> bool {
        self.0.as_ref().is_some_and(|running| running.id == id)
    }

    /// Empties the slot and returns the operation of the request `id`. None if that request no
    /// longer runs.
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
