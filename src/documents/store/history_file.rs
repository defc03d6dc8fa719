//! The history file beside a saved document: the steps that can be undone and redone, so that undo
//! survives a restart.
//!
//! Checksummed lines (format: [`lines`](super::lines)). The first has the SHA-256 of the document
//! from which the steps start, and their numbers. Then each step has a line, as an edit by frame
//! id: steps to undo from the last one back, then steps to redo from the next one on.
//!
//! The file is written whole just before its document, so that it belongs to that document, or
//! after a crash to the one that the journal leads to. It contains at most
//! [`History::DEFAULT_LIMIT`] steps and [`MOST_BYTES`] bytes in each direction; the steps farthest
//! from the document are left out.
//!
//! The file is a convenience. If it is damaged or belongs to another document, it is ignored with a
//! message, and a failure to write it does not prevent saving the document.

use super::atomic::write_atomically;
use super::calls;
use super::journal::DocumentHash;
use super::lines::{first_line, line, line_within};
use crate::document::{Document, History, StepEdit, StepMisfit};
use serde::{Deserialize, Serialize};
use std::fs::OpenOptions;
use std::io::{self, Read as _};
use std::path::Path;
use thiserror::Error;
use touchline_core::files::open_regular;

/// The version of the file that this program reads and writes.
const VERSION: u32 = 1;
/// Maximum size of the steps in each direction, bytes. A step that changed one frame takes a few
/// kilobytes; one that moved the base changed every solved frame.
pub(super) const MOST_BYTES: usize = 32 << 20;
/// Maximum size of the file, bytes. This program writes no larger one.
const MOST_FILE_BYTES: u64 = 2 * MOST_BYTES as u64 + 1024;

/// Why steps of earlier sessions cannot be undone.
#[derive(Clone, Debug, PartialEq, Eq, Error)]
#[non_exhaustive]
pub enum HistoryLeftOut {
    /// The file was cut off or its bytes were changed.
    #[error("their file is damaged")]
    Damaged,
    /// The document is another version than the one from which the steps start.
    #[error("they lead to another version of the document")]
    OtherDocument,
    /// A newer program wrote the file.
    #[error("their file has version {version}, newer than this program")]
    Newer {
        /// Its version.
        version: u32,
    },
    /// The file is larger than any that this program writes.
    #[error("their file has {bytes} bytes, more than this program writes")]
    TooLarge {
        /// Its size.
        bytes: u64,
    },
    /// The file cannot be read, or is not a regular file.
    #[error("{reason}")]
    Unreadable {
        /// The system's reason.
        reason: String,
    },
    /// A step does not apply; that one and those beyond it are left out.
    #[error(transparent)]
    Misfit(#[from] StepMisfit),
}

impl From<io::Error> for HistoryLeftOut {
    fn from(error: io::Error) -> Self {
        Self::Unreadable {
            reason: error.to_string(),
        }
    }
}

/// The content of a line.
#[derive(Debug, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
enum Record {
    /// The first line.
    History(Header),
    /// A step to undo: from the document after it to the one before it.
    Undo(StepEdit),
    /// A step to redo: from the document before it to the one after it.
    Redo(StepEdit),
}

/// The content of the first line.
#[derive(Debug, Serialize, Deserialize)]
struct Header {
    version: u32,
    document_sha256: DocumentHash,
    /// Number of steps to undo.
    undo: usize,
    /// Number of steps to redo.
    redo: usize,
}

/// A history file of which the first line has been parsed.
#[derive(Debug)]
pub(super) struct HistoryFile {
    header: Header,
    /// The lines of the steps.
    steps: Vec<u8>,
}

impl HistoryFile {
    /// Reads the file; none if it does not exist.
    pub fn read(path: &Path) -> Result<Option<Self>, HistoryLeftOut> {
        // The size is checked before anything is read: the file may come from anybody.
        let file = match open_regular(path, OpenOptions::new().read(true)) {
            Err(error) if error.kind() == io::ErrorKind::NotFound => return Ok(None),
            other => other?,
        };
        let bytes = file.metadata()?.len();
        if bytes > MOST_FILE_BYTES {
            return Err(HistoryLeftOut::TooLarge { bytes });
        }
        let mut bytes = Vec::new();
        file.take(MOST_FILE_BYTES).read_to_end(&mut bytes)?;
        Self::parse(bytes).map(Some)
    }

    fn parse(mut bytes: Vec<u8>) -> Result<Self, HistoryLeftOut> {
        let Some((json, length)) = first_line(&bytes) else {
            return Err(HistoryLeftOut::Damaged);
        };
        // The header of a newer version may have another form, apart from the version number.
        let header: Option<serde_json::Value> = serde_json::from_slice(json).ok();
        let version =
            header.and_then(|header| u32::try_from(header["history"]["version"].as_u64()?).ok());
        if let Some(version) = version.filter(|version| *version > VERSION) {
            return Err(HistoryLeftOut::Newer { version });
        }
        let Ok(Record::History(header)) = serde_json::from_slice(json) else {
            return Err(HistoryLeftOut::Damaged);
        };
        let steps = bytes.split_off(length);
        Ok(Self { header, steps })
    }

    /// Whether the steps start from the document with this hash.
    pub fn starts_from(&self, document: &DocumentHash) -> bool {
        self.header.document_sha256 == *document
    }

    /// The steps before and after `document`, from which they start; and why some are left out, if
    /// they are.
    pub fn history(&self, document: &Document) -> (History<Document>, Option<HistoryLeftOut>) {
        match self.steps() {
            Some((undo, redo)) => {
                let (history, misfit) = History::from_edits(document, undo, redo);
                (history, misfit.map(Into::into))
            }
            None => (History::default(), Some(HistoryLeftOut::Damaged)),
        }
    }

    /// The steps to undo and to redo; none if any line is damaged or missing.
    fn steps(&self) -> Option<(Vec<StepEdit>, Vec<StepEdit>)> {
        let (mut undo, mut redo) = (Vec::new(), Vec::new());
        let mut rest = &self.steps[..];
        while !rest.is_empty() {
            let (json, length) = first_line(rest)?;
            // All steps to undo come before those to redo. Other orders were never written.
            match serde_json::from_slice(json).ok()? {
                Record::Undo(step) if redo.is_empty() => undo.push(step),
                Record::Redo(step) => redo.push(step),
                Record::Undo(_) | Record::History(_) => return None,
            }
            rest = &rest[length..];
        }
        ((undo.len(), redo.len()) == (self.header.undo, self.header.redo)).then_some((undo, redo))
    }
}

/// Writes the steps before and after a document with this hash. Without steps, removes the file.
pub(super) fn write(
    path: &Path,
    hash: &DocumentHash,
    document: &Document,
    history: &History<Document>,
) -> io::Result<()> {
    // A link or a pipe in place of the file is refused here, because a rename would replace it
    // without a word.
    if let Err(error) = open_regular(path, OpenOptions::new().read(true))
        && error.kind() != io::ErrorKind::NotFound
    {
        return Err(error);
    }
    if history.is_empty() {
        return remove(path);
    }
    write_atomically(path, &bytes(hash, document, history)?)
}

/// Deletes the file if it exists.
pub(super) fn remove(path: &Path) -> io::Result<()> {
    match calls::remove(path) {
        Err(error) if error.kind() != io::ErrorKind::NotFound => Err(error),
        _ => Ok(()),
    }
}

/// The content of the file.
fn bytes(
    hash: &DocumentHash,
    document: &Document,
    history: &History<Document>,
) -> io::Result<Vec<u8>> {
    // Undo and redo work on the document without suggestions; what a step did to these is in it.
    let edited = document.without_suggestions();
    let (undo_lines, undo) = lines(history.undo_edits(&edited).map(Record::Undo))?;
    let (redo_lines, redo) = lines(history.redo_edits(&edited).map(Record::Redo))?;
    let header = Header {
        version: VERSION,
        document_sha256: hash.clone(),
        undo,
        redo,
    };
    let mut bytes = line(&Record::History(header))?.into_bytes();
    bytes.extend(undo_lines);
    bytes.extend(redo_lines);
    Ok(bytes)
}

/// The lines of the steps that fit into [`MOST_BYTES`], and the number of steps.
fn lines(steps: impl Iterator<Item = Record>) -> io::Result<(Vec<u8>, usize)> {
    let (mut bytes, mut count) = (Vec::new(), 0);
    for step in steps {
        let Some(line) = line_within(&step, MOST_BYTES - bytes.len())? else {
            break;
        };
        bytes.extend(line);
        count += 1;
    }
    Ok((bytes, count))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::document::Step;
    use crate::testing::{new_frame, soccer_document};
    use touchline_core::geometry::ImageSize;

    /// A document with three steps before it and two after.
    fn document_with_history() -> (Document, History<Document>) {
        let mut document = soccer_document();
        let frame = |index: i32| new_frame(&index.to_string(), ImageSize::new(64, 48)).into();
        document.frames.extend((0..4).map(frame));
        let mut history = History::default();
        for index in 0..5 {
            history.begin(&document, Step::on_document(format!("Step {index}")));
            document.frames[index % 4].comment = Some(format!("{index}"));
            document.frames[index % 4].revision += 1;
            assert!(history.commit(&document));
        }
        history.undo(&mut document);
        history.undo(&mut document);
        (document, history)
    }

    fn written() -> (Document, History<Document>, Vec<u8>) {
        let (document, history) = document_with_history();
        let bytes = bytes(&"a".to_owned(), &document, &history).unwrap();
        (document, history, bytes)
    }

    #[test]
    fn what_is_written_is_read_again() {
        let (document, history, bytes) = written();
        let file = HistoryFile::parse(bytes).unwrap();
        assert!(file.starts_from(&"a".to_owned()) && !file.starts_from(&"b".to_owned()));
        assert_eq!(file.history(&document), (history, None));
    }

    #[test]
    fn a_cut_or_a_flipped_byte_leaves_the_history_out() {
        let (document, _, bytes) = written();
        let read = |bytes: Vec<u8>| HistoryFile::parse(bytes).map(|file| file.history(&document));
        for at in 0..bytes.len() {
            for damaged in [bytes[..at].to_vec(), {
                let mut flipped = bytes.clone();
                flipped[at] ^= 1;
                flipped
            }] {
                let left_out = match read(damaged) {
                    Err(left_out) => left_out,
                    Ok((history, left_out)) => {
                        assert!(history.is_empty(), "byte {at}");
                        left_out.unwrap()
                    }
                };
                assert_eq!(left_out, HistoryLeftOut::Damaged, "byte {at}");
            }
        }
    }

    #[test]
    fn a_newer_version_is_named_whatever_else_it_holds() {
        let newer = line(&serde_json::json!({ "history": { "version": 2, "steps": {} } })).unwrap();
        let left_out = HistoryFile::parse(newer.into_bytes()).unwrap_err();
        assert_eq!(left_out, HistoryLeftOut::Newer { version: 2 });
    }

    #[test]
    fn the_history_ends_before_a_step_that_does_not_fit() {
        let (document, history, bytes) = written();
        let mut other = document.clone();
        // The second step back changed it.
        other.frames[1].revision += 1;
        let (found, left_out) = HistoryFile::parse(bytes).unwrap().history(&other);
        assert_eq!(found.next_undo(), history.next_undo());
        assert_eq!(found.undo_edits(&other).count(), 1);
        assert!(
            matches!(left_out, Some(HistoryLeftOut::Misfit(misfit)) if misfit.name == "Step 1")
        );
    }

    #[test]
    fn a_step_too_large_for_the_file_and_those_before_it_are_left_out() {
        let (mut document, mut history) = document_with_history();
        for (name, bytes) in [("Large", MOST_BYTES), ("Small", 1)] {
            history.begin(&document, Step::on_document(name));
            document.frames[0].comment = Some("x".repeat(bytes));
            document.frames[0].revision += 1;
            assert!(history.commit(&document));
        }
        // Taking the small step back brings the large comment.
        let bytes_of_none = bytes(&"a".to_owned(), &document, &history).unwrap();
        assert!(
            HistoryFile::parse(bytes_of_none)
                .unwrap()
                .history(&document)
                .0
                .is_empty()
        );
        history.begin(&document, Step::on_document("Last"));
        document.frames[1].comment = None;
        document.frames[1].revision += 1;
        assert!(history.commit(&document));
        let bytes_of_one = bytes(&"a".to_owned(), &document, &history).unwrap();
        let (found, left_out) = HistoryFile::parse(bytes_of_one).unwrap().history(&document);
        assert_eq!((found.undo_edits(&document).count(), left_out), (1, None));
    }
}
