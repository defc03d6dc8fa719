//! Files of other programs as their makers publish them.

use crate::parts::{Test, frames_folder, tests};
use crate::program::touchline;
use serde_json::Value;
use std::path::{Path, PathBuf};
use touchline::document::{Document, document_from_bytes};
use touchline::geometry::{ImagePoint, Mat3, Vec3};

pub const TESTS: &[Test] = tests![
    [Frames] all_cameras_of_the_basketball_challenge_are_read_as_one_a_place;
];

/// A published file.
fn original(name: &str) -> PathBuf {
    frames_folder().join("originals").join(name)
}

/// What an import of a published file makes; its exit code must be `code`.
fn import(folder: &Path, arguments: &str, code: i32) -> (Document, String) {
    let ran = touchline(folder, &format!("import {arguments} -o out.json --force"));
    assert_eq!(ran.code, code, "{arguments}: {}", ran.stderr);
    let bytes = std::fs::read(folder.join("out.json")).unwrap();
    (document_from_bytes(&bytes).unwrap(), ran.stderr)
}

/// The numbers under a key.
fn numbers<const N: usize>(value: &Value, key: &str) -> [f64; N] {
    let values = value[key].as_array().unwrap().iter();
    let values: Vec<f64> = values.map(|number| number.as_f64().unwrap()).collect();
    values.try_into().unwrap()
}

/// The largest distance between where K [R | T] shows points and where the document's frame does,
/// px, over a grid of the picture; and how far fx and fy are apart.
fn off_px(published: &Value, document: &Document, index: usize) -> (f64, f64) {
    let [k, r] = ["K", "R"].map(|key| Mat3::from_row_slice(&numbers::<9>(published, key)));
    let t = Vec3::from(numbers::<3>(published, "T"));
    let frame = &document.frames[index];
    let camera = document.ptz_camera(frame).unwrap();
    let mut worst = 0.0_f64;
    for place in 0..28 * 17 {
        let (u, v) = (
            960.0 * f64::from(place % 28) / 27.0,
            540.0 * f64::from(place / 28) / 16.0,
        );
        // A point 25 m from the camera that the matrix shows here, pixel centres at whole numbers.
        let ray = k.try_inverse().unwrap() * Vec3::new(u - 0.5, v - 0.5, 1.0);
        let in_court = r.transpose() * (ray * 2500.0 - t) / 100.0;
        let point = Vec3::new(in_court.x - 14.0, 7.5 - in_court.y, -in_court.z);
        let shown = camera.image_from_world(point).unwrap();
        worst = worst.max(shown.distance_px(ImagePoint::new(u, v)));
    }
    (worst, (k[(0, 0)] / k[(1, 1)] - 1.0).abs())
}

fn all_cameras_of_the_basketball_challenge_are_read_as_one_a_place() {
    let folder = tempfile::tempdir().unwrap();
    let path = original("basketball-deepsport-val.json");
    let (document, said) = import(folder.path(), path.to_str().unwrap(), 0);
    let bytes = std::fs::read(&path).unwrap();
    let published: Vec<Value> = serde_json::from_slice(&bytes).unwrap();
    let cameras = &published[1..];
    assert_eq!((document.frames.len(), document.cameras.len()), (164, 8));
    let mut worst = (0.0_f64, 0.0_f64);
    for (index, camera) in cameras.iter().enumerate() {
        let (off_px, oblong) = off_px(camera, &document, index);
        // Pixels that are not square are off by half of that at the corner at most.
        assert!(
            off_px < 0.01 + 240.0 * oblong,
            "{index}: {off_px} px for {oblong}"
        );
        worst = (worst.0.max(off_px), worst.1.max(oblong));
    }
    println!(
        "at most {:.3} px off, where fx and fy are {:.3} % apart; {said}",
        worst.0,
        100.0 * worst.1
    );
    assert!(worst.0 < 0.47, "{worst:?}");
    assert!(said.contains("the nearest camera is taken"), "{said}");
}
