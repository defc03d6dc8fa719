//! A clip with four clicks in one frame, which `touchline calibrate` labels without a search.
#![cfg(feature = "opencv")]

use crate::drawn_clip::{drawn_clip, landmark_errors_px, visible_landmarks};
use crate::program::touchline;
use touchline::document::{Camera, Click, FrameStatus};
use touchline::field::LandmarkId;
use touchline::geometry::ImagePoint;
use touchline_documents::testing::{load, save};

/// The four landmarks on the ground that lie farthest from the middle of the picture.
pub fn four_corners(mut shown: Vec<(LandmarkId, ImagePoint)>) -> Vec<Click> {
    shown.retain(|(id, _)| !id.as_str().contains("post") && !id.as_str().contains("flag"));
    let middle = ImagePoint::new(320.0, 180.0);
    shown.sort_by(|(_, one), (_, other)| {
        other
            .distance_px(middle)
            .total_cmp(&one.distance_px(middle))
    });
    let clicks = shown.into_iter().take(4);
    clicks.map(|(id, at)| Click::landmark(id, at)).collect()
}

#[test]
fn four_clicks_in_one_frame_label_the_whole_clip() {
    let place = tempfile::tempdir().unwrap();
    let truth = drawn_clip(place.path());
    let folder = place.path().join("match");
    let mut clicked = truth.clone();
    let size = clicked.cameras[0].image_size;
    clicked.cameras[0] = Camera::new("main".into(), size).into();
    for frame in &mut clicked.frames {
        (frame.status, frame.ptz, frame.solution) = (FrameStatus::New, None, None);
        frame.clicks.clear();
    }
    clicked.frames[0].clicks = four_corners(visible_landmarks(&truth, 0));
    save(folder.join("clicked.json"), &clicked);

    let ran = touchline(&folder, "calibrate clicked.json -o labelled");
    assert_eq!(ran.code, 0, "{}", ran.stderr);
    assert!(ran.stderr.contains("from its clicks"), "{}", ran.stderr);
    let labelled = load(folder.join("labelled/project.json"));
    for index in 0..labelled.frames.len() {
        let errors_px = landmark_errors_px(&labelled, &truth, index).unwrap();
        let worst_px = errors_px.into_iter().fold(0.0, f64::max);
        assert!(worst_px < 2.0, "frame {index}: {worst_px} px");
    }
}
