//! The dataset to be replaced: which of its files the program wrote.

use crate::exchange::error::ExchangeError;
use crate::exchange::files::cannot_read;
use std::collections::BTreeMap;
use std::fs;
use std::path::{Path, PathBuf};
use touchline_vision::media::sha256_of_file;

/// The file that marks a folder as a dataset; it lists every other file.
pub const MANIFEST: &str = "manifest.sha256";
/// The document of a dataset.
pub const DOCUMENT: &str = "dataset.json";

/// The path for a new folder: the chosen one if it is empty, absent or a dataset, else a folder of
/// this name in it.
pub fn folder_for_new(chosen: &Path, name: &str) -> PathBuf {
    let is_full = fs::read_dir(chosen).is_ok_and(|mut entries| entries.next().is_some());
    let is_dataset = chosen.join(MANIFEST).is_file();
    if is_full && !is_dataset {
        chosen.join(name)
    } else {
        chosen.to_path_buf()
    }
}

/// The files of an earlier dataset with their SHA-256, from its manifest.
#[derive(Default)]
pub struct OldDataset(BTreeMap<String, String>);

impl OldDataset {
    /// Reads the manifest in a folder. An empty or missing folder has no files.
    ///
    /// # Errors
    /// The folder is not empty and not a dataset, or it is a dataset and `force` was not given.
    pub fn read(folder: &Path, force: bool) -> Result<Self, ExchangeError> {
        let is_empty = fs::read_dir(folder).is_ok_and(|mut entries| entries.next().is_none());
        // `symlink_metadata`, because a broken link is something that is there.
        if is_empty || fs::symlink_metadata(folder).is_err() {
            return Ok(Self::default());
        }
        if !folder.join(MANIFEST).is_file() || !folder.join(DOCUMENT).is_file() {
            return Err(ExchangeError::NoDatasetThere {
                path: folder.to_path_buf(),
            });
        }
        if !force {
            return Err(ExchangeError::Exists {
                path: folder.to_path_buf(),
            });
        }
        let path = folder.join(MANIFEST);
        let manifest = fs::read_to_string(&path).map_err(|source| cannot_read(&path, source))?;
        // As `sha256sum` writes it: the hash, two blanks, the name.
        let files = manifest.lines().filter_map(|line| line.split_once("  "));
        Ok(Self(
            files
                .map(|(hash, name)| (name.to_owned(), hash.to_owned()))
                .collect(),
        ))
    }

    /// Whether the program wrote a file and it has not changed since.
    pub fn wrote(&self, name: &str, path: &Path) -> bool {
        self.0
            .get(name)
            .is_some_and(|hash| sha256_of_file(path).is_ok_and(|found| found == *hash))
    }
}
