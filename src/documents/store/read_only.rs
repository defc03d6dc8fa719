//! Why a document can only be looked at.

use std::fmt;

/// Why a document opens read-only.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum ReadOnly {
    /// Another program has it open.
    OpenElsewhere {
        /// Who, as far as it can be known: "process 4711".
        holder: String,
    },
    /// The file or its folder must not be written.
    NotWritable {
        /// What the system says.
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
