//! Where a document lives on disk: found, locked, opened with what its journal holds, journaled edit by edit, written whole and
//! atomically.

mod atomic;
mod error;
mod file_id;
mod journal;
mod location;
mod lock;
mod store;

pub use atomic::{write_atomically, write_output};
pub use error::StoreError;
pub use location::{Location, PROJECT_FILE, PROJECT_SUFFIX};
pub use lock::ReadOnly;
pub use store::{Access, Opened, Recovery, Store, open, read, write_document};
