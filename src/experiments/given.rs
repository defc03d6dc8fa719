//! Where things lie in a folder that a user gives.

use std::path::{Path, PathBuf};

/// The largest file of given data that is read.
pub const MAX_GIVEN_BYTES: u64 = 256 << 20;

/// The folder itself, else the first one in it by name, that holds what is looked for.
pub fn folder_with(data: &Path, holds: impl Fn(&Path) -> bool) -> Option<PathBuf> {
    if holds(data) {
        return Some(data.to_path_buf());
    }
    let entries = std::fs::read_dir(data).ok()?;
    let mut folders: Vec<PathBuf> = entries
        .flatten()
        .map(|entry| entry.path())
        .filter(|path| path.is_dir())
        .collect();
    folders.sort();
    folders.into_iter().find(|folder| holds(folder))
}
