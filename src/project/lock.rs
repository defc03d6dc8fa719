//! One program writes a document; a second one is told.

use super::Location;
use std::fs::{File, OpenOptions, TryLockError};
use std::io::{self, Read, Seek, SeekFrom, Write};

/// Held while a document is open for writing; the system frees it when the program ends, however it ends.
#[derive(Debug)]
pub(super) struct Lock {
    _file: File,
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
    let options = OpenOptions::new().read(true).write(true).create(true).truncate(false).open(location.lock());
    let mut file = options.map_err(|error| not_writable(&error))?;
    match file.try_lock() {
        Ok(()) => {
            write_holder(&mut file).map_err(|error| not_writable(&error))?;
            Ok(Lock { _file: file })
        }
        Err(TryLockError::WouldBlock) => Err(ReadOnly::OpenElsewhere { holder: read_holder(&mut file) }),
        Err(TryLockError::Error(error)) => Err(not_writable(&error)),
    }
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
