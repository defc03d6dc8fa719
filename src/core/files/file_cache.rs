//! A folder of files that can be made again: read by name, of limited size.

use super::{read_regular, remove_stray_files, temporary_file_in};
use std::io::{self, Write as _};
use std::path::{Path, PathBuf};
use std::sync::{Arc, Mutex, PoisonError};
use std::time::SystemTime;

/// A folder of files with one ending, which may be deleted at any time. Files of other endings in
/// it are not touched.
#[derive(Clone, Debug)]
pub struct FileCache {
    folder: PathBuf,
    extension: &'static str,
    max_bytes: u64,
    /// Size of the folder when it was last measured, plus what was added since. None before the
    /// first measurement. Clones of the cache share it.
    stored_bytes: Arc<Mutex<Option<u64>>>,
}

impl FileCache {
    /// A cache of at most `max_bytes` in a folder, which is created when the first file is stored.
    pub fn new(folder: &Path, extension: &'static str, max_bytes: u64) -> Self {
        Self {
            folder: folder.to_path_buf(),
            extension,
            max_bytes,
            stored_bytes: Arc::default(),
        }
    }

    /// The content of a stored file. Whoever reads it checks whether it is intact.
    pub fn get(&self, name: &str) -> Option<Vec<u8>> {
        read_regular(&self.path(name)).ok()
    }

    /// Whether there is a file of this name.
    pub fn contains(&self, name: &str) -> bool {
        self.path(name).is_file()
    }

    /// Stores a file and deletes the oldest ones if there is not enough room. It appears whole or
    /// not at all, whenever the program ends.
    ///
    /// # Errors
    /// The folder cannot be created or written to. The caller may ignore this: the file can be made
    /// again.
    pub fn put(&self, name: &str, bytes: &[u8]) -> io::Result<()> {
        std::fs::create_dir_all(&self.folder)?;
        self.make_room_if_needed(bytes.len() as u64)?;
        // Written under a temporary name and renamed, so that readers never see half a file.
        let mut file = temporary_file_in(&self.folder)?;
        file.as_file_mut().write_all(bytes)?;
        file.persist(self.path(name)).map_err(|error| error.error)?;
        Ok(())
    }

    /// The path of a file.
    pub fn path(&self, name: &str) -> PathBuf {
        self.folder.join(name).with_extension(self.extension)
    }

    /// Makes room for `more` bytes. The folder is measured the first time and when it seems full,
    /// not for every file.
    fn make_room_if_needed(&self, more: u64) -> io::Result<()> {
        // The lock is taken while the folder is measured, so that two threads do not both delete.
        // It guards a plain number, which a panic elsewhere cannot leave half changed.
        let mut stored = self
            .stored_bytes
            .lock()
            .unwrap_or_else(PoisonError::into_inner);
        // The count may be wrong if other programs use the folder, a file replaces one, or writing
        // fails afterwards; measuring again corrects it.
        let total = match *stored {
            Some(bytes) if bytes + more <= self.max_bytes => bytes,
            _ => self.make_room(more)?,
        };
        *stored = Some(total + more);
        Ok(())
    }

    /// Deletes the oldest files until `more` bytes fit. Returns the size of what is left.
    fn make_room(&self, more: u64) -> io::Result<u64> {
        remove_stray_files(&self.folder);
        let mut files: Vec<(SystemTime, PathBuf, u64)> = Vec::new();
        for entry in std::fs::read_dir(&self.folder)? {
            let path = entry?.path();
            // Another program may have deleted it meanwhile. The metadata of a link are its own, so
            // that nothing outside the folder is counted or deleted.
            let Ok(metadata) = std::fs::symlink_metadata(&path) else {
                continue;
            };
            // Files of other names are not the cache's to delete.
            if path
                .extension()
                .is_some_and(|extension| extension == self.extension)
            {
                files.push((
                    metadata.modified().unwrap_or(SystemTime::UNIX_EPOCH),
                    path,
                    metadata.len(),
                ));
            }
        }
        let mut total: u64 = files.iter().map(|(.., bytes)| bytes).sum();
        // By time, then by path. A file without a known time counts as the oldest.
        files.sort();
        for (_, path, bytes) in files {
            if total + more <= self.max_bytes {
                break;
            }
            // A file that another program has just deleted makes room, too.
            match std::fs::remove_file(&path) {
                Err(error) if error.kind() != io::ErrorKind::NotFound => return Err(error),
                _ => total -= bytes,
            }
        }
        Ok(total)
    }
}

/// The size of the running program's file, bytes, and when it was written, ns since 1970; none if
/// the system does not say. They differ between two programs of one version.
pub fn state_of_program() -> Option<(u64, u128)> {
    let file = std::env::current_exe().and_then(std::fs::metadata).ok()?;
    let modified = file.modified().ok()?;
    let since = modified.duration_since(SystemTime::UNIX_EPOCH).ok()?;
    Some((file.len(), since.as_nanos()))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_oldest_make_room_and_other_files_stay() {
        let folder = tempfile::tempdir().unwrap();
        let cache = FileCache::new(folder.path(), "kept", 30);
        std::fs::write(folder.path().join("notes.txt"), "not ours").unwrap();
        for number in 0..5u64 {
            let name = number.to_string();
            cache.put(&name, &[7; 10]).unwrap();
            let written = SystemTime::UNIX_EPOCH + std::time::Duration::from_secs(1000 + number);
            let file = std::fs::File::options()
                .write(true)
                .open(cache.path(&name))
                .unwrap();
            file.set_modified(written).unwrap();
        }
        let kept: Vec<bool> = (0..5).map(|i| cache.contains(&i.to_string())).collect();
        assert_eq!(kept, [false, false, true, true, true]);
        assert_eq!(cache.get("4"), Some(vec![7; 10]));
        assert_eq!(cache.get("0"), None);
        assert!(folder.path().join("notes.txt").exists());
    }
}
