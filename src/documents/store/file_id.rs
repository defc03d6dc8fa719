//! Which file a path leads to: what tells a file that is still in its place from one that was moved
//! or replaced.

#[cfg(unix)]
use std::fs::Metadata;
use std::fs::{self, File};
use std::path::Path;

/// Whether the open file is still the one at this path; a link there is another file.
#[cfg(unix)]
pub(super) fn is_at(file: &File, path: &Path) -> bool {
    matches!((file.metadata(), fs::symlink_metadata(path)), (Ok(open), Ok(there)) if id(&open) == id(&there))
}

/// Whether the open file is still the one at this path, as far as the system lets it be known.
#[cfg(not(unix))]
pub(super) fn is_at(_file: &File, path: &Path) -> bool {
    fs::symlink_metadata(path).is_ok()
}

/// Whether two paths lead to one file, as a folder that is mounted twice makes possible.
#[cfg(unix)]
pub(super) fn is_same_file(a: &Path, b: &Path) -> bool {
    matches!((fs::metadata(a), fs::metadata(b)), (Ok(a), Ok(b)) if id(&a) == id(&b))
}

/// Whether two paths lead to one file.
#[cfg(not(unix))]
pub(super) fn is_same_file(a: &Path, b: &Path) -> bool {
    matches!((fs::canonicalize(a), fs::canonicalize(b)), (Ok(a), Ok(b)) if a == b)
}

#[cfg(unix)]
fn id(metadata: &Metadata) -> (u64, u64) {
    use std::os::unix::fs::MetadataExt;
    (metadata.dev(), metadata.ino())
}
