//! A cache of features on disk.
//!
//! The cache is a folder with one file per picture, named by a hash of everything that determines
//! the features: the picture's own hash, the settings, the masks and the version of this code. The
//! folder may be deleted at any time. A file that is damaged or of another version counts as
//! absent. The folder's size is limited; the oldest files are deleted first.

use super::{DESCRIPTOR_BYTES, Descriptor, FeatureOptions, Features, Keypoint};
use sha2::{Digest, Sha256};
use std::io::{self, Write as _};
use std::path::{Path, PathBuf};
use std::sync::{Arc, Mutex, PoisonError};
use std::time::SystemTime;
use touchline_core::files::{read_regular, remove_stray_files, temporary_file_in};
use touchline_core::geometry::{ImagePoint, ImageSize, PixelBox, hex};

/// Changes whenever the same picture and settings would give other features, or the file format
/// changes.
const VERSION: u32 = 1;
const MAGIC: &[u8; 8] = b"TLFEATS\0";
const EXTENSION: &str = "features";
/// Bytes of a keypoint and its descriptor in a file.
const FEATURE_BYTES: usize = 24 + DESCRIPTOR_BYTES;

/// A folder of features.
#[derive(Clone, Debug)]
pub struct FeatureCache {
    folder: PathBuf,
    max_bytes: u64,
    /// Size of the folder when it was last measured, plus what was added since. None before the
    /// first measurement. Clones of the cache share it.
    stored_bytes: Arc<Mutex<Option<u64>>>,
}

/// A hash of everything that determines the features of a picture.
#[derive(Clone, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub struct FeatureKey(String);

impl FeatureKey {
    /// Combines the SHA-256 of the picture's file, as documents store it, with the settings and the
    /// masks.
    pub fn new(picture_sha256: &str, options: &FeatureOptions, masks: &[PixelBox]) -> Self {
        // The masks come last, because they alone vary in number: no two combinations are the same
        // bytes. 128 bits are enough against accidental collisions.
        let mut digest = Sha256::new();
        digest.update(VERSION.to_le_bytes());
        digest.update(picture_sha256.as_bytes());
        for number in options.numbers() {
            digest.update(number.to_le_bytes());
        }
        for mask in masks {
            for number in [mask.x, mask.y, mask.width, mask.height] {
                digest.update(number.to_le_bytes());
            }
        }
        Self(hex(&digest.finalize()[..16]))
    }
}

impl FeatureCache {
    /// A cache of at most `max_bytes` in a folder, which is created when the first features are
    /// stored.
    pub fn new(folder: &Path, max_bytes: u64) -> Self {
        Self {
            folder: folder.to_path_buf(),
            max_bytes,
            stored_bytes: Arc::default(),
        }
    }

    /// The stored features of a picture, if there are any and the file is intact.
    pub fn get(&self, key: &FeatureKey) -> Option<Features> {
        decode(&read_regular(&self.file(key)).ok()?)
    }

    /// Stores features and deletes the oldest files if there is not enough room.
    ///
    /// # Errors
    ///
    /// The folder cannot be created or written to. The caller may ignore this: the features can be
    /// computed again.
    pub fn put(&self, key: &FeatureKey, features: &Features) -> io::Result<()> {
        let bytes = encode(features);
        std::fs::create_dir_all(&self.folder)?;
        self.make_room_if_needed(bytes.len() as u64)?;
        // Written under a temporary name and renamed, so that readers never see half a file.
        let mut file = temporary_file_in(&self.folder)?;
        file.as_file_mut().write_all(&bytes)?;
        file.persist(self.file(key)).map_err(|error| error.error)?;
        Ok(())
    }

    fn file(&self, key: &FeatureKey) -> PathBuf {
        self.folder.join(&key.0).with_extension(EXTENSION)
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
                .is_some_and(|extension| extension == EXTENSION)
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

fn encode(features: &Features) -> Vec<u8> {
    let mut body = Vec::with_capacity(12 + features.len() * FEATURE_BYTES);
    for number in [
        features.image_size.width,
        features.image_size.height,
        features.len() as u32,
    ] {
        body.extend(number.to_le_bytes());
    }
    for (keypoint, descriptor) in features.keypoints.iter().zip(&features.descriptors) {
        body.extend(keypoint.point.x.to_le_bytes());
        body.extend(keypoint.point.y.to_le_bytes());
        body.extend(keypoint.size_px.to_le_bytes());
        body.extend(keypoint.strength.to_le_bytes());
        body.extend(descriptor.0);
    }
    // The checksum covers the body, so that a file cut short is recognised.
    let mut file = MAGIC.to_vec();
    file.extend(VERSION.to_le_bytes());
    file.extend(crc32fast::hash(&body).to_le_bytes());
    file.extend(body);
    file
}

/// The features in a file. None if it is damaged or of another version.
fn decode(file: &[u8]) -> Option<Features> {
    let body = file
        .strip_prefix(MAGIC)?
        .strip_prefix(&VERSION.to_le_bytes())?;
    let (checksum, body) = body.split_first_chunk()?;
    if crc32fast::hash(body) != u32::from_le_bytes(*checksum) {
        return None;
    }
    let (width, rest) = body.split_first_chunk()?;
    let (height, rest) = rest.split_first_chunk()?;
    let (count, rest) = rest.split_first_chunk()?;
    let (chunks, remainder) = rest.as_chunks::<FEATURE_BYTES>();
    // The number of features must agree with the length of the file.
    if !remainder.is_empty() || chunks.len() != u32::from_le_bytes(*count) as usize {
        return None;
    }
    let mut features = Features {
        image_size: ImageSize::new(u32::from_le_bytes(*width), u32::from_le_bytes(*height)),
        ..Features::default()
    };
    for chunk in chunks {
        let (x, rest) = chunk.split_first_chunk()?;
        let (y, rest) = rest.split_first_chunk()?;
        let (size, rest) = rest.split_first_chunk()?;
        let (strength, descriptor) = rest.split_first_chunk()?;
        let point = ImagePoint::new(f64::from_le_bytes(*x), f64::from_le_bytes(*y));
        let (size_px, strength) = (f32::from_le_bytes(*size), f32::from_le_bytes(*strength));
        features.keypoints.push(Keypoint {
            point,
            size_px,
            strength,
        });
        features
            .descriptors
            .push(Descriptor(*descriptor.first_chunk()?));
    }
    Some(features)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::features::Detector;
    use touchline_core::testing::pixel_box;

    fn features(count: u8) -> Features {
        Features {
            image_size: ImageSize::new(1280, 720),
            keypoints: (0..count)
                .map(|i| Keypoint {
                    point: ImagePoint::new(f64::from(i), 0.1),
                    size_px: 2.5,
                    strength: 0.01,
                })
                .collect(),
            descriptors: (0..count)
                .map(|i| Descriptor([i; DESCRIPTOR_BYTES]))
                .collect(),
        }
    }

    #[test]
    fn features_come_back_and_every_setting_counts() {
        let folder = tempfile::tempdir().unwrap();
        let cache = FeatureCache::new(&folder.path().join("features"), 1 << 20);
        let options = FeatureOptions::default();
        let key = FeatureKey::new("abc", &options, &[]);
        assert_eq!(cache.get(&key), None);
        cache.put(&key, &features(3)).unwrap();
        assert_eq!(cache.get(&key), Some(features(3)));
        let mask = pixel_box(1.0, 2.0, 3.0, 4.0);
        let root = FeatureOptions {
            root_sift: true,
            ..options
        };
        let orb = FeatureOptions {
            detector: Detector::Orb,
            ..options
        };
        for other in [
            FeatureKey::new("abd", &options, &[]),
            FeatureKey::new("abc", &root, &[]),
            FeatureKey::new("abc", &orb, &[]),
            FeatureKey::new("abc", &options, &[mask]),
        ] {
            assert_ne!(other, key);
        }
    }

    #[test]
    fn a_damaged_file_counts_as_absent() {
        let bytes = encode(&features(2));
        assert_eq!(decode(&bytes), Some(features(2)));
        for length in 0..bytes.len() {
            assert_eq!(decode(&bytes[..length]), None, "{length} bytes");
        }
        for at in 0..bytes.len() {
            let mut altered = bytes.clone();
            altered[at] ^= 4;
            assert_eq!(decode(&altered), None, "byte {at}");
        }
    }

    #[test]
    fn the_oldest_make_room() {
        let folder = tempfile::tempdir().unwrap();
        let cache = FeatureCache::new(folder.path(), 3 * encode(&features(10)).len() as u64);
        std::fs::write(folder.path().join("notes.txt"), "not ours").unwrap();
        let key = |i: u64| FeatureKey::new(&i.to_string(), &FeatureOptions::default(), &[]);
        for i in 0..5u64 {
            cache.put(&key(i), &features(10)).unwrap();
            let written = SystemTime::UNIX_EPOCH + std::time::Duration::from_secs(1000 + i);
            let file = std::fs::File::options()
                .write(true)
                .open(cache.file(&key(i)))
                .unwrap();
            file.set_modified(written).unwrap();
        }
        let kept: Vec<bool> = (0..5).map(|i| cache.get(&key(i)).is_some()).collect();
        assert_eq!(kept, [false, false, true, true, true]);
        assert!(folder.path().join("notes.txt").exists());
    }
}
