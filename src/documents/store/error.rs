//! Errors of reading and writing documents on disk.

use super::ReadOnly;
use crate::document::{ReadError, WriteError, hint_for_missing};
use std::io;
use std::path::{Path, PathBuf};
use thiserror::Error;
use touchline_core::files::{WrongKind, way_out};

/// Why a document was not opened or not saved.
#[derive(Debug, Error)]
#[non_exhaustive]
pub enum StoreError {
    /// The operating system refused.
    #[error("cannot {action} {}: {source}{}", path.display(), remedy(action, source))]
    Io {
        /// The attempted action, such as "read" or "write".
        action: &'static str,
        /// The file.
        path: PathBuf,
        /// The system's error.
        source: io::Error,
    },
    /// There is nothing at this path.
    #[error(
        "{} does not exist; {}",
        path.display(),
        hint_for_missing(path)
            .unwrap_or("give a project folder, its project.json or a dataset file")
    )]
    NotFound {
        /// The path.
        path: PathBuf,
    },
    /// A relative path, although the working folder no longer exists.
    #[error("cannot find {}: the folder that the program was started in was removed; start it in another one", path.display())]
    NoWorkingFolder {
        /// The path.
        path: PathBuf,
    },
    /// A folder without a project.
    #[error("the folder {} holds no project.json; `touchline new` makes a project", folder.display())]
    NoProject {
        /// The folder.
        folder: PathBuf,
    },
    /// A folder or a device where a file should be.
    #[error("{} is not a file; give a project folder, its project.json or a dataset file", path.display())]
    NotAFile {
        /// The path.
        path: PathBuf,
    },
    /// One of the store's own files is a link, a pipe or a device.
    #[error(transparent)]
    WrongKind(WrongKind),
    /// The document's folder or its journal was moved or deleted while the document was open.
    #[error("{} was moved or deleted while it was open; put it back, or save elsewhere", path.display())]
    Gone {
        /// The folder or the journal.
        path: PathBuf,
    },
    /// The bytes are not a document.
    #[error("{}: {source}{}", path.display(), backup_hint(backup.as_deref()))]
    Read {
        /// The file.
        path: PathBuf,
        /// What is wrong with it.
        source: ReadError,
        /// The backup, if there is one.
        backup: Option<PathBuf>,
    },
    /// The document in memory cannot be serialised.
    #[error("{} was not written: {source}", path.display())]
    Write {
        /// The file.
        path: PathBuf,
        /// Why.
        source: WriteError,
    },
    /// A newer program wrote the journal.
    #[error("{} has version {version}, newer than this program; update touchline to open it", path.display())]
    NewerJournal {
        /// The journal.
        path: PathBuf,
        /// Its version.
        version: u32,
    },
    /// There is a file or folder already.
    #[error("{} exists; give another name, or --force to replace it", path.display())]
    Exists {
        /// The file or folder.
        path: PathBuf,
    },
    /// A file that is no document where a document should be written.
    #[error("{} is no document of touchline and is not replaced; move it away, or give another name", path.display())]
    NotADocument {
        /// The file.
        path: PathBuf,
    },
    /// A document where another file should be written.
    #[error("{} is a document of touchline and is not replaced by another kind of file; give another name", path.display())]
    IsDocument {
        /// The document.
        path: PathBuf,
    },
    /// The document is open in another program, or write-protected.
    #[error("{} is {reason}", path.display())]
    ReadOnly {
        /// The document.
        path: PathBuf,
        /// Why.
        reason: ReadOnly,
    },
    /// Another program changed the file since it was read.
    #[error("{} was changed by another program since it was opened; save under another name, or replace it", path.display())]
    ChangedOutside {
        /// The file.
        path: PathBuf,
    },
    /// Another program changed the file while a command worked on it, and the result cannot be
    /// joined with what it has become.
    #[error("{} was changed by another program meanwhile and stays as it is; the result is in {}", path.display(), beside.display())]
    WrittenBeside {
        /// The file.
        path: PathBuf,
        /// The result.
        beside: PathBuf,
    },
}

impl StoreError {
    /// Converts an error of the system.
    pub(super) fn from_io(action: &'static str, path: &Path, source: io::Error) -> Self {
        // The most telling error first: what is in the place of the file says more than that the
        // call failed, and in a working folder that was removed no relative path leads anywhere.
        if let Some(wrong) = WrongKind::behind(&source) {
            return Self::WrongKind(wrong.clone());
        }
        let path = path.to_path_buf();
        match source.kind() {
            io::ErrorKind::NotFound if path.is_relative() && std::env::current_dir().is_err() => {
                Self::NoWorkingFolder { path }
            }
            io::ErrorKind::NotFound if action == "find" => Self::NotFound { path },
            _ => Self::Io {
                action,
                path,
                source,
            },
        }
    }

    /// Converts the error that a document cannot be serialised for a file.
    pub(super) fn from_write(path: &Path, source: WriteError) -> Self {
        Self::Write {
            path: path.to_path_buf(),
            source,
        }
    }
}

/// What helps after a failure; nothing where reading failed, which saving elsewhere does not mend.
fn remedy(action: &str, source: &io::Error) -> &'static str {
    match action {
        "find" | "read" => "",
        _ => way_out(source),
    }
}

fn backup_hint(backup: Option<&Path>) -> String {
    backup.map_or_else(String::new, |path| {
        format!("; the version before it is {}", path.display())
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    fn denied(action: &'static str) -> String {
        let denied = io::ErrorKind::PermissionDenied.into();
        StoreError::from_io(action, Path::new("/a"), denied).to_string()
    }

    #[test]
    fn only_after_a_failed_write_saving_elsewhere_is_advised() {
        assert_eq!(denied("read"), "cannot read /a: permission denied");
        let advised = "cannot write /a: permission denied; save elsewhere";
        assert_eq!(denied("write"), advised);
    }
}
