//! A change after which many frames are solved again, while it is worked out in the background.

use thiserror::Error;
use touchline_calibration::calibrate::{BulkError, BulkProgress, BulkSolve, BulkSolved};
use touchline_core::geometry::thousands;
use touchline_documents::document::Step;

/// A change of fewer frames than this is made at once: a frame takes 0.1 ms.
pub(super) const IN_BACKGROUND: usize = 200;

/// A change that is being worked out.
#[derive(Debug)]
pub struct BulkWork {
    /// Which one it is: reports say it again.
    pub(super) ticket: u64,
    /// The step of undo that it becomes.
    pub(super) step: Step,
    /// How far it has come; none before it says so.
    pub progress: Option<BulkProgress>,
    /// It is done, and waits for the end of what the person is doing.
    pub(super) done: Option<Box<BulkSolved>>,
}

/// A change to be worked out in the background.
#[derive(Clone, Debug, PartialEq)]
pub struct BulkOrder {
    /// Which one it is: reports say it again.
    pub ticket: u64,
    /// What is to be done.
    pub work: BulkSolve,
}

/// Why a change was not made.
#[derive(Clone, Debug, PartialEq, Error)]
pub enum BulkFailure {
    /// It cannot be made.
    #[error(transparent)]
    Impossible(#[from] BulkError),
    /// The program made a mistake.
    #[error("internal error (please report it): {message}")]
    Panicked {
        /// The words of the panic.
        message: String,
    },
}

impl BulkWork {
    /// What is being done, in one sentence.
    #[must_use]
    pub fn describe(&self) -> String {
        let far = self.progress.map(|progress| {
            format!(": {} of {} frames solved again", thousands(progress.done), thousands(progress.of))
        });
        format!("{}{}…", self.step.name, far.unwrap_or_default())
    }
}
