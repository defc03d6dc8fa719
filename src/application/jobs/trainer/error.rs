//! Errors of recalling and training a forest.

use super::kept_forest::KeptForestError;
use thiserror::Error;
use touchline_calibration::pipelines::LearnForestError;

/// Why no forest of an earlier run can be used, or no new one can be trained.
#[derive(Debug, Error)]
pub(super) enum TrainerError {
    /// The stored forest cannot be used.
    #[error("The stored forest is trained again: {0}")]
    Kept(#[from] KeptForestError),
    /// No forest can be trained.
    #[error(transparent)]
    Learn(#[from] LearnForestError),
}
