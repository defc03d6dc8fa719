//! Cameras with pixels that are not square through every format and back.

use std::path::Path;
use touchline_core::camera::{CameraBase, FocalCurve};
use touchline_core::geometry::ImagePoint;
use touchline_core::testing::{SIZE, base_at};
use touchline_documents::document::{
    Document, FrameStatus, document_from_bytes, document_to_string,
};
use touchline_documents::exchange::{ExportOptions, Format, ImportOptions, Zoom, export, import};
use touchline_documents::testing::{match_from, new_video_frame, ptz_at};

/// Three frames of a camera with pixels of an aspect.
fn oblong(pixel_aspect: f64) -> Document {
    let base = CameraBase {
        distortion: FocalCurve::constant(-0.08).with_pixel_aspect(pixel_aspect),
        ..base_at([-3.0, -61.0, 16.0], ImagePoint::new(951.5, 548.25))
    };
    let mut document = match_from(&base, SIZE);
    for (index, pan_deg) in [-12.0, 2.0, 15.0].into_iter().enumerate() {
        let mut frame = new_video_frame("match.mp4", index as u64, SIZE);
        frame.status = FrameStatus::Reference;
        frame.ptz = ptz_at(pan_deg, -11.0, 2410.0);
        document.frames.push(frame.into());
    }
    document
}

/// How far landmarks are at most from where the cameras of another document show them, px.
fn off_px(document: &Document, other: &Document) -> f64 {
    let field = document.field.model(Path::new("/")).unwrap();
    let mut worst = 0.0_f64;
    for (frame, there) in document.frames.iter().zip(&other.frames) {
        let (camera, other) = (
            document.ptz_camera(frame).unwrap(),
            other.ptz_camera(there).unwrap(),
        );
        for landmark in &field.landmarks {
            let at = field.landmark_in_world(landmark);
            let Ok(image) = camera.image_from_world(at) else {
                continue;
            };
            if SIZE.contains(image) {
                let there = other.image_from_world(at).unwrap();
                worst = worst.max(there.distance_px(image));
            }
        }
    }
    worst
}

#[test]
fn formats_hold_the_aspect_of_the_pixels_or_say_what_it_loses() {
    let document = oblong(1.25);
    let mut lost = Vec::new();
    for format in [
        Format::SoccerNet,
        Format::Colmap,
        Format::OpenCv,
        Format::OpenTrackIo,
        Format::Csv,
        Format::Fifa,
        Format::BroadTrack,
        Format::FreeDCsv,
        Format::Chan,
    ] {
        let folder = tempfile::tempdir().unwrap();
        let options = ExportOptions::default();
        let exported = export(document.at(Path::new("/")), format, &options).unwrap();
        for (name, bytes) in exported.files.sorted_entries() {
            std::fs::write(folder.path().join(name), bytes).unwrap();
        }
        let options = ImportOptions {
            size: Some(SIZE),
            zoom: Some(Zoom::FocalPx),
            ..ImportOptions::default()
        };
        let back = import(folder.path(), format, &options).unwrap();
        let said = exported.loss.map(|loss| loss.to_string());
        let is_lost = said
            .as_ref()
            .is_some_and(|said| said.contains("pixels that are not square"));
        let off_px = off_px(&document, &back.document);
        assert_eq!(off_px > 1e-6, is_lost, "{format}: {off_px} px, {said:?}");
        lost.extend(is_lost.then(|| format.name()));
    }
    assert_eq!(lost, ["broadtrack", "freed-csv", "chan"]);
    // Written only, or read as a homography: the export compares what it reads back.
    for format in [Format::Usda, Format::Homography, Format::Wc14] {
        let options = ExportOptions::default();
        let exported = export(document.at(Path::new("/")), format, &options).unwrap();
        let said = exported
            .loss
            .map(|loss| loss.to_string())
            .unwrap_or_default();
        assert!(!said.contains("not square"), "{format}: {said}");
    }
}

#[test]
fn a_document_states_the_aspect_only_where_the_pixels_are_not_square() {
    let text = |document: &Document| document_to_string(document).unwrap();
    assert!(!text(&oblong(1.0)).contains("pixel_aspect"));
    let stated = text(&oblong(1.25));
    assert!(stated.contains("\"pixel_aspect\": 1.25"), "{stated}");
    let again = document_from_bytes(stated.as_bytes()).unwrap();
    assert_eq!(text(&again), stated);
    let camera = again.ptz_camera(&again.frames[0]).unwrap();
    assert_eq!(camera.lens().pixel_aspect, 1.25);
    for wrong in ["0", "-1", "5", "1e400", "\"1\"", "null"] {
        let text = stated.replace(
            "\"pixel_aspect\": 1.25",
            &format!("\"pixel_aspect\": {wrong}"),
        );
        assert!(document_from_bytes(text.as_bytes()).is_err(), "{wrong}");
    }
}
