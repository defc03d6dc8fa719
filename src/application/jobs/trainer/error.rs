//! Why the trainer has no forest.

use super::kept_forest::KeptForestError;
use thiserror::Error;
use touchline_calibration::pipelines::LearnForestError;

/// Why there is no forest of an earlier session, or cannot be a new one.
#[derive(Debug, Error)]
pub(super) enum TrainerError {
    /// The forest of an earlier session is of no use.
    #[error("The stored forest is trained again: {0}")]
    Kept(#[from] KeptForestError),
    /// It cannot be trained.
    #[error(transparent)]
    Learn(#[from] LearnForestError),
}
