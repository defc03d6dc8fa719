//! Reasons why a document is read-only.

use std::fmt;

/// Why a document opens read-only.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum ReadOnly {
    /// Another program has it open.
    OpenElsewhere {
        /// The process, if known: "process 4711".
        holder: String,
    },
    /// The file or its folder is not writable.
    NotWritable {
        /// The system's reason.
        reason: String,
    },
}

impl fmt::Display for ReadOnly {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::OpenElsewhere { holder } => {
                write!(
                    f,
                    "open in another touchline ({holder}); close it there to edit here"
                )
            }
            Self::NotWritable { reason } => {
                write!(f, "not writable ({reason}); save a copy elsewhere to edit")
            }
        }
    }
}
