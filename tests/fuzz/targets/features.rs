//! A file of the features cache, as it is and with the checksum that fits.
#![no_main]

use libfuzzer_sys::fuzz_target;
use std::fs;
use std::path::PathBuf;
use std::sync::LazyLock;
use touchline::features::{FeatureCache, FeatureKey, FeatureOptions, Features};
use touchline_fuzz::{Folder, run_in_bounds};

/// Magic, version, checksum.
const HEADER: usize = 16;

static PLACE: LazyLock<(Folder, FeatureCache, FeatureKey, PathBuf)> = LazyLock::new(|| {
    let folder = Folder::new();
    let cache = FeatureCache::new(folder.path(), 1 << 30);
    let key = FeatureKey::new("picture", &FeatureOptions::default(), &[]);
    cache.put(&key, &Features::default()).expect("features can be kept");
    let mut files = fs::read_dir(folder.path()).expect("the folder can be read");
    let file = files.next().expect("the file is there").expect("the folder can be read").path();
    (folder, cache, key, file)
});

fn check_bytes(bytes: &[u8]) {
    let (_folder, cache, key, file) = &*PLACE;
    fs::write(file, bytes).expect("the file can be written");
    if let Some(features) = run_in_bounds(bytes, || cache.get(key)) {
        assert_eq!(features.keypoints.len(), features.descriptors.len());
        cache.put(key, &features).expect("features can be kept");
        assert_eq!(fs::read(file).expect("the file can be read"), bytes, "what is read is written as the same");
    }
}

fuzz_target!(|data: &[u8]| {
    check_bytes(data);
    if let Some(body) = data.get(HEADER..) {
        let mut whole = data.to_vec();
        whole[12..16].copy_from_slice(&crc32fast::hash(body).to_le_bytes());
        check_bytes(&whole);
    }
});
