//! `touchline experiment` on data that a user gives: published homographies, a published motion,
//! documents of their own.

use crate::touchline;
use serde_json::{Value, json as value};
use std::fs;
use std::path::Path;
use touchline::document::{Clip, document_to_string};
use touchline::geometry::ImageSize;
use touchline::jobs::{DrawnPicture, MatchOrder, draw_match};
use touchline::synthetic::{Graphics, Preset, ShootOptions};
use touchline_laboratory::ExperimentError;

fn json(path: &Path) -> Value {
    serde_json::from_str(&fs::read_to_string(path).unwrap()).unwrap()
}

fn number(row: &Value, key: &str) -> f64 {
    row[key]
        .as_f64()
        .unwrap_or_else(|| panic!("no {key} in {row}"))
}

/// A drawn match of two clips, and the same frames as one clip.
fn write_drawn_match(folder: &Path) {
    let folder = folder.join("match");
    fs::create_dir_all(folder.join("images")).unwrap();
    let order = MatchOrder {
        frames: 8,
        seed: 5,
        image_size: ImageSize::new(640, 360),
        shoot: ShootOptions {
            step_s: 2.0,
            ..Preset::default().shoot()
        },
        masks: false,
        graphics: Graphics {
            score_bug: true,
            ..Graphics::NONE
        },
        unmasked: false,
        references: 0.0,
        ..MatchOrder::demo()
    };
    let drawn = draw_match(&order, &mut |picture: DrawnPicture| {
        fs::write(folder.join(&picture.image), &picture.jpeg).unwrap();
        Ok::<(), ExperimentError>(())
    });
    let mut document = drawn.unwrap().truth;
    for (name, num_clips) in [("truth.json", 2), ("one.json", 1)] {
        for (index, frame) in document.frames.iter_mut().enumerate() {
            frame.clip = Some(Clip::Number(index as i64 % num_clips));
        }
        fs::write(folder.join(name), document_to_string(&document).unwrap()).unwrap();
    }
}

#[test]
fn clips_of_a_users_document_are_asked_of_each_other() {
    let folder = tempfile::tempdir().unwrap();
    write_drawn_match(folder.path());
    let ran = touchline(
        folder.path(),
        "experiment highlights --quick --train match/truth.json -o out",
    );
    assert_eq!(ran.code, 0, "{}", ran.stderr);
    let tables = &json(&folder.path().join("out/highlights.json"))["tables"];
    let rows = tables["highlights-summary"].as_array().unwrap();
    let row = |name: &str| rows.iter().find(|row| row["method"] == name).unwrap();
    for clip in ["default, clip 0", "published, clip 1", "calibme 5, all"] {
        assert!(
            number(row(clip), "right") + number(row(clip), "refused") > 0.0,
            "{rows:?}"
        );
    }
    let all = row("default, all");
    assert!(
        number(all, "right") >= 6.0 && number(all, "rotation_median_deg") < 0.02,
        "{all}"
    );
    assert!(
        number(&tables["highlights-overlay"][2], "within_5_px") >= 0.75,
        "{tables}"
    );
    assert_eq!(tables["highlights-worst"].as_array().unwrap().len(), 5);
    let report = fs::read_to_string(folder.path().join("out/highlights.md")).unwrap();
    assert!(
        report.starts_with("## Sequences: relocalized with other sequences (own frames)"),
        "{report}"
    );
    assert!(
        fs::read(folder.path().join("out/highlights-sheet.png"))
            .unwrap()
            .starts_with(b"\x89PNG")
    );

    // Other features are looked for in the user's own pictures.
    let ran = touchline(
        folder.path(),
        "experiment descriptors --quick --train match/truth.json --test match/truth.json -o out",
    );
    assert_eq!(ran.code, 2, "{}", ran.stderr);
    let ran = touchline(
        folder.path(),
        "experiment descriptors --quick --train match/truth.json --test match/truth.json -o features",
    );
    assert_eq!(ran.code, 0, "{}", ran.stderr);
    let kinds =
        json(&folder.path().join("features/descriptors.json"))["tables"]["descriptors-kinds"]
            .clone();
    let methods = ["published", "default", "nearest neighbours"];
    let ways = methods.map(|method| ["SIFT", "SURF", "ORB", "AKAZE"].map(|kind| (method, kind)));
    for (row, (method, kind)) in ways.as_flattened().iter().enumerate() {
        assert_eq!(
            (&kinds[row]["method"], &kinds[row]["features"]),
            (&value!(method), &value!(kind))
        );
        let answered = number(&kinds[row], "right") + number(&kinds[row], "wrong");
        assert!(answered >= 1.0, "{kinds}");
    }
}

#[test]
fn what_is_missing_is_named_in_one_line() {
    let folder = tempfile::tempdir().unwrap();
    write_drawn_match(folder.path());
    fs::create_dir_all(folder.path().join("bad/highlights")).unwrap();
    fs::write(
        folder.path().join("bad/highlights/seq1_anno.mat"),
        "no matrix",
    )
    .unwrap();
    fs::write(folder.path().join("bad/train_val.json"), "{}").unwrap();
    fs::write(folder.path().join("bad/soccer_ground_truth.json"), "[1, 2]").unwrap();
    for (arguments, named) in [
        ("homographies", "homographies needs data: give --data DIR"),
        (
            "homographies --data match",
            "homographies needs train_val.json",
        ),
        (
            "homographies --data bad",
            "train_val.json: missing field `frames`",
        ),
        (
            "motion --data match",
            "motion needs soccer_ground_truth.json",
        ),
        ("motion --data bad", "soccer_ground_truth.json: "),
        (
            "highlights --data match",
            "highlights needs MATLAB files such as seq1_anno.mat",
        ),
        (
            "highlights --data bad",
            "seq1_anno.mat: it is not a MATLAB file of level 5",
        ),
        (
            "synthetic --data bad",
            "synthetic needs no data; omit --data",
        ),
        ("motion --data nowhere", "nowhere is no folder"),
        (
            "motion --train match/truth.json",
            "does not use frames of your own",
        ),
        (
            "highlights --train match/one.json",
            "no camera has solved frames in two clips",
        ),
        (
            "highlights --train match/truth.json --train match/truth.json --test match/truth.json",
            "--test needs exactly one --train",
        ),
    ] {
        let ran = touchline(
            folder.path(),
            &format!("experiment {arguments} --quick -o out"),
        );
        let lines: Vec<&str> = ran
            .stderr
            .lines()
            .filter(|line| !line.starts_with("touchline: note"))
            .collect();
        assert_eq!(
            (ran.code, lines.len()),
            (2, 1),
            "{arguments}: {}",
            ran.stderr
        );
        assert!(ran.stderr.contains(named), "{arguments}: {}", ran.stderr);
    }
}
