//! Locks a document, or a folder of results, for writing. A second program can only read it.

use super::{Location, ReadOnly, StoreError, calls, file_id::is_at};
use std::fs::{self, File, TryLockError};
use std::io::{self, Read};
use std::path::PathBuf;

/// Maximum number of attempts, if the previous owner deletes the lock file between opening and
/// locking it. Each further one needs another owner that ends at just that moment.
const ATTEMPTS: usize = 10;

/// An exclusive lock on a lock file. The system releases it when the process ends, even
/// after a crash. Dropping it deletes the file; a killed process leaves the file unlocked.
#[derive(Debug)]
pub struct Lock {
    path: PathBuf,
    file: File,
}

impl Lock {
    /// Whether the lock still protects its document: the lock file was neither moved nor deleted.
    pub(super) fn is_in_place(&self) -> bool {
        is_at(&self.file, &self.path)
    }
}

impl Drop for Lock {
    fn drop(&mut self) {
        // The file is deleted while it is still locked: no other process can lock it in between. On
        // other systems an open file cannot be deleted. A file that stays does no harm.
        if cfg!(unix)
            && self.is_in_place()
            && let Err(error) = fs::remove_file(&self.path)
        {
            log::warn!("{}: {error}", self.path.display());
        }
    }
}

/// Locks a document for writing, or returns the reason why it is read-only.
pub(super) fn lock(location: &Location) -> Result<Lock, ReadOnly> {
    if let Ok(metadata) = location.file().metadata()
        && metadata.permissions().readonly()
    {
        return Err(ReadOnly::NotWritable {
            reason: "the file is write-protected".to_owned(),
        });
    }
    lock_file(location.lock())
}

/// Locks a document for writing.
///
/// # Errors
/// It is read-only.
pub(super) fn lock_or_fail(location: &Location) -> Result<Lock, StoreError> {
    lock(location).map_err(|reason| StoreError::ReadOnly {
        path: location.file().to_path_buf(),
        reason,
    })
}

/// Locks a file that is made for that, such as one in a folder of results. The name of this process
/// is written into it.
///
/// # Errors
/// Another process has the lock, or the file cannot be made.
pub fn lock_file(path: PathBuf) -> Result<Lock, ReadOnly> {
    for _ in 0..ATTEMPTS {
        // The lock is on the open file, not on its name. It counts only if the name still leads to
        // that file once it is locked: otherwise the next process would lock another file.
        let opened = calls::open(&path);
        let mut file = opened.map_err(|error| not_writable(&error))?;
        match file.try_lock() {
            Ok(()) if is_at(&file, &path) => {
                write_holder(&mut file).map_err(|error| not_writable(&error))?;
                return Ok(Lock { path, file });
            }
            // The previous owner deleted the file between opening and locking. Try again.
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

fn not_writable(error: &io::Error) -> ReadOnly {
    ReadOnly::NotWritable {
        reason: error.to_string(),
    }
}

/// Writes the process number into the lock file, so that a second program can name the first.
fn write_holder(file: &mut File) -> io::Result<()> {
    calls::truncate(file, 0)?;
    calls::write_all(file, format!("process {}", std::process::id()).as_bytes())
}

/// Reads the name of the process that has the lock.
fn read_holder(file: &mut File) -> String {
    // What is read is shown to the user, so a limit keeps a foreign file from filling the message.
    let mut text = String::new();
    // On some systems a locked file cannot be read. Then the message names no process.
    let read = file.take(80).read_to_string(&mut text);
    if read.is_ok() && !text.trim().is_empty() {
        text.trim().to_owned()
    } else {
        "another process".to_owned()
    }
}
