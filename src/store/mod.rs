//! Where a document lives on disk: found, locked, opened with what its journal holds, journaled edit by edit, written whole and
//! atomically.

mod atomic;
mod disk;
mod error;
mod file_id;
mod journal;
mod location;
mod lock;
mod read_only;

pub(crate) use atomic::{write_atomically, write_output};
pub use disk::{Access, Opened, Recovery, Store, open, read, write_document};
pub use error::StoreError;
pub use location::Location;
pub(crate) use location::{PROJECT_FILE, PROJECT_SUFFIX};
pub use read_only::ReadOnly;
