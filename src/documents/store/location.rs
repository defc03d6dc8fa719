//! Where a document lies.

use super::StoreError;
use super::atomic::{folder_of, with_suffix};
use super::file_id::is_same_file;
use std::fs;
use std::path::{Path, PathBuf};
pub use touchline_core::files::{PROJECT_FILE, PROJECT_SUFFIX};

/// Where a document lies: a file, and the folder that its relative paths start from.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Location {
    file: PathBuf,
}

impl Location {
    /// Finds an existing document: a project folder, its `project.json`, or a dataset file.
    ///
    /// # Errors
    /// There is no such file or folder, or the folder holds no project.
    pub fn find(path: &Path) -> Result<Self, StoreError> {
        let io = |source| StoreError::from_io("find", path, source);
        let mut file = path.to_path_buf();
        if fs::metadata(path).map_err(io)?.is_dir() {
            file.push(PROJECT_FILE);
            if !file.exists() {
                return Err(StoreError::NoProject {
                    folder: path.to_path_buf(),
                });
            }
        }
        if !file.is_file() {
            return Err(StoreError::NotAFile { path: file });
        }
        Ok(Self {
            file: fs::canonicalize(file).map_err(io)?,
        })
    }

    /// Where a new document is to lie: in a folder that exists or is named with a final separator
    /// as `project.json`, else in the file. The folder is made.
    ///
    /// # Errors
    /// The folder that is to hold it does not exist and cannot be made.
    pub fn for_new_document(path: &Path) -> Result<Self, StoreError> {
        let text = path.to_string_lossy();
        let file = if path.is_dir() || text.ends_with(std::path::is_separator) {
            path.join(PROJECT_FILE)
        } else {
            path.into()
        };
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
            // The document behind a link keeps its journal and its relative paths where it is
            // found.
            let file = fs::canonicalize(&file)
                .map_err(|source| StoreError::from_io("follow the link", &file, source))?;
            return Ok(Self { file });
        }
        Ok(Self { file })
    }

    /// Whether both are one document, by whatever path: then they share a lock.
    #[must_use]
    pub fn is_same_document(&self, other: &Self) -> bool {
        self.file == other.file || is_same_file(&self.lock(), &other.lock())
    }

    /// The document's file.
    #[must_use]
    pub fn file(&self) -> &Path {
        &self.file
    }

    /// The folder that the document's relative paths start from.
    #[must_use]
    pub fn folder(&self) -> &Path {
        folder_of(&self.file)
    }

    /// What people call the document: the folder's name for a project, else the file's.
    #[must_use]
    pub fn name(&self) -> String {
        let name = self.file.file_name().unwrap_or_default();
        let name = if name == PROJECT_FILE {
            self.folder().file_name().unwrap_or(name)
        } else {
            name
        };
        name.to_string_lossy().into_owned()
    }

    /// The journal beside the document.
    #[must_use]
    pub fn journal(&self) -> PathBuf {
        with_suffix(&self.file, ".journal")
    }

    /// The steps beside the document that can be undone and redone.
    #[must_use]
    pub fn history(&self) -> PathBuf {
        with_suffix(&self.file, ".history")
    }

    /// The last version of the document.
    #[must_use]
    pub fn backup(&self) -> PathBuf {
        with_suffix(&self.file, ".bak")
    }

    /// The file that says that somebody has the document open.
    #[must_use]
    pub fn lock(&self) -> PathBuf {
        with_suffix(&self.file, ".lock")
    }
}
