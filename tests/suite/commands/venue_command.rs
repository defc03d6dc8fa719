//! `touchline venue`, and the camera of a venue in another project.
#![cfg(feature = "opencv")]

use crate::drawn_clip::{drawn_clip, landmark_errors_px};
use crate::program::touchline;
use std::fs;
use touchline_documents::testing::{load, save};

#[test]
fn a_camera_is_known_again_by_its_venues_file_and_a_damaged_one_is_refused() {
    let place = tempfile::tempdir().unwrap();
    let place = place.path();
    let truth = drawn_clip(place);
    save(place.join("match/project.json"), &truth);

    let kept = touchline(place, "venue match -o arena.venue");
    assert_eq!(kept.code, 0, "{}", kept.stderr);
    kept.assert_says("arena.venue: 1 camera");
    let again = touchline(place, "venue match -o arena.venue");
    assert_eq!(again.code, 2, "{}", again.stderr);

    let calibrate = "calibrate match/images -o next --found-only --venue";
    let found = touchline(place, &format!("{calibrate} arena.venue"));
    found.assert_says("venue arena, camera ");
    found.assert_says("same place");
    let next = load(place.join("next/project.json"));
    let labelled = (0..next.frames.len()).filter(|at| next.frames[*at].ptz.is_some());
    let mut count = 0;
    for frame in labelled {
        let off_px = landmark_errors_px(&next, &truth, frame).unwrap();
        assert!(
            off_px.iter().all(|px| *px < 2.0),
            "frame {frame}: {off_px:?}"
        );
        count += 1;
    }
    assert!(count >= 12, "{count} of 16 frames that are tried");

    let bytes = fs::read(place.join("arena.venue")).unwrap();
    fs::write(place.join("half.venue"), &bytes[..bytes.len() / 2]).unwrap();
    let broken = touchline(place, "calibrate match/images -o broken --venue half.venue");
    assert_eq!(broken.code, 2, "{}", broken.stderr);
    broken.assert_says("half.venue: no venue can be read from it");
    assert!(!place.join("broken").exists(), "nothing is made");
}
