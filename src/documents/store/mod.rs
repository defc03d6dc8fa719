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
//! | `project.json.result-N.json` | a command's result that cannot be joined | by the command |
//! | `project.json.journal.damaged-N` | a copy of a damaged journal | on opening |
//!
//! # Saving
//!
//! 1. A line in the journal announces the SHA-256 of the new document.
//! 2. The history is written.
//! 3. The new document is written to a temporary file, flushed and renamed to its place; the old
//!    one then becomes the backup.
//! 4. The journal is emptied and starts from the new document.
//!
//! After a crash at any moment, the journal contains a line with the hash of the document on disk,
//! and the edits after that line are those that the document lacks. The only exception is an empty
//! journal, during step 4, when the document lacks none. `faults.rs` tests this for each system
//! call: with errors, kills and power cuts.
//!
//! # Reading in order to write
//!
//! [`open_for_writing`] is for a command that writes its result into the document that it read: it
//! holds the lock in between, and [`OpenForWriting::commit`] joins the result with what other
//! programs wrote meanwhile. [`FilesRead::write_back`] is for a program that holds no lock: it
//! refuses a file that is another one by then. [`reserve`] locks a document that will be replaced.
//!
//! # Other programs
//!
//! A lock keeps a second instance of this program from writing. Sync clients and version control do
//! not respect it, so the hash of the file is compared before each save. If it has changed, nothing
//! is overwritten until the user decides; until then, the own version is kept beside the other one.

mod atomic;
mod calls;
mod disk;
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

pub use disk::{Access, Opened, Outside, Recovery, Store, open, read, write_document};
pub use error::StoreError;
pub use history_file::HistoryLeftOut;
pub use location::Location;
pub use read_only::ReadOnly;
// For the crates above alone: no promise to other programs.
#[doc(hidden)]
pub use {
    atomic::{write_atomically, write_new, write_output},
    disk::{
        FilesRead, OpenForWriting, Others, Reserved, open_for_writing, read_with_state,
        refuse_document, refuse_other_file, reserve,
    },
    location::{PROJECT_FILE, PROJECT_SUFFIX},
    lock::{Lock, lock_file},
    orphan::{orphans, put_orphan_away, read_orphan, save_orphan},
    orphan_edits::{Orphan, OrphanEdits},
};
