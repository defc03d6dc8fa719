//! A real court, its camera found without a click.
#![cfg(feature = "opencv")]

use crate::parts::{Test, frames_folder, tests};
use crate::program::touchline;
use touchline::document::{CameraId, FrameStatus};
use touchline_documents::testing::load;

pub const TESTS: &[Test] = tests![
    [Frames] a_court_of_another_colour_than_its_surround_is_found_without_a_click;
];

/// Six clicked corners put the camera at (-33.2, 0.1, 8.7) m, the paint of all frames at (-35.1, 0.1,
/// 9.0) ± 1 m.
fn a_court_of_another_colour_than_its_surround_is_found_without_a_click() {
    let place = tempfile::tempdir().unwrap();
    let video = frames_folder().join("wild/tennis-1.mp4");
    let calibrate = format!(
        "calibrate {} --field tennis --found-only -o match",
        video.display()
    );
    touchline(place.path(), &calibrate).done();
    let document = load(place.path().join("match/project.json"));
    let camera = document.camera(&CameraId::from("main")).unwrap();
    let at = camera.base().unwrap().position_m;
    assert!(
        (at.x + 33.5).abs() < 1.5 && at.y.abs() < 0.5 && (at.z - 8.8).abs() < 0.4,
        "{at:?}"
    );
    let suggested = document
        .frames
        .iter()
        .filter(|frame| frame.status == FrameStatus::Suggested);
    let confidences: Vec<f64> = suggested
        .filter_map(|frame| frame.solution.as_ref()?.confidence)
        .collect();
    assert!(confidences.len() >= 4, "{confidences:?}");
    assert!(
        confidences.iter().all(|confidence| *confidence > 0.9),
        "{confidences:?}"
    );
}
