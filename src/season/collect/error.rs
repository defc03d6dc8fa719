//! Why parts were not collected.

use std::io;
use std::path::{Path, PathBuf};
use thiserror::Error;
use touchline_core::files::way_out;
use touchline_documents::store::StoreError;

/// Why parts were not collected.
#[derive(Debug, Error)]
#[non_exhaustive]
pub enum CollectError {
    /// The system refused.
    #[error("cannot {action} {}: {source}{}", path.display(), way_out(source))]
    Io {
        /// The attempted action.
        action: &'static str,
        /// The file or folder.
        path: PathBuf,
        /// The system's error.
        source: io::Error,
    },
    /// There is no folder of parts.
    #[error("there is no folder {}; do the shards of the plan first, with this folder as their -o", parts.display())]
    NoParts {
        /// The folder of parts.
        parts: PathBuf,
    },
    /// The output is a file.
    #[error("{} is a file; give a folder for the season", output.display())]
    NotAFolder {
        /// The output.
        output: PathBuf,
    },
    /// The output holds other things.
    #[error("{} holds other things than a collected season; give another -o", output.display())]
    OtherFolder {
        /// The output.
        output: PathBuf,
    },
    /// A file there has the name of one that is to be written, and is not as it was written.
    #[error(
        "{} is not as touchline collect wrote it and would be replaced; move it away or give another -o",
        path.display()
    )]
    OtherFile {
        /// The file.
        path: PathBuf,
    },
    /// Another process collects into the same folder.
    #[error(
        "another touchline collects into {} ({holder}); wait until it has ended",
        output.display()
    )]
    Busy {
        /// The output.
        output: PathBuf,
        /// The process, if known.
        holder: String,
    },
    /// The output cannot be written into.
    #[error("cannot write into {}: {reason}", output.display())]
    NotWritable {
        /// The output.
        output: PathBuf,
        /// The system's reason.
        reason: String,
    },
    /// A project cannot be read or written.
    #[error(transparent)]
    Store(#[from] StoreError),
    /// The progress cancelled it.
    #[error("stopped; the projects of some matches are not collected, and the queue is as it was")]
    Stopped,
}

impl CollectError {
    pub(super) fn from_io(action: &'static str, path: &Path, source: io::Error) -> Self {
        Self::Io {
            action,
            path: path.to_path_buf(),
            source,
        }
    }
}
