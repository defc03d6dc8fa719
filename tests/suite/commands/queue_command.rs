//! `touchline queue`: several matches labelled one after the other.
#![cfg(feature = "opencv")]

use super::calibrate_clicked::four_corners;
use super::calibrate_command::grey_pictures;
use crate::drawn_clip::{drawn_clip, visible_landmarks};
use crate::program::touchline;
use std::fs;
use std::path::Path;
use touchline::document::{Camera, Document, FrameStatus};
use touchline::season::queue::Queue;
use touchline_documents::testing::{load, save};

/// A clip with four clicks in one frame, in the folder `match`, and a match of it that is labelled
/// already, in `labelled`.
fn clicked_and_labelled(place: &Path) -> Document {
    let truth = drawn_clip(place);
    let mut clicked = truth.clone();
    let size = clicked.cameras[0].image_size;
    clicked.cameras[0] = Camera::new("main".into(), size).into();
    for frame in &mut clicked.frames {
        (frame.status, frame.ptz, frame.solution) = (FrameStatus::New, None, None);
        frame.clicks.clear();
    }
    clicked.frames[0].clicks = four_corners(visible_landmarks(&truth, 0));
    save(place.join("match/project.json"), &clicked);
    fs::create_dir(place.join("labelled")).unwrap();
    save(place.join("labelled/project.json"), &truth);
    truth
}

/// The reasons of the failures in a queue, by the names of its matches.
fn failures(queue: &Path) -> Vec<(String, Option<String>)> {
    let matches = Queue::read(queue).unwrap().matches.into_iter();
    matches.map(|queued| (queued.name, queued.failed)).collect()
}

#[test]
fn a_match_that_fails_is_named_and_the_others_are_labelled() {
    let place = tempfile::tempdir().unwrap();
    let place = place.path();
    let truth = clicked_and_labelled(place);
    grey_pictures(&place.join("grey"));
    fs::write(place.join("broken.mp4"), "no video").unwrap();
    let labelled = fs::read(place.join("labelled/project.json")).unwrap();

    let ran = touchline(place, "queue broken.mp4 match grey labelled nowhere.mp4");
    assert_eq!(ran.code, 1, "{}", ran.stderr);
    let failed = failures(&place.join("queue.json"));
    let has_failed: Vec<_> = failed.iter().map(|(_, why)| why.is_some()).collect();
    assert_eq!(has_failed, [true, false, true, false, true], "{failed:?}");
    ran.assert_says("broken.mp4: ");
    ran.assert_says("grey: no two of the 4 frames match each other");
    ran.assert_says("labelled: done already");
    let lines = ran.stderr.lines().map(str::split_whitespace);
    let rows: Vec<Vec<&str>> = lines.map(|words| words.skip(1).collect()).collect();
    assert!(
        rows.contains(&vec!["match", "1", "30", "30", "0", "0", "0", "–"]),
        "{}",
        ran.stderr
    );
    assert!(
        rows.iter().any(|row| row.starts_with(&["grey", "failed:"])),
        "{}",
        ran.stderr
    );
    let found = load(place.join("match/project.json"));
    assert!(found.cameras[0].base().is_some());
    assert!(found.frames.iter().all(|frame| frame.ptz.is_some()));
    assert_eq!(found.frames[0].clicks.len(), 4, "they are kept");
    assert_eq!(found.frames.len(), truth.frames.len());
    assert_eq!(
        fs::read(place.join("labelled/project.json")).unwrap(),
        labelled
    );
    assert!(!place.join("broken.mp4.touchline").exists());

    // The queue itself is enough to go on with: what is labelled stays, what failed is tried again.
    let project = fs::read(place.join("match/project.json")).unwrap();
    let again = touchline(place, "queue queue.json");
    assert_eq!(again.code, 1, "{}", again.stderr);
    again.assert_says("match: done already");
    assert_eq!(failures(&place.join("queue.json")), failed);
    assert_eq!(fs::read(place.join("match/project.json")).unwrap(), project);
}

#[test]
fn another_queue_is_not_replaced_and_a_stopped_labelling_is_begun_again() {
    let place = tempfile::tempdir().unwrap();
    let place = place.path();
    grey_pictures(&place.join("grey"));
    let project = place.join("grey.touchline/project.json");
    for (text, arguments) in [
        ("[1, 2]", "queue grey"),
        (r#"{"format":"touchline queue""#, "queue queue.json"),
        (
            r#"{"format":"touchline queue","version":1,
                "matches":[{"match":"a","project":"a/project.json"}]}"#,
            "queue grey",
        ),
    ] {
        fs::write(place.join("queue.json"), text).unwrap();
        touchline(place, arguments).assert_refused(2);
        assert_eq!(fs::read_to_string(place.join("queue.json")).unwrap(), text);
    }
    fs::remove_file(place.join("queue.json")).unwrap();

    // A draft that a stopped run left, and the note about it.
    touchline(place, "new grey.touchline --frames grey --field soccer").done();
    let mut draft = load(&project);
    let base = touchline_core::testing::base_at([0.0, -60.0, 18.0], draft.cameras[0].image_size);
    draft.cameras[0].set_base(&base);
    save(&project, &draft);
    let queue = Queue::from_paths(&[place.join("grey")]).unwrap();
    let stopped = |why: Option<&str>| {
        let mut queue = queue.clone();
        queue.matches[0].failed = why.map(str::to_owned);
        fs::write(place.join("queue.json"), queue.to_text()).unwrap();
    };
    stopped(None);
    let ran = touchline(place, "queue grey").done();
    ran.assert_says("grey: done already");
    stopped(Some("its labelling was stopped"));
    let ran = touchline(place, "queue grey");
    assert!(!ran.stderr.contains("done already"), "{}", ran.stderr);
    ran.assert_says("no two of the 4 frames match each other");
}
