//! Painted lines of a real court of wood: right cameras told from wrong ones, and snapping.
#![cfg(feature = "opencv")]

use crate::parts::{Test, frames_folder, tests};
use crate::program::touchline;
use crate::real_paint::{apart_px, turn_view};
use std::fs;
use std::path::Path;
use touchline::camera::PtzCamera;
use touchline::document::Document;
use touchline::markings::LineVerdict;
use touchline::paint::{GroundPicture, SnapOptions, check_lines, snap};
use touchline::proposals::PictureStream;
use touchline_documents::testing::load;

pub const TESTS: &[Test] = tests![
    [Frames] right_cameras_are_told_from_wrong_ones_and_snapping_comes_back_on_wood;
];

/// The five clicked frames of a basketball video, as a document in a new folder.
fn clicked_court(place: &Path) -> Document {
    let text = include_str!("../laboratory/benches/relocalize/clicks/basketball.json");
    let video = frames_folder().join("video-basketball/clip.mp4");
    fs::write(
        place.join("clicks.json"),
        text.replace("video-basketball/clip.mp4", &video.to_string_lossy()),
    )
    .unwrap();
    touchline(place, "refine-base clicks.json --markings -o base.json").done();
    load(place.join("base.json"))
}

fn right_cameras_are_told_from_wrong_ones_and_snapping_comes_back_on_wood() {
    let place = tempfile::tempdir().unwrap();
    let document = clicked_court(place.path());
    let field = document.field.model(place.path()).unwrap();
    let mut back = 0;
    for shown in PictureStream::new(document.at(place.path()), 0..document.frames.len()) {
        let (frame, picture) = (shown.frame, shown.picture.unwrap());
        let ground = GroundPicture::new(&picture, &document.masks_of(frame));
        assert!(!ground.surface().is_turf(), "{}", frame.name());
        let camera = document.ptz_camera(frame).unwrap();
        let right = check_lines(&ground, &field, &camera);
        assert_eq!(
            right.verdict(),
            LineVerdict::Supports,
            "{}: {right:?}",
            frame.name()
        );
        assert!(right.offset_px < 1.0, "{}: {right:?}", frame.name());
        for (pan_px, tilt_px, zoom) in [
            (60.0, 10.0, 1.0),
            (-20.0, 25.0, 1.0),
            (0.0, 0.0, 1.08),
            (200.0, 0.0, 1.0),
        ] {
            let off = check_lines(&ground, &field, &turn_view(&camera, pan_px, tilt_px, zoom));
            assert_ne!(
                off.verdict(),
                LineVerdict::Supports,
                "{}: {off:?}",
                frame.name()
            );
        }
        let start = turn_view(&camera, 18.0, -12.0, 1.01).ptz();
        let found = snap(
            &ground,
            &field,
            camera.base(),
            start,
            &[],
            &SnapOptions::default(),
        );
        let pointed = |ptz| PtzCamera::new(*camera.base(), ptz);
        back += usize::from(found.is_ok_and(|found| {
            apart_px(&field, &camera, &pointed(found.ptz), frame.image_size) < 1.5
        }));
    }
    assert!(back >= 4, "{back} of 5 come back");
}
