//! A cache of features on disk.
//!
//! The cache is a folder with one file per picture, named by a hash of everything that determines
//! the features: the picture's own hash, the settings, the masks and the version of this code. The
//! folder may be deleted at any time. A file that is damaged or of another version counts as
//! absent. The folder's size is limited; the oldest files are deleted first.

use super::{DESCRIPTOR_BYTES, Descriptor, FeatureOptions, Features, Keypoint};
use sha2::{Digest, Sha256};
use std::io;
use std::path::Path;
use touchline_core::files::FileCache;
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
pub struct FeatureCache(FileCache);

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
        Self(FileCache::new(folder, EXTENSION, max_bytes))
    }

    /// The stored features of a picture, if there are any and the file is intact.
    pub fn get(&self, key: &FeatureKey) -> Option<Features> {
        decode(&self.0.get(&key.0)?)
    }

    /// Stores features and deletes the oldest files if there is not enough room.
    ///
    /// # Errors
    ///
    /// The folder cannot be created or written to. The caller may ignore this: the features can be
    /// computed again.
    pub fn put(&self, key: &FeatureKey, features: &Features) -> io::Result<()> {
        self.0.put(&key.0, &encode(features))
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
}
