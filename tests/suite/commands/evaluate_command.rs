//! `touchline evaluate`: what a script can rely on.

use crate::program::touchline;
use serde_json::Value;
use std::path::Path;
use tempfile::TempDir;
use touchline::camera::{Ptz, PtzCamera};
use touchline::document::{Camera, Click, Clip, Document, FramePtz, FrameStatus, Solution};
use touchline::geometry::{Angle, ImageSize, Mat3, Vec3};
use touchline::store::{Location, write_document};
use touchline_core::testing::{landmark_in, soccer, turned_base};
use touchline_documents::testing::{match_from, new_frame};

const SIZE: ImageSize = ImageSize::new(1280, 720);

fn ptz(index: usize) -> Ptz {
    Ptz::from_degrees(10.0 + index as f64, -11.0, 1500.0 + 700.0 * index as f64)
}

fn document(frames: usize) -> Document {
    let base = turned_base([1.0, -58.0, 16.0], [0.0, -1.0, 0.0], SIZE);
    let mut document = match_from(&base, SIZE);
    let field = soccer();
    for index in 0..frames {
        let mut frame = new_frame(&format!("images/{index}.jpg"), SIZE);
        frame.status = FrameStatus::Reference;
        frame.clip = Some(Clip::Number(index as i64 / 2));
        frame.ptz = Some(FramePtz::new(ptz(index), None));
        let exact = PtzCamera::new(base, ptz(index));
        for name in [
            "centre_mark",
            "centre_circle_right",
            "penalty_arc_near_right",
        ] {
            let at = landmark_in(&exact, &field, name);
            if SIZE.contains(at) {
                frame.clicks.push(Click::landmark(name.into(), at));
            }
        }
        document.frames.push(frame.into());
    }
    document
}

fn write(folder: &Path, name: &str, document: &Document) {
    write_document(
        &Location::for_new_document(&folder.join(name)).unwrap(),
        document,
        false,
    )
    .unwrap();
}

/// A truth of four frames; an estimate that is 0.1° too far right in all, 2 % too long in the
/// second, unsolved in the third, without the fourth, and with a frame too many.
fn folder() -> TempDir {
    let folder = tempfile::tempdir().unwrap();
    let truth = document(4);
    let mut estimate = document(4);
    for frame in &mut estimate.frames {
        let exact = frame.ptz.as_ref().unwrap().ptz();
        let moved = Ptz {
            pan: exact.pan + Angle::from_degrees(0.1),
            ..exact
        };
        frame.ptz = Some(FramePtz::new(moved, None));
        frame.clicks.truncate(1);
        let sigmas = Mat3::from_diagonal(&Vec3::new(0.01, 0.01, 400.0));
        frame.solution = Some(Solution {
            covariance: Some(sigmas),
            ..Solution::default()
        });
    }
    let second = estimate.frames[1].ptz.as_mut().unwrap();
    second.focal_px *= 1.02;
    estimate.frames[2].ptz = None;
    estimate.frames.remove(3);
    estimate
        .frames
        .push(new_frame("images/more.jpg", SIZE).into());
    write(folder.path(), "truth.json", &truth);
    write(folder.path(), "estimate.json", &estimate);
    folder
}

fn near(value: &Value, expected: f64, tolerance: f64) {
    let value = value.as_f64().unwrap();
    assert!((value - expected).abs() <= tolerance, "{value} {expected}");
}

#[test]
fn errors_are_those_put_in_and_missing_frames_are_named() {
    let folder = folder();
    let ran = touchline(folder.path(), "evaluate truth.json estimate.json --json");
    assert_eq!(ran.code, 1, "{}", ran.stderr);
    assert!(
        ran.stderr.contains("images/2.jpg")
            && ran.stderr.contains("the estimate has no camera for it")
    );
    assert!(
        ran.stderr.contains("images/3.jpg")
            && ran.stderr.contains("the estimate has no such frame")
    );
    assert!(ran.stderr.contains("images/more.jpg"));
    let report: Value = serde_json::from_str(&ran.stdout).unwrap();
    let frames = report["frames"].as_array().unwrap();
    assert_eq!(frames.len(), 4);
    near(&frames[0]["pan_deg"], 0.1, 1e-9);
    near(&frames[0]["tilt_deg"], 0.0, 1e-9);
    near(&frames[0]["focal_px"], 0.0, 1e-9);
    near(&frames[0]["rotation_deg"], 0.1, 1e-9);
    near(&frames[1]["focal_percent"], 2.0, 1e-9);
    // One sigma in pan alone: χ² 1 of 3.
    near(&frames[0]["error_over_sigma"], (1.0f64 / 3.0).sqrt(), 1e-9);
    // A turn by δ moves a pixel near the middle of the picture by f δ.
    near(&frames[0]["clicks_px"], 1500.0 * 0.1f64.to_radians(), 0.4);
    assert!(
        frames[0]["held_out_px"].as_f64().unwrap() > 2.0
            && frames[0]["held_out_m"].as_f64().unwrap() > 0.05
    );
    assert!(frames[2].get("pan_deg").is_none() && frames[2]["unscored"].is_string());

    let summary = &report["summary"];
    near(&summary["completeness"], 0.5, 0.0);
    near(&summary["measures"]["pan_deg"]["mean"], 0.1, 1e-9);
    near(&summary["measures"]["focal_percent"]["median"], 1.0, 1e-9);
    let jaccard = summary["measures"]["jac_5"]["mean"].as_f64().unwrap();
    near(&summary["soccernet_score"], 0.5 * jaccard, 1e-12);
    let groups: Vec<(&str, &str)> = report["groups"]
        .as_array()
        .unwrap()
        .iter()
        .map(|g| (g["by"].as_str().unwrap(), g["name"].as_str().unwrap()))
        .collect();
    assert_eq!(&groups[..2], [("clip", "0"), ("clip", "1")]);
    assert!(
        groups[2..].iter().all(|(by, _)| *by == "view") && groups.len() > 3,
        "{groups:?}"
    );
}

#[test]
fn a_document_is_right_by_itself() {
    let folder = folder();
    let ran = touchline(folder.path(), "evaluate truth.json truth.json --json").done();
    let report: Value = serde_json::from_str(&ran.stdout).unwrap();
    let measures = &report["summary"]["measures"];
    for (key, expected) in [
        ("iou_part", 1.0),
        ("iou_whole", 1.0),
        ("jac_5", 1.0),
        ("rotation_deg", 0.0),
        ("clicks_px", 0.0),
    ] {
        near(&measures[key]["mean"], expected, 1e-9);
    }
}

#[test]
fn a_truth_of_clicks_alone_measures_clicks() {
    let folder = folder();
    let mut clicks = document(2);
    clicks.cameras[0].position_m = None;
    for frame in &mut clicks.frames {
        frame.ptz = None;
    }
    write(folder.path(), "clicks.json", &clicks);
    let ran = touchline(folder.path(), "evaluate clicks.json estimate.json --json").done();
    let report: Value = serde_json::from_str(&ran.stdout).unwrap();
    let measures = report["summary"]["measures"].as_object().unwrap();
    assert!(measures.contains_key("held_out_px") && !measures.contains_key("iou_part"));
    assert!(
        report["summary"]["every_held_out_click_px"]["count"]
            .as_u64()
            .unwrap()
            >= 2
    );
}

#[test]
fn files_are_written_by_their_ending_and_never_over_something() {
    let folder = folder();
    let run = |arguments: &str| {
        touchline(
            folder.path(),
            &format!("evaluate truth.json estimate.json {arguments}"),
        )
    };
    for name in ["scores.json", "scores.csv", "scores.md"] {
        let ran = run(&format!("-o {name}"));
        assert_eq!((ran.code, ran.stdout.as_str()), (1, ""), "{}", ran.stderr);
    }
    let text = |name: &str| std::fs::read_to_string(folder.path().join(name)).unwrap();
    assert!(
        text("scores.csv").starts_with(
            "frame,clip,camera,view_deg,iou_part,iou_segments,iou_whole,rotation_deg,"
        )
    );
    assert_eq!(text("scores.csv").lines().count(), 5);
    assert!(text("scores.md").contains("| rotation error (°) |"));
    assert!(serde_json::from_str::<Value>(&text("scores.json")).is_ok());
    assert_eq!(run("-o more.json --report report").code, 1);
    assert!(text("report/evaluation.md").contains("](evaluation-rotation_deg.svg)"));
    assert!(
        folder
            .path()
            .join("report/evaluation-iou-view.png")
            .is_file()
    );
    let refused = run("-o scores.csv");
    assert_eq!(refused.code, 2);
    assert!(
        refused
            .stderr
            .contains("scores.csv already exists; give --force"),
        "{}",
        refused.stderr
    );
    let wrong = run("-o scores.txt");
    assert_eq!(wrong.code, 2);
    wrong.assert_says(".json, .csv or .md");
    // The same input and seed give the same bytes.
    assert_eq!(run("").stdout, text("scores.json"));
    assert!(
        run("--table").stdout.starts_with(
            "2 of 4 frames have a camera (completeness 0.500); px are of pictures of "
        )
    );
}

#[test]
fn nothing_to_compare_with_is_said_in_one_line() {
    let folder = folder();
    write(folder.path(), "empty.json", &document(0));
    let ran = touchline(folder.path(), "evaluate empty.json estimate.json");
    assert_eq!(ran.code, 2);
    ran.assert_says("no frame of the truth has a camera or a named click");
    let missing = touchline(folder.path(), "evaluate truth.json nowhere.json");
    missing.assert_refused(2);
}

#[test]
fn frames_of_two_matches_with_the_same_names_are_not_compared() {
    let folder = folder();
    let (mut truth, mut estimate) = (document(3), document(3));
    for (document, digit) in [(&mut truth, "a"), (&mut estimate, "b")] {
        for frame in &mut document.frames {
            frame.sha256 = Some(digit.repeat(64));
        }
    }
    write(folder.path(), "red.json", &truth);
    write(folder.path(), "blue.json", &estimate);
    let ran = touchline(folder.path(), "evaluate red.json blue.json --json");
    assert_eq!(ran.code, 1, "{}", ran.stderr);
    assert_eq!(
        ran.stderr.matches("the estimate has no such frame").count(),
        3,
        "{}",
        ran.stderr
    );
}

#[test]
fn no_name_is_a_formula_in_the_table() {
    let folder = folder();
    let mut truth = document(1);
    truth.frames[0].image = Some("=cmd|'-1'!A0".to_owned());
    write(folder.path(), "named.json", &truth);
    touchline(folder.path(), "evaluate named.json named.json -o named.csv").done();
    let table = std::fs::read_to_string(folder.path().join("named.csv")).unwrap();
    assert!(
        table.lines().nth(1).unwrap().starts_with("'=cmd"),
        "{table}"
    );
}

#[test]
fn metres_on_the_ground_are_those_put_in() {
    let folder = tempfile::tempdir().unwrap();
    let truth = document(2);
    let mut estimate = truth.clone();
    // The same view from a place a metre to the right.
    let camera = &truth.cameras[0];
    let mut base = camera.base().unwrap();
    base.position_m.x += 1.0;
    let mut moved = Camera::new("main".into(), SIZE);
    moved.set_base(&base);
    estimate.cameras = vec![moved.into()];
    write(folder.path(), "truth.json", &truth);
    write(folder.path(), "estimate.json", &estimate);
    std::fs::write(
        folder.path().join("feet.csv"),
        "frame,x,y,w,h\n0,600,300,40,80\nimages/1.jpg,640,500,0,0\n",
    )
    .unwrap();
    for (points, kind, least) in [("", "grid", 50), ("--points feet.csv", "given", 2)] {
        let ran = touchline(
            folder.path(),
            &format!("evaluate truth.json estimate.json {points} --json"),
        )
        .done();
        let report: Value = serde_json::from_str(&ran.stdout).unwrap();
        let ground = &report["ground"];
        assert_eq!(ground["points"], kind);
        near(&ground["all"]["median_m"], 1.0, 1e-9);
        near(&ground["all"]["p95_m"], 1.0, 1e-9);
        assert!(
            ground["all"]["count"].as_u64().unwrap() >= least,
            "{ground}"
        );
        assert_eq!(ground["frames"].as_array().unwrap().len(), 2);
    }
    let ran = touchline(
        folder.path(),
        "evaluate truth.json estimate.json --points feet.csv --table",
    );
    let line = "On the ground, at 2 given points in 2 frames: median 1.000 m, 95 % within 1.000 m.";
    ran.assert_prints(line);
    std::fs::write(folder.path().join("bad.txt"), "1,2,3\n").unwrap();
    let ran = touchline(
        folder.path(),
        "evaluate truth.json estimate.json --points bad.txt",
    );
    ran.assert_refused(2);
}
