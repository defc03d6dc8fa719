//! What `--force` may replace: files that the program writes again under the same name. All other
//! files of a folder are kept.
//!
//! A folder of results is written beside its target and then renamed, so that it is either complete
//! or absent. The folder that it replaces may by then contain anything: a project, the user's
//! notes, labels added by another program. [`refuse_other_files`] returns the first file that would
//! be lost. [`replace_folder`] checks again when the result is ready, and even then deletes only
//! files that are replaced.

use super::way_out;
use std::fs::{self, DirEntry};
use std::io;
use std::path::{Path, PathBuf};
use tempfile::TempDir;
use thiserror::Error;

/// The document's file in a project folder.
pub const PROJECT_FILE: &str = "project.json";
/// The suffix of a project's name for a folder of frames or a video: `match.mp4` lies beside
/// `match.mp4.touchline/`.
pub const PROJECT_SUFFIX: &str = ".touchline";
/// The suffixes of files that the program keeps beside a document.
const BESIDE_DOCUMENT: [&str; 3] = [".journal", ".history", ".lock"];
/// Files that file managers create in every folder. They do not prevent a replacement, and move
/// into the new folder.
const OF_FILE_MANAGERS: [&str; 3] = [".DS_Store", "Thumbs.db", "desktop.ini"];

/// Whether a file in a folder is replaced, by its name relative to the folder (with `/` as
/// separator) and its path.
pub type IsReplaced<'a> = &'a dyn Fn(&str, &Path) -> bool;

/// Why a result did not replace its target. Nothing was changed, unless the error says where the
/// old files are.
#[derive(Debug, Error)]
#[non_exhaustive]
pub enum NotReplaced {
    /// The folder contains a file that is not written again.
    #[error("{} holds {name}, which would be lost; move it away, or give another folder", folder.display())]
    OtherFile {
        /// The folder.
        folder: PathBuf,
        /// The file, from the folder.
        name: String,
    },
    /// The folder contains a project.
    #[error("{} holds a project ({name}); give another folder", folder.display())]
    Project {
        /// The folder.
        folder: PathBuf,
        /// The document, or a file beside it.
        name: String,
    },
    /// The target of a folder is a file.
    #[error("{} is a file; give a folder", path.display())]
    File {
        /// The file.
        path: PathBuf,
    },
    /// The target of a file belongs to a project.
    #[error("{} belongs to a project; give another name", path.display())]
    PartOfProject {
        /// The file.
        path: PathBuf,
    },
    /// The system refused.
    #[error("cannot write {}: {source}{}", path.display(), way_out(source))]
    Io {
        /// What was to be written.
        path: PathBuf,
        /// The system's error.
        source: io::Error,
    },
}

/// Rejects the replacement of a file of a project: its document, or a file beside a document. Only
/// the store writes these.
///
/// # Errors
/// It is such a file.
pub fn refuse_part_of_project(path: &Path) -> Result<(), NotReplaced> {
    let path = &follow_link(path);
    if path.is_file() && is_part_of_project(path) {
        return Err(NotReplaced::PartOfProject { path: path.clone() });
    }
    Ok(())
}

/// Rejects the replacement of a folder with a project or with any file that is not replaced. A
/// missing folder is not an error.
///
/// # Errors
/// The folder contains such a file, which is named; or the path is a file, or a link that leads
/// nowhere, or cannot be read.
pub fn refuse_other_files(folder: &Path, is_replaced: IsReplaced) -> Result<(), NotReplaced> {
    let metadata = match fs::metadata(folder) {
        Ok(metadata) => metadata,
        // A link that leads nowhere would move aside for the new folder.
        Err(source) if folder.is_symlink() => return Err(io_error(folder, source)),
        Err(_) => return Ok(()),
    };
    if !metadata.is_dir() {
        return Err(NotReplaced::File {
            path: folder.to_path_buf(),
        });
    }
    let other =
        find_other_file(folder, "", is_replaced).map_err(|source| io_error(folder, source))?;
    let Some(other) = other else {
        return Ok(());
    };
    let (folder, name) = (folder.to_path_buf(), other.name);
    Err(if other.is_project {
        NotReplaced::Project { folder, name }
    } else {
        NotReplaced::OtherFile { folder, name }
    })
}

/// Puts a finished temporary folder, which lies beside `path`, in the place of the folder at
/// `path`. Files of the old one that are not replaced move into the new one.
///
/// # Errors
/// As [`refuse_other_files`], or the system refuses.
pub fn replace_folder(
    new: TempDir,
    path: &Path,
    is_replaced: IsReplaced,
) -> Result<(), NotReplaced> {
    refuse_other_files(path, is_replaced)?;
    put_in_place(new, path, is_replaced).map_err(|source| io_error(path, source))
}

/// Renames a folder to `path`, moves the files of the old one that are not replaced into it and
/// deletes the old one.
fn put_in_place(new: TempDir, path: &Path, is_replaced: IsReplaced) -> io::Result<()> {
    if fs::symlink_metadata(path).is_err() {
        fs::rename(new.path(), path)?;
        // The folder is no temporary one any more: without this, it would be deleted here.
        let _ = new.keep();
        return Ok(());
    }
    // A folder cannot be renamed onto one with files, so the old one moves aside, into a folder
    // that lies in the same file system. It is deleted only when the new one is in its place.
    let aside = super::temporary_folder_in(super::folder_of(path))?;
    let old = aside.path().join("old");
    fs::rename(path, &old)?;
    // From here on the folder aside contains the only copy of the old files and must not be deleted
    // as a temporary one, whatever fails.
    let aside = aside.keep();
    if let Err(error) = fs::rename(new.path(), path) {
        fs::rename(&old, path).map_err(|_| naming_old(&error, &old))?;
        // An empty folder that stays is no loss.
        let _ = fs::remove_dir(aside);
        return Err(error);
    }
    let _ = new.keep();
    empty_folder(&old, path, "", is_replaced).map_err(|error| naming_old(&error, &old))?;
    fs::remove_dir(aside)
}

/// An error after which files of the old folder are in another place.
fn naming_old(error: &io::Error, old: &Path) -> io::Error {
    let text = format!("{error}; the old files are in {}", old.display());
    io::Error::new(error.kind(), text)
}

fn io_error(path: &Path, source: io::Error) -> NotReplaced {
    NotReplaced::Io {
        path: path.to_path_buf(),
        source,
    }
}

/// The target of a link; any other path unchanged. Writing to a link writes to its target.
pub fn follow_link(path: &Path) -> PathBuf {
    let target = if path.is_symlink() {
        fs::canonicalize(path).ok()
    } else {
        None
    };
    target.unwrap_or_else(|| path.to_path_buf())
}

/// A file that would be lost.
struct OtherFile {
    name: String,
    is_project: bool,
}

/// Finds the first file of a folder that is not replaced. Links are not followed; they count as
/// files.
fn find_other_file(
    folder: &Path,
    prefix: &str,
    is_replaced: IsReplaced,
) -> io::Result<Option<OtherFile>> {
    for entry in sorted_entries(folder)? {
        let name = format!("{prefix}{}", entry.file_name().to_string_lossy());
        // The type of the entry itself: a link to a folder is no folder here, so that the search
        // does not leave `folder`.
        let file_type = entry.file_type()?;
        if file_type.is_dir() {
            if let Some(other) = find_other_file(&entry.path(), &format!("{name}/"), is_replaced)? {
                return Ok(Some(other));
            }
            continue;
        }
        // A project is refused even if all its files would be written again.
        let is_project = is_part_of_project(&entry.path());
        let is_lost = !(file_type.is_file() && is_replaced(&name, &entry.path()));
        if is_project || (is_lost && !is_of_file_manager(&entry)) {
            return Ok(Some(OtherFile { name, is_project }));
        }
    }
    Ok(None)
}

/// Deletes the files of a folder that are replaced, moves the others into `new`, and deletes the
/// empty folder.
fn empty_folder(old: &Path, new: &Path, prefix: &str, is_replaced: IsReplaced) -> io::Result<()> {
    for entry in sorted_entries(old)? {
        let name = format!("{prefix}{}", entry.file_name().to_string_lossy());
        let file_type = entry.file_type()?;
        if file_type.is_dir() {
            empty_folder(
                &entry.path(),
                &new.join(entry.file_name()),
                &format!("{name}/"),
                is_replaced,
            )?;
        } else if file_type.is_file() && is_replaced(&name, &entry.path()) {
            fs::remove_file(entry.path())?;
        } else {
            // A file manager's, or one that came after the check: it is in the same file system, so
            // a rename moves it.
            fs::create_dir_all(new)?;
            fs::rename(entry.path(), new.join(entry.file_name()))?;
        }
    }
    fs::remove_dir(old)
}

fn sorted_entries(folder: &Path) -> io::Result<Vec<DirEntry>> {
    let mut entries = fs::read_dir(folder)?.collect::<io::Result<Vec<DirEntry>>>()?;
    entries.sort_by_key(DirEntry::file_name);
    Ok(entries)
}

fn is_of_file_manager(entry: &DirEntry) -> bool {
    OF_FILE_MANAGERS
        .iter()
        .any(|name| entry.file_name() == *name)
}

/// Whether a file is a project's document, or lies beside a document under its name.
fn is_part_of_project(path: &Path) -> bool {
    let name = path.file_name().unwrap_or_default().to_string_lossy();
    // `project.json`, and what lies beside it: `project.json.journal`, `project.json.bak`.
    let is_of_project = name
        .strip_prefix(PROJECT_FILE)
        .is_some_and(|rest| rest.is_empty() || rest.starts_with('.'));
    // A document of any other name is known by the file beside it.
    let document = BESIDE_DOCUMENT
        .iter()
        .find_map(|ending| name.strip_suffix(ending));
    is_of_project || document.is_some_and(|document| path.with_file_name(document).is_file())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::files::temporary_folder_in;

    /// A folder `out` with the files, beside a temporary folder with `a.txt`.
    fn place(files: &[&str]) -> (TempDir, TempDir) {
        let place = tempfile::tempdir().unwrap();
        for name in files {
            let path = place.path().join("out").join(name);
            fs::create_dir_all(path.parent().unwrap()).unwrap();
            fs::write(path, "old").unwrap();
        }
        let new = temporary_folder_in(place.path()).unwrap();
        fs::write(new.path().join("a.txt"), "new").unwrap();
        (place, new)
    }

    fn is_a(name: &str, _: &Path) -> bool {
        name == "a.txt" || name == "stale/a.txt"
    }

    #[test]
    fn a_folder_of_the_same_files_is_replaced_and_nothing_temporary_stays() {
        let (place, new) = place(&["a.txt", "stale/a.txt", ".DS_Store"]);
        let out = place.path().join("out");
        replace_folder(new, &out, &is_a).unwrap();
        assert_eq!(fs::read_to_string(out.join("a.txt")).unwrap(), "new");
        assert!(!out.join("stale").exists());
        assert_eq!(
            fs::read_to_string(out.join(".DS_Store")).unwrap(),
            "old",
            "it moved over"
        );
        assert_eq!(fs::read_dir(place.path()).unwrap().count(), 1);
    }

    #[test]
    fn another_file_is_named_and_stays() {
        for (name, says) in [
            (
                "sub/notes.txt",
                "holds sub/notes.txt, which would be lost; move it away, or give another folder",
            ),
            (
                "project.json",
                "holds a project (project.json); give another folder",
            ),
            (
                "project.json.journal",
                "holds a project (project.json.journal); give another folder",
            ),
        ] {
            let (place, new) = place(&["a.txt", name]);
            let out = place.path().join("out");
            let refusal = replace_folder(new, &out, &is_a).unwrap_err().to_string();
            assert!(refusal.ends_with(says), "{refusal}");
            assert_eq!(fs::read_to_string(out.join("a.txt")).unwrap(), "old");
            assert_eq!(
                fs::read_dir(place.path()).unwrap().count(),
                1,
                "nothing temporary is left"
            );
        }
    }

    #[test]
    fn a_file_that_comes_in_the_last_moment_moves_over() {
        let (place, _new) = place(&["a.txt", "late/notes.txt"]);
        let (out, new) = (place.path().join("out"), place.path().join("new"));
        fs::create_dir(&new).unwrap();
        empty_folder(&out, &new, "", &is_a).unwrap();
        assert_eq!(
            fs::read_to_string(new.join("late/notes.txt")).unwrap(),
            "old"
        );
        assert!(!out.exists());
    }

    #[test]
    fn files_that_cannot_move_over_stay_and_are_named() {
        let (place, new) = place(&["a.txt", "notes"]);
        fs::create_dir(new.path().join("notes")).unwrap();
        fs::write(new.path().join("notes/b.txt"), "new").unwrap();
        let out = place.path().join("out");
        let error = put_in_place(new, &out, &is_a).unwrap_err().to_string();
        let (_, old) = error.split_once("; the old files are in ").unwrap();
        assert_eq!(
            fs::read_to_string(Path::new(old).join("notes")).unwrap(),
            "old"
        );
        assert_eq!(fs::read_to_string(out.join("a.txt")).unwrap(), "new");
    }

    #[test]
    fn what_a_project_keeps_is_known_by_its_name() {
        let (place, _new) = place(&[
            "doc.json",
            "doc.json.journal",
            "project.json.bak",
            "own.journal",
            "project.jsonl",
        ]);
        let is_refused =
            |name: &str| refuse_part_of_project(&place.path().join("out").join(name)).is_err();
        let refused = [
            "doc.json.journal",
            "project.json.bak",
            "doc.json",
            "own.journal",
            "project.jsonl",
            "missing",
        ];
        assert_eq!(
            refused.map(is_refused),
            [true, true, false, false, false, false]
        );
    }

    #[cfg(unix)]
    #[test]
    fn a_result_has_the_permissions_of_a_new_folder_and_replaces_no_broken_link() {
        use std::os::unix::fs::PermissionsExt as _;
        let (place, new) = place(&["a.txt"]);
        let out = place.path().join("out");
        fs::set_permissions(new.path(), fs::Permissions::from_mode(0o750)).unwrap();
        replace_folder(new, &out, &is_a).unwrap();
        assert_eq!(
            fs::metadata(&out).unwrap().permissions().mode() & 0o777,
            0o750
        );

        let link = place.path().join("link");
        std::os::unix::fs::symlink(place.path().join("nowhere"), &link).unwrap();
        let new = temporary_folder_in(place.path()).unwrap();
        let refusal = replace_folder(new, &link, &is_a).unwrap_err().to_string();
        assert!(refusal.starts_with("cannot write "), "{refusal}");
        assert!(link.is_symlink());
    }

    #[cfg(unix)]
    #[test]
    fn a_link_to_a_project_is_followed_and_one_inside_is_a_file_of_its_own() {
        use std::os::unix::fs::symlink;
        let (place, new) = place(&["a.txt", "project.json"]);
        let link = place.path().join("link");
        symlink(place.path().join("out"), &link).unwrap();
        assert!(refuse_other_files(&follow_link(&link), &is_a).is_err());
        assert!(refuse_part_of_project(&link.join("project.json")).is_err());
        fs::remove_file(place.path().join("out/project.json")).unwrap();
        symlink(new.path().join("a.txt"), place.path().join("out/stale")).unwrap();
        let refusal = refuse_other_files(&follow_link(&link), &is_a)
            .unwrap_err()
            .to_string();
        assert!(
            refusal.contains("out holds stale, which would be lost"),
            "{refusal}"
        );
    }
}
