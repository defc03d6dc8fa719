//! A document as its file, its journal and its history together state it. Nothing is written here.

use super::recovery::Recovery;
use crate::document::{Document, History, document_from_bytes};
use crate::store::history_file::{HistoryFile, HistoryLeftOut};
use crate::store::journal::{DocumentHash, JournalContent, Pending, hash_of};
use crate::store::replay::Replay;
use crate::store::{Location, StoreError};
use std::io;
use std::path::Path;
use touchline_core::files::{read_regular, read_regular_within};

/// Maximum number of times that a document and its journal are read, if another program replaces
/// one of them between the two readings.
const READ_ATTEMPTS: usize = 3;

/// Whether the steps of earlier sessions are read, too.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Steps {
    Wanted,
    Ignored,
}

/// A document as read from its file, journal and history.
pub(super) struct Contents {
    pub(super) document: Document,
    pub(super) history: History<Document>,
    /// The document in the file, without the journal's edits.
    pub(super) written: Document,
    pub(super) hash: DocumentHash,
    pub(super) recovery: Recovery,
    /// The hash of the journal; none if it holds no edit.
    pub(super) journal: Option<DocumentHash>,
    /// Length of the readable part of the journal, bytes.
    pub(super) whole_bytes: u64,
    pub(super) damage: Damage,
}

/// Damage of a journal, other than a last line that is cut off: a crash leaves that.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Damage {
    /// No damage.
    None,
    /// A whole line cannot be read.
    Unreadable,
    /// An edit does not apply to the document.
    Misfit,
}

/// Reads document, journal and history consistently, although other programs may replace them
/// meanwhile.
pub(super) fn read_contents(location: &Location, steps: Steps) -> Result<Contents, StoreError> {
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
    let bytes = read_journal(&path)?;
    let (written, hash) = read_document(location)?;
    let mut replay = Replay::new(written.clone());
    let content = JournalContent::parse(&bytes);
    let (whole_bytes, lost_bytes) = (content.whole_bytes, content.lost_bytes);
    let journal = content.may_hold_edits().then(|| hash_of(&bytes));
    // A whole line that cannot be read is damaged, or of another version of the program. A line
    // without its end was cut off by a crash.
    let mut damage = if bytes[whole_bytes as usize..].contains(&b'\n') {
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
        // A newer journal may have edits that would be lost if the document were opened without
        // them.
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
        journal,
        whole_bytes,
        damage,
    })
}

/// The bytes of a journal; none if there is no journal.
pub(super) fn read_journal(path: &Path) -> Result<Vec<u8>, StoreError> {
    match read_regular(path) {
        Err(error) if error.kind() == io::ErrorKind::NotFound => Ok(Vec::new()),
        other => other.map_err(|source| StoreError::from_io("read", path, source)),
    }
}

/// Maximum size of a document, bytes: enough for a million solved frames.
const MAX_DOCUMENT_BYTES: u64 = 2 << 30;

pub(super) fn read_document(location: &Location) -> Result<(Document, DocumentHash), StoreError> {
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
