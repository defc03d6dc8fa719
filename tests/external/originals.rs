//! Files of other programs as their makers publish them.

use crate::mutated_originals::without_scales;
use crate::parts::{Test, frames_folder, tests};
use crate::program::touchline;
use serde_json::{Value, json};
use std::path::{Path, PathBuf};
use touchline::document::{Document, Frame, FrameStatus, document_from_bytes};
use touchline::geometry::{ImagePoint, Mat3, Vec3};

pub const TESTS: &[Test] = tests![
    [Frames] all_cameras_of_the_basketball_challenge_are_read_as_one_a_place;
    [Frames] homographies_of_badminton_courts_show_the_corners_that_they_state;
    [Frames] points_of_a_model_are_read_and_give_cameras;
    [Frames] lens_tables_give_frames_their_lens;
    [Frames] points_named_by_their_place_are_landmarks_and_lines;
    [Frames] examples_of_opentrackio_are_read_once_their_distortion_is_out;
    [Frames] control_points_of_a_survey_give_a_camera_by_a_template_of_them;
    [Frames] files_that_are_not_read_say_what_to_do_instead;
];

/// A published file.
fn original(name: &str) -> PathBuf {
    frames_folder().join("originals").join(name)
}

/// What an import of a published file makes; its exit code must be `code`.
fn import(folder: &Path, arguments: &str, code: i32) -> (Document, String) {
    let ran = touchline(folder, &format!("import {arguments} -o out.json --force"));
    assert_eq!(ran.code, code, "{arguments}: {}", ran.stderr);
    let bytes = std::fs::read(folder.join("out.json")).unwrap();
    (document_from_bytes(&bytes).unwrap(), ran.stderr)
}

/// The numbers under a key.
fn numbers<const N: usize>(value: &Value, key: &str) -> [f64; N] {
    let values = value[key].as_array().unwrap().iter();
    let values: Vec<f64> = values.map(|number| number.as_f64().unwrap()).collect();
    values.try_into().unwrap()
}

/// The largest distance between where K [R | T] shows points and where the document's frame does,
/// px, over a grid of the picture.
fn off_px(published: &Value, document: &Document, index: usize) -> f64 {
    let [k, r] = ["K", "R"].map(|key| Mat3::from_row_slice(&numbers::<9>(published, key)));
    let t = Vec3::from(numbers::<3>(published, "T"));
    let frame = &document.frames[index];
    let camera = document.ptz_camera(frame).unwrap();
    let mut worst = 0.0_f64;
    for place in 0..28 * 17 {
        let (u, v) = (
            960.0 * f64::from(place % 28) / 27.0,
            540.0 * f64::from(place / 28) / 16.0,
        );
        // A point 25 m from the camera that the matrix shows here, pixel centres at whole numbers.
        let ray = k.try_inverse().unwrap() * Vec3::new(u - 0.5, v - 0.5, 1.0);
        let in_court = r.transpose() * (ray * 2500.0 - t) / 100.0;
        let point = Vec3::new(in_court.x - 14.0, 7.5 - in_court.y, -in_court.z);
        let shown = camera.image_from_world(point).unwrap();
        worst = worst.max(shown.distance_px(ImagePoint::new(u, v)));
    }
    worst
}

fn all_cameras_of_the_basketball_challenge_are_read_as_one_a_place() {
    let folder = tempfile::tempdir().unwrap();
    let path = original("basketball-deepsport-val.json");
    let (document, said) = import(folder.path(), path.to_str().unwrap(), 0);
    let bytes = std::fs::read(&path).unwrap();
    let published: Vec<Value> = serde_json::from_slice(&bytes).unwrap();
    let cameras = &published[1..];
    assert_eq!((document.frames.len(), document.cameras.len()), (164, 8));
    // Only the skew is left out.
    let cameras = cameras.iter().enumerate();
    let off_px = cameras.map(|(index, camera)| off_px(camera, &document, index));
    let worst_px = off_px.fold(0.0, f64::max);
    println!("at most {worst_px:.4} px off; {said}");
    assert!(worst_px < 0.01, "{worst_px}");
    assert!(said.contains("the nearest camera is taken"), "{said}");
}

fn homographies_of_badminton_courts_show_the_corners_that_they_state() {
    let folder = tempfile::tempdir().unwrap();
    let path = original("badminton-shuttleset-homography.csv");
    let (document, said) = import(
        folder.path(),
        &format!(
            "{} --format homographies --template shuttleset --size 1280x720",
            path.to_str().unwrap()
        ),
        1,
    );
    // Broadcast lenses bend a little: the cameras that miss their homography are said.
    assert_eq!(document.frames.len(), 44, "{said}");
    assert!(
        document.frames.iter().all(|frame| frame.ptz.is_some()),
        "{said}"
    );
    let worst = document.frames.iter().map(|frame| {
        let camera = document.ptz_camera(frame).unwrap();
        assert!(
            camera.base().position_m.x < -10.0,
            "behind the left end: {}",
            frame.name()
        );
        camera.base().position_m.z
    });
    assert!(worst.fold(f64::INFINITY, f64::min) > 2.0);
}

fn points_of_a_model_are_read_and_give_cameras() {
    let folder = tempfile::tempdir().unwrap();
    let zip = original("soccer-pnlcalib-wc14-2d-test_pred.zip");
    let unpacked = folder.path().join("points");
    let status = std::process::Command::new("unzip")
        .args([
            "-q",
            zip.to_str().unwrap(),
            "-d",
            unpacked.to_str().unwrap(),
        ])
        .status();
    if !status.is_ok_and(|status| status.success()) {
        eprintln!("no unzip: the points of PnLCalib were not tried");
        return;
    }
    let arguments = "--points points --layout pnlcalib --size 1280x720 --each-own-camera";
    let (document, said) = import(folder.path(), arguments, 0);
    let solved = document.frames.iter().filter(|frame| frame.ptz.is_some());
    assert_eq!(
        (document.frames.len(), solved.count()),
        (186, 186),
        "{said}"
    );
    let is_suggested = |frame: &Frame| frame.status == FrameStatus::Suggested;
    assert!(document.frames.iter().all(|frame| is_suggested(frame)));
}

fn lens_tables_give_frames_their_lens() {
    let folder = tempfile::tempdir().unwrap();
    for (name, options, count, focal_px) in [
        (
            "lens-venice-frames.csv",
            "--sensor-mm 36",
            588,
            1920.0 * 32.0 / 36.0,
        ),
        // The sensor follows from the focal length for film of 36 mm: 26.3 mm.
        ("lens-canon-frames.csv", "", 1, 1920.0 * 26.3 / 36.0),
    ] {
        let path = original(name);
        let arguments = format!("{} --size 1920x1080 {options}", path.to_str().unwrap());
        let (document, said) = import(folder.path(), &arguments, 0);
        assert_eq!(
            (document.frames.len(), document.cameras.len()),
            (count, 1),
            "{said}"
        );
        for frame in &document.frames {
            let lens = frame.lens.as_ref().unwrap();
            assert!(
                (lens.focal_px - focal_px).abs() < 1e-9,
                "{name}: {}",
                lens.focal_px
            );
            assert!(frame.ptz.is_none());
        }
    }
}

fn points_named_by_their_place_are_landmarks_and_lines() {
    let folder = tempfile::tempdir().unwrap();
    let path = original("soccer-sportslabkit-keypoints.json");
    let arguments = format!("{} --size 6500x1000", path.to_str().unwrap());
    let (document, said) = import(folder.path(), &arguments, 0);
    let clicks = &document.frames[0].clicks;
    assert_eq!((document.frames.len(), clicks.len()), (1, 65), "{said}");
    let on_lines = clicks.iter().filter(|click| click.is_on_line()).count();
    assert_eq!(on_lines, 36, "between the corners and the halfway line");
    let named = |name: &str| {
        let mut clicks = clicks.iter();
        let found = clicks.find(|click| click.target.as_ref().is_some_and(|t| t.as_str() == name));
        found.unwrap().image
    };
    assert_eq!(named("centre_mark"), ImagePoint::new(3540.39, 558.79));
    assert_eq!(named("corner_near_left"), ImagePoint::new(118.18, 889.57));
}

fn examples_of_opentrackio_are_read_once_their_distortion_is_out() {
    let folder = tempfile::tempdir().unwrap();
    for (name, options) in [
        (
            "opentrackio-recommended_dynamic.json",
            "--size 1920x1080 --sensor-mm 36",
        ),
        ("opentrackio-recommended_static.json", "--size 1920x1080"),
    ] {
        let path = original(name);
        let arguments = format!("{} --undistorted {options}", path.to_str().unwrap());
        let (document, _) = import(folder.path(), &arguments, 0);
        let camera = document.ptz_camera(&document.frames[0]).unwrap();
        // Stated: (1, 2, 3) m, and an entrance pupil 0.123 m ahead.
        let off_m = (camera.base().position_m - Vec3::new(1.0, 2.0, 3.0)).norm();
        assert!((off_m - 0.123).abs() < 1e-9, "{name}: {off_m}");
        assert!(
            (camera.ptz().focal_px / 1920.0 * 36.0 - 24.305).abs() < 1e-9,
            "{name}"
        );
    }
    // What the message says of the complete ones: jq -c 'del(.transforms[].scale)'.
    for (name, options) in [
        (
            "opentrackio-complete_dynamic.json",
            "--size 1920x1080 --sensor-mm 36",
        ),
        ("opentrackio-complete_static.json", ""),
    ] {
        let unscaled = folder.path().join("unscaled.json");
        std::fs::copy(original(name), &unscaled).unwrap();
        without_scales(&unscaled);
        let arguments = format!("unscaled.json --undistorted {options}");
        let (document, said) = import(folder.path(), &arguments, 0);
        assert!(document.frames[0].ptz.is_some(), "{name}: {said}");
    }
}

/// The points of a survey on its map become landmarks of a template, their pixels a table. The map
/// does not state its scale.
fn control_points_of_a_survey_give_a_camera_by_a_template_of_them() {
    let folder = tempfile::tempdir().unwrap();
    let read = |name: &str| -> Value {
        serde_json::from_slice(&std::fs::read(original(name)).unwrap()).unwrap()
    };
    let (survey, map) = (
        read("ptz-survey-gcp.json"),
        read("ptz-survey-map-points.json"),
    );
    let on_map = |id: &Value| {
        let mut points = map["points"].as_array().unwrap().iter();
        let point = points.find(|point| point["id"] == *id).unwrap();
        ["pixel_x", "pixel_y"].map(|key| point[key].as_f64().unwrap())
    };
    let marked = survey["capture"]["annotations"].as_array().unwrap();
    let metre_a_pixel = 0.15;
    let middle = on_map(&marked[0]["gcp_id"]);
    let (mut landmarks, mut rows) = (Vec::new(), vec!["frame,label,x,y".to_owned()]);
    for mark in marked {
        let id = mark["gcp_id"].as_str().unwrap().to_lowercase();
        let [x, y] = on_map(&mark["gcp_id"]);
        landmarks.push(json!({ "id": id, "label": id, "code": id, "unmarked": true,
            "at": [metre_a_pixel * (x - middle[0]), metre_a_pixel * (middle[1] - y)] }));
        let [u, v] = ["x", "y"].map(|key| mark["pixel"][key].as_f64().unwrap());
        rows.push(format!("1.jpg,{id},{u},{v}"));
    }
    let side = json!({ "label": "Side", "unit": "m", "default": 300, "min": 300, "max": 300,
        "source": "the map" });
    let line = json!({ "id": "line", "label": "Line", "code": "ln", "from": landmarks[0]["id"],
        "to": landmarks[1]["id"], "width_m": 0.1, "painted": false });
    let template = json!({ "format": "touchline-field", "version": 1, "name": "survey",
        "title": "Survey", "params": { "length_m": side, "width_m": side }, "dimensions": {},
        "extent_m": ["length_m", "width_m"], "symmetry": [], "landmarks": landmarks,
        "lines": [line] });
    std::fs::write(folder.path().join("my.json"), template.to_string()).unwrap();
    std::fs::write(folder.path().join("points.csv"), rows.join("\n")).unwrap();
    let arguments = "points.csv --field my.json --size 1920x1080 --each-own-camera";
    let (document, said) = import(folder.path(), arguments, 0);
    let frame = &document.frames[0];
    let rms_px = frame.solution.as_ref().and_then(|solution| solution.rms_px);
    assert!(
        rms_px.is_some_and(|rms_px| rms_px < 8.0),
        "{rms_px:?} {said}"
    );
    // The head's own read-out is a tilt of 13.1°.
    let tilt_deg = document.ptz_camera(frame).unwrap().ptz().tilt.degrees();
    assert!((tilt_deg + 13.1).abs() < 3.0, "{tilt_deg}");
}

fn files_that_are_not_read_say_what_to_do_instead() {
    let folder = tempfile::tempdir().unwrap();
    for (name, wanted) in [
        ("ptz-survey-gcp.json", "into a template"),
        ("ptz-survey-map-points.json", "into a template"),
        ("lens-venice-frames.csv", "give --video VIDEO or --size"),
        ("lens-canon-frames.csv", "give --video VIDEO or --size"),
        (
            "opentrackio-recommended_dynamic.json",
            "give --size WIDTHxHEIGHT and --sensor-mm",
        ),
        (
            "opentrackio-complete_static.json",
            "the scale of transforms, which shears the camera",
        ),
        ("badminton-shuttleset-homography.csv", "give --template"),
    ] {
        let path = original(name);
        let ran = touchline(
            folder.path(),
            &format!("import {} -o out.json", path.to_str().unwrap()),
        );
        assert_eq!(ran.code, 2, "{name}");
        assert!(ran.stderr.contains(wanted), "{name}: {}", ran.stderr);
    }
}
