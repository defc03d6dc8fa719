//! A document on disk: opening with recovery from the journal, journaling of each edit, and atomic
//! writes of the whole document.
//!
//! A document is a file with companions beside it: `.journal` (edits since the last whole write),
//! `.history` (steps to undo and redo), `.bak` (the version before) and `.lock`. [`Store`] writes
//! them in an order such that a crash at any moment loses no acknowledged edit: announce the new
//! document in the journal, write its history, replace the file, restart the journal.

mod contents;
mod edits;
mod for_writing;
mod opening;
mod recovery;
mod unopened;

pub use edits::{Others, Outside};
pub use for_writing::{OpenForWriting, open_for_writing};
pub use opening::{Access, Opened, open, read, read_with_state};
pub use recovery::Recovery;
pub use unopened::{
    FilesRead, Reserved, refuse_document, refuse_other_file, reserve, write_document,
};

use super::atomic::{copy_aside, set_aside, write_keeping_backup};
use super::history_file;
use super::journal::{DocumentHash, Journal, JournalContent, hash_of};
use super::lock::{Lock, lock_or_fail};
use super::own_version::OwnVersion;
use super::{Location, StoreError, calls};
use crate::document::{Document, History, document_to_string};
use contents::{read_document, read_journal};
use std::fs;
use std::io;
use std::path::{Path, PathBuf};
use touchline_core::files::read_regular;

/// A document that only this program may write. On drop, a journal without unsaved edits is
/// removed.
#[derive(Debug)]
pub struct Store {
    location: Location,
    journal: Journal,
    /// The document's file as last read or written; none before the first write of a new document.
    written: Option<(Document, DocumentHash)>,
    /// The document's file as it was when opened, or another program's version that this program
    /// last overwrote. It is one of the candidates for the common base of a merge.
    opened: Option<Document>,
    /// The own version that is kept beside another program's version.
    own: Option<OwnVersion>,
    /// Hash of the document that the journal last announced. If its write failed after the rename,
    /// the file already has this hash.
    announced: Option<DocumentHash>,
    /// Whether the journal contains edits that the document's file lacks.
    behind: bool,
    /// Whether the journal was deleted together with its edits. Nothing may be appended before the
    /// whole document is written.
    needs_whole: bool,
    lock: Lock,
}

impl Store {
    /// Creates a document where there is none.
    ///
    /// # Errors
    /// There is a file already, or it cannot be written.
    pub fn create(location: &Location, document: &Document) -> Result<Self, StoreError> {
        if location.file().exists() {
            return Err(StoreError::Exists {
                path: location.file().to_path_buf(),
            });
        }
        Self::replace(location, document)
    }

    /// Writes a document, replacing any document there. The old one is kept as the backup, and a
    /// journal with edits that it lacks is set aside.
    ///
    /// # Errors
    /// Another program has it open, the file is no document, or it cannot be written.
    pub fn replace(location: &Location, document: &Document) -> Result<Self, StoreError> {
        // The lock comes first, so that no other program has the document open below.
        Self::replace_locked(location, lock_or_fail(location)?, document)
    }

    /// As [`Store::replace`], under a lock that was taken before.
    fn replace_locked(
        location: &Location,
        lock: Lock,
        document: &Document,
    ) -> Result<Self, StoreError> {
        refuse_other_file(location.file())?;
        let path = location.journal();
        set_orphan_aside(&path)?;
        let journal = Journal::open(&path, 0)
            .map_err(|source| StoreError::from_io("write", &path, source))?;
        let mut store = Self::begun(location.clone(), journal, None, lock);
        let on_disk = store.hash_on_disk()?;
        store.write(document, None, on_disk.as_ref())?;
        Ok(store)
    }

    /// A store with an empty journal, or one whose edits are all in the file.
    fn begun(
        location: Location,
        journal: Journal,
        written: Option<(Document, DocumentHash)>,
        lock: Lock,
    ) -> Self {
        let opened = written.as_ref().map(|(document, _)| document.clone());
        let (own, announced) = (None, None);
        Self {
            location,
            journal,
            written,
            opened,
            own,
            announced,
            behind: false,
            needs_whole: false,
            lock,
        }
    }

    /// The document's location.
    pub const fn location(&self) -> &Location {
        &self.location
    }

    /// Writes the document and its history, keeps the version before as the backup, and restarts
    /// the journal.
    ///
    /// # Errors
    /// Another program changed the file since it was read or written, or it cannot be written.
    /// After any error the file on disk is whole, and the journal contains all edits.
    pub fn save(
        &mut self,
        document: &Document,
        history: &History<Document>,
    ) -> Result<(), StoreError> {
        let on_disk = self.hash_on_disk()?;
        if self.is_of_others(on_disk.as_ref()) {
            return Err(StoreError::ChangedOutside {
                path: self.location.file().to_path_buf(),
            });
        }
        self.write(document, Some(history), on_disk.as_ref())
    }

    /// Writes the document even if another program changed the file. Returns the path under which
    /// that program's version is kept, if there is one.
    ///
    /// # Errors
    /// It cannot be written.
    pub fn save_over(
        &mut self,
        document: &Document,
        history: &History<Document>,
    ) -> Result<Option<PathBuf>, StoreError> {
        // Their version is copied before anything else, so that no failure below can lose it.
        let path = self.location.file().to_path_buf();
        let (mut kept, mut theirs) = (None, None);
        let on_disk = self.hash_on_disk()?;
        if self.is_of_others(on_disk.as_ref()) {
            // It may not be a document; then it is only copied.
            theirs = read_document(&self.location).ok();
            kept = Some(
                copy_aside(&path, "outside")
                    .map_err(|source| StoreError::from_io("copy", &path, source))?,
            );
        }
        self.write(document, Some(history), on_disk.as_ref())?;
        if let Some((theirs, _)) = theirs {
            self.opened = Some(theirs);
        }
        Ok(kept)
    }

    /// Whether another program changed the file since this store last read or wrote it.
    fn has_changed_on_disk(&self) -> Result<bool, StoreError> {
        Ok(self.is_of_others(self.hash_on_disk()?.as_ref()))
    }

    /// The hash of the document's file on disk; none if it does not exist.
    fn hash_on_disk(&self) -> Result<Option<DocumentHash>, StoreError> {
        let path = self.location.file();
        match read_regular(path) {
            Ok(bytes) => Ok(Some(hash_of(&bytes))),
            Err(error) if error.kind() == io::ErrorKind::NotFound => Ok(None),
            Err(source) => Err(StoreError::from_io("read", path, source)),
        }
    }

    /// Whether another program wrote the file with hash `on_disk`. A file that does not exist
    /// counts as ours: there is nothing to lose.
    fn is_of_others(&self, on_disk: Option<&DocumentHash>) -> bool {
        on_disk.is_some_and(|hash| !self.has_written(hash) && self.announced.as_ref() != Some(hash))
    }

    /// Whether this store last read or wrote the document with this hash.
    fn has_written(&self, hash: &DocumentHash) -> bool {
        self.written
            .as_ref()
            .is_some_and(|(_, written)| written == hash)
    }

    /// Writes the document in place of the file with hash `on_disk`, but not if another program
    /// replaces that file meanwhile. The history is written before the document: after a crash in
    /// between, it belongs to the document that the journal leads to.
    fn write(
        &mut self,
        document: &Document,
        history: Option<&History<Document>>,
        on_disk: Option<&DocumentHash>,
    ) -> Result<(), StoreError> {
        self.settle_again()?;
        let path = self.location.file();
        let text =
            document_to_string(document).map_err(|source| StoreError::from_write(path, source))?;
        let hash = hash_of(text.as_bytes());
        // Compare with the file on disk rather than with the last known one: another program may
        // have replaced it.
        let is_there = on_disk == Some(&hash);
        let changes = !is_there || !self.has_written(&hash);
        // Announce the new document first. A reader that finds it then knows which edits it
        // contains.
        if changes {
            self.journal
                .announce(&hash)
                .map_err(|source| self.journal_error(source))?;
            self.announced = Some(hash.clone());
        }
        if let Some(history) = history {
            let path = self.location.history();
            if let Err(error) = history_file::write(&path, &hash, document, history) {
                log::warn!(
                    "{}: {error}; after closing, these steps cannot be undone",
                    path.display()
                );
            }
        }
        if is_there && changes {
            // An earlier write failed after the rename, so the file is there and the version before
            // it is the backup. Only the folder has to be flushed.
            calls::flush_folder(self.location.folder())
                .map_err(|source| StoreError::from_io("write", path, source))?;
        } else if changes {
            // A file that cannot be read any more counts as replaced, and is not overwritten.
            let is_written = self.write_text(&text, &|| {
                self.hash_on_disk().ok().flatten().as_ref() != on_disk
            });
            if !is_written.map_err(|source| StoreError::from_io("write", path, source))? {
                return Err(StoreError::ChangedOutside {
                    path: path.to_path_buf(),
                });
            }
        }
        // From here on the document is on the disk. A new one has no earlier state: it counts as
        // opened in the state that is written first.
        self.opened.get_or_insert_with(|| document.clone());
        self.written = Some((document.clone(), hash.clone()));
        (self.behind, self.needs_whole) = (false, false);
        // The document now contains all edits. If the journal cannot be restarted, the announcement
        // says the same.
        self.journal
            .restart(&hash)
            .map_err(|source| self.journal_error(source))?;
        // Among them are those of the own version, also where the other program put ours back.
        if let Some(own) = self.own.take() {
            own.remove();
        }
        Ok(())
    }

    /// Writes the document's file unless another program replaces it meanwhile; returns whether it
    /// was written. The version before becomes the backup. On a full disk, the history file is
    /// removed to make room.
    fn write_text(&self, text: &str, is_replaced: &dyn Fn() -> bool) -> io::Result<bool> {
        let (path, backup) = (self.location.file(), self.location.backup());
        let write = || write_keeping_backup(path, text.as_bytes(), &backup, is_replaced);
        match write() {
            Err(error)
                if is_disk_full(&error)
                    && history_file::remove(&self.location.history()).is_ok() =>
            {
                write()
            }
            written => written,
        }
    }

    /// Restores the journal and the lock if they were deleted, or if the folder was moved away and
    /// a folder of that name exists again.
    fn settle_again(&mut self) -> Result<(), StoreError> {
        let has_journal = self.journal.is_in_place();
        if has_journal && self.lock.is_in_place() {
            return Ok(());
        }
        let folder = self.location.folder();
        if !folder.is_dir() {
            return Err(StoreError::Gone {
                path: folder.to_path_buf(),
            });
        }
        // Without its file the lock keeps no other program out. If another one has locked the
        // document since, the journal is its own, too, and nothing may be written.
        if !self.lock.is_in_place() {
            self.lock = lock_or_fail(&self.location)?;
        }
        if has_journal {
            return Ok(());
        }
        let path = self.location.journal();
        // The edits of the deleted journal are in memory only, so the next write must be a whole
        // one.
        set_orphan_aside(&path)?;
        self.needs_whole = true;
        self.journal = Journal::open(&path, 0)
            .map_err(|source| StoreError::from_io("write", &path, source))?;
        Ok(())
    }

    /// The error of a failed journal write: the folder or the journal was removed, or the system
    /// refused.
    fn journal_error(&self, source: io::Error) -> StoreError {
        let path = self.location.journal();
        if self.journal.is_in_place() {
            return StoreError::from_io("write", &path, source);
        }
        let folder = self.location.folder();
        StoreError::Gone {
            path: if folder.is_dir() {
                path
            } else {
                folder.to_path_buf()
            },
        }
    }
}

impl Drop for Store {
    fn drop(&mut self) {
        let path = self.location.journal();
        // A journal with edits may be removed if the own version beside the document contains them.
        // This comes before the lock is dropped. Without the lock's file, the journal may belong to
        // another program.
        let is_kept = self.own.as_ref().is_some_and(|own| own.is_whole);
        if (!self.behind || is_kept)
            && self.lock.is_in_place()
            && self.journal.is_in_place()
            && let Err(error) = fs::remove_file(&path)
        {
            log::warn!("{}: {error}", path.display());
        }
    }
}

/// Whether a write failed because there is no room.
fn is_disk_full(error: &io::Error) -> bool {
    // A quota is a full disk for this user: there, too, a smaller history makes room.
    matches!(
        error.kind(),
        io::ErrorKind::StorageFull | io::ErrorKind::QuotaExceeded
    )
}

/// Moves a journal away if it contains edits; they belong to a document that is no longer here.
fn set_orphan_aside(path: &Path) -> Result<(), StoreError> {
    let holds_edits = JournalContent::parse(&read_journal(path)?).may_hold_edits();
    if holds_edits {
        set_aside(path, path, "orphan")
            .map_err(|source| StoreError::from_io("write", path, source))?;
    }
    Ok(())
}
