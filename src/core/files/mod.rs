//! Safe opening of files from untrusted sources: no blocking on a pipe, no reading from a device,
//! no larger size than expected.
//!
//! | what | for |
//! |---|---|
//! | [`read_named`], [`open_named`] | files that a person names; links are followed |
//! | [`read_regular`], [`open_regular`] | the program's own files in a folder that is not trusted; links are refused |
//! | [`replace_folder`], [`refuse_other_files`], [`refuse_part_of_project`] | results: what `--force` may replace |
//!
//! Temporary files are created here too, so that all have the same kind of name and stray ones can
//! be removed.

mod named_file;
mod plain;
mod regular_file;
mod replace;
mod temporary;

pub use plain::plain;
pub use regular_file::WrongKind;
pub use replace::NotReplaced;
// For the crates above alone: no promise to other programs.
#[doc(hidden)]
pub use {
    named_file::{open_named, read_named, read_named_text},
    plain::is_control,
    regular_file::{
        NotReadable, open_regular, read_regular, read_regular_within, refuse_linked_folder,
    },
    replace::{
        IsReplaced, PROJECT_FILE, PROJECT_SUFFIX, follow_link, refuse_other_files,
        refuse_part_of_project, replace_folder,
    },
    temporary::{remove_stray_files, temporary_file_in, temporary_folder_in, temporary_link_to},
};

use std::io::{Error, ErrorKind};
use std::path::Path;

/// The folder that a path lies in.
#[doc(hidden)]
pub fn folder_of(path: &Path) -> &Path {
    // The parent of a bare name is the empty path, which no system call accepts.
    path.parent()
        .filter(|folder| !folder.as_os_str().is_empty())
        .unwrap_or(Path::new("."))
}

/// The remedy at the end of a message about a failed write; empty if the system's reason suffices.
#[doc(hidden)]
pub fn way_out(error: &Error) -> &'static str {
    match error.kind() {
        ErrorKind::StorageFull | ErrorKind::QuotaExceeded => "; free some space, or save elsewhere",
        ErrorKind::PermissionDenied | ErrorKind::ReadOnlyFilesystem => "; save elsewhere",
        _ => "",
    }
}
