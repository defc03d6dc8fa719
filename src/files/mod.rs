//! Opening files that may come from anybody: nothing hangs on a pipe, nothing reads a device, nothing is larger than expected.
//!
//! | what | for |
//! |---|---|
//! | [`read_named`], [`open_named`] | files that a person names; links are followed |
//! | [`read_regular`], [`open_regular`] | the program's own files in a folder that is not trusted; links are refused |

mod named_file;
mod not_readable;
mod regular_file;

pub use named_file::{open_named, read_named, read_named_text};
pub use not_readable::NotReadable;
pub use regular_file::{WrongKind, open_regular, read_regular, read_regular_within, refuse_linked_folder};
