//! Real frames for tests, where they are to be had.

use std::path::{Path, PathBuf};

/// The folder of real frames: `TOUCHLINE_DATA`, else `../shared/data` beside the package; says so when it is missing.
pub fn shared_data() -> Option<PathBuf> {
    let folder = std::env::var_os("TOUCHLINE_DATA")
        .map_or_else(|| Path::new(env!("CARGO_MANIFEST_DIR")).join("../shared/data"), PathBuf::from);
    if folder.is_dir() {
        return Some(folder);
    }
    eprintln!("skipped: no real frames at {}", folder.display());
    None
}
