//! Opens files in a folder that may come from an untrusted source: regular files only, and no
//! symbolic links.
//!
//! A project from someone else may contain a link in place of one of the program's own files;
//! writing through it would destroy one of the user's files. A pipe would block the program
//! forever, a device would receive the data.

use std::fs::{self, File, FileType, OpenOptions};
use std::io::{self, Read as _};
use std::path::{Path, PathBuf};
use thiserror::Error;

/// One of the program's own files or folders is of another kind.
#[derive(Clone, Debug, PartialEq, Eq, Error)]
#[error("{} is {found}, not {wanted}; move it away", path.display())]
pub struct WrongKind {
    /// Its path.
    pub path: PathBuf,
    /// What it is: "a symbolic link".
    pub found: &'static str,
    /// What it should be: "a regular file".
    pub wanted: &'static str,
}

impl WrongKind {
    /// The inner error of an I/O error, if it is this one.
    pub fn behind(error: &io::Error) -> Option<&Self> {
        error.get_ref()?.downcast_ref()
    }
}

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

/// Opens a regular file. `options` must not truncate, because the file's kind is certain only once
/// it is open.
///
/// # Errors
/// [`WrongKind`], as the inner error, for a link, a folder, a pipe or a device; otherwise the
/// system's error.
pub fn open_regular(path: &Path, options: &OpenOptions) -> io::Result<File> {
    // A file that cannot be inspected may be one that `options` creates; if not, opening it gives
    // the system's error.
    if let Ok(metadata) = fs::symlink_metadata(path) {
        refuse_irregular(path, metadata.file_type())?;
    }
    let mut options = options.clone();
    // Another program may put a link or a pipe there between the check above and the opening. The
    // flags refuse the link, and open the pipe without blocking; the open file is checked again.
    #[cfg(unix)]
    {
        use std::os::unix::fs::OpenOptionsExt;
        options.custom_flags(libc::O_NOFOLLOW | libc::O_NONBLOCK);
    }
    let file = options.open(path)?;
    refuse_irregular(path, file.metadata()?.file_type())?;
    Ok(file)
}

/// Reads a whole regular file.
///
/// # Errors
/// As [`open_regular`].
pub fn read_regular(path: &Path) -> io::Result<Vec<u8>> {
    let mut bytes = Vec::new();
    open_regular(path, OpenOptions::new().read(true))?.read_to_end(&mut bytes)?;
    Ok(bytes)
}

/// Reads a whole regular file of at most `limit` bytes.
///
/// # Errors
/// As [`open_regular`]; [`NotReadable`], as the inner error, if it is larger.
pub fn read_regular_within(path: &Path, limit: u64) -> io::Result<Vec<u8>> {
    read_within(open_regular(path, OpenOptions::new().read(true))?, limit)
}

/// Reads the rest of an open file of at most `limit` bytes.
pub(super) fn read_within(file: File, limit: u64) -> io::Result<Vec<u8>> {
    // The stated size is checked first, so that a huge sparse file takes no memory.
    let stated = file.metadata()?.len();
    let mut content = Vec::new();
    if stated <= limit {
        content.reserve(stated as usize);
        // One byte more than allowed shows that the file has grown in the meantime. Reading up to
        // the limit alone would return a truncated file as if it were whole.
        file.take(limit.saturating_add(1))
            .read_to_end(&mut content)?;
    }
    let bytes = stated.max(content.len() as u64);
    if bytes > limit {
        return Err(io::Error::other(NotReadable::TooLarge { bytes, limit }));
    }
    Ok(content)
}

/// Rejects a link, or anything else that is not a folder, in the place of one of the program's own
/// folders.
///
/// # Errors
/// [`WrongKind`], as the inner error. A missing folder is not an error.
pub fn refuse_linked_folder(path: &Path) -> io::Result<()> {
    // What cannot be inspected is missing as a rule; otherwise using it gives the system's error.
    let Ok(metadata) = fs::symlink_metadata(path) else {
        return Ok(());
    };
    if metadata.is_dir() {
        return Ok(());
    }
    let found = kind_of(metadata.file_type()).unwrap_or("a file");
    Err(io::Error::other(WrongKind {
        path: path.to_path_buf(),
        found,
        wanted: "a folder",
    }))
}

fn refuse_irregular(path: &Path, file_type: FileType) -> io::Result<()> {
    let Some(found) = kind_of(file_type) else {
        return Ok(());
    };
    Err(io::Error::other(WrongKind {
        path: path.to_path_buf(),
        found,
        wanted: "a regular file",
    }))
}

/// The kind of a file that is not regular, in words.
pub(super) fn kind_of(file_type: FileType) -> Option<&'static str> {
    #[cfg(unix)]
    {
        use std::os::unix::fs::FileTypeExt;
        if file_type.is_fifo() {
            return Some("a pipe");
        }
        if file_type.is_socket() {
            return Some("a socket");
        }
        if file_type.is_char_device() || file_type.is_block_device() {
            return Some("a device");
        }
    }
    match file_type {
        _ if file_type.is_file() => None,
        _ if file_type.is_symlink() => Some("a symbolic link"),
        _ if file_type.is_dir() => Some("a folder"),
        _ => Some("something else"),
    }
}

#[cfg(test)]
#[cfg(unix)]
mod tests {
    use super::*;
    use std::os::unix::fs::symlink;

    fn refusal(path: &Path) -> String {
        open_regular(path, OpenOptions::new().read(true).write(true).create(true))
            .unwrap_err()
            .to_string()
    }

    #[test]
    fn a_link_a_pipe_a_device_and_a_folder_are_refused_by_name() {
        let folder = tempfile::tempdir().unwrap();
        let at = |name: &str| folder.path().join(name);
        std::fs::write(at("victim"), "precious").unwrap();
        symlink(at("victim"), at("link")).unwrap();
        symlink(at("nothing"), at("dangling")).unwrap();
        symlink("/dev/null", at("to a device")).unwrap();
        std::fs::create_dir(at("folder")).unwrap();
        assert!(
            std::process::Command::new("mkfifo")
                .arg(at("pipe"))
                .status()
                .unwrap()
                .success()
        );
        for (name, found) in [
            ("link", "a symbolic link"),
            ("dangling", "a symbolic link"),
            ("to a device", "a symbolic link"),
            ("folder", "a folder"),
            ("pipe", "a pipe"),
        ] {
            let expected = format!(
                "{} is {found}, not a regular file; move it away",
                at(name).display()
            );
            assert_eq!(refusal(&at(name)), expected);
            assert!(WrongKind::behind(&read_regular(&at(name)).unwrap_err()).is_some());
        }
        assert!(refusal(Path::new("/dev/null")).contains("is a device"));
        assert_eq!(std::fs::read_to_string(at("victim")).unwrap(), "precious");
        assert!(
            !at("nothing").exists(),
            "nothing is made through a dangling link"
        );
    }

    #[test]
    fn a_regular_file_is_opened_and_a_new_one_made() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("new");
        drop(open_regular(&path, OpenOptions::new().write(true).create(true)).unwrap());
        assert_eq!(read_regular(&path).unwrap(), b"");
        let missing = read_regular(&folder.path().join("missing")).unwrap_err();
        assert_eq!(missing.kind(), io::ErrorKind::NotFound);
    }

    #[test]
    fn a_folder_of_the_program_is_no_link() {
        let folder = tempfile::tempdir().unwrap();
        let link = folder.path().join("link");
        symlink(folder.path(), &link).unwrap();
        assert!(
            refuse_linked_folder(&link)
                .unwrap_err()
                .to_string()
                .contains("is a symbolic link, not a folder")
        );
        assert!(refuse_linked_folder(folder.path()).is_ok());
        assert!(refuse_linked_folder(&folder.path().join("missing")).is_ok());
    }
}
