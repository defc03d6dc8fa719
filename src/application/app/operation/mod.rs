//! Slow work beside the window: how an operation is described, started, observed, cancelled, and
//! how its result enters the application.
//!
//! An operation is a value with all inputs of its work. Its way through the program:
//!
//! 1. `App::start` gives it a [`RequestId`], keeps it in the [`Slot`] of its kind and returns it to
//!    the shell as a [`Job`].
//! 2. `jobs` runs the job on a thread of its own. It does not know which operation that is.
//! 3. Progress and result come back as [`Report`]s. A report carries its own types, so it reaches
//!    [`Operation::take_over`] without a cast and without a list of all operations.
//! 4. A report whose request is no longer in its slot is dropped. No operation compares request ids
//!    itself.
//!
//! A request is cancelled by dropping it from its slot. Whatever removes the request (the user
//! stops it, a newer one of the same kind replaces it, another document is opened) therefore also
//! ends its work, without further code.

mod as_it_was;
mod job;
#[cfg(test)]
pub(crate) mod probe;
mod slot;

pub(in crate::app) use as_it_was::AsItWas;
pub use job::{Context, Decoders, Job};
pub use slot::{RequestId, Running, Slot};

use super::App;
use crate::app::window_state::session::Level;
use slot::Cancellation;
use std::fmt::{self, Debug, Display};
use thiserror::Error;

/// One kind of slow work. The value is the input: a copy of what the work needs of the document,
/// because the document may change while the work runs. Documents share their parts, so a copy is
/// cheap.
///
/// All code of an operation is in its own file in `app/operations/`; `Operations` there has a field
/// for its state.
pub trait Operation: Sized + Send + Sync + 'static {
    /// Progress of the work. [`std::convert::Infallible`] if it reports none.
    type Progress: Debug + Send + 'static;
    /// The result of the work.
    type Output: Send + 'static;
    /// Why the work failed. Its text completes a sentence that the operation begins.
    type Error: Display + Send + 'static;

    /// The name of the thread, for debuggers and bug reports.
    const NAME: &'static str;

    /// Does the work, on a thread of its own. It checks `context` regularly for cancellation; the
    /// result of a cancelled request is dropped.
    ///
    /// # Errors
    /// Any error of the operation's own.
    fn run(&self, context: &Context<'_, Self::Progress>) -> Result<Self::Output, Self::Error>;

    /// The slot of the request while it runs. A slot has room for one request: starting another one
    /// cancels the first.
    fn slot(app: &mut App) -> &mut Slot<Self>;

    /// Whether the result must wait, for instance for the end of a drag. Evaluated again after each
    /// action. Meanwhile the request stays in its slot and can still be cancelled.
    fn must_wait(_app: &App) -> bool {
        false
    }

    /// Puts the result into the application. The slot is empty by then, so the operation may be
    /// started again from here.
    fn take_over(&self, app: &mut App, result: Result<Self::Output, Failure<Self::Error>>);
}

/// Why work failed, where no more than the text is read.
pub type WorkError = Box<dyn std::error::Error + Send + Sync>;

/// Why a request has no result.
#[derive(Clone, Debug, PartialEq, Eq, Error)]
pub enum Failure<E> {
    /// The work returned an error.
    #[error("{0}")]
    Failed(E),
    /// The work did not run to its end.
    #[error(transparent)]
    Broken(Breakdown),
}

/// Failures that can happen to any operation.
#[derive(Clone, Debug, PartialEq, Eq, Error)]
pub enum Breakdown {
    /// The work panicked with this message.
    #[error("internal error (please report it): {0}")]
    Panicked(String),
    /// The system could not start a thread, for this reason.
    #[error("the system could not start a thread: {0}")]
    NotStarted(String),
}

impl<E> Failure<E> {
    /// The severity of the message to the user. An error of the work itself is a warning, since its
    /// text usually says what to do.
    pub const fn level(&self) -> Level {
        match self {
            Self::Failed(_) => Level::Warning,
            Self::Broken(_) => Level::Error,
        }
    }
}

/// Progress or result of a request: the value with its type and a function that applies it, so
/// that nothing between the thread and the application needs to know the operation.
pub struct Report {
    id: RequestId,
    name: &'static str,
    apply: Box<Apply>,
}

/// Applies a report to the application, or returns it if it must wait.
type Apply = dyn FnOnce(&mut App) -> Option<Report> + Send;

impl Report {
    /// A report of progress.
    pub fn from_progress<O: Operation>(id: RequestId, progress: O::Progress) -> Self {
        Self {
            id,
            name: O::NAME,
            apply: Box::new(move |app: &mut App| {
                O::slot(app).set_progress(id, progress);
                None
            }),
        }
    }

    /// A report of the result.
    pub fn from_result<O: Operation>(
        id: RequestId,
        result: Result<O::Output, Failure<O::Error>>,
    ) -> Self {
        Self {
            id,
            name: O::NAME,
            apply: Box::new(move |app: &mut App| {
                // Only a request that still runs may wait: the report of a cancelled one is of no
                // use later either.
                if O::slot(app).is_running_as(id) && O::must_wait(app) {
                    return Some(Self::from_result::<O>(id, result));
                }
                // The slot has another request or none if this one was cancelled or replaced, or if
                // its document was closed. Then the result is dropped.
                if let Some(operation) = O::slot(app).finish(id) {
                    operation.take_over(app, result);
                }
                None
            }),
        }
    }

    /// Applies the report, or returns it if it must wait.
    pub(in crate::app) fn apply(self, app: &mut App) -> Option<Self> {
        (self.apply)(app)
    }
}

impl fmt::Debug for Report {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{} {:?}", self.name, self.id)
    }
}

/// Needed to compare actions in tests of the window, which send no reports: a report equals only
/// itself.
impl PartialEq for Report {
    fn eq(&self, other: &Self) -> bool {
        std::ptr::eq(self, other)
    }
}
