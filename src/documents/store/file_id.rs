//! The identity of files, by which a file in its place differs from one that was moved or replaced.

#[cfg(unix)]
use std::fs::Metadata;
use std::fs::{self, File};
use std::path::Path;

/// Whether the open file is still the one at this path. A link at the path is another file.
#[cfg(unix)]
pub(super) fn is_at(file: &File, path: &Path) -> bool {
    matches!((file.metadata(), fs::symlink_metadata(path)), (Ok(open), Ok(there)) if id(&open) == id(&there))
}

/// Whether there is a file at this path. The identity of files is not compared on this system.
#[cfg(not(unix))]
pub(super) fn is_at(_file: &File, path: &Path) -> bool {
    fs::symlink_metadata(path).is_ok()
}

/// Whether two paths lead to the same file. They may differ if a folder is mounted twice.
#[cfg(unix)]
pub(super) fn is_same_file(a: &Path, b: &Path) -> bool {
    matches!((fs::metadata(a), fs::metadata(b)), (Ok(a), Ok(b)) if id(&a) == id(&b))
}

/// Whether two paths lead to the same file.
#[cfg(not(unix))]
pub(super) fn is_same_file(a: &Path, b: &Path) -> bool {
    matches!((fs::canonicalize(a), fs::canonicalize(b)), (Ok(a), Ok(b)) if a == b)
}

/// Device and inode, which identify a file as long as it is open: no other file gets its inode
/// before it is closed.
#[cfg(unix)]
fn id(metadata: &Metadata) -> (u64, u64) {
    use std::os::unix::fs::MetadataExt;
    (metadata.dev(), metadata.ino())
}
