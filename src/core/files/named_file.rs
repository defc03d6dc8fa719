//! Files named by the user: links are followed, but the target must be a regular file of limited
//! size.

use super::NotReadable;
use super::regular_file::{kind_of, read_within};
use std::fs::{self, File, FileType, OpenOptions};
use std::io;
use std::path::Path;

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

#[cfg(test)]
#[cfg(unix)]
mod tests {
    use super::*;

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
