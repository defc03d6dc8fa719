//! The system calls by which the store changes the disk. Each goes through [`try_call`], where the
//! fault tests let it fail.

use std::fs::{self, File, OpenOptions};
use std::io::{self, Seek as _, SeekFrom, Write as _};
use std::path::Path;
use tempfile::{NamedTempFile, PersistError, TempPath};
use touchline_core::files::{open_regular, temporary_file_in, temporary_link_to};

/// Makes a call. In the store's tests it may fail instead.
fn try_call<T>(call: impl FnOnce() -> io::Result<T>) -> io::Result<T> {
    #[cfg(test)]
    {
        super::faults::try_call(call)
    }
    #[cfg(not(test))]
    {
        call()
    }
}

/// Makes a call that flushes the file or folder at a path. In the store's tests, what is flushed
/// survives a simulated power cut, and nothing else does.
fn try_flush(path: &Path, call: impl FnOnce() -> io::Result<()>) -> io::Result<()> {
    try_call(call)?;
    #[cfg(test)]
    super::faults::note_flushed(path);
    #[cfg(not(test))]
    let _ = path;
    Ok(())
}

/// Opens one of the store's own files for reading and writing, or creates it.
pub(super) fn open(path: &Path) -> io::Result<File> {
    try_call(|| open_regular(path, OpenOptions::new().read(true).write(true).create(true)))
}

/// Creates a temporary file in a folder.
pub(super) fn temporary_in(folder: &Path) -> io::Result<NamedTempFile> {
    try_call(|| temporary_file_in(folder))
}

/// Truncates a file and moves to its end.
pub(super) fn truncate(file: &mut File, bytes: u64) -> io::Result<()> {
    try_call(|| file.set_len(bytes))?;
    file.seek(SeekFrom::Start(bytes)).map(drop)
}

/// Writes all bytes.
pub(super) fn write_all(file: &mut File, bytes: &[u8]) -> io::Result<()> {
    // In tests, two calls: a fault may come after half of the bytes.
    let half = if cfg!(test) { bytes.len() / 2 } else { 0 };
    if half > 0 {
        try_call(|| file.write_all(&bytes[..half]))?;
    }
    try_call(|| file.write_all(&bytes[half..]))
}

/// Flushes a file's content and metadata to disk.
pub(super) fn flush(file: &File, path: &Path) -> io::Result<()> {
    try_flush(path, || file.sync_all())
}

/// Flushes a file's content to disk, without metadata that reading does not need, such as times.
pub(super) fn flush_data(file: &File, path: &Path) -> io::Result<()> {
    try_flush(path, || file.sync_data())
}

/// Flushes a folder's entries: only then a new name or a rename survives a power cut. Does nothing
/// on systems other than Unix, which cannot.
pub(super) fn flush_folder(folder: &Path) -> io::Result<()> {
    try_flush(folder, || {
        if cfg!(unix) {
            File::open(folder)?.sync_all()
        } else {
            Ok(())
        }
    })
}

/// Renames a temporary file to its final name, with or without replacing a file of that name.
pub(super) fn persist(file: NamedTempFile, path: &Path, replace: bool) -> io::Result<()> {
    try_call(|| {
        let persisted = if replace {
            file.persist(path)
        } else {
            persist_new(file, path)
        };
        persisted.map(drop).map_err(|refused| refused.error)
    })
}

/// Renames a temporary file to a name that is not in use. Not all file systems can rename without
/// replacing; there a file of that name is replaced.
fn persist_new(file: NamedTempFile, path: &Path) -> Result<File, PersistError> {
    file.persist_noclobber(path)
        .or_else(|refused| match refused.error.kind() {
            io::ErrorKind::AlreadyExists => Err(refused),
            _ => refused.file.persist(path),
        })
}

/// Renames a file.
pub(super) fn rename(from: &Path, to: &Path) -> io::Result<()> {
    try_call(|| fs::rename(from, to))
}

/// Gives a file a second, temporary name in its folder.
pub(super) fn link_temporarily(path: &Path) -> io::Result<TempPath> {
    try_call(|| temporary_link_to(path))
}

/// Renames a temporary name to a final one, in place of a file that has it.
pub(super) fn persist_name(name: TempPath, path: &Path) -> io::Result<()> {
    try_call(|| name.persist(path).map_err(|refused| refused.error))
}

/// Deletes a file.
pub(super) fn remove(path: &Path) -> io::Result<()> {
    try_call(|| fs::remove_file(path))
}
