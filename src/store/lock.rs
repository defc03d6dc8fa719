//! One program writes a document; a second one is told.

use super::Location;
use std::fs::{self, File, OpenOptions, TryLockError};
use std::io::{self, Read, Seek, SeekFrom, Write};
use std::path::{Path, PathBuf};

/// How often the lock is tried again when its holder takes the file away in between.
const ATTEMPTS: usize = 10;

/// Held while a document is open for writing; the system frees it when the program ends, however it ends. Its file goes
/// with it, unless the program was killed.
#[derive(Debug)]
pub(super) struct Lock {
    path: PathBuf,
    _file: File,
}

impl Drop for Lock {
    fn drop(&mut self) {
        // Elsewhere an open file cannot be taken away, and one that stays does no harm.
        if cfg!(unix)
            && let Err(error) = fs::remove_file(&self.path)
        {
            log::warn!("{}: {error}", self.path.display());
        }
    }
}

/// Why a document opens read-only.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum ReadOnly {
    /// Another program has it open.
    OpenElsewhere {
        /// Who, as far as it can be known: "process 4711".
        holder: String,
    },
    /// The file or its folder must not be written.
    NotWritable {
        /// What the system says.
        reason: String,
    },
}

impl std::fmt::Display for ReadOnly {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        match self {
            Self::OpenElsewhere { holder } => {
                write!(f, "open in another touchline ({holder}); close it there to edit here")
            }
            Self::NotWritable { reason } => write!(f, "not writable ({reason}); save a copy elsewhere to edit"),
        }
    }
}

/// Takes the lock of a document, or says why it must stay unwritten.
pub(super) fn lock(location: &Location) -> Result<Lock, ReadOnly> {
    let not_writable = |error: &io::Error| ReadOnly::NotWritable { reason: error.to_string() };
    if let Ok(metadata) = location.file().metadata()
        && metadata.permissions().readonly()
    {
        return Err(ReadOnly::NotWritable { reason: "the file is write-protected".to_owned() });
    }
    let path = location.lock();
    for _ in 0..ATTEMPTS {
        let options = OpenOptions::new().read(true).write(true).create(true).truncate(false).open(&path);
        let mut file = options.map_err(|error| not_writable(&error))?;
        match file.try_lock() {
            Ok(()) if is_at(&file, &path) => {
                write_holder(&mut file).map_err(|error| not_writable(&error))?;
                return Ok(Lock { path, _file: file });
            }
            // The last holder took the file away between opening and locking it.
            Ok(()) => {}
            Err(TryLockError::WouldBlock) => return Err(ReadOnly::OpenElsewhere { holder: read_holder(&mut file) }),
            Err(TryLockError::Error(error)) => return Err(not_writable(&error)),
        }
    }
    Err(ReadOnly::OpenElsewhere { holder: "another process".to_owned() })
}

/// Whether the open file is still the one at this path.
#[cfg(unix)]
fn is_at(file: &File, path: &Path) -> bool {
    use std::os::unix::fs::MetadataExt;
    let id = |metadata: &fs::Metadata| (metadata.dev(), metadata.ino());
    matches!((file.metadata(), fs::metadata(path)), (Ok(open), Ok(there)) if id(&open) == id(&there))
}

/// Whether the open file is still the one at this path: an open file cannot be taken away here.
#[cfg(not(unix))]
fn is_at(_file: &File, _path: &Path) -> bool {
    true
}

fn write_holder(file: &mut File) -> io::Result<()> {
    file.set_len(0)?;
    file.seek(SeekFrom::Start(0))?;
    write!(file, "process {}", std::process::id())
}

fn read_holder(file: &mut File) -> String {
    let mut text = String::new();
    // Some systems let nobody read a locked file; then nobody is named.
    let read = file.take(80).read_to_string(&mut text);
    if read.is_ok() && !text.trim().is_empty() { text.trim().to_owned() } else { "another process".to_owned() }
}
