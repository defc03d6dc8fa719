//! How far a long function has come, and whether it is cancelled.
//!
//! A long function takes a `&Progress` and reports each step to it. The caller decides at each report whether to go on, and
//! `&Progress::default()` is for a caller who does not care. What a step looks like is up to the function: a share, or an event.

mod panic_message;

pub use panic_message::panic_message;

use std::fmt;
use std::ops::ControlFlow;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};

/// Receives the steps of a long function, from any thread, and may cancel it.
pub struct Progress<'a, S> {
    receive: Box<dyn Fn(S) -> ControlFlow<()> + Sync + 'a>,
    /// Shared with the progress of each part.
    is_cancelled: Arc<AtomicBool>,
}

impl<'a, S> Progress<'a, S> {
    /// A progress that hands each step to `receive`. A break cancels the function.
    #[must_use]
    pub fn new(receive: impl Fn(S) -> ControlFlow<()> + Sync + 'a) -> Self {
        Self { receive: Box::new(receive), is_cancelled: Arc::default() }
    }

    /// Reports a step. A break tells the function to return early; it stays one after the first.
    pub fn report(&self, step: S) -> ControlFlow<()> {
        if (self.receive)(step).is_break() {
            self.is_cancelled.store(true, Ordering::Relaxed);
        }
        self.check()
    }

    /// Whether to go on, without a report.
    pub fn check(&self) -> ControlFlow<()> {
        if self.is_cancelled() { ControlFlow::Break(()) } else { ControlFlow::Continue(()) }
    }

    /// Whether a report was answered with a break. Threads that work side by side ask this before they begin another step.
    #[must_use]
    pub fn is_cancelled(&self) -> bool {
        self.is_cancelled.load(Ordering::Relaxed)
    }

    /// The progress of a part of the function. Each step of the part becomes one of the whole; both are cancelled together.
    #[must_use]
    pub fn part<'p, P>(&'p self, step_of_whole: impl Fn(P) -> S + Sync + 'p) -> Progress<'p, P> {
        Progress {
            receive: Box::new(move |step| (self.receive)(step_of_whole(step))),
            is_cancelled: Arc::clone(&self.is_cancelled),
        }
    }
}

/// A progress that drops each step and never cancels.
impl<S> Default for Progress<'_, S> {
    fn default() -> Self {
        Self::new(|_| ControlFlow::Continue(()))
    }
}

impl<S> fmt::Debug for Progress<'_, S> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("Progress").field("is_cancelled", &self.is_cancelled()).finish_non_exhaustive()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::sync::Mutex;

    #[test]
    fn a_break_cancels_the_whole_and_its_parts_for_good() {
        let received = Mutex::new(Vec::new());
        let whole = Progress::new(|step: usize| {
            received.lock().unwrap().push(step);
            if step == 20 { ControlFlow::Break(()) } else { ControlFlow::Continue(()) }
        });
        let (first, second) = (whole.part(|step: usize| 10 * step), whole.part(|step: usize| 100 * step));
        assert!(first.report(1).is_continue());
        assert!(!whole.is_cancelled());
        assert!(first.report(2).is_break());
        assert!(whole.is_cancelled() && second.check().is_break());
        assert!(second.report(3).is_break(), "a later step is received, but does not revive the function");
        assert_eq!(*received.lock().unwrap(), [10, 20, 300]);
    }

    #[test]
    fn the_default_goes_on() {
        assert!(Progress::default().report("a step").is_continue());
    }
}
