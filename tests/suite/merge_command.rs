//! `touchline split` and `touchline merge`: work handed out in packages and put together again.

use crate::program::touchline;
use std::fs;
use std::path::Path;
use touchline::document::{Click, Document, FrameStatus, document_to_string};
use touchline::geometry::ImagePoint;
use touchline::store::read;

fn document(path: &Path) -> Document {
    read(path).unwrap().1
}

/// Clicks a landmark on a frame of the document in a file.
fn click(path: &Path, frame: usize, landmark: &str) {
    let mut document = document(path);
    document.frames[frame].clicks.push(Click::landmark(
        landmark.into(),
        ImagePoint::new(20.0 + frame as f64, 30.0),
    ));
    document.frames[frame].status = FrameStatus::Draft;
    let file = if path.is_dir() {
        path.join("project.json")
    } else {
        path.to_path_buf()
    };
    fs::write(file, document_to_string(&document).unwrap()).unwrap();
}

#[test]
fn packages_come_back_with_what_was_done_in_them() {
    let place = tempfile::tempdir().unwrap();
    let at = |name: &str| place.path().join(name);
    assert_eq!(
        touchline(place.path(), "synth --frames 5 --size 320x180 -o match").code,
        0
    );
    let ran = touchline(place.path(), "split match --frames 2 -o work");
    assert_eq!(ran.code, 0, "{}", ran.stderr);
    assert!(
        ran.stderr.contains("5 frames in 3 packages in work"),
        "{}",
        ran.stderr
    );
    for (package, frame, landmark) in [
        ("work/package001", 1, "centre_mark"),
        ("work/package002", 0, "halfway_far"),
        ("work/package003", 0, "halfway_near"),
    ] {
        let check = touchline(place.path(), &format!("check {package}"));
        assert_eq!(
            check.code, 0,
            "a package is whole by itself: {}",
            check.stdout
        );
        click(&at(package), frame, landmark);
    }
    let ran = touchline(
        place.path(),
        "merge match work/package001 work/package002 work/package003 -o merged",
    );
    assert_eq!(ran.code, 0, "{}", ran.stderr);
    let mut expected = document(&at("match"));
    for (frame, landmark, at) in [
        (1, "centre_mark", 21.0),
        (2, "halfway_far", 20.0),
        (4, "halfway_near", 20.0),
    ] {
        expected.frames[frame]
            .clicks
            .push(Click::landmark(landmark.into(), ImagePoint::new(at, 30.0)));
        expected.frames[frame].status = FrameStatus::Draft;
    }
    let merged = touchline(place.path(), "solve merged");
    assert_eq!(merged.code, 0);
    let (location, merged, _) = read(&at("merged")).unwrap();
    for (frame, expected) in merged.frames.iter().zip(&expected.frames) {
        assert_eq!(
            (&frame.id, &frame.clicks, frame.status),
            (&expected.id, &expected.clicks, expected.status)
        );
        assert!(
            frame.image_path(location.folder()).unwrap().is_file(),
            "{}",
            frame.name()
        );
        let picture = fs::canonicalize(frame.image_path(location.folder()).unwrap()).unwrap();
        assert!(
            picture.starts_with(fs::canonicalize(at("match")).unwrap()),
            "pictures lie where the base has them"
        );
    }
    let again = touchline(place.path(), "split match --frames 2 -o work");
    assert_eq!(again.code, 2);
    assert!(
        again
            .stderr
            .contains("work holds something already; give an empty or a new folder"),
        "{}",
        again.stderr
    );
}

#[test]
fn what_two_people_did_differently_is_listed_and_neither_is_lost() {
    let place = tempfile::tempdir().unwrap();
    let at = |name: &str| place.path().join(name);
    assert_eq!(
        touchline(place.path(), "synth --frames 3 --size 320x180 -o match").code,
        0
    );
    for (name, landmark) in [("a.json", "centre_mark"), ("b.json", "halfway_far")] {
        fs::copy(at("match/project.json"), at("match").join(name)).unwrap();
        click(&at("match").join(name), 1, landmark);
    }
    click(&at("match/b.json"), 2, "halfway_near");
    let ran = touchline(
        place.path(),
        "merge match match/a.json match/b.json -o match/merged.json",
    );
    assert_eq!(ran.code, 1, "{}", ran.stderr);
    assert!(
        ran.stderr
            .contains("images/0002.jpg: match/b.json has it otherwise; what came before it stays"),
        "{}",
        ran.stderr
    );
    let merged = document(&at("match/merged.json"));
    let landmark = |document: &Document, frame: usize| {
        document.frames[frame].clicks[0].target.clone().unwrap()
    };
    assert_eq!(
        (landmark(&merged, 1).as_str(), landmark(&merged, 2).as_str()),
        ("centre_mark", "halfway_near")
    );
    let others = document(&at("match/merged.conflicts.json"));
    assert_eq!(
        (others.frames.len(), landmark(&others, 0).as_str()),
        (1, "halfway_far")
    );
}
