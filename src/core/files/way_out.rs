//! Remedies for a place that cannot be written to.

use std::io::{Error, ErrorKind};

/// The remedy at the end of a message about a failed write; empty if the system's reason suffices.
#[must_use]
pub fn way_out(error: &Error) -> &'static str {
    match error.kind() {
        ErrorKind::StorageFull | ErrorKind::QuotaExceeded => "; free some space, or save elsewhere",
        ErrorKind::PermissionDenied | ErrorKind::ReadOnlyFilesystem => "; save elsewhere",
        _ => "",
    }
}
