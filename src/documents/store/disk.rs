//! A document on disk: opening with recovery from the journal, journaling of each edit, and atomic
//! writes of the whole document.
//!
//! A document is a file with companions beside it: `.journal` (edits since the last whole write),
//! `.history` (steps to undo and redo), `.bak` (the version before) and `.lock`. [`Store`] writes
//! them in an order such that a crash at any moment loses no acknowledged edit: announce the new
//! document in the journal, write its history, replace the file, restart the journal.

use super::atomic::{
    copy_aside, is_pipe_or_device, keep_backup, set_aside, write_atomically, write_new,
    write_output, write_unless_replaced,
};
use super::calls;
use super::history_file::{self, HistoryFile, HistoryLeftOut};
use super::journal::{DocumentHash, Journal, JournalContent, Pending, hash_of};
use super::lock::{Lock, lock};
use super::own_version::OwnVersion;
use super::replay::Replay;
use super::{DocumentStore, Location, Orphan, Others, Outside, ReadOnly, StoreError};
use crate::document::{
    Document, Edit, History, common_base, document_from_bytes, document_to_string,
};
use std::fmt::Write as _;
use std::fs;
use std::io;
use std::path::{Path, PathBuf};
use touchline_core::files::{read_regular, read_regular_within, remove_stray_files};

/// Maximum number of times that a document and its journal are read, if another program replaces
/// one of them between the two readings.
const READ_ATTEMPTS: usize = 3;

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

/// What was recovered from a journal when a document was opened.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Recovery {
    /// The names of the recovered edits, oldest first. The opened document contains them; its file
    /// does not.
    pub edits: Vec<String>,
    /// Number of unreadable bytes at the journal's end.
    pub lost_bytes: u64,
    /// The name of the first edit that does not apply to the document, and the number of edits from
    /// it to the journal's end. None of them is in the document.
    pub misfit: Option<(String, usize)>,
    /// The path under which a journal was kept because it is damaged or belongs to another
    /// document.
    pub set_aside: Option<PathBuf>,
    /// Number of edits in a journal that starts from another document. They are not in the
    /// document.
    pub foreign_edits: usize,
    /// Why the steps of earlier sessions cannot be undone, if they cannot.
    pub history: Option<HistoryLeftOut>,
}

impl Recovery {
    /// Whether there is nothing to report.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        *self == Self::default()
    }

    /// The report to the user, in a few sentences; none if there is nothing to report.
    #[must_use]
    pub fn message(&self) -> Option<String> {
        let mut text = match &self.edits[..] {
            [] => String::new(),
            [one] => format!("Recovered 1 edit: {one}."),
            [.., last] => format!(
                "Recovered {} edits, the last one: {last}.",
                self.edits.len()
            ),
        };
        let mut say = |sentence: std::fmt::Arguments| {
            text.push_str(if text.is_empty() { "" } else { " " });
            let _ = text.write_fmt(sentence);
        };
        if self.lost_bytes > 0 {
            say(format_args!(
                "The journal is incomplete: its last {} bytes are unreadable.",
                self.lost_bytes
            ));
        }
        if let Some((name, left_out)) = &self.misfit {
            let others = match left_out - 1 {
                0 => "it is".to_owned(),
                1 => "it and 1 edit after it are".to_owned(),
                others => format!("it and {others} edits after it are"),
            };
            say(format_args!(
                "The edit {name:?} does not apply to the document: {others} left out."
            ));
        }
        if self.foreign_edits > 0 {
            let edits = if self.foreign_edits == 1 {
                "edit is"
            } else {
                "edits are"
            };
            say(format_args!(
                "Another program changed the document: {} {edits} not in it.",
                self.foreign_edits
            ));
        }
        if let Some(path) = &self.set_aside {
            say(format_args!("The journal is kept as {}.", path.display()));
        }
        if let Some(left_out) = &self.history {
            say(format_args!(
                "Steps of earlier sessions cannot be undone: {left_out}."
            ));
        }
        (!text.is_empty()).then_some(text)
    }
}

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

/// Opens a document for writing, or read-only if it is open in another program or write-protected.
///
/// # Errors
/// There is no document, it cannot be read, or its content is not a document.
pub fn open(path: &Path) -> Result<Opened, StoreError> {
    let location = Location::find(path)?;
    let lock = match lock(&location) {
        Ok(lock) => lock,
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
    let contents = read_contents(&location, Steps::Wanted)?;
    let Contents {
        document,
        history,
        written,
        hash,
        mut recovery,
        whole_bytes,
        damage,
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
    let location = Location::find(path)?;
    let Contents {
        document, recovery, ..
    } = read_contents(&location, Steps::Ignored)?;
    Ok((location, document, recovery))
}

/// Writes a document that this program does not have open: a command's result, a dataset, a new
/// project.
///
/// If a project there has been edited, its last version is kept as the backup, and a journal with
/// edits is set aside.
///
/// # Errors
/// There is a file and `replace` is false, another program has the document open, or it cannot be
/// written.
pub fn write_document(
    location: &Location,
    document: &Document,
    replace: bool,
) -> Result<(), StoreError> {
    let path = location.file();
    if path.exists() && !replace {
        return Err(StoreError::Exists {
            path: path.to_path_buf(),
        });
    }
    // A journal or a lock means that the file is, or was, open in the program: take the lock.
    if location.journal().exists() || location.lock().exists() {
        return Store::replace(location, document).map(drop);
    }
    let text = document_to_string(document).map_err(|source| StoreError::Write {
        path: path.to_path_buf(),
        source,
    })?;
    if is_pipe_or_device(path) {
        return write_output(path, text.as_bytes())
            .map_err(|source| StoreError::from_io("write", path, source));
    }
    // The file is checked again as it gets its name: another program may create it meanwhile.
    if !replace && !path.is_symlink() {
        return write_new(path, text.as_bytes()).map_err(|source| match source.kind() {
            io::ErrorKind::AlreadyExists => StoreError::Exists {
                path: path.to_path_buf(),
            },
            _ => StoreError::from_io("write", path, source),
        });
    }
    let backup = location.backup();
    keep_backup(path, &backup).map_err(|source| StoreError::from_io("write", &backup, source))?;
    write_atomically(path, text.as_bytes())
        .map_err(|source| StoreError::from_io("write", path, source))
}

/// Returns an error if another program has the document open. Commands call it before long work,
/// the result of which replaces the document.
///
/// # Errors
/// The document is open in another program, or cannot be written.
pub fn refuse_open(path: &Path) -> Result<(), StoreError> {
    let Ok(location) = Location::find(path) else {
        return Ok(());
    };
    if !location.lock().exists() {
        return Ok(());
    }
    let read_only = |reason| StoreError::ReadOnly {
        path: location.file().to_path_buf(),
        reason,
    };
    lock(&location).map(drop).map_err(read_only)
}

/// Moves a journal away if it contains edits; they belong to a document that is no longer here.
fn set_orphan_aside(path: &Path) -> Result<(), StoreError> {
    let holds_edits = match read_regular(path) {
        Ok(bytes) => JournalContent::parse(&bytes).has_edits(),
        Err(error) if error.kind() == io::ErrorKind::NotFound => false,
        Err(source) => return Err(StoreError::from_io("read", path, source)),
    };
    if holds_edits {
        set_aside(path, path, "orphan")
            .map_err(|source| StoreError::from_io("write", path, source))?;
    }
    Ok(())
}

/// Whether the steps of earlier sessions are read, too.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Steps {
    Wanted,
    Ignored,
}

/// A document as read from its file, journal and history.
struct Contents {
    document: Document,
    history: History<Document>,
    /// The document in the file, without the journal's edits.
    written: Document,
    hash: DocumentHash,
    recovery: Recovery,
    /// Length of the readable part of the journal, bytes.
    whole_bytes: u64,
    damage: Damage,
}

/// Damage of a journal, other than a last line that is cut off: a crash leaves that.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Damage {
    /// No damage.
    None,
    /// There are lines after the unreadable one.
    Unreadable,
    /// An edit does not apply to the document.
    Misfit,
}

/// Reads document, journal and history consistently, although other programs may replace them
/// meanwhile.
fn read_contents(location: &Location, steps: Steps) -> Result<Contents, StoreError> {
    let mut attempt = 1;
    loop {
        let contents = read_contents_once(location, steps)?;
        // If the journal belongs to another document, that document may have been replaced between
        // the two readings. Read both again.
        if contents.recovery.foreign_edits == 0 || attempt == READ_ATTEMPTS {
            return Ok(contents);
        }
        attempt += 1;
    }
}

/// Reads document, journal and history once.
fn read_contents_once(location: &Location, steps: Steps) -> Result<Contents, StoreError> {
    // Read the journal before the document. If it is restarted in between, its old content still
    // leads to the document that is read then.
    let path = location.journal();
    let bytes = match read_regular(&path) {
        Err(error) if error.kind() == io::ErrorKind::NotFound => Vec::new(),
        other => other.map_err(|source| StoreError::from_io("read", &path, source))?,
    };
    let (written, hash) = read_document(location)?;
    let mut replay = Replay::new(written.clone());
    let content = JournalContent::parse(&bytes);
    let (whole_bytes, lost_bytes) = (content.whole_bytes, content.lost_bytes);
    // A newline with bytes after it, inside the unreadable part, means damage. Without one, the
    // last line was cut off by a crash.
    let lost = &bytes[whole_bytes as usize..];
    let goes_on = lost
        .iter()
        .position(|byte| *byte == b'\n')
        .is_some_and(|end| end + 1 < lost.len());
    let mut damage = if goes_on {
        Damage::Unreadable
    } else {
        Damage::None
    };
    let mut recovery = Recovery {
        lost_bytes,
        ..Recovery::default()
    };
    let file = match steps {
        Steps::Wanted => HistoryFile::read(&location.history()).unwrap_or_else(|left_out| {
            replay.left_out = Some(left_out);
            None
        }),
        Steps::Ignored => None,
    };
    match content.pending(&hash) {
        Pending::Newer { version } => return Err(StoreError::NewerJournal { path, version }),
        Pending::OtherDocument { edits } => {
            recovery.foreign_edits = edits;
            replay.left_out = replay
                .left_out
                .or(file.map(|_| HistoryLeftOut::OtherDocument));
        }
        Pending::Edits(pending) => {
            let count = pending.edits.len();
            if let Err((name, misfit)) = replay.through(pending, &hash, file.as_ref()) {
                log::warn!("{}: {name}: {misfit}", path.display());
                recovery.misfit = Some((name, count - replay.edits.len()));
                damage = Damage::Misfit;
            }
        }
    }
    let Replay {
        document,
        history,
        edits,
        left_out,
        ..
    } = replay;
    (recovery.edits, recovery.history) = (edits, left_out);
    Ok(Contents {
        document,
        history,
        written,
        hash,
        recovery,
        whole_bytes,
        damage,
    })
}

/// Maximum size of a document, bytes: enough for a million solved frames.
const MAX_DOCUMENT_BYTES: u64 = 2 << 30;

fn read_document(location: &Location) -> Result<(Document, DocumentHash), StoreError> {
    let path = location.file();
    let bytes = read_regular_within(path, MAX_DOCUMENT_BYTES);
    let bytes = bytes.map_err(|source| StoreError::from_io("read", path, source))?;
    let document = document_from_bytes(&bytes).map_err(|source| {
        let backup = Some(location.backup()).filter(|backup| backup.exists());
        StoreError::Read {
            path: path.to_path_buf(),
            source,
            backup,
        }
    })?;
    Ok((document, hash_of(&bytes)))
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
    /// Another program has it open, or it cannot be written.
    pub fn replace(location: &Location, document: &Document) -> Result<Self, StoreError> {
        let read_only = |reason| StoreError::ReadOnly {
            path: location.file().to_path_buf(),
            reason,
        };
        let lock = lock(location).map_err(read_only)?;
        let path = location.journal();
        let io = |source| StoreError::from_io("write", &path, source);
        set_orphan_aside(&path)?;
        let journal = Journal::open(&path, 0).map_err(io)?;
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
    #[must_use]
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
        if let Some(own) = self.own.take() {
            own.remove();
        }
        Ok(kept)
    }

    /// Whether another program changed the file since this store last read or wrote it.
    fn changed_outside(&self) -> Result<bool, StoreError> {
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
        let text = document_to_string(document).map_err(|source| StoreError::Write {
            path: path.to_path_buf(),
            source,
        })?;
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
            let backup = self.location.backup();
            keep_backup(path, &backup)
                .map_err(|source| StoreError::from_io("write", &backup, source))?;
            let is_written = self.write_text(&text, &|| {
                self.hash_on_disk().ok().flatten().as_ref() != on_disk
            });
            if !is_written.map_err(|source| StoreError::from_io("write", path, source))? {
                return Err(StoreError::ChangedOutside {
                    path: path.to_path_buf(),
                });
            }
        }
        self.opened.get_or_insert_with(|| document.clone());
        self.written = Some((document.clone(), hash.clone()));
        (self.behind, self.needs_whole) = (false, false);
        // The document now contains all edits. If the journal cannot be restarted, the announcement
        // says the same.
        self.journal
            .restart(&hash)
            .map_err(|source| self.journal_error(source))
    }

    /// Writes the document's file unless another program replaces it meanwhile; returns whether it
    /// was written. On a full disk, the history file is removed to make room.
    fn write_text(&self, text: &str, is_replaced: &dyn Fn() -> bool) -> io::Result<bool> {
        let path = self.location.file();
        let is_full = |error: &io::Error| {
            matches!(
                error.kind(),
                io::ErrorKind::StorageFull | io::ErrorKind::QuotaExceeded
            )
        };
        match write_unless_replaced(path, text.as_bytes(), is_replaced) {
            Err(error)
                if is_full(&error) && history_file::remove(&self.location.history()).is_ok() =>
            {
                write_unless_replaced(path, text.as_bytes(), is_replaced)
            }
            written => written,
        }
    }

    /// Restores the journal and the lock if they were deleted, or if the folder was moved away and
    /// a folder of that name exists again.
    fn settle_again(&mut self) -> Result<(), StoreError> {
        if self.journal.is_in_place() {
            return Ok(());
        }
        let folder = self.location.folder();
        if !folder.is_dir() {
            return Err(StoreError::Gone {
                path: folder.to_path_buf(),
            });
        }
        if !self.lock.is_in_place() {
            let read_only = |reason| StoreError::ReadOnly {
                path: self.location.file().to_path_buf(),
                reason,
            };
            self.lock = lock(&self.location).map_err(read_only)?;
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

impl DocumentStore for Store {
    fn load(&self) -> Result<Document, StoreError> {
        Ok(read_contents(&self.location, Steps::Ignored)?.document)
    }

    fn append(&mut self, edits: &[Edit]) -> Result<(), StoreError> {
        if self.needs_whole {
            return Err(StoreError::Gone {
                path: self.location.journal(),
            });
        }
        self.journal
            .append(edits)
            .map_err(|source| self.journal_error(source))?;
        self.behind = true;
        if let Some(own) = &mut self.own {
            own.is_whole = false;
        }
        Ok(())
    }

    fn since(&self) -> Result<Option<Outside>, StoreError> {
        if !self.changed_outside()? {
            return Ok(None);
        }
        let (theirs, _) = read_document(&self.location)?;
        let base = match (&self.opened, &self.written) {
            (Some(opened), Some((written, _))) => common_base(opened, written, &theirs),
            _ => theirs.clone(),
        };
        Ok(Some(Outside { base, theirs }))
    }

    fn keep_own(&mut self, own: &Document) -> Result<Option<Orphan>, StoreError> {
        let base = match self.since() {
            Ok(None) => return Ok(None),
            Ok(Some(Outside { mut base, theirs })) => {
                // A revision counts edits, so it cannot tell a later state from a fork of an
                // earlier one with as many edits. The base leaves out frames in which theirs lacks
                // work of the user; the merge then keeps ours.
                base.frames = base
                    .frames
                    .iter()
                    .filter(|frame| !frame.gives_way_in(&theirs))
                    .cloned()
                    .collect();
                base
            }
            // Their file is not a document, so there is nothing to merge with: the base is the
            // document as it was opened.
            Err(error) => self.opened.clone().ok_or(error)?,
        };
        let version = OwnVersion::write(self.own.take(), &self.location, &base, own)?;
        let Some(version) = version else {
            return Ok(None);
        };
        // Edits from here on start from the own version. If this journal is set aside, too, its
        // edits find their base there.
        self.journal
            .announce(version.hash())
            .map_err(|source| self.journal_error(source))?;
        let orphan = version.as_orphan();
        self.own = Some(version);
        Ok(Some(orphan))
    }

    fn keep(
        &mut self,
        document: &Document,
        history: &History<Document>,
        others: Others,
    ) -> Result<Option<PathBuf>, StoreError> {
        match others {
            Others::Stay => self.save(document, history).map(|()| None),
            Others::SetAside => self.save_over(document, history),
        }
    }

    fn is_behind(&self) -> bool {
        self.behind
    }
}

impl Drop for Store {
    fn drop(&mut self) {
        let path = self.location.journal();
        // A journal with edits may be removed if the own version beside the document contains them.
        let is_kept = self.own.as_ref().is_some_and(|own| own.is_whole);
        if (!self.behind || is_kept)
            && self.journal.is_in_place()
            && let Err(error) = fs::remove_file(&path)
        {
            log::warn!("{}: {error}", path.display());
        }
    }
}
