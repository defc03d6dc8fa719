//! Slow work beside the window: how an operation is described, started, followed, cancelled and
//! taken over.
//!
//! An operation is a value that holds all that its work needs. Its way through the program:
//!
//! 1. `App::start` gives it a [`RequestId`], keeps it in the [`Slot`] of its kind and returns it to
//!    the shell as a [`Job`].
//! 2. `jobs` runs the job on a thread of its own. It does not know which operation that is.
//! 3. What the work has to say comes back as [`Report`]s. A report carries its own types, so that
//!    it reaches [`Operation::take_over`] without a cast and without a list of all operations.
//! 4. A report whose request is no longer in its slot is dropped. No operation compares request ids
//!    itself.
//!
//! A request is cancelled by dropping it from its slot. Whatever makes the application forget a
//! request (the user stops it, a newer one of the same kind replaces it, another document is
//! opened) therefore also ends its work; nobody has to remember to.

mod job;
#[cfg(test)]
pub(crate) mod probe;
mod report;
mod slot;

pub use job::{Context, Decoders, Job};
pub use report::Report;
pub use slot::{RequestId, Running, Slot};

use slot::Cancellation;

use super::App;
use super::session::Level;
use std::fmt::{Debug, Display};
use thiserror::Error;

/// One kind of slow work. The value is the input: what the work needs of the document is copied
/// into it (documents share their parts, so that a copy is cheap), because the document goes on
/// changing while the work runs.
///
/// Everything about an operation stands in its own file below `app/operations/`; `Operations` there
/// has a field for its state.
pub trait Operation: Sized + Send + Sync + 'static {
    /// How far the work has come. [`std::convert::Infallible`] where it does not say.
    type Progress: Debug + Send + 'static;
    /// What the work gives.
    type Output: Send + 'static;
    /// Why the work gives nothing. Its text completes a sentence that the operation begins.
    type Error: Display + Send + 'static;

    /// The name of the thread, for debuggers and bug reports.
    const NAME: &'static str;

    /// Does the work, on a thread of its own. It asks `context` often enough whether it is
    /// cancelled; what it returns then is dropped.
    ///
    /// # Errors
    /// Whatever the operation says.
    fn run(&self, context: &Context<'_, Self::Progress>) -> Result<Self::Output, Self::Error>;

    /// Where the request is kept while it runs. One slot holds one request: starting another
    /// cancels the first.
    fn slot(app: &mut App) -> &mut Slot<Self>;

    /// Whether the result has to wait, as for the end of a drag. Asked again after each action;
    /// meanwhile the request stays in its slot and can still be cancelled.
    fn must_wait(_app: &App) -> bool {
        false
    }

    /// Takes the result into the application. By now the slot is empty, so that the operation may
    /// be started again.
    fn take_over(&self, app: &mut App, result: Result<Self::Output, Failure<Self::Error>>);
}

/// Why a request has no output.
#[derive(Clone, Debug, PartialEq, Eq, Error)]
pub enum Failure<E> {
    /// The work ended with an error of its own.
    #[error("{0}")]
    Failed(E),
    /// The work broke down.
    #[error(transparent)]
    Broken(Breakdown),
}

/// How work can break down, whichever it is.
#[derive(Clone, Debug, PartialEq, Eq, Error)]
pub enum Breakdown {
    /// It panicked with this message.
    #[error("internal error (please report it): {0}")]
    Panicked(String),
    /// The system gave no thread, for this reason.
    #[error("the system could not start a thread: {0}")]
    NotStarted(String),
}

impl<E> Failure<E> {
    /// How loudly the user is told: an error of the work itself is a warning, since it usually says
    /// what to do instead.
    #[must_use]
    pub const fn level(&self) -> Level {
        match self {
            Self::Failed(_) => Level::Warning,
            Self::Broken(_) => Level::Error,
        }
    }
}
