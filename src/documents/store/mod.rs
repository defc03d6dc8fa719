//! Where a document lives on disk: found, locked, opened with what its journal holds, journaled
//! edit by edit, written whole and atomically.

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
pub use orphan::{orphans, put_orphan_away, read_orphan, save_orphan};
pub use orphan_edits::{Orphan, OrphanEdits};
pub use read_only::ReadOnly;
