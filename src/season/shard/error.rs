//! Why a shard was not done.

use crate::part::PartError;
use crate::source::SourceError;
use std::io;
use std::path::PathBuf;
use thiserror::Error;
use touchline_calibration::pipelines::LabelMatchError;
use touchline_calibration::proposals::BaseMismatch;
use touchline_core::field::FieldError;
use touchline_documents::document::{ReadError, WriteError};
use touchline_documents::store::StoreError;
use touchline_vision::relocalize::ForestFileError;

/// What to do on a machine of another class than the plan's.
const OTHER_CLASS: &str =
    "bytes would differ; use such a machine, or make the plan again with --any-processor";

/// Why a shard was not done. Nothing was written then.
#[derive(Debug, Error)]
#[non_exhaustive]
pub enum ShardError {
    /// The plan has no shard of this id.
    #[error(
        "{} has no shard {id}; touchline plan --commands writes its shards",
        plan.display()
    )]
    NotInPlan {
        /// The plan.
        plan: PathBuf,
        /// The id.
        id: String,
    },
    /// Another program made the plan.
    #[error(
        "the plan is of {planned}, and this is {here}: bytes would differ; make the plan again"
    )]
    OtherProgram {
        /// The program that made the plan.
        planned: String,
        /// This program.
        here: String,
    },
    /// This machine is of another processor class than the plan.
    #[error(
        "the plan is for machines of class \"{planned}\", this is one of \"{here}\": {OTHER_CLASS}"
    )]
    OtherProcessor {
        /// The plan's class.
        planned: String,
        /// This machine's class.
        here: String,
    },
    /// The frames are not those that were planned.
    #[error("{} changed after the plan was made; make the plan again", path.display())]
    FramesChanged {
        /// The video or folder.
        path: PathBuf,
    },
    /// A project or forest is not the one that was planned.
    #[error("{} changed after the plan was made; make the plan again", path.display())]
    FileChanged {
        /// The project or forest.
        path: PathBuf,
    },
    /// The frames cannot be read.
    #[error(transparent)]
    Source(#[from] SourceError),
    /// A part cannot be used or written.
    #[error(transparent)]
    Part(#[from] PartError),
    /// The project cannot be read.
    #[error(transparent)]
    Store(#[from] StoreError),
    /// The project cannot be hashed.
    #[error(transparent)]
    Write(#[from] WriteError),
    /// The forest cannot be read.
    #[error("cannot read {}: {source}", path.display())]
    ForestIo {
        /// The forest.
        path: PathBuf,
        /// The system's error.
        source: io::Error,
    },
    /// A forest is not one, or is damaged.
    #[error("{what}: {source}")]
    Forest {
        /// The forest.
        what: String,
        /// Why.
        source: ForestFileError,
    },
    /// The cameras in a forest cannot be read.
    #[error("{what}: {source}")]
    ForestCameras {
        /// The forest.
        what: String,
        /// Why.
        source: ReadError,
    },
    /// A forest is of other cameras than the project.
    #[error(transparent)]
    Base(#[from] BaseMismatch),
    /// Cameras could not be searched for.
    #[error(transparent)]
    Label(#[from] LabelMatchError),
    /// The field is not valid.
    #[error(transparent)]
    Field(#[from] FieldError),
    /// `progress` cancelled it.
    #[error("stopped; no part was written")]
    Stopped,
}
