//! Atomic replacement of files: after a crash, a file has its old or its new content, never a part
//! of it.

use super::calls;
use std::fs::{self, OpenOptions};
use std::io::{self, Write};
use std::path::{Path, PathBuf};
use tempfile::{NamedTempFile, TempPath};
pub(super) use touchline_core::files::folder_of;

/// Writes a file so that a crash or a full disk at any moment leaves the old content or the new
/// one: writes a temporary file in the same folder, flushes and renames it, and flushes the folder.
/// Keeps the permissions of the file that is replaced.
///
/// # Errors
/// The folder is missing or not writable, or the disk is full; the old file is untouched.
pub fn write_atomically(path: &Path, bytes: &[u8]) -> io::Result<()> {
    write_whole(path, bytes, true)
}

/// Replaces a file as [`write_atomically`] does and keeps the old one as `backup`, unless
/// `is_replaced` says that another program has replaced the old one meanwhile. Returns whether it
/// was written. The check comes after the flush, just before the rename: the flush takes long
/// enough for a sync client to write the file.
///
/// An older backup is replaced only after the file was: a write that fails costs neither.
///
/// # Errors
/// As [`write_atomically`], or the backup cannot be made.
pub(super) fn write_keeping_backup(
    path: &Path,
    bytes: &[u8],
    backup: &Path,
    is_replaced: &dyn Fn() -> bool,
) -> io::Result<bool> {
    // A folder in the place of the backup could not be replaced, which would show too late.
    if fs::symlink_metadata(backup).is_ok_and(|there| there.is_dir()) {
        return Err(io::Error::new(
            io::ErrorKind::IsADirectory,
            format!("the backup {} is a folder", backup.display()),
        ));
    }
    let file = write_temporary(path, bytes)?;
    if is_replaced() {
        return Ok(false);
    }
    let old = if path.exists() {
        Some(name_temporarily(path)?)
    } else {
        None
    };
    calls::persist(file, path, true)?;
    if let Some(old) = old {
        calls::persist_name(old, backup)?;
    }
    calls::flush_folder(folder_of(path))?;
    Ok(true)
}

/// Writes a new file. A file that another program creates meanwhile is not replaced.
///
/// # Errors
/// The file exists; otherwise as [`write_atomically`].
pub fn write_new(path: &Path, bytes: &[u8]) -> io::Result<()> {
    write_whole(path, bytes, false)
}

/// Writes a file by way of a temporary one. `replace` decides whether a file at `path` may be
/// replaced.
fn write_whole(path: &Path, bytes: &[u8], replace: bool) -> io::Result<()> {
    let file = write_temporary(path, bytes)?;
    calls::persist(file, path, replace)?;
    calls::flush_folder(folder_of(path))
}

/// Writes the future content of a file under a temporary name beside it, with the permissions of
/// the file that it will replace.
fn write_temporary(path: &Path, bytes: &[u8]) -> io::Result<NamedTempFile> {
    // In the same folder, because a rename is atomic only within a file system. If a call fails,
    // the temporary file is deleted as it is dropped.
    let mut file = calls::temporary_in(folder_of(path))?;
    calls::write_all(file.as_file_mut(), bytes)?;
    if let Ok(old) = fs::metadata(path) {
        file.as_file().set_permissions(old.permissions())?;
    }
    // The content must be on the disk before the name: otherwise a power cut could leave the new
    // name with an empty file.
    calls::flush(file.as_file(), file.path())?;
    Ok(file)
}

/// Gives a file a second, temporary name, under which its content stays when it is replaced.
fn name_temporarily(path: &Path) -> io::Result<TempPath> {
    // A hard link is instant. File systems without hard links get a copy.
    calls::link_temporarily(path)
        .or_else(|_| Ok(write_temporary(path, &fs::read(path)?)?.into_temp_path()))
}

/// Writes a result to a path that a user named. A regular file is replaced as by
/// [`write_atomically`]; if a link leads to it, the link stays. A pipe or a device is written to.
///
/// # Errors
/// As [`write_atomically`], or the pipe or device refuses the bytes.
pub fn write_output(path: &Path, bytes: &[u8]) -> io::Result<()> {
    // The metadata are those of a link's target. A regular file is replaced at its real path,
    // because a rename over the link would replace the link.
    match fs::metadata(path) {
        Ok(there) if there.is_file() => write_atomically(&fs::canonicalize(path)?, bytes),
        Ok(there) if !there.is_dir() => OpenOptions::new().write(true).open(path)?.write_all(bytes),
        // A link to a file that does not exist yet; there is nothing to lose.
        Err(_) if path.is_symlink() => fs::write(path, bytes),
        Ok(_) | Err(_) => write_atomically(path, bytes),
    }
}

/// Whether the path leads to a pipe or a device, which is written to instead of replaced.
pub(super) fn is_pipe_or_device(path: &Path) -> bool {
    fs::metadata(path).is_ok_and(|there| !there.is_file() && !there.is_dir())
}

/// Renames `file` to the first free name of `path.WORD-1`, `path.WORD-2`, …, so that nothing is
/// overwritten. Returns that name.
pub(super) fn set_aside(path: &Path, file: &Path, word: &str) -> io::Result<PathBuf> {
    let free = free_name(path, word, "");
    calls::rename(file, &free)?;
    calls::flush_folder(folder_of(path))?;
    Ok(free)
}

/// Copies a file to the first free name of `path.WORD-1`, `path.WORD-2`, …. Returns that name.
pub(super) fn copy_aside(path: &Path, word: &str) -> io::Result<PathBuf> {
    let free = free_name(path, word, "");
    copy_new(path, &free)?;
    Ok(free)
}

/// Copies a file, whole or not at all, to a name that is not in use.
fn copy_new(path: &Path, to: &Path) -> io::Result<()> {
    write_new(to, &fs::read(path)?)
}

/// Writes a new file under the first free name of `path.WORD-1ENDING`, `path.WORD-2ENDING`, ….
/// Returns that name.
pub(super) fn write_new_as(
    path: &Path,
    word: &str,
    ending: &str,
    bytes: &[u8],
) -> io::Result<PathBuf> {
    let free = free_name(path, word, ending);
    write_new(&free, bytes)?;
    Ok(free)
}

/// The first name of `path.WORD-1ENDING`, `path.WORD-2ENDING`, … that nothing has, not even a link
/// that leads nowhere.
fn free_name(path: &Path, word: &str, ending: &str) -> PathBuf {
    let mut number = 1;
    loop {
        let candidate = with_suffix(path, &format!(".{word}-{number}{ending}"));
        if fs::symlink_metadata(&candidate).is_err() {
            return candidate;
        }
        number += 1;
    }
}

/// A path with something appended to its file name: `project.json` + `.bak`.
pub(super) fn with_suffix(path: &Path, suffix: &str) -> PathBuf {
    let mut name = path.as_os_str().to_owned();
    name.push(suffix);
    PathBuf::from(name)
}

/// The name of a file, without its folder.
pub(super) fn file_name(path: &Path) -> String {
    path.file_name()
        .unwrap_or_default()
        .to_string_lossy()
        .into_owned()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_new_file_replaces_none() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("new");
        write_new(&path, b"first").unwrap();
        assert_eq!(
            write_new(&path, b"second").unwrap_err().kind(),
            io::ErrorKind::AlreadyExists
        );
        assert_eq!(fs::read(&path).unwrap(), b"first");
        assert_eq!(
            fs::read_dir(folder.path()).unwrap().count(),
            1,
            "no temporary file is left"
        );
    }

    #[test]
    fn a_file_is_replaced_whole_and_keeps_its_permissions() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("a.json");
        write_atomically(&path, b"one").unwrap();
        #[cfg(unix)]
        {
            use std::os::unix::fs::PermissionsExt;
            fs::set_permissions(&path, fs::Permissions::from_mode(0o640)).unwrap();
        }
        write_atomically(&path, b"two").unwrap();
        assert_eq!(fs::read(&path).unwrap(), b"two");
        #[cfg(unix)]
        {
            use std::os::unix::fs::PermissionsExt;
            assert_eq!(
                fs::metadata(&path).unwrap().permissions().mode() & 0o777,
                0o640
            );
        }
        assert_eq!(
            fs::read_dir(folder.path()).unwrap().count(),
            1,
            "no temporary file is left"
        );
    }

    #[cfg(unix)]
    #[test]
    fn a_link_keeps_its_target_and_a_device_is_written_to() {
        use std::os::unix::fs::{FileTypeExt as _, symlink};
        let folder = tempfile::tempdir().unwrap();
        let at = |name: &str| folder.path().join(name);
        fs::write(at("target"), "old").unwrap();
        for (link, target) in [
            ("link", at("target")),
            ("ahead", at("to come")),
            ("null", "/dev/null".into()),
        ] {
            symlink(target, at(link)).unwrap();
            write_output(&at(link), b"new").unwrap();
            assert!(at(link).is_symlink(), "{link} was replaced");
        }
        assert_eq!(
            (
                fs::read(at("target")).unwrap(),
                fs::read(at("to come")).unwrap()
            ),
            (b"new".into(), b"new".into())
        );
        assert!(
            fs::metadata(at("null"))
                .unwrap()
                .file_type()
                .is_char_device()
        );
    }

    #[test]
    fn a_backup_changes_together_with_its_file() {
        let folder = tempfile::tempdir().unwrap();
        let at = |name: &str| folder.path().join(name);
        let read = || ["a", "a.bak"].map(|name| fs::read_to_string(at(name)).unwrap_or_default());
        let write = |text: &str, is_replaced: bool| {
            write_keeping_backup(&at("a"), text.as_bytes(), &at("a.bak"), &|| is_replaced)
        };
        assert!(write("1", false).unwrap());
        assert_eq!(read(), ["1", ""], "nothing was replaced");
        assert!(write("2", false).unwrap() && write("3", false).unwrap());
        assert_eq!(read(), ["3", "2"]);
        assert!(!write("4", true).unwrap());
        assert_eq!(
            read(),
            ["3", "2"],
            "a write that is refused costs no backup"
        );
        fs::remove_file(at("a.bak")).unwrap();
        fs::create_dir(at("a.bak")).unwrap();
        assert!(write("4", false).is_err());
        assert_eq!(read(), ["3", ""]);
        assert_eq!(fs::read_dir(folder.path()).unwrap().count(), 2);
    }

    #[test]
    fn a_write_that_fails_leaves_the_old_file() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("folder");
        fs::create_dir(&path).unwrap();
        assert!(write_atomically(&path, b"x").is_err());
        assert!(write_atomically(&folder.path().join("missing/a.json"), b"x").is_err());
        assert_eq!(
            fs::read_dir(folder.path()).unwrap().count(),
            1,
            "no temporary file is left"
        );
    }

    #[test]
    fn what_is_set_aside_never_replaces_anything() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("a");
        for content in ["1", "2"] {
            fs::write(&path, content).unwrap();
            set_aside(&path, &path, "orphan").unwrap();
        }
        assert_eq!(
            fs::read_to_string(folder.path().join("a.orphan-1")).unwrap(),
            "1"
        );
        assert_eq!(
            fs::read_to_string(folder.path().join("a.orphan-2")).unwrap(),
            "2"
        );
    }
}
