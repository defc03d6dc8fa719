//! Why a file is not read: kind, size or encoding.

use thiserror::Error;

/// Why something is not read.
#[derive(Clone, Debug, PartialEq, Eq, Error)]
#[non_exhaustive]
pub enum NotReadable {
    /// It is not a regular file.
    #[error("it is {found}, not a file")]
    Kind {
        /// What it is: "a pipe".
        found: &'static str,
    },
    /// It is too large.
    #[error("it has {bytes} bytes, and {limit} are read at most")]
    TooLarge {
        /// Its size.
        bytes: u64,
        /// The maximum size, bytes.
        limit: u64,
    },
    /// It is not UTF-8 text.
    #[error("it is not UTF-8 text (byte {offset})")]
    NotUtf8 {
        /// The offset of the first invalid byte.
        offset: usize,
    },
}
