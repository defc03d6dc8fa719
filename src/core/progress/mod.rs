//! Progress reports and cancellation of long functions.
//!
//! A long function takes a `&Progress` and reports each step to it. The caller decides at each
//! report whether to continue; `&Progress::default()` ignores reports and never cancels. The type
//! of a step is up to the function: a fraction, or an event.

use std::any::Any;
use std::fmt;
use std::ops::ControlFlow;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};

/// A step of a function that processes a number of equal parts: how many are done.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Share {
    /// Parts that are done.
    pub done: usize,
    /// All parts.
    pub of: usize,
}

impl Share {
    /// So many of all parts are done.
    pub const fn new(done: usize, of: usize) -> Self {
        Self { done, of }
    }

    /// From 0 to 1.
    pub fn fraction(self) -> f32 {
        if self.of == 0 {
            0.0
        } else {
            (self.done as f32 / self.of as f32).min(1.0)
        }
    }

    /// In whole percent.
    pub fn percent(self) -> usize {
        100 * self.done / self.of.max(1)
    }
}

/// Receives the steps of a long function, from any thread, and may cancel it.
pub struct Progress<'a, S> {
    receive: Box<dyn Fn(S) -> ControlFlow<()> + Sync + 'a>,
    /// Shared with the progress of each part.
    is_cancelled: Arc<AtomicBool>,
}

impl<'a, S> Progress<'a, S> {
    /// A progress that hands each step to `receive`. A break cancels the function.
    pub fn new(receive: impl Fn(S) -> ControlFlow<()> + Sync + 'a) -> Self {
        Self {
            receive: Box::new(receive),
            is_cancelled: Arc::default(),
        }
    }

    /// Reports a step. A break means that the function must return early; after the first break all
    /// reports return one.
    pub fn report(&self, step: S) -> ControlFlow<()> {
        // A receiver that breaks once may continue later; the flag keeps the first break. It guards
        // no other memory, so relaxed ordering suffices.
        if (self.receive)(step).is_break() {
            self.is_cancelled.store(true, Ordering::Relaxed);
        }
        self.check()
    }

    /// Whether to continue, without a report.
    pub fn check(&self) -> ControlFlow<()> {
        if self.is_cancelled() {
            ControlFlow::Break(())
        } else {
            ControlFlow::Continue(())
        }
    }

    /// Whether a report was answered with a break. Parallel threads check this before they begin
    /// another step.
    pub fn is_cancelled(&self) -> bool {
        self.is_cancelled.load(Ordering::Relaxed)
    }

    /// A progress with the same receiver for another run of the function; not cancelled initially,
    /// even if this one was.
    #[must_use]
    pub fn renew(&self) -> Progress<'_, S> {
        Progress::new(|step| (self.receive)(step))
    }

    /// The progress of a part of the function. Each step of the part becomes one of the whole; both
    /// are cancelled together.
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
        f.debug_struct("Progress")
            .field("is_cancelled", &self.is_cancelled())
            .finish_non_exhaustive()
    }
}

/// The message of a panic in a long function.
#[doc(hidden)]
pub fn panic_message(payload: &(dyn Any + Send)) -> String {
    // `panic!` with a literal has a `&str`, with arguments a `String`; any other payload comes from
    // `panic_any` and has no text.
    let text = payload
        .downcast_ref::<&str>()
        .map(|text| (*text).to_owned());
    text.or_else(|| payload.downcast_ref::<String>().cloned())
        .unwrap_or_else(|| "without a message".to_owned())
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::panic::catch_unwind;
    use std::sync::Mutex;

    #[test]
    fn a_panic_message_is_found_whether_its_text_is_formatted_or_literal() {
        assert_eq!(panic_message(&"as written"), "as written");
        assert_eq!(panic_message(&String::from("as made")), "as made");
        let payload = catch_unwind(|| std::panic::resume_unwind(Box::new(7))).unwrap_err();
        assert_eq!(panic_message(payload.as_ref()), "without a message");
    }

    #[test]
    fn a_break_cancels_the_whole_and_its_parts_for_good() {
        let received = Mutex::new(Vec::new());
        let whole = Progress::new(|step: usize| {
            received.lock().unwrap().push(step);
            if step == 20 {
                ControlFlow::Break(())
            } else {
                ControlFlow::Continue(())
            }
        });
        let (first, second) = (
            whole.part(|step: usize| 10 * step),
            whole.part(|step: usize| 100 * step),
        );
        assert!(first.report(1).is_continue());
        assert!(!whole.is_cancelled());
        assert!(first.report(2).is_break());
        assert!(whole.is_cancelled() && second.check().is_break());
        assert!(
            second.report(3).is_break(),
            "a later step is received, but does not revive the function"
        );
        assert_eq!(*received.lock().unwrap(), [10, 20, 300]);
    }

    #[test]
    fn another_run_begins_uncancelled() {
        let patience = AtomicBool::new(false);
        let first = Progress::new(|()| {
            if patience.load(Ordering::Relaxed) {
                ControlFlow::Continue(())
            } else {
                ControlFlow::Break(())
            }
        });
        assert!(first.report(()).is_break());
        patience.store(true, Ordering::Relaxed);
        assert!(first.check().is_break());
        assert!(first.renew().report(()).is_continue());
    }

    #[test]
    fn the_default_goes_on() {
        assert!(Progress::default().report("a step").is_continue());
    }
}
