//! What a person can do about a place that takes nothing.

use std::io::{Error, ErrorKind};

/// The end of a message about what could not be written; nothing where the system's reason says it
/// all.
#[must_use]
pub fn way_out(error: &Error) -> &'static str {
    match error.kind() {
        ErrorKind::StorageFull | ErrorKind::QuotaExceeded => "; free some space, or save elsewhere",
        ErrorKind::PermissionDenied | ErrorKind::ReadOnlyFilesystem => "; save elsewhere",
        _ => "",
    }
}
