//! The journal: all edits since the document was last written, one checksummed line each, flushed
//! to disk.
//!
//! The first line (format: [`lines`](super::lines)) has the SHA-256 of the document from which the
//! edits start. Before the document is replaced, a line with the SHA-256 of the new one is added.
//! If the program stops between the two, a reader that finds the old document applies all edits,
//! and one that finds the new document applies those after the line. A journal that ends within a
//! line is read up to that line.

use super::atomic::folder_of;
use super::calls;
use super::file_id::is_at;
use super::lines::{first_line, line};
use crate::document::Edit;
use serde::{Deserialize, Serialize};
use sha2::{Digest, Sha256};
use std::fs::File;
use std::io;
use std::path::{Path, PathBuf};
use touchline_core::geometry::hex;

/// The version of the journal that this program writes and reads.
const JOURNAL_VERSION: u32 = 1;

/// The SHA-256 of a document's bytes, hexadecimal.
pub(super) type DocumentHash = String;

/// Computes the hash of a document's file.
pub(super) fn hash_of(document: &[u8]) -> DocumentHash {
    hex(&Sha256::digest(document))
}

/// The content of a line.
#[derive(Debug, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
enum Record {
    /// The first line: the edits start from this document.
    Journal {
        version: u32,
        document_sha256: DocumentHash,
    },
    /// One edit.
    Edit(Edit),
    /// The document with this hash contains all edits above. It is about to replace the old one.
    Saving { document_sha256: DocumentHash },
}

impl Record {
    /// Whether edits after this line start from the document with this hash.
    fn starts_from(&self, document: &DocumentHash) -> bool {
        match self {
            Self::Journal {
                document_sha256, ..
            }
            | Self::Saving { document_sha256 } => document_sha256 == document,
            Self::Edit(_) => false,
        }
    }
}

/// The readable part of a journal.
#[derive(Debug, Default)]
pub(super) struct JournalContent {
    records: Vec<Record>,
    /// Length of the readable lines, bytes.
    pub whole_bytes: u64,
    /// Length of the unreadable rest, bytes.
    pub lost_bytes: u64,
}

/// The meaning of a journal for the document beside it.
#[derive(Debug)]
pub(super) enum Pending {
    /// Edits that the document lacks.
    Edits(PendingEdits),
    /// The edits start from another document.
    OtherDocument {
        /// Number of edits.
        edits: usize,
    },
    /// A newer program wrote the journal, in a version that this one cannot read.
    Newer {
        /// Its version.
        version: u32,
    },
}

/// Edits that the document lacks, oldest first.
#[derive(Debug, Default)]
pub(super) struct PendingEdits {
    pub edits: Vec<Edit>,
    /// The documents announced among them: the number of these edits that each contains, and its
    /// hash.
    pub announced: Vec<(usize, DocumentHash)>,
}

impl JournalContent {
    /// Reads lines up to the first unreadable one.
    pub fn parse(bytes: &[u8]) -> Self {
        let mut content = Self::default();
        let mut rest = bytes;
        while let Some((json, length)) = first_line(rest) {
            let Ok(record) = serde_json::from_slice::<Record>(json) else {
                break;
            };
            content.records.push(record);
            rest = &rest[length..];
        }
        content.lost_bytes = rest.len() as u64;
        content.whole_bytes = bytes.len() as u64 - content.lost_bytes;
        content
    }

    /// Whether the journal contains an edit. What cannot be read may be edits, too: of a newer
    /// program, or of a damaged journal.
    pub fn may_hold_edits(&self) -> bool {
        self.lost_bytes > 0 || self.edit_names().next().is_some()
    }

    /// The names of the edits, oldest first.
    pub fn edit_names(&self) -> impl Iterator<Item = String> {
        self.records.iter().filter_map(|record| match record {
            Record::Edit(edit) => Some(edit.name.clone()),
            Record::Journal { .. } | Record::Saving { .. } => None,
        })
    }

    /// All edits, regardless of the document from which they start.
    pub fn into_edits(self) -> Vec<Edit> {
        let edits = self.records.into_iter().filter_map(|record| match record {
            Record::Edit(edit) => Some(edit),
            Record::Journal { .. } | Record::Saving { .. } => None,
        });
        edits.collect()
    }

    /// Whether edits may start from the document with this hash.
    pub fn knows(&self, document: &DocumentHash) -> bool {
        self.records
            .iter()
            .any(|record| record.starts_from(document))
    }

    /// The edits that the document with this hash lacks: those after the last line that names it.
    pub fn pending(self, document: &DocumentHash) -> Pending {
        if let Some(Record::Journal { version, .. }) = self.records.first()
            && *version > JOURNAL_VERSION
        {
            return Pending::Newer { version: *version };
        }
        // The last line that names the document: what was announced before it is in the document,
        // too. A hash occurs twice where a write failed after its announcement and was repeated.
        let start = self
            .records
            .iter()
            .rposition(|record| record.starts_from(document));
        let mut pending = PendingEdits::default();
        for record in self
            .records
            .into_iter()
            .skip(start.map_or(0, |start| start + 1))
        {
            match record {
                Record::Edit(edit) => pending.edits.push(edit),
                Record::Journal { .. } => {}
                Record::Saving { document_sha256 } => pending
                    .announced
                    .push((pending.edits.len(), document_sha256)),
            }
        }
        // A journal without edits may belong to any document: there is nothing in it to lose.
        if start.is_none() && !pending.edits.is_empty() {
            return Pending::OtherDocument {
                edits: pending.edits.len(),
            };
        }
        Pending::Edits(pending)
    }
}

/// A journal open for writing.
#[derive(Debug)]
pub(super) struct Journal {
    path: PathBuf,
    file: File,
    /// Length of the whole lines. A line that was written in part is cut off before the next one is
    /// written.
    whole_bytes: u64,
    /// The document from which the journal starts, until the first line is written.
    start: Option<DocumentHash>,
}

impl Journal {
    /// Opens a journal, or creates it. Its first `whole_bytes` bytes stay; the next write cuts off
    /// what is behind them.
    pub fn open(path: &Path, whole_bytes: u64) -> io::Result<Self> {
        let file = calls::open(path)?;
        calls::flush_folder(folder_of(path))?;
        Ok(Self {
            path: path.to_path_buf(),
            file,
            whole_bytes,
            start: None,
        })
    }

    /// Whether a reader would find the journal: neither it nor its folder was moved or deleted.
    pub fn is_in_place(&self) -> bool {
        is_at(&self.file, &self.path)
    }

    /// Empties the journal; it then starts from `document`, which contains all edits. If the write
    /// fails, the next one repeats it.
    pub fn restart(&mut self, document: &DocumentHash) -> io::Result<()> {
        self.whole_bytes = 0;
        self.start = Some(document.clone());
        self.write("")
    }

    /// Appends edits and flushes them to disk.
    pub fn append(&mut self, edits: &[Edit]) -> io::Result<()> {
        let lines: io::Result<Vec<String>> = edits
            .iter()
            .map(|edit| line(&Record::Edit(edit.clone())))
            .collect();
        self.write(&lines?.concat())
    }

    /// Announces the document that will contain all edits so far.
    pub fn announce(&mut self, document: &DocumentHash) -> io::Result<()> {
        self.write(&line(&Record::Saving {
            document_sha256: document.clone(),
        })?)
    }

    /// Appends lines and flushes them, after the first line if that is still to be written.
    fn write(&mut self, lines: &str) -> io::Result<()> {
        let start = self.start.clone().map(|document_sha256| Record::Journal {
            version: JOURNAL_VERSION,
            document_sha256,
        });
        let lines = start.map_or(Ok(String::new()), |start| line(&start))? + lines;
        // The state changes only after the flush. Whatever fails before it, the next write cuts off
        // what this one left and writes it again.
        calls::truncate(&mut self.file, self.whole_bytes)?;
        calls::write_all(&mut self.file, lines.as_bytes())?;
        calls::flush_data(&self.file, &self.path)?;
        // A deleted or moved file accepts writes that no reader would find.
        if !self.is_in_place() {
            return Err(io::ErrorKind::NotFound.into());
        }
        self.whole_bytes += lines.len() as u64;
        self.start = None;
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::document::EditKind;
    use proptest::prelude::*;

    fn edit(name: &str) -> Edit {
        Edit {
            name: name.to_owned(),
            kind: EditKind::NoStep,
            changes: Vec::new(),
        }
    }

    fn journal(records: &[Record]) -> Vec<u8> {
        records
            .iter()
            .flat_map(|record| line(record).unwrap().into_bytes())
            .collect()
    }

    fn opened(document: &str) -> Record {
        Record::Journal {
            version: 1,
            document_sha256: document.to_owned(),
        }
    }

    fn names(bytes: &[u8], document: &str) -> Vec<String> {
        match JournalContent::parse(bytes).pending(&document.to_owned()) {
            Pending::Edits(pending) => pending.edits.into_iter().map(|edit| edit.name).collect(),
            other => panic!("{other:?}"),
        }
    }

    #[test]
    fn a_reader_finds_the_edits_that_its_document_lacks() {
        let saving = Record::Saving {
            document_sha256: "b".to_owned(),
        };
        let bytes = journal(&[
            opened("a"),
            Record::Edit(edit("1")),
            saving,
            Record::Edit(edit("2")),
        ]);
        assert_eq!(
            names(&bytes, "a"),
            ["1", "2"],
            "the document was not replaced"
        );
        assert_eq!(
            names(&bytes, "b"),
            ["2"],
            "the document was replaced, the journal was not restarted"
        );
        assert!(matches!(
            JournalContent::parse(&bytes).pending(&"c".to_owned()),
            Pending::OtherDocument { edits: 2 }
        ));
        assert!(
            names(&journal(&[opened("a")]), "c").is_empty(),
            "no edits, no matter"
        );
        let newer = Record::Journal {
            version: 2,
            document_sha256: "a".to_owned(),
        };
        assert!(matches!(
            JournalContent::parse(&journal(&[newer])).pending(&"a".to_owned()),
            Pending::Newer { version: 2 }
        ));
    }

    #[test]
    fn a_line_that_failed_half_way_is_cut_off_before_the_next() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("journal");
        let mut journal = Journal::open(&path, 0).unwrap();
        journal.restart(&"a".to_owned()).unwrap();
        journal.append(&[edit("1")]).unwrap();
        std::io::Write::write_all(&mut journal.file, b"0000ffff 0000").unwrap();
        journal.append(&[edit("2")]).unwrap();
        let bytes = std::fs::read(&path).unwrap();
        assert_eq!(names(&bytes, "a"), ["1", "2"]);
        assert_eq!(JournalContent::parse(&bytes).lost_bytes, 0);
    }

    #[test]
    fn every_cut_keeps_the_whole_lines() {
        let records = [
            opened("a"),
            Record::Edit(edit("1")),
            Record::Edit(edit("zwei")),
            Record::Edit(edit("3")),
        ];
        let bytes = journal(&records);
        let ends: Vec<usize> = (1..=4)
            .map(|count| journal(&records[..count]).len())
            .collect();
        for cut in 0..=bytes.len() {
            let content = JournalContent::parse(&bytes[..cut]);
            let whole = ends.iter().filter(|end| **end <= cut).count();
            assert_eq!(content.records.len(), whole, "cut at {cut}");
            assert_eq!(content.whole_bytes + content.lost_bytes, cut as u64);
        }
    }

    proptest! {
        #[test]
        fn any_bytes_are_read_without_panic(bytes in prop::collection::vec(any::<u8>(), 0..300)) {
            JournalContent::parse(&bytes);
        }

        #[test]
        fn a_damaged_byte_ends_the_reading_there(at in 0usize..400, flip in 1u8..=255) {
            let mut bytes = journal(&[opened("a"), Record::Edit(edit("1")), Record::Edit(edit("2"))]);
            let at = at % bytes.len();
            let before = JournalContent::parse(&bytes[..at]).records.len();
            bytes[at] ^= flip;
            prop_assert_eq!(JournalContent::parse(&bytes).records.len(), before);
        }
    }
}
