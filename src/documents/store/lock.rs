//! Locks a document for writing; a second program opens it read-only.

use super::ReadOnly;
use super::{Location, calls, file_id::is_at};
use std::fs::{self, File, TryLockError};
use std::io::{self, Read};
use std::path::PathBuf;

/// How often the lock is tried again when its holder takes the file away in between.
const ATTEMPTS: usize = 10;

/// Held while a document is open for writing; the system frees it when the program ends, however it
/// ends. Its file goes with it, unless the program was killed.
#[derive(Debug)]
pub(super) struct Lock {
    path: PathBuf,
    file: File,
}

impl Lock {
    /// Whether the lock still guards its document: its file was neither moved nor deleted.
    pub(super) fn is_in_place(&self) -> bool {
        is_at(&self.file, &self.path)
    }
}

impl Drop for Lock {
    fn drop(&mut self) {
        // Elsewhere an open file cannot be taken away, and one that stays does no harm.
        if cfg!(unix)
            && self.is_in_place()
            && let Err(error) = fs::remove_file(&self.path)
        {
            log::warn!("{}: {error}", self.path.display());
        }
    }
}

/// Takes the lock of a document, or says why it must stay unwritten.
pub(super) fn lock(location: &Location) -> Result<Lock, ReadOnly> {
    let not_writable = |error: &io::Error| ReadOnly::NotWritable {
        reason: error.to_string(),
    };
    if let Ok(metadata) = location.file().metadata()
        && metadata.permissions().readonly()
    {
        return Err(ReadOnly::NotWritable {
            reason: "the file is write-protected".to_owned(),
        });
    }
    let path = location.lock();
    for _ in 0..ATTEMPTS {
        let opened = calls::open(&path);
        let mut file = opened.map_err(|error| not_writable(&error))?;
        match file.try_lock() {
            Ok(()) if is_at(&file, &path) => {
                write_holder(&mut file).map_err(|error| not_writable(&error))?;
                return Ok(Lock { path, file });
            }
            // The last holder took the file away between opening and locking it.
            Ok(()) => {}
            Err(TryLockError::WouldBlock) => {
                return Err(ReadOnly::OpenElsewhere {
                    holder: read_holder(&mut file),
                });
            }
            Err(TryLockError::Error(error)) => return Err(not_writable(&error)),
        }
    }
    Err(ReadOnly::OpenElsewhere {
        holder: "another process".to_owned(),
    })
}

fn write_holder(file: &mut File) -> io::Result<()> {
    calls::truncate(file, 0)?;
    calls::write_all(file, format!("process {}", std::process::id()).as_bytes())
}

fn read_holder(file: &mut File) -> String {
    let mut text = String::new();
    // On some systems a locked file cannot be read; then the other program is not named.
    let read = file.take(80).read_to_string(&mut text);
    if read.is_ok() && !text.trim().is_empty() {
        text.trim().to_owned()
    } else {
        "another process".to_owned()
    }
}
