//! The dataset that another one replaces: which of its files the program wrote.

use crate::exchange::error::ExchangeError;
use std::collections::BTreeMap;
use std::fs;
use std::path::{Path, PathBuf};
use touchline_vision::media::sha256_of_file;

/// What marks a folder as a dataset; every other file stands in it.
pub const MANIFEST: &str = "manifest.sha256";
/// The document of a dataset.
pub const DOCUMENT: &str = "dataset.json";

/// Where a new folder of this name is written: in place of the chosen one if that is empty or
/// absent or holds a dataset, else in it.
#[must_use]
pub fn folder_for_new(chosen: &Path, name: &str) -> PathBuf {
    let is_full = fs::read_dir(chosen).is_ok_and(|mut entries| entries.next().is_some());
    let is_dataset = chosen.join(MANIFEST).is_file();
    if is_full && !is_dataset {
        chosen.join(name)
    } else {
        chosen.to_path_buf()
    }
}

/// The files of an earlier dataset with their SHA-256, as its manifest lists them.
#[derive(Default)]
pub struct OldDataset(BTreeMap<String, String>);

impl OldDataset {
    /// Reads the manifest in a folder. An empty or missing folder holds no file.
    ///
    /// # Errors
    /// The folder holds something other than a dataset, or a dataset and `force` was not given.
    pub fn read(folder: &Path, force: bool) -> Result<Self, ExchangeError> {
        let is_empty = fs::read_dir(folder).is_ok_and(|mut entries| entries.next().is_none());
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
        let failed = |source| ExchangeError::Read {
            path: folder.join(MANIFEST),
            source,
        };
        let manifest = fs::read_to_string(folder.join(MANIFEST)).map_err(failed)?;
        let files = manifest.lines().filter_map(|line| line.split_once("  "));
        Ok(Self(
            files
                .map(|(hash, name)| (name.to_owned(), hash.to_owned()))
                .collect(),
        ))
    }

    /// Whether the program wrote a file, and nobody changed it since.
    pub fn wrote(&self, name: &str, path: &Path) -> bool {
        self.0
            .get(name)
            .is_some_and(|hash| sha256_of_file(path).is_ok_and(|found| found == *hash))
    }
}
