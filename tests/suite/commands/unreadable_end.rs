//! A clip whose last pictures cannot be read, as of a video that states more frames than it
//! decodes.
#![cfg(feature = "opencv")]

use crate::drawn_clip::{drawn_clip, landmark_errors_px};
use crate::program::touchline;
use std::fs;
use touchline_documents::testing::load;

#[test]
fn what_can_be_read_of_a_clip_is_tracked() {
    let place = tempfile::tempdir().unwrap();
    let truth = drawn_clip(place.path());
    let folder = place.path().join("match");
    for number in [28, 29, 30] {
        fs::write(folder.join(format!("images/00{number}.jpg")), b"torn").unwrap();
    }
    let ran = touchline(&folder, "track ask.json -o tracked.json");
    assert_eq!(ran.code, 1, "{}", ran.stderr);
    assert!(ran.stderr.contains("0028.jpg"), "{}", ran.stderr);
    let tracked = load(folder.join("tracked.json"));
    for index in 1..27 {
        let errors_px = landmark_errors_px(&tracked, &truth, index).unwrap();
        let worst_px = errors_px.into_iter().fold(0.0, f64::max);
        assert!(worst_px < 2.0, "frame {index}: {worst_px} px");
    }
    assert!(tracked.frames[27].ptz.is_none() && tracked.frames[28].ptz.is_none());
    assert_eq!(
        tracked.frames[29].ptz, truth.frames[29].ptz,
        "what is known stays"
    );
}
