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

/// Opens a file for reading. It must be a regular file, or a link to one.
///
/// # Errors
/// [`NotReadable`], as the inner error, for a folder, a pipe, a socket or a device; else the
/// system's error.
pub fn open_named(path: &Path) -> io::Result<File> {
    // The check before the opening, because opening a device may already have an effect.
    refuse_kind(fs::metadata(path)?.file_type())?;
    let mut options = OpenOptions::new();
    options.read(true);
    // Another program may put a pipe there between the check above and the opening. Without the
    // flag, opening a pipe that has no writer blocks; for regular files it has no effect.
    #[cfg(unix)]
    {
        use std::os::unix::fs::OpenOptionsExt;
        options.custom_flags(libc::O_NONBLOCK);
    }
    let file = options.open(path)?;
    refuse_kind(file.metadata()?.file_type())?;
    Ok(file)
}

/// Reads a file of at most `limit` bytes.
///
/// # Errors
/// As [`open_named`]; [`NotReadable`], as the inner error, if it is larger.
pub fn read_named(path: &Path, limit: u64) -> io::Result<Vec<u8>> {
    read_within(open_named(path)?, limit)
}

/// Reads a UTF-8 text of at most `limit` bytes, without its byte order mark.
///
/// # Errors
/// As [`read_named`]; [`NotReadable`], as the inner error, if it is not UTF-8.
pub fn read_named_text(path: &Path, limit: u64) -> io::Result<String> {
    let text = String::from_utf8(read_named(path, limit)?).map_err(|error| {
        let offset = error.utf8_error().valid_up_to();
        io::Error::other(NotReadable::NotUtf8 { offset })
    })?;
    // Some editors on Windows begin a UTF-8 file with the mark, which no JSON reader accepts.
    Ok(text
        .strip_prefix('\u{feff}')
        .map(ToOwned::to_owned)
        .unwrap_or(text))
}

fn refuse_kind(file_type: FileType) -> io::Result<()> {
    kind_of(file_type).map_or(Ok(()), |found| {
        Err(io::Error::other(NotReadable::Kind { found }))
    })
}

#[cfg(unix)]
#[cfg(test)]
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

    #[test]
    fn pipes_devices_and_folders_are_refused_and_links_followed() {
        let folder = tempfile::tempdir().unwrap();
        let at = |name: &str| folder.path().join(name);
        fs::write(at("file"), "\u{feff}text").unwrap();
        std::os::unix::fs::symlink(at("file"), at("link")).unwrap();
        std::os::unix::fs::symlink("/dev/zero", at("endless")).unwrap();
        std::os::unix::fs::symlink(at("circle"), at("circle")).unwrap();
        assert!(
            std::process::Command::new("mkfifo")
                .arg(at("pipe"))
                .status()
                .unwrap()
                .success()
        );
        assert_eq!(read_named_text(&at("link"), 100).unwrap(), "text");
        let refusal = |name: &str| read_named(&at(name), 100).unwrap_err().to_string();
        assert_eq!(refusal("pipe"), "it is a pipe, not a file");
        assert_eq!(refusal("endless"), "it is a device, not a file");
        assert_eq!(refusal("."), "it is a folder, not a file");
        assert!(
            refusal("circle").contains("symbolic links"),
            "{}",
            refusal("circle")
        );
        assert_eq!(
            read_named(&at("missing"), 100).unwrap_err().kind(),
            io::ErrorKind::NotFound
        );
    }

    #[test]
    fn what_is_too_large_or_no_text_is_refused() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("file");
        fs::write(&path, b"abc\xff").unwrap();
        for limit in [4, u64::MAX] {
            assert_eq!(read_named(&path, limit).unwrap(), b"abc\xff");
        }
        let refusal = read_named(&path, 3).unwrap_err().to_string();
        assert_eq!(refusal, "it has 4 bytes, and 3 are read at most");
        assert_eq!(
            read_named_text(&path, 4).unwrap_err().to_string(),
            "it is not UTF-8 text (byte 3)"
        );
        // A file with a huge apparent size takes no memory.
        File::create(&path).unwrap().set_len(1 << 40).unwrap();
        assert!(read_named(&path, 1 << 20).is_err());
    }
}
