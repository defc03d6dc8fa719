//! Documents on disk: finding, locking, reading with recovery from the journal, journaling of each
//! edit, and atomic writes of the whole document.
//!
//! # Files
//!
//! | file | content | written |
//! |---|---|---|
//! | `project.json` | the document | on saving, atomically |
//! | `project.json.journal` | the edits since then | with each edit, flushed |
//! | `project.json.history` | the steps to undo and redo | just before the document |
//! | `project.json.bak` | the document before the last save | on saving |
//! | `project.json.lock` | the process that may write | while the document is open |
//! | `project.json.mine-N`, `.mine-N.base` | own version, common base | after a change by others |
//! | `project.json.outside-N` | the version of others | when it is overwritten |
//! | `project.json.journal.orphan-N` | edits of a document that was replaced | on opening |
//! | `project.json.journal.damaged-N` | a copy of a damaged journal | on opening |
//!
//! # Saving
//!
//! 1. A line in the journal announces the SHA-256 of the new document.
//! 2. The history is written.
//! 3. The old document becomes the backup, and the new one is written to a temporary file, flushed
//!    and renamed to its place.
//! 4. The journal is emptied and starts from the new document.
//!
//! After a crash at any moment, the journal contains a line with the hash of the document on disk,
//! and the edits after that line are those that the document lacks. The only exception is an empty
//! journal, during step 4, when the document lacks none. `faults.rs` tests this for each system
//! call: with errors, kills and power cuts.
//!
//! # Other programs
//!
//! A lock keeps a second instance of this program from writing. Sync clients and version control do
//! not respect it, so the hash of the file is compared before each save. If it has changed, nothing
//! is overwritten until the user decides; until then, the own version is kept beside the other one.

mod atomic;
mod calls;
mod disk;
mod document_store;
mod error;
#[cfg(test)]
mod faults;
mod file_id;
mod history_file;
mod journal;
mod lines;
mod location;
mod lock;
mod orphan;
mod orphan_edits;
mod own_version;
mod read_only;
mod replay;

pub use atomic::{write_atomically, write_new, write_output};
pub use disk::{Access, Opened, Recovery, Store, open, read, refuse_open, write_document};
pub use document_store::{DocumentStore, Others, Outside};
pub use error::StoreError;
pub use history_file::HistoryLeftOut;
pub use location::{Location, PROJECT_FILE, PROJECT_SUFFIX};
pub use lock::{Lock, lock_file};
pub use orphan::{orphans, put_orphan_away, read_orphan, save_orphan};
pub use orphan_edits::{Orphan, OrphanEdits};
pub use read_only::ReadOnly;
