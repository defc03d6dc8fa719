//! Safe opening of files from untrusted sources: no blocking on a pipe, no reading from a device,
//! no larger size than expected.
//!
//! | what | for |
//! |---|---|
//! | [`read_named`], [`open_named`] | files that a person names; links are followed |
//! | [`read_regular`], [`open_regular`] | the program's own files in a folder that is not trusted; links are refused |
//! | [`FileCache`] | files that can be made again, of limited size |
//! | [`replace_folder`], [`refuse_other_files`], [`refuse_part_of_project`] | results: what `--force` may replace |
//!
//! Temporary files are created here too, so that all have the same kind of name and stray ones can
//! be removed.

mod file_cache;
mod regular_file;
mod replace;
mod temporary;

pub use regular_file::WrongKind;
pub use replace::NotReplaced;
// For the crates above alone: no promise to other programs.
#[doc(hidden)]
pub use {
    file_cache::{FileCache, state_of_program},
    regular_file::{
        NotReadable, open_named, open_regular, read_named, read_named_text, read_regular,
        read_regular_within, refuse_linked_folder,
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

/// A text without control characters, and without characters that change the writing direction.
pub fn plain(text: &str) -> String {
    let mut plain = String::with_capacity(text.len());
    for letter in text.chars() {
        if is_control(letter) {
            plain.extend(letter.escape_default());
        } else {
            plain.push(letter);
        }
    }
    plain
}

/// Whether a terminal or a text view obeys a character instead of showing it.
#[doc(hidden)]
pub fn is_control(letter: char) -> bool {
    // Beside the control characters: the marks, embeddings, overrides and isolates of Unicode's
    // bidirectional algorithm (UAX 9), characters of zero width, line and paragraph separators.
    letter.is_control()
        || matches!(
            letter,
            '\u{61c}'
                | '\u{200b}'..='\u{200f}'
                | '\u{2028}'..='\u{202e}'
                | '\u{2060}'..='\u{2069}'
                | '\u{feff}'
        )
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn marks_that_change_the_direction_of_writing_are_escaped() {
        for mark in [
            '\u{61c}', '\u{200e}', '\u{200f}', '\u{202a}', '\u{202e}', '\u{2060}', '\u{2066}',
            '\u{2069}',
        ] {
            let escaped = format!("a{}gpj.exe", mark.escape_default());
            assert_eq!(plain(&format!("a{mark}gpj.exe")), escaped);
        }
    }
}
