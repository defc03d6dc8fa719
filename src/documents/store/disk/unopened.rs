//! Documents that this program does not have open: written whole, and refused if another program
//! has them open.

use super::contents::read_journal;
use super::{Store, set_orphan_aside};
use crate::document::{Document, FORMAT_NAME, document_from_bytes, document_to_string};
use crate::store::atomic::{is_pipe_or_device, write_new, write_output};
use crate::store::journal::{DocumentHash, Journal, JournalContent, hash_of};
use crate::store::lock::{Lock, lock_or_fail};
use crate::store::{Location, StoreError};
use std::fs::OpenOptions;
use std::io::{self, Read as _};
use std::path::Path;
use touchline_core::files::{open_regular, read_regular};

/// Writes a document that this program does not have open: a command's result, a dataset, a new
/// project.
///
/// The version of a document that is replaced is kept as the backup, and a journal with edits is
/// set aside.
///
/// # Errors
/// There is a file and `replace` is false, or the file is no document; another program has the
/// document open, or it cannot be written.
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
    let text =
        document_to_string(document).map_err(|source| StoreError::from_write(path, source))?;
    if is_pipe_or_device(path) {
        return write_output(path, text.as_bytes())
            .map_err(|source| StoreError::from_io("write", path, source));
    }
    // Whatever is or was a document is replaced under its lock. A new file needs none.
    if path.exists() || location.journal().exists() || location.lock().exists() {
        return Store::replace(location, document).map(drop);
    }
    // The file is checked again as it gets its name: another program may create it meanwhile.
    write_new(path, text.as_bytes()).map_err(|source| match source.kind() {
        io::ErrorKind::AlreadyExists => StoreError::Exists {
            path: path.to_path_buf(),
        },
        _ => StoreError::from_io("write", path, source),
    })
}

/// A document that will be replaced: its place, locked until then.
#[derive(Debug)]
pub struct Reserved {
    location: Location,
    lock: Lock,
}

/// Locks a document that will be replaced, so that long work is not lost at its end; none if there
/// is no document yet.
///
/// # Errors
/// The document is open in another program, cannot be written, or the file is none.
pub fn reserve(path: &Path) -> Result<Option<Reserved>, StoreError> {
    // What does not exist is open nowhere.
    let Ok(location) = Location::find(path) else {
        return Ok(None);
    };
    refuse_other_file(location.file())?;
    let lock = lock_or_fail(&location)?;
    Ok(Some(Reserved { location, lock }))
}

impl Reserved {
    /// The document's location.
    pub const fn location(&self) -> &Location {
        &self.location
    }

    /// Replaces the document. The old one is kept as the backup, and a journal with edits is set
    /// aside.
    ///
    /// # Errors
    /// It cannot be written.
    pub fn write(self, document: &Document) -> Result<(), StoreError> {
        Store::replace_locked(&self.location, self.lock, document).map(drop)
    }
}

/// What the files of a document held when they were read.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct FilesRead {
    pub(super) hash: DocumentHash,
    /// The hash of the journal; none if it held no edit.
    pub(super) journal: Option<DocumentHash>,
    /// Whether all edits of the journal are in the document that was read.
    pub(super) is_journal_in_document: bool,
}

impl FilesRead {
    /// What the files of a document hold now.
    ///
    /// # Errors
    /// They cannot be read.
    pub fn now(location: &Location) -> Result<Self, StoreError> {
        let path = location.file();
        let bytes =
            read_regular(path).map_err(|source| StoreError::from_io("read", path, source))?;
        let journal = read_journal(&location.journal())?;
        let holds_edits = JournalContent::parse(&journal).may_hold_edits();
        Ok(Self {
            hash: hash_of(&bytes),
            journal: holds_edits.then(|| hash_of(&journal)),
            is_journal_in_document: !holds_edits,
        })
    }

    /// Writes a document that was read with these files, as long as they are the same. The edits of
    /// the journal are in it, so that the journal ends. Returns the files as they are then.
    ///
    /// # Errors
    /// Another program changed the document meanwhile or has it open, or it cannot be written.
    pub fn write_back(&self, location: &Location, document: &Document) -> Result<Self, StoreError> {
        let lock = lock_or_fail(location)?;
        // A file that was deleted is written again: there is nothing in it to lose.
        if location.file().exists() {
            let now = Self::now(location)?;
            if (&now.hash, &now.journal) != (&self.hash, &self.journal) {
                return Err(StoreError::ChangedOutside {
                    path: location.file().to_path_buf(),
                });
            }
        }
        let path = location.journal();
        if !self.is_journal_in_document {
            set_orphan_aside(&path)?;
        }
        let whole_bytes = JournalContent::parse(&read_journal(&path)?).whole_bytes;
        let journal = Journal::open(&path, whole_bytes)
            .map_err(|source| StoreError::from_io("write", &path, source))?;
        let mut store = Store::begun(location.clone(), journal, None, lock);
        // A file that was replaced since is another one for `write`.
        let on_disk = location.file().exists().then_some(&self.hash);
        store.write(document, None, on_disk)?;
        drop(store);
        Self::now(location)
    }
}

/// Number of bytes from a document's beginning in which its format is stated as a rule.
const HEAD_BYTES: u64 = 4096;

/// Refuses to replace a file that is no document by a document, such as a video that was named by
/// mistake. An empty file has nothing to lose; a pipe or a device is written to and not replaced.
///
/// # Errors
/// The file is no document.
pub fn refuse_other_file(path: &Path) -> Result<(), StoreError> {
    let head = head_of(path);
    if head.is_empty() || states_format(&head) {
        return Ok(());
    }
    // The keys may be in another order.
    let is_document = head.trim_ascii_start().first() == Some(&b'{')
        && read_regular(path).is_ok_and(|bytes| document_from_bytes(&bytes).is_ok());
    if is_document {
        return Ok(());
    }
    Err(StoreError::NotADocument {
        path: path.to_path_buf(),
    })
}

/// Refuses to replace a document by another kind of file, whatever its name.
///
/// # Errors
/// The file is a document.
pub fn refuse_document(path: &Path) -> Result<(), StoreError> {
    if states_format(&head_of(path)) {
        return Err(StoreError::IsDocument {
            path: path.to_path_buf(),
        });
    }
    Ok(())
}

/// The first bytes of a file; none of what is no file or cannot be read, which is refused with the
/// reason where it is read or written.
fn head_of(path: &Path) -> Vec<u8> {
    let mut head = Vec::new();
    let opened = open_regular(path, OpenOptions::new().read(true));
    let read = opened.and_then(|file| file.take(HEAD_BYTES).read_to_end(&mut head));
    read.map_or_else(|_| Vec::new(), |_| head)
}

/// Whether the beginning of a file states the format of documents; a damaged one does, too.
fn states_format(head: &[u8]) -> bool {
    // Forests hold documents' parts, after a beginning of their own.
    let head = head.strip_prefix(b"\xef\xbb\xbf").unwrap_or(head);
    if head.trim_ascii_start().first() != Some(&b'{') {
        return false;
    }
    let text = String::from_utf8_lossy(head);
    let words: String = text.split_whitespace().collect();
    words.contains(&format!("\"format\":\"{FORMAT_NAME}\""))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::store::read_with_state;
    use crate::testing::document;
    use std::fs;

    #[test]
    fn a_file_that_is_no_document_is_not_replaced_by_one() {
        let folder = tempfile::tempdir().unwrap();
        let written = document_to_string(&document(&["a"])).unwrap();
        // Keys in another order, as other programs write them.
        let sorted: serde_json::Value = serde_json::from_str(&written).unwrap();
        let keys = sorted.as_object().unwrap().iter().rev();
        let reversed: Vec<String> = keys
            .map(|(key, value)| format!("{key:?}:{value}"))
            .collect();
        let padding = format!("\"padding\": \"{}\",", " ".repeat(5000));
        for (content, is_replaced) in [
            (String::new(), true),
            (written[..written.len() / 2].to_owned(), true),
            (format!("{{{}}}", reversed.join(",")), true),
            (written.replacen('{', &format!("{{{padding}"), 1), true),
            ("{\"images\": []}".to_owned(), false),
            ("\u{0}\u{0}\u{0}\u{18}ftypisom".to_owned(), false),
        ] {
            let path = folder.path().join("file");
            fs::write(&path, &content).unwrap();
            let location = Location::for_new_document(&path).unwrap();
            let replaced = write_document(&location, &document(&["b"]), true);
            assert_eq!(replaced.is_ok(), is_replaced, "{content}: {replaced:?}");
            if !is_replaced {
                assert_eq!(fs::read_to_string(&path).unwrap(), content);
                assert!(reserve(&path).is_err());
            }
        }
    }

    #[test]
    fn a_document_that_changed_since_it_was_read_is_not_written_back() {
        let folder = tempfile::tempdir().unwrap();
        let location = Location::for_new_document(&folder.path().join("project.json")).unwrap();
        write_document(&location, &document(&["a"]), false).unwrap();
        let (_, _, _, first) = read_with_state(location.file()).unwrap();
        let second = first.write_back(&location, &document(&["b"])).unwrap();
        let refused = first.write_back(&location, &document(&["c"]));
        assert!(
            matches!(refused, Err(StoreError::ChangedOutside { .. })),
            "{refused:?}"
        );
        second.write_back(&location, &document(&["c"])).unwrap();
        let (_, now, _, _) = read_with_state(location.file()).unwrap();
        assert_eq!(now.frames, document(&["c"]).frames);
        assert_eq!(
            fs::read_dir(folder.path()).unwrap().count(),
            2,
            "and a backup"
        );
    }
}
