//! The calls by which the store changes the disk: each passes one place, where its tests let it
//! fail.

use std::fs::{self, File, OpenOptions};
use std::io::{self, Seek as _, SeekFrom, Write as _};
use std::path::Path;
use tempfile::NamedTempFile;
use touchline_core::files::{open_regular, temporary_file_in};

/// Carries a call out; in the store's tests it may fail instead.
fn tried<T>(call: impl FnOnce() -> io::Result<T>) -> io::Result<T> {
    #[cfg(test)]
    {
        super::faults::tried(call)
    }
    #[cfg(not(test))]
    {
        call()
    }
}

/// Carries out a call that flushes what is at a path; in the store's tests it is noted what
/// outlives a power cut.
fn flushed(path: &Path, call: impl FnOnce() -> io::Result<()>) -> io::Result<()> {
    tried(call)?;
    #[cfg(test)]
    super::faults::note_flushed(path);
    #[cfg(not(test))]
    let _ = path;
    Ok(())
}

/// Opens one of the store's own files for reading and writing, or makes it.
pub(super) fn open(path: &Path) -> io::Result<File> {
    tried(|| open_regular(path, OpenOptions::new().read(true).write(true).create(true)))
}

/// Makes a file where there is none; a link that somebody put there meanwhile is not followed.
pub(super) fn make_new(path: &Path) -> io::Result<File> {
    tried(|| OpenOptions::new().write(true).create_new(true).open(path))
}

/// Makes a temporary file in a folder.
pub(super) fn temporary_in(folder: &Path) -> io::Result<NamedTempFile> {
    tried(|| temporary_file_in(folder))
}

/// Cuts a file off, and goes to its end.
pub(super) fn truncate(file: &mut File, bytes: u64) -> io::Result<()> {
    tried(|| file.set_len(bytes))?;
    file.seek(SeekFrom::Start(bytes)).map(drop)
}

/// Writes all of some bytes.
pub(super) fn write_all(file: &mut File, bytes: &[u8]) -> io::Result<()> {
    // In tests it may break off in the middle.
    let half = if cfg!(test) { bytes.len() / 2 } else { 0 };
    if half > 0 {
        tried(|| file.write_all(&bytes[..half]))?;
    }
    tried(|| file.write_all(&bytes[half..]))
}

/// Flushes a file to disk.
pub(super) fn flush(file: &File, path: &Path) -> io::Result<()> {
    flushed(path, || file.sync_all())
}

/// Flushes what a file holds to disk.
pub(super) fn flush_data(file: &File, path: &Path) -> io::Result<()> {
    flushed(path, || file.sync_data())
}

/// Flushes a folder's entries; only Unix can.
pub(super) fn flush_folder(folder: &Path) -> io::Result<()> {
    flushed(folder, || {
        if cfg!(unix) {
            File::open(folder)?.sync_all()
        } else {
            Ok(())
        }
    })
}

/// Gives a temporary file its name, in the place of what is there or only where nothing is.
pub(super) fn persist(file: NamedTempFile, path: &Path, replace: bool) -> io::Result<()> {
    let persist = || {
        if replace {
            return file.persist(path).map(drop);
        }
        // Some file systems cannot rename without replacing.
        file.persist_noclobber(path)
            .map(drop)
            .or_else(|refused| match refused.error.kind() {
                io::ErrorKind::AlreadyExists => Err(refused),
                _ => refused.file.persist(path).map(drop),
            })
    };
    tried(|| persist().map_err(|refused| refused.error))
}

/// Renames a file.
pub(super) fn rename(from: &Path, to: &Path) -> io::Result<()> {
    tried(|| fs::rename(from, to))
}

/// Gives a file a second name.
pub(super) fn link(path: &Path, second: &Path) -> io::Result<()> {
    tried(|| fs::hard_link(path, second))
}

/// Takes a file away.
pub(super) fn remove(path: &Path) -> io::Result<()> {
    tried(|| fs::remove_file(path))
}
