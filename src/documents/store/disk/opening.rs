//! Opening a document for writing, or only reading it, with the edits of its journal.

use super::Store;
use super::contents::{Contents, Damage, Steps, read_contents};
use super::recovery::Recovery;
use super::unopened::FilesRead;
use crate::document::{Document, History};
use crate::store::atomic::{copy_aside, set_aside};
use crate::store::journal::Journal;
use crate::store::lock::lock;
use crate::store::{Location, ReadOnly, StoreError};
use std::path::Path;
use touchline_core::files::remove_stray_files;

/// An opened document.
#[derive(Debug)]
pub struct Opened {
    /// The document's location.
    pub location: Location,
    /// The document, including the edits of its journal.
    pub document: Document,
    /// The steps of earlier sessions that can be undone and redone; empty if the document is
    /// read-only.
    pub history: History<Document>,
    /// The store to write it with, or the reason why it is read-only.
    pub access: Access,
    /// What was recovered from the journal.
    pub recovery: Recovery,
}

/// Whether an opened document may be written.
#[derive(Debug)]
#[allow(
    clippy::large_enum_variant,
    reason = "there is one for each document that is open"
)]
pub enum Access {
    /// This program has the lock and may write it.
    Writable(Store),
    /// This program may only read it.
    ReadOnly(ReadOnly),
}

/// Opens a document for writing, or read-only if it is open in another program or write-protected.
///
/// # Errors
/// There is no document, it cannot be read, or its content is not a document.
pub fn open(path: &Path) -> Result<Opened, StoreError> {
    let location = Location::find(path)?;
    let lock = match lock(&location) {
        Ok(lock) => lock,
        // Read-only, nothing can be undone, so that the steps need not be read.
        Err(reason) => {
            let Contents {
                document, recovery, ..
            } = read_contents(&location, Steps::Ignored)?;
            let history = History::default();
            return Ok(Opened {
                location,
                document,
                history,
                access: Access::ReadOnly(reason),
                recovery,
            });
        }
    };
    // Read under the lock: no other instance can write between this and the first own write.
    let contents = read_contents(&location, Steps::Wanted)?;
    let Contents {
        document,
        history,
        written,
        hash,
        mut recovery,
        whole_bytes,
        damage,
        ..
    } = contents;
    remove_stray_files(location.folder());
    let path = location.journal();
    let io = |source| StoreError::from_io("write", &path, source);
    // A journal of another document is moved away and a new one begun. A damaged one is copied,
    // because its whole lines stay in use.
    if recovery.foreign_edits > 0 {
        recovery.set_aside = Some(set_aside(&path, &path, "orphan").map_err(io)?);
    } else if damage != Damage::None {
        recovery.set_aside = Some(copy_aside(&path, "damaged").map_err(io)?);
    }
    let journal = Journal::open(&path, whole_bytes).map_err(io)?;
    let written = Some((written, hash.clone()));
    let mut store = Store::begun(location.clone(), journal, written, lock);
    // If an edit does not apply, write the recovered document whole, so that the journal starts
    // from it. If nothing was recovered, start the journal from the file. Otherwise keep appending
    // to it.
    if damage == Damage::Misfit {
        let on_disk = store.hash_on_disk()?;
        store.write(&document, Some(&history), on_disk.as_ref())?;
    } else if recovery.edits.is_empty() {
        store.journal.restart(&hash).map_err(io)?;
    } else {
        store.behind = true;
    }
    Ok(Opened {
        location,
        document,
        history,
        access: Access::Writable(store),
        recovery,
    })
}

/// Reads a document including the edits of its journal. Writes nothing.
///
/// # Errors
/// There is no document, it cannot be read, or its content is not a document.
pub fn read(path: &Path) -> Result<(Location, Document, Recovery), StoreError> {
    let (location, document, recovery, _) = read_with_state(path)?;
    Ok((location, document, recovery))
}

/// Reads a document as [`read`] does, and what its files held, for a later
/// [`FilesRead::write_back`].
///
/// # Errors
/// As [`read`].
pub fn read_with_state(
    path: &Path,
) -> Result<(Location, Document, Recovery, FilesRead), StoreError> {
    let location = Location::find(path)?;
    let Contents {
        document,
        recovery,
        hash,
        journal,
        ..
    } = read_contents(&location, Steps::Ignored)?;
    let is_journal_in_document =
        recovery.foreign_edits == 0 && recovery.misfit.is_none() && recovery.lost_bytes == 0;
    let files = FilesRead {
        hash,
        journal,
        is_journal_in_document,
    };
    Ok((location, document, recovery, files))
}
