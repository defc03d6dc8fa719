//! `touchline experiment` on published data: homographies of matches, a camera's motion.

use crate::touchline;
use serde_json::Value;
use std::fs;
use std::path::{Path, PathBuf};

/// The folder of real frames.
fn frames_folder() -> PathBuf {
    PathBuf::from(std::env::var_os("TOUCHLINE_DATA").unwrap())
}

fn json(path: &Path) -> Value {
    serde_json::from_str(&fs::read_to_string(path).unwrap()).unwrap()
}

fn number(row: &Value, key: &str) -> f64 {
    row[key]
        .as_f64()
        .unwrap_or_else(|| panic!("no {key} in {row}"))
}

#[test]
#[ignore = "wants real frames: TOUCHLINE_DATA"]
fn published_homographies_are_fitted_as_well_as_seven_parameters_can() {
    let data = frames_folder();
    let folder = tempfile::tempdir().unwrap();
    let ran = touchline(
        folder.path(),
        &format!(
            "experiment homographies --quick --data {} -o out",
            data.display()
        ),
    );
    assert_eq!(ran.code, 0, "{}", ran.stderr);
    let tables = &json(&folder.path().join("out/homographies.json"))["tables"];
    let [part, whole, distance] = [0, 1, 2].map(|row| tables["homographies-fit"][row].clone());
    assert_eq!(number(&part, "frames"), 27.0);
    assert!(
        number(&part, "median") > 0.98 && number(&whole, "median") > 0.88,
        "{part} {whole}"
    );
    // An independent least-squares fit of the same seven parameters to the same points.
    assert!(
        (number(&distance, "mean") - 3.6696).abs() < 2e-3,
        "{distance}"
    );
    assert!(
        (number(&distance, "median") - 3.0786).abs() < 2e-3,
        "{distance}"
    );
    assert!(
        (number(&distance, "worst") - 12.009).abs() < 2e-2,
        "{distance}"
    );
    assert!(folder.path().join("out/homographies-order.svg").is_file());
}

#[test]
#[ignore = "wants real frames: TOUCHLINE_DATA"]
fn a_real_motion_is_drawn_and_found_again() {
    let data = frames_folder();
    let folder = tempfile::tempdir().unwrap();
    let motion = data.join("ptz-soccer-330");
    let ran = touchline(
        folder.path(),
        &format!(
            "experiment motion --quick --data {} -o out",
            motion.display()
        ),
    );
    assert_eq!(ran.code, 0, "{}", ran.stderr);
    let tables = &json(&folder.path().join("out/motion.json"))["tables"];
    let path = tables["motion-path"].as_array().unwrap();
    assert!(
        (number(&path[0], "least") - 49.23).abs() < 0.01
            && (number(&path[2], "greatest") - 4228.0).abs() < 1.0
    );
    let all = &tables["motion-all"][0];
    let [right, wrong, refused] = ["right", "wrong", "refused"].map(|key| number(all, key));
    assert!(right >= 9.0 * (wrong + refused), "{all}");
    assert!(
        number(all, "rotation_median_deg") < 0.01 && number(all, "focal_median_px") < 1.0,
        "{all}"
    );
    let report = fs::read_to_string(folder.path().join("out/motion.md")).unwrap();
    assert!(
        report.contains("Frames: drawn, 15 frames along the published motion"),
        "{report}"
    );
}
