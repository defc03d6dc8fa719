//! A store of extracted features: on disk beside the document, and the latest ones in memory.

use std::collections::{BTreeMap, VecDeque};
use std::io;
use std::path::{Path, PathBuf};
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};
use touchline_core::files::refuse_linked_folder;
use touchline_vision::features::{FeatureCache, FeatureKey, Features};

/// Name of the hidden folder beside a document, for files that can be recomputed.
pub const WORK_FOLDER: &str = ".touchline";

/// Maximum size of the features on disk, bytes: about 13,000 pictures of 1000 features.
const DISK_BYTES: u64 = 2 << 30;

/// Maximum size of the features in memory, bytes: about 1,700 pictures of 1000 features.
const MEMORY_BYTES: usize = 256 << 20;

/// The hidden folder beside a document, for files that can be recomputed. The user may delete it at
/// any time.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct WorkFolder {
    folder: PathBuf,
    document: String,
}

impl WorkFolder {
    /// The folder beside a document's file.
    pub fn beside(document: &Path) -> Self {
        let name = document
            .file_name()
            .unwrap_or_default()
            .to_string_lossy()
            .into_owned();
        Self {
            folder: document.with_file_name(WORK_FOLDER),
            document: name,
        }
    }

    /// The path of the folder.
    pub fn path(&self) -> &Path {
        &self.folder
    }

    /// The path of the document's forest. Each document in the folder has a separate one.
    pub fn forest(&self) -> PathBuf {
        self.folder.join(format!("{}.forest", self.document))
    }

    /// The features of pictures, shared by all documents in the folder.
    ///
    /// # Errors
    /// As [`refuse_links`](Self::refuse_links).
    pub fn features(&self) -> io::Result<FeatureCache> {
        self.refuse_links()?;
        Ok(FeatureCache::new(&self.features_folder(), DISK_BYTES))
    }

    /// The folder of the finished parts of long work, which may not exist yet.
    ///
    /// # Errors
    /// The hidden folder, or this one in it, is a link or no folder.
    pub fn finished_work(&self) -> io::Result<PathBuf> {
        let folder = self.folder.join("work");
        refuse_linked_folder(&self.folder)?;
        refuse_linked_folder(&folder)?;
        Ok(folder)
    }

    /// Refuses a hidden folder that is a link: in a project from someone else it may lead anywhere.
    /// Call this before anything is written into the folder.
    ///
    /// # Errors
    /// The folder, or the one for features in it, is a link or no folder.
    pub fn refuse_links(&self) -> io::Result<()> {
        refuse_linked_folder(&self.folder)?;
        refuse_linked_folder(&self.features_folder())
    }

    fn features_folder(&self) -> PathBuf {
        self.folder.join("features")
    }
}

/// A store of extracted features. After a failed write it uses the memory only.
#[derive(Debug, Default)]
pub struct FeatureStore {
    disk: Option<FeatureCache>,
    shelf: Mutex<Shelf>,
}

/// The features in memory.
#[derive(Debug, Default)]
struct Shelf {
    held: BTreeMap<FeatureKey, Arc<Features>>,
    /// The keys, oldest first.
    order: VecDeque<FeatureKey>,
    bytes: usize,
    /// The first error of the disk, if any.
    refused: Option<String>,
}

impl FeatureStore {
    /// A store in memory only.
    pub fn in_memory() -> Self {
        Self::default()
    }

    /// A store on disk beside a document.
    pub fn on_disk(place: &WorkFolder) -> Self {
        // A folder that cannot be used costs time in the next session and nothing else, so it is no
        // error.
        let (disk, refused) = match place.features() {
            Ok(disk) => (Some(disk), None),
            Err(error) => (None, Some(error.to_string())),
        };
        Self {
            disk,
            shelf: Mutex::new(Shelf {
                refused,
                ..Shelf::default()
            }),
        }
    }

    /// The features with this key; none if they are not stored.
    pub fn get(&self, key: &FeatureKey) -> Option<Arc<Features>> {
        if let Some(features) = self.shelf().held.get(key) {
            return Some(Arc::clone(features));
        }
        // The lock of the memory is free while the disk is read, so two threads may read the same
        // features. The first ones stay.
        let features = Arc::new(self.disk.as_ref()?.get(key)?);
        self.shelf().put(key, &features);
        Some(features)
    }

    /// Stores features.
    pub fn put(&self, key: &FeatureKey, features: Features) -> Arc<Features> {
        let features = Arc::new(features);
        // After the first failed write the disk is not tried again. The disk is written without
        // holding the lock of the memory, because that takes long.
        let refused = self
            .disk
            .as_ref()
            .filter(|_| self.shelf().refused.is_none());
        let refused = refused.and_then(|disk| disk.put(key, &features).err());
        let mut shelf = self.shelf();
        shelf.put(key, &features);
        if let Some(error) = refused {
            shelf.refused = Some(error.to_string());
        }
        features
    }

    /// Why features are not stored on disk, if they are not. They then have to be extracted again
    /// in the next session.
    pub fn refusal(&self) -> Option<String> {
        self.shelf().refused.clone()
    }

    /// Locks the memory. A poisoned lock is used all the same: no code under it can panic.
    fn shelf(&self) -> MutexGuard<'_, Shelf> {
        self.shelf.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

impl Shelf {
    fn put(&mut self, key: &FeatureKey, features: &Arc<Features>) {
        if self.held.contains_key(key) {
            return;
        }
        self.bytes += bytes_of(features);
        self.order.push_back(key.clone());
        self.held.insert(key.clone(), Arc::clone(features));
        // First in, first out. A picture that exceeds the limit alone is dropped, too.
        while self.bytes > MEMORY_BYTES {
            let Some(oldest) = self.order.pop_front() else {
                break;
            };
            self.bytes -= self
                .held
                .remove(&oldest)
                .map_or(0, |features| bytes_of(&features));
        }
    }
}

fn bytes_of(features: &Features) -> usize {
    size_of_val(&features.keypoints[..]) + size_of_val(&features.descriptors[..])
}

#[cfg(test)]
mod tests {
    use super::*;
    use touchline_core::geometry::ImagePoint;
    use touchline_vision::features::{DESCRIPTOR_BYTES, Descriptor, FeatureOptions, Keypoint};

    fn features(count: usize) -> Features {
        let keypoint = Keypoint {
            point: ImagePoint::new(1.0, 2.0),
            size_px: 3.0,
            strength: 4.0,
        };
        Features {
            keypoints: vec![keypoint; count],
            descriptors: vec![Descriptor([7; DESCRIPTOR_BYTES]); count],
            ..Features::default()
        }
    }

    fn key(name: &str) -> FeatureKey {
        FeatureKey::new(name, &FeatureOptions::default(), &[])
    }

    #[test]
    fn features_outlive_the_program_beside_the_document() {
        let place = tempfile::tempdir().unwrap();
        let folder = WorkFolder::beside(&place.path().join("project.json"));
        FeatureStore::on_disk(&folder).put(&key("a"), features(3));
        let later = FeatureStore::on_disk(&folder);
        assert_eq!(later.get(&key("a")).as_deref(), Some(&features(3)));
        assert_eq!(later.get(&key("b")), None);
        assert_eq!(later.refusal(), None);
        assert_eq!(
            folder.forest(),
            place.path().join(".touchline/project.json.forest")
        );
    }

    #[test]
    fn where_nothing_can_be_written_memory_serves() {
        let place = tempfile::tempdir().unwrap();
        // A file in place of the folder stops every user, including the superuser.
        std::fs::write(place.path().join(WORK_FOLDER), "").unwrap();
        let store = FeatureStore::on_disk(&WorkFolder::beside(&place.path().join("project.json")));
        store.put(&key("a"), features(2));
        assert!(store.refusal().is_some());
        assert_eq!(store.get(&key("a")).as_deref(), Some(&features(2)));
    }

    #[cfg(unix)]
    #[test]
    fn a_linked_folder_is_not_written_to() {
        let place = tempfile::tempdir().unwrap();
        for linked in [WORK_FOLDER, ".touchline/features"] {
            let project = tempfile::tempdir_in(place.path()).unwrap();
            let elsewhere = tempfile::tempdir_in(place.path()).unwrap();
            std::fs::create_dir_all(project.path().join(linked).parent().unwrap()).unwrap();
            std::os::unix::fs::symlink(elsewhere.path(), project.path().join(linked)).unwrap();
            let folder = WorkFolder::beside(&project.path().join("project.json"));
            let store = FeatureStore::on_disk(&folder);
            store.put(&key("a"), features(2));
            assert!(
                store
                    .refusal()
                    .unwrap()
                    .contains("is a symbolic link, not a folder"),
                "{linked}"
            );
            assert_eq!(
                std::fs::read_dir(elsewhere.path()).unwrap().count(),
                0,
                "{linked}"
            );
        }
    }

    #[test]
    fn memory_is_bounded_and_the_oldest_goes_first() {
        let store = FeatureStore::in_memory();
        let large = MEMORY_BYTES / bytes_of(&features(1)) / 3;
        for name in ["a", "b", "c", "d"] {
            store.put(&key(name), features(large));
        }
        assert_eq!(store.get(&key("a")), None);
        assert!(store.get(&key("b")).is_some() && store.get(&key("d")).is_some());
        assert!(store.shelf().bytes <= MEMORY_BYTES);
    }
}
