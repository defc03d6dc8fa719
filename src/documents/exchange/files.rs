//! The files of an export or import in memory, written completely or not at all, and read with
//! limits.

use super::error::{ExchangeError, Problem};
use std::collections::BTreeMap;
use std::fs::{self, OpenOptions};
use std::io::{self, Write as _};
use std::path::{Path, PathBuf};
use touchline_core::files::{
    NotReadable, folder_of, follow_link, read_named, refuse_part_of_project, replace_folder,
    temporary_file_in, temporary_folder_in,
};

/// The maximum size of a file that is read, bytes.
pub const MAX_FILE_BYTES: u64 = 64 << 20;
/// The maximum total size of the files read from one folder, bytes.
const MAX_TOTAL_BYTES: u64 = 1 << 30;
/// The maximum number of files inspected in one folder.
const MAX_FILES: usize = 500_000;
/// The maximum depth to which folders are searched.
const MAX_DEPTH: usize = 5;

/// The name of a file without its folders, whichever system its path was written on.
pub fn base_name(path: &str) -> &str {
    path.rsplit(['/', '\\']).next().unwrap_or(path)
}

/// The folder of a file's path, with its last `/`; empty if there is none.
pub fn folder_prefix(path: &str) -> &str {
    path.rfind('/').map_or("", |at| &path[..=at])
}

/// A file's ending in small letters; empty where it has none.
pub fn ending_of(name: &str) -> String {
    let ending = base_name(name).rsplit_once('.').map(|(_, ending)| ending);
    ending.unwrap_or_default().to_ascii_lowercase()
}

/// A file's name or path without the ending.
pub fn without_ending(path: &str) -> &str {
    path.rsplit_once('.').map_or(path, |(stem, _)| stem)
}

/// A file's name without folders and ending.
pub fn stem(path: &str) -> &str {
    without_ending(base_name(path))
}

/// Files by their path within a common folder, with `/` between the parts.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Files(BTreeMap<String, Vec<u8>>);

impl Files {
    /// One file.
    pub fn one(name: &str, bytes: Vec<u8>) -> Self {
        Self(BTreeMap::from([(name.to_owned(), bytes)]))
    }

    /// Adds a file; the caller ensures that names are unique.
    pub fn add(&mut self, name: impl Into<String>, bytes: impl Into<Vec<u8>>) {
        self.0.insert(name.into(), bytes.into());
    }

    /// All files by name, in natural order of the numbers within the names.
    pub fn sorted_entries(&self) -> Vec<(&str, &[u8])> {
        let mut files: Vec<(&str, &[u8])> = self
            .0
            .iter()
            .map(|(name, bytes)| (name.as_str(), &bytes[..]))
            .collect();
        // Natural order puts `9.txt` before `10.txt`. Formats without frame numbers take the frames
        // in this order.
        files.sort_by(|a, b| alphanumeric_sort::compare_str(a.0, b.0));
        files
    }

    /// Reads every file, in order, and returns the concatenated results.
    ///
    /// # Errors
    /// One of them is damaged; it is named.
    pub(super) fn read_all<T, I: IntoIterator<Item = T>>(
        &self,
        mut read: impl FnMut(&str, &[u8]) -> Result<I, Problem>,
    ) -> Result<Vec<T>, ExchangeError> {
        let mut all = Vec::new();
        for (name, bytes) in self.sorted_entries() {
            all.extend(read(name, bytes).map_err(|problem| problem.within(name))?);
        }
        Ok(all)
    }

    /// A file by name.
    pub fn get(&self, name: &str) -> Option<&[u8]> {
        self.0.get(name).map(Vec::as_slice)
    }

    /// How many there are.
    pub fn len(&self) -> usize {
        self.0.len()
    }

    /// Whether there is none.
    pub fn is_empty(&self) -> bool {
        self.0.is_empty()
    }

    /// Reads a file, or those files of a folder whose names are accepted. Links are not followed.
    ///
    /// # Errors
    /// Something cannot be read, is too large, or the folder holds too much.
    pub(super) fn read(
        path: &Path,
        is_wanted: &dyn Fn(&str) -> bool,
    ) -> Result<Self, ExchangeError> {
        let mut files = Self::default();
        // A path that the user gives is followed through a link, and it is read whatever its name;
        // only the files of a folder must be wanted.
        let metadata = fs::metadata(path).map_err(|source| cannot_read(path, source))?;
        if !metadata.is_dir() {
            let name = path
                .file_name()
                .unwrap_or_default()
                .to_string_lossy()
                .into_owned();
            let bytes = read_limited(path, &name)?;
            files.add(name, bytes);
            return Ok(files);
        }
        let mut reader = FolderReader {
            root: path,
            is_wanted,
            seen: 0,
            total: 0,
            files,
        };
        reader.folder(path, "", 0)?;
        Ok(reader.files)
    }

    /// Reads as [`Self::read`] does, at least one file. `wanted` describes the files in errors.
    ///
    /// # Errors
    /// Those of [`Self::read`], and that no name is accepted.
    pub(super) fn read_some(
        path: &Path,
        is_wanted: &dyn Fn(&str) -> bool,
        wanted: &'static str,
    ) -> Result<Self, ExchangeError> {
        let files = Self::read(path, is_wanted)?;
        if files.is_empty() {
            return Err(no_files(path, wanted));
        }
        Ok(files)
    }

    /// Writes the only file to `path`, or all of them into a new folder there. Everything is first
    /// written to a temporary place beside it and then renamed. `force` replaces files of the same
    /// names; a folder with other files is not replaced.
    ///
    /// # Errors
    /// Something is there already and `force` was not given, other files would be lost, or it
    /// cannot be written; nothing was changed then.
    pub fn write(&self, path: &Path, is_folder: bool, force: bool) -> Result<(), ExchangeError> {
        if !force && path.exists() && !is_empty_folder(path) {
            return Err(ExchangeError::Exists {
                path: path.to_path_buf(),
            });
        }
        // Errors name the path as it was given, not the target of a link.
        let target = &follow_link(path);
        if is_folder {
            let new = self
                .write_temporary_folder(target)
                .map_err(|source| cannot_write(path, source))?;
            // The folder that is replaced may have files of the same names alone, so that nothing
            // else is lost.
            return Ok(replace_folder(new, target, &|name, _| {
                self.0.contains_key(name)
            })?);
        }
        refuse_part_of_project(target)?;
        self.write_file(target)
            .map_err(|source| cannot_write(path, source))
    }

    fn write_file(&self, path: &Path) -> io::Result<()> {
        // The only file; an export without files writes an empty one.
        let bytes = self.0.values().next().map_or(&[][..], Vec::as_slice);
        // A pipe or a device, such as `/dev/stdout`, is written into: a rename would replace it.
        if fs::metadata(path).is_ok_and(|there| !there.is_file() && !there.is_dir()) {
            return OpenOptions::new().write(true).open(path)?.write_all(bytes);
        }
        // The bytes reach the disk before the rename, so that after a power failure either the old
        // or the new file is there, never an empty one.
        let mut file = temporary_file_in(folder_of(path))?;
        file.as_file_mut().write_all(bytes)?;
        file.as_file().sync_all()?;
        file.persist(path).map(drop).map_err(|error| error.error)
    }

    /// The files in a temporary folder beside `path`.
    fn write_temporary_folder(&self, path: &Path) -> io::Result<tempfile::TempDir> {
        let new = temporary_folder_in(folder_of(path))?;
        for (name, bytes) in &self.0 {
            write_new(&new.path().join(name), bytes)?;
        }
        Ok(new)
    }
}

/// Writes a file, and the folders that it lies in.
pub(super) fn write_new(file: &Path, bytes: &[u8]) -> io::Result<()> {
    fs::create_dir_all(folder_of(file))?;
    fs::write(file, bytes)
}

/// The error that a file or folder holds nothing of what is wanted.
pub(super) fn no_files(path: &Path, wanted: &'static str) -> ExchangeError {
    ExchangeError::NoFiles {
        path: path.to_path_buf(),
        wanted,
    }
}

/// The error that a file or folder cannot be read.
pub(super) fn cannot_read(path: &Path, source: io::Error) -> ExchangeError {
    ExchangeError::Read {
        path: path.to_path_buf(),
        source,
    }
}

/// The error that a file or folder cannot be written.
pub(super) fn cannot_write(path: &Path, source: io::Error) -> ExchangeError {
    ExchangeError::Write {
        path: path.to_path_buf(),
        source,
    }
}

/// An empty folder counts as absent.
fn is_empty_folder(path: &Path) -> bool {
    fs::read_dir(path).is_ok_and(|mut entries| entries.next().is_none())
}

/// Reads the wanted files of a folder and those in it.
struct FolderReader<'a> {
    root: &'a Path,
    is_wanted: &'a dyn Fn(&str) -> bool,
    seen: usize,
    total: u64,
    files: Files,
}

impl FolderReader<'_> {
    fn folder(&mut self, folder: &Path, prefix: &str, depth: usize) -> Result<(), ExchangeError> {
        // All entries are counted, wanted or not: `/` or a home folder must end in an error, not in
        // a search of minutes. Names are relative to the root, with `/` on every system.
        let mut entries: Vec<(String, PathBuf, fs::FileType)> = Vec::new();
        for entry in fs::read_dir(folder).map_err(|source| cannot_read(folder, source))? {
            let entry = entry.map_err(|source| cannot_read(folder, source))?;
            let name = format!("{prefix}{}", entry.file_name().to_string_lossy());
            let kind = entry
                .file_type()
                .map_err(|source| cannot_read(folder, source))?;
            entries.push((name, entry.path(), kind));
            self.seen += 1;
            if self.seen > MAX_FILES {
                return Err(ExchangeError::TooMuch {
                    path: self.root.to_path_buf(),
                    limit: "500 000 files",
                });
            }
        }
        // The order of `read_dir` differs between systems; the limits below must stop at the same
        // file everywhere.
        entries.sort_by(|a, b| a.0.cmp(&b.0));
        for (name, path, kind) in entries {
            // `file_type` does not follow links, so that a link is neither a folder nor a file
            // here. A link to a parent folder would otherwise be searched without end.
            if kind.is_dir() && depth < MAX_DEPTH {
                self.folder(&path, &format!("{name}/"), depth + 1)?;
            } else if kind.is_file() && (self.is_wanted)(&name) {
                // Only names that are not UTF-8 can become equal as text. One of the two files
                // would be lost without a word.
                if self.files.get(&name).is_some() {
                    let reason = "its name is not UTF-8 and reads as another file's; rename it";
                    let source = io::Error::new(io::ErrorKind::InvalidData, reason);
                    return Err(cannot_read(&path, source));
                }
                let bytes = read_limited(&path, &name)?;
                self.total += bytes.len() as u64;
                if self.total > MAX_TOTAL_BYTES {
                    return Err(ExchangeError::TooMuch {
                        path: self.root.to_path_buf(),
                        limit: "1 GiB",
                    });
                }
                self.files.add(name, bytes);
            }
        }
        Ok(())
    }
}

/// Reads a file up to the limit.
fn read_limited(path: &Path, name: &str) -> Result<Vec<u8>, ExchangeError> {
    read_named(path, MAX_FILE_BYTES).map_err(|source| {
        // The limit is an error about the file, in the words of this room; all others are the
        // system's.
        match source
            .get_ref()
            .and_then(|inner| inner.downcast_ref::<NotReadable>())
        {
            Some(NotReadable::TooLarge { bytes, limit }) => Problem::TooLarge {
                bytes: *bytes,
                limit: *limit,
            }
            .within(name),
            _ => cannot_read(path, source),
        }
    })
}

/// Rejects archives: the user unpacks them and sees where the contents go.
///
/// # Errors
/// It is one.
pub(super) fn refuse_archive(bytes: &[u8]) -> Result<(), Problem> {
    // The first bytes of each kind of archive.
    const ARCHIVES: [(&[u8], &str); 3] = [
        (b"PK\x03\x04", "zip"),
        (b"\x1f\x8b", "gzip"),
        (b"7z\xbc\xaf", "7z"),
    ];
    let found = ARCHIVES
        .into_iter()
        .find(|(magic, _)| bytes.starts_with(magic));
    found.map_or(Ok(()), |(_, kind)| Err(Problem::Archive(kind)))
}

/// The text of a file, without a byte order mark.
///
/// # Errors
/// It is empty, an archive or not UTF-8.
pub(super) fn text(bytes: &[u8]) -> Result<&str, Problem> {
    refuse_archive(bytes)?;
    let text = std::str::from_utf8(bytes).map_err(|error| Problem::NotUtf8 {
        offset: error.valid_up_to(),
    })?;
    // Excel and Notepad put a byte order mark before UTF-8.
    let text = text.strip_prefix('\u{feff}').unwrap_or(text);
    if text.trim().is_empty() {
        Err(Problem::Empty)
    } else {
        Ok(text)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn names(folder: &Path) -> Vec<String> {
        let files = Files::read(folder, &|_| true).unwrap();
        files
            .sorted_entries()
            .into_iter()
            .map(|(name, _)| name.to_owned())
            .collect()
    }

    #[test]
    fn a_folder_is_written_whole_and_replaced_only_by_force() {
        let place = tempfile::tempdir().unwrap();
        let path = place.path().join("out");
        let mut files = Files::default();
        files.add("labels/10.txt", "ten");
        files.add("labels/9.txt", "nine");
        files.write(&path, true, false).unwrap();
        assert_eq!(names(&path), ["labels/9.txt", "labels/10.txt"]);
        let other = Files::one("labels/9.txt", b"other".to_vec());
        let refusal = other.write(&path, true, false).unwrap_err().to_string();
        assert!(
            refusal.ends_with("out already exists; give --force to replace it, or another -o"),
            "{refusal}"
        );
        let refusal = other.write(&path, true, true).unwrap_err().to_string();
        assert!(
            refusal.contains("out holds labels/10.txt, which would be lost"),
            "{refusal}"
        );
        files.add("labels/9.txt", "other");
        files.write(&path, true, true).unwrap();
        assert_eq!(fs::read(path.join("labels/9.txt")).unwrap(), b"other");
        assert_eq!(
            fs::read_dir(place.path()).unwrap().count(),
            1,
            "nothing temporary is left"
        );
    }

    #[test]
    fn a_file_too_large_is_refused_before_it_is_read() {
        let place = tempfile::tempdir().unwrap();
        let path = place.path().join("large.json");
        fs::File::create(&path)
            .unwrap()
            .set_len(MAX_FILE_BYTES + 1)
            .unwrap();
        let error = Files::read(&path, &|_| true).unwrap_err();
        assert_eq!(
            error.to_string(),
            "large.json: it is 65 MiB, at most 64 MiB are read"
        );
    }

    #[cfg(unix)]
    #[test]
    fn a_link_is_written_through() {
        let place = tempfile::tempdir().unwrap();
        let (file, folder) = (place.path().join("file"), place.path().join("folder"));
        fs::write(&file, "old").unwrap();
        fs::create_dir(&folder).unwrap();
        for (target, is_folder) in [(&file, false), (&folder, true)] {
            let link = target.with_extension("link");
            std::os::unix::fs::symlink(target, &link).unwrap();
            Files::one("a.txt", b"new".to_vec())
                .write(&link, is_folder, true)
                .unwrap();
            assert!(link.is_symlink(), "{} was replaced", link.display());
        }
        assert_eq!(
            (
                fs::read(file).unwrap(),
                fs::read(folder.join("a.txt")).unwrap()
            ),
            (b"new".into(), b"new".into())
        );
    }

    #[cfg(target_os = "linux")]
    #[test]
    fn names_that_read_as_one_are_refused_instead_of_lost() {
        use std::ffi::OsStr;
        use std::os::unix::ffi::OsStrExt as _;
        let place = tempfile::tempdir().unwrap();
        fs::write(place.path().join(OsStr::from_bytes(b"a\xe8.json")), "{}").unwrap();
        assert_eq!(names(place.path()), ["a\u{fffd}.json"]);
        fs::write(place.path().join(OsStr::from_bytes(b"a\xe9.json")), "{}").unwrap();
        let error = Files::read(place.path(), &|_| true).unwrap_err();
        assert!(error.to_string().ends_with("; rename it"), "{error}");
    }

    #[cfg(unix)]
    #[test]
    fn links_in_a_folder_are_not_followed() {
        let place = tempfile::tempdir().unwrap();
        fs::write(place.path().join("a.json"), "{}").unwrap();
        std::os::unix::fs::symlink("/", place.path().join("root")).unwrap();
        std::os::unix::fs::symlink("/etc/passwd", place.path().join("b.json")).unwrap();
        assert_eq!(names(place.path()), ["a.json"]);
    }
}
