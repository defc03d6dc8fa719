//! Finding data in a folder that the user gives.

use std::path::{Path, PathBuf};

/// Maximum size of a data file, bytes.
pub const MAX_GIVEN_BYTES: u64 = 256 << 20;

/// The folder itself, or its first subfolder by name, for which `holds` is true.
pub fn folder_with(data: &Path, holds: impl Fn(&Path) -> bool) -> Option<PathBuf> {
    if holds(data) {
        return Some(data.to_path_buf());
    }
    // A folder that cannot be read has nothing for an experiment; the message then says what is
    // missing.
    let entries = std::fs::read_dir(data).ok()?;
    let mut folders: Vec<PathBuf> = entries
        .flatten()
        .map(|entry| entry.path())
        .filter(|path| path.is_dir())
        .collect();
    // The order of a folder's entries is the file system's.
    folders.sort();
    folders.into_iter().find(|folder| holds(folder))
}
