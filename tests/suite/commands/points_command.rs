//! `touchline import --points` and `touchline points`: points of a model from their file to a
//! suggestion, and out again.

use crate::program::touchline;
use serde_json::{Value, json};
use std::fs;
use std::path::Path;
use touchline::camera::{BaseAngles, CameraBase, Ptz, PtzCamera};
use touchline::document::{Document, FrameStatus, SolutionSource, document_to_string};
use touchline::field::builtin;
use touchline::geometry::{ImageSize, Vec3};
use touchline::store::read;

const SIZE: ImageSize = ImageSize::new(1280, 720);

/// The base of the camera, and the JSON map of what a model sees with it: every landmark of the
/// picture, one of them 60 px off with a small probability.
fn seen() -> (CameraBase, Value) {
    let base = CameraBase::new(
        Vec3::new(1.0, -58.0, 16.0),
        BaseAngles::default().base_from_world(),
        SIZE.centre(),
    );
    let camera = PtzCamera::new(base, Ptz::from_degrees(4.0, -12.0, 1500.0));
    let field = builtin("soccer").unwrap().default_model().unwrap();
    let mut points = serde_json::Map::new();
    for landmark in &field.landmarks {
        let image = camera.image_from_world(field.landmark_in_world(landmark));
        if let Some(image) = image.ok().filter(|image| SIZE.contains(*image)) {
            points.insert(landmark.id.to_string(), json!([image.x, image.y, 0.8]));
        }
    }
    let wrong = points["centre_mark"].clone();
    let (x, y) = (wrong[0].as_f64().unwrap(), wrong[1].as_f64().unwrap());
    points.insert("centre_mark".to_owned(), json!([x + 60.0, y, 0.05]));
    (base, json!({ "a.jpg": points, "b.jpg": {} }))
}

fn document_at(path: &Path) -> Document {
    read(path).unwrap().1
}

/// Writes a document with the base of its camera, as the user has it from elsewhere.
fn set_base(path: &Path, base: &CameraBase) {
    let mut document = document_at(path);
    document.cameras[0].set_base(base);
    fs::write(path, document_to_string(&document).unwrap()).unwrap();
}

#[test]
fn points_of_a_model_become_a_suggestion_and_go_again_together() {
    let folder = tempfile::tempdir().unwrap();
    let (base, map) = seen();
    fs::write(folder.path().join("points.json"), map.to_string()).unwrap();
    let ran = touchline(
        folder.path(),
        "import --points points.json --layout json-map --model net --min-probability 0.1 \
         --size 1280x720 -o doc.json",
    );
    assert_eq!(ran.code, 0, "{}", ran.stderr);
    assert!(
        ran.stderr
            .contains("1 point below --min-probability left out"),
        "{}",
        ran.stderr
    );
    let path = folder.path().join("doc.json");
    let document = document_at(&path);
    let frame = &document.frames[0];
    assert_eq!(frame.status, FrameStatus::New);
    let origin = frame.clicks[0].origin.as_ref().unwrap();
    assert_eq!(
        (origin.name.as_str(), origin.probability),
        ("model:net", Some(0.8))
    );
    // 2.2 px / √p at 1920 px width.
    let sigma_px = 2.2 * (1280.0 / 1920.0) / 0.8_f64.sqrt();
    assert!((origin.sigma_px.unwrap() - sigma_px).abs() < 1e-9);

    set_base(&path, &base);
    let ran = touchline(folder.path(), "solve doc.json -o doc.json --force");
    assert_eq!(ran.code, 0, "{}", ran.stderr);
    let solved = document_at(&path);
    let frame = &solved.frames[0];
    assert_eq!(
        (frame.status, frame.source()),
        (FrameStatus::Suggested, Some(SolutionSource::Points))
    );
    assert!((frame.ptz.as_ref().unwrap().pan_deg - 4.0).abs() < 0.05);
    assert!(!frame.is_used_for_training(), "nobody has accepted it");

    // No label of a person: an export of points has nothing to write.
    let ran = touchline(folder.path(), "export doc.json --format coco -o coco.json");
    assert_eq!(ran.code, 2);
    assert!(
        ran.stderr.contains("points of a model alone"),
        "{}",
        ran.stderr
    );

    let listed = touchline(folder.path(), "points doc.json");
    assert!(listed.stdout.starts_with("net: "), "{}", listed.stdout);
    let ran = touchline(folder.path(), "points doc.json --outcomes what.json");
    assert_eq!(ran.code, 0, "{}", ran.stderr);
    let text = fs::read_to_string(folder.path().join("what.json")).unwrap();
    let outcomes: Value = serde_json::from_str(&text).unwrap();
    let point = &outcomes["frames"][0]["points"][0];
    assert_eq!(point["outcome"], "open");
    assert!(point["off_camera_px"].as_f64().unwrap() < 1.0);

    let ran = touchline(
        folder.path(),
        "points doc.json --remove --model net -o bare.json",
    );
    assert_eq!(ran.code, 0, "{}", ran.stderr);
    let bare = document_at(&folder.path().join("bare.json"));
    assert!(bare.frames[0].clicks.is_empty() && bare.frames[0].ptz.is_none());
    assert_eq!(bare.frames[0].status, FrameStatus::New);
    let ran = touchline(folder.path(), "points bare.json");
    assert_eq!(ran.code, 2);
    assert!(ran.stderr.contains("no points of models"), "{}", ran.stderr);
}

#[test]
fn wrong_points_and_options_are_refused_in_one_line() {
    let folder = tempfile::tempdir().unwrap();
    fs::write(
        folder.path().join("points.json"),
        r#"{"a.jpg": {"centre_mark": [1, 2, 7]}}"#,
    )
    .unwrap();
    for (arguments, wanted) in [
        (
            "import --points points.json --layout json-map --size 64x36 -o o.json",
            "points.json: the probability of \"centre_mark\" is 7, which must be between 0 and 1",
        ),
        (
            "import --points points.json --layout pnlcalib --map soccernet -o o.json",
            "--points in the layout pnlcalib",
        ),
        ("import --points points.json -o o.json", "--layout"),
        ("import points.json --layout coco -o o.json", "--points"),
    ] {
        let ran = touchline(folder.path(), arguments);
        assert_eq!(ran.code, 2, "{arguments}");
        assert!(ran.stderr.contains(wanted), "{arguments}: {}", ran.stderr);
    }
}

#[test]
fn arguments_that_were_exchanged_say_their_order() {
    let folder = tempfile::tempdir().unwrap();
    fs::write(folder.path().join("match.mp4"), b"no video").unwrap();
    fs::create_dir(folder.path().join("project")).unwrap();
    for (arguments, wanted) in [
        (
            "new match.mp4 --frames project --field soccer",
            "match.mp4 is a video, and the project's folder comes first",
        ),
        (
            "relocalize project match.tlf -o o.json",
            "project is a folder, and the forest comes first",
        ),
        ("sovle project", "`touchline solve` may be meant"),
        (
            "render project --frame -1 -o o.png",
            "a number below zero is written behind =",
        ),
        (
            "import https://x.org/a.json -o o.json",
            "it is a web address; download the file",
        ),
    ] {
        let ran = touchline(folder.path(), arguments);
        assert_eq!(ran.code, 2, "{arguments}");
        assert!(ran.stderr.contains(wanted), "{arguments}: {}", ran.stderr);
        assert_eq!(ran.stderr.lines().count(), 1, "{arguments}: {}", ran.stderr);
    }
}
