//! Files that tests break, and what is said of them.

use std::path::{Path, PathBuf};

/// A file with these bytes.
pub fn new_file(folder: &Path, name: &str, bytes: &[u8]) -> PathBuf {
    let path = folder.join(name);
    std::fs::write(&path, bytes).unwrap();
    path
}

/// The first bytes.
pub fn cut(bytes: &[u8], length: usize) -> Vec<u8> {
    bytes[..length].to_vec()
}

/// What an error says in its one line, behind the file's path.
pub fn behind_path(folder: &Path, name: &str, error: &dyn std::error::Error) -> String {
    let line = error.to_string();
    assert!(!line.contains('\n'));
    let behind = line
        .strip_prefix(&format!("{}: ", folder.join(name).display()))
        .map(ToOwned::to_owned);
    behind.unwrap_or_else(|| panic!("no path in front: {line}"))
}
