//! The location of a document.

use super::StoreError;
use super::atomic::{folder_of, with_suffix};
use super::file_id::is_same_file;
use std::fs;
use std::io::ErrorKind;
use std::path::{Path, PathBuf};
pub use touchline_core::files::{PROJECT_FILE, PROJECT_SUFFIX};

/// A document's file, and the folder to which its relative paths refer.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Location {
    file: PathBuf,
}

impl Location {
    /// Finds an existing document: a project folder, its `project.json`, or a dataset file.
    ///
    /// # Errors
    /// The file or folder does not exist, or the folder contains no project.
    pub fn find(path: &Path) -> Result<Self, StoreError> {
        let io = |source| StoreError::from_io("find", path, source);
        let mut file = path.to_path_buf();
        if fs::metadata(path).map_err(io)?.is_dir() {
            file.push(PROJECT_FILE);
            if let Err(error) = fs::metadata(&file) {
                // A folder that may not be searched does not show what it holds.
                return Err(match error.kind() {
                    ErrorKind::NotFound => StoreError::NoProject {
                        folder: path.to_path_buf(),
                    },
                    _ => StoreError::from_io("find", &file, error),
                });
            }
        }
        if !file.is_file() {
            return Err(StoreError::NotAFile { path: file });
        }
        // Journal, history and lock lie beside the real file, by whatever link it was opened.
        Ok(Self {
            file: fs::canonicalize(file).map_err(io)?,
        })
    }

    /// The location of a new document: `project.json` in a folder that exists or that is named with
    /// a final separator, otherwise the file at `path`. Creates the folder.
    ///
    /// # Errors
    /// The document's folder does not exist and cannot be created.
    pub fn for_new_document(path: &Path) -> Result<Self, StoreError> {
        let text = path.to_string_lossy();
        let file = if path.is_dir() || text.ends_with(std::path::is_separator) {
            path.join(PROJECT_FILE)
        } else {
            path.into()
        };
        // The folder is resolved, not the file, which need not exist yet.
        let folder = folder_of(&file);
        fs::create_dir_all(folder)
            .map_err(|source| StoreError::from_io("make the folder", folder, source))?;
        let folder = fs::canonicalize(folder)
            .map_err(|source| StoreError::from_io("find", folder, source))?;
        let Some(name) = file.file_name() else {
            return Err(StoreError::NotAFile { path: file });
        };
        let file = folder.join(name);
        if file.is_symlink() {
            // The document is the target of the link. Its journal lies beside the target, and its
            // relative paths start there.
            let file = fs::canonicalize(&file)
                .map_err(|source| StoreError::from_io("follow the link", &file, source))?;
            return Ok(Self { file });
        }
        Ok(Self { file })
    }

    /// Whether both are the same document, by any path. If so, their lock files are the same file.
    /// Without a lock file, only equal paths are recognised: then no program has the document open.
    pub fn is_same_document(&self, other: &Self) -> bool {
        self.file == other.file || is_same_file(&self.lock(), &other.lock())
    }

    /// The document's file.
    pub fn file(&self) -> &Path {
        &self.file
    }

    /// The folder to which the document's relative paths refer.
    pub fn folder(&self) -> &Path {
        folder_of(&self.file)
    }

    /// Path of the journal: the edits since the document was last written.
    pub fn journal(&self) -> PathBuf {
        with_suffix(&self.file, ".journal")
    }

    /// Path of the history: the steps that can be undone and redone.
    pub fn history(&self) -> PathBuf {
        with_suffix(&self.file, ".history")
    }

    /// Path of the backup: the version before the last write.
    pub fn backup(&self) -> PathBuf {
        with_suffix(&self.file, ".bak")
    }

    /// Path of the lock: a program that has the document open for writing locks this file.
    pub fn lock(&self) -> PathBuf {
        with_suffix(&self.file, ".lock")
    }
}

#[cfg(unix)]
#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_project_that_cannot_be_reached_is_not_called_missing() {
        let folder = tempfile::tempdir().unwrap();
        let file = folder.path().join(PROJECT_FILE);
        // A link to itself leads nowhere, but there is something of that name.
        std::os::unix::fs::symlink(&file, &file).unwrap();
        let refusal = Location::find(folder.path()).unwrap_err();
        assert!(matches!(refusal, StoreError::Io { .. }), "{refusal}");
        fs::remove_file(&file).unwrap();
        let refusal = Location::find(folder.path()).unwrap_err();
        assert!(matches!(refusal, StoreError::NoProject { .. }), "{refusal}");
    }
}
