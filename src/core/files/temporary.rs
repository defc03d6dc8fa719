//! Temporary files and folders beside the path to which they are renamed once they are complete.

use super::folder_of;
use std::fs::{self, Metadata};
use std::io;
use std::path::Path;
use std::time::Duration;
use tempfile::{Builder, NamedTempFile, TempDir, TempPath};

/// Prefix and suffix of temporary names.
const NAME: (&str, &str) = (".touchline-", ".tmp");
/// Age beyond which a temporary file belongs to no running program.
const STRAY: Duration = Duration::from_hours(24);

/// Makes a temporary file in a folder, with the permissions that any new file gets.
///
/// # Errors
/// The system's error, without the temporary name, which would not help the user.
pub fn temporary_file_in(folder: &Path) -> io::Result<NamedTempFile> {
    let mut builder = Builder::new();
    builder.prefix(NAME.0).suffix(NAME.1);
    // The crate's default is 0600, and a rename keeps the mode; the system takes the umask off.
    #[cfg(unix)]
    {
        use std::os::unix::fs::PermissionsExt;
        builder.permissions(fs::Permissions::from_mode(0o666));
    }
    builder
        .tempfile_in(folder)
        .map_err(|error| without_name(&error))
}

/// Gives a file a second, temporary name in its folder: a hard link.
///
/// # Errors
/// The file system has no hard links, or as [`temporary_file_in`].
pub fn temporary_link_to(path: &Path) -> io::Result<TempPath> {
    Builder::new()
        .prefix(NAME.0)
        .suffix(NAME.1)
        .make_in(folder_of(path), |name| fs::hard_link(path, name))
        .map(NamedTempFile::into_temp_path)
        .map_err(|error| without_name(&error))
}

/// Makes a temporary folder in a folder.
///
/// # Errors
/// As [`temporary_file_in`].
pub fn temporary_folder_in(folder: &Path) -> io::Result<TempDir> {
    Builder::new()
        .prefix(NAME.0)
        .suffix(NAME.1)
        .tempdir_in(folder)
        .map_err(|error| without_name(&error))
}

/// An error of the crate `tempfile`, without the temporary path that it appends.
fn without_name(error: &io::Error) -> io::Error {
    let text = error.to_string();
    let said = text.split(" at path \"").next().unwrap_or(&text);
    io::Error::new(error.kind(), said)
}

/// Removes temporary files that a killed program left in a folder. Files that cannot be inspected
/// stay. Temporary folders stay, too: one may contain the only copy of a dataset that was being
/// replaced.
pub fn remove_stray_files(folder: &Path) {
    // Cleaning up is no part of what the user wants done, so no failure is reported.
    let Ok(entries) = fs::read_dir(folder) else {
        return;
    };
    for entry in entries.flatten() {
        let name = entry.file_name();
        let name = name.to_string_lossy();
        let is_ours = name.starts_with(NAME.0) && name.ends_with(NAME.1);
        // For a link these are the metadata of the link itself, which is not a regular file.
        if is_ours && fs::symlink_metadata(entry.path()).is_ok_and(|metadata| is_stray(&metadata)) {
            let _ = fs::remove_file(entry.path());
        }
    }
}

/// Whether a temporary name belongs to a file that is so old that no running program needs it.
fn is_stray(metadata: &Metadata) -> bool {
    // Without a time, or with one in the future, the age is unknown, and the file stays.
    let age = metadata
        .modified()
        .ok()
        .and_then(|modified| modified.elapsed().ok());
    metadata.is_file() && age.is_some_and(|age| age > STRAY)
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::fs::File;

    #[test]
    fn stray_files_go_after_a_day_and_others_stay() {
        let folder = tempfile::tempdir().unwrap();
        let at = |name: &str| folder.path().join(name);
        let old = std::time::SystemTime::now() - 2 * STRAY;
        for (name, is_old) in [
            (".touchline-a.tmp", true),
            (".touchline-b.tmp", false),
            ("touchline-c.tmp", true),
        ] {
            fs::write(at(name), "x").unwrap();
            if is_old {
                File::options()
                    .write(true)
                    .open(at(name))
                    .unwrap()
                    .set_modified(old)
                    .unwrap();
            }
        }
        remove_stray_files(folder.path());
        let left = [".touchline-a.tmp", ".touchline-b.tmp", "touchline-c.tmp"]
            .map(|name| at(name).exists());
        assert_eq!(left, [false, true, true]);
    }

    #[test]
    fn a_refusal_does_not_say_the_temporary_name() {
        let missing = Path::new("/no/such/folder");
        for error in [
            temporary_file_in(missing).unwrap_err(),
            temporary_folder_in(missing).unwrap_err(),
        ] {
            assert_eq!(error.kind(), io::ErrorKind::NotFound);
            assert!(!error.to_string().contains("touchline-"), "{error}");
        }
    }
}
