//! A clip whose key frames do not show how long its field is, which the document assumes a little
//! wrong.
#![cfg(feature = "opencv")]

use crate::drawn::draw;
use crate::drawn_clip::landmark_errors_px;
use crate::program::touchline;
use touchline::document::{Document, FieldSize, FrameStatus};
use touchline::field::FieldModel;
use touchline::markings::project_landmarks;
use touchline_documents::testing::{load, save};

/// The parts of the field whose landmarks a frame shows.
fn shows(truth: &Document, frame: usize, field: &FieldModel, part: &str) -> bool {
    let frame = &truth.frames[frame];
    let camera = truth.ptz_camera(frame).unwrap();
    let shown = project_landmarks(field, &camera, frame.image_size, 0.0);
    let mut names = shown
        .iter()
        .map(|shown| field.landmarks[shown.landmark].id.as_str());
    names.any(|name| name.contains(part))
}

/// The paint of the ends was aligned to with the assumed length: the cameras turned by most of its
/// error, which then hid it.
#[test]
fn the_ends_show_a_length_that_is_a_metre_off_in_key_frames_of_the_middle() {
    let place = tempfile::tempdir().unwrap();
    draw(
        place.path(),
        "--frames 42 --step 0.2 --seed 13 --size 480x270 --preset easy",
    );
    let folder = place.path().join("match");
    let truth = load(folder.join("truth.json"));
    let field = truth.at(&folder).model_of(&truth.field).unwrap();
    let mut asked = truth.clone();
    asked.field.params.insert("length_m".to_owned(), 106.0);
    asked.field.size = Some(FieldSize::Assumed);
    let mut tracked_only = Vec::new();
    for index in 0..asked.frames.len() {
        let is_end = ["goal", "penalty"]
            .iter()
            .any(|part| shows(&truth, index, &field, part));
        let is_key = shows(&truth, index, &field, "halfway") && !is_end;
        let frame = &mut asked.frames[index];
        if is_key {
            frame.status = FrameStatus::Reference;
        } else {
            (frame.status, frame.ptz) = (FrameStatus::New, None);
            tracked_only.push(index);
        }
    }
    assert!((30..42).contains(&tracked_only.len()), "{tracked_only:?}");
    save(folder.join("asked.json"), &asked);

    let ran = touchline(&folder, "track asked.json -o tracked.json");
    assert_eq!(ran.code, 0, "{}", ran.stderr);
    let tracked = load(folder.join("tracked.json"));
    let length_m = tracked.field.params["length_m"];
    assert!(
        (length_m - 105.0).abs() < 0.5,
        "{length_m} m: {}",
        ran.stderr
    );
    for index in tracked_only {
        let errors_px = landmark_errors_px(&tracked, &truth, index).unwrap();
        let worst_px = errors_px.into_iter().fold(0.0, f64::max);
        assert!(worst_px < 2.0, "frame {index}: {worst_px} px");
    }
}
