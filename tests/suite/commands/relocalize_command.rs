//! `touchline train` and `touchline relocalize` on a drawn match.
#![cfg(feature = "opencv")]

use crate::drawn::drawn_match;
use crate::program::touchline;
use std::fs;
use touchline::document::{Frame, FrameStatus, SolutionSource};
use touchline::geometry::rotation::{angle_between, q_pan, q_tilt};
use touchline::relocalize::CERTAIN;
use touchline::relocalize::ForestModel;
use touchline_documents::testing::{load, save};

#[test]
fn a_forest_of_the_references_answers_the_other_frames() {
    let place = tempfile::tempdir().unwrap();
    drawn_match(place.path());
    let folder = place.path().join("match");
    let trained = touchline(&folder, "train references.json -o forest.tlf").done();
    trained.assert_says("forest.tlf: 5 references, ");
    let bytes = fs::read(folder.join("forest.tlf")).unwrap();
    assert_eq!(
        touchline(&folder, "train references.json -o forest.tlf").code,
        2,
        "it exists"
    );
    assert_eq!(
        touchline(&folder, "train references.json -o forest.tlf --force").code,
        0
    );
    assert!(
        fs::read(folder.join("forest.tlf")).unwrap() == bytes,
        "same input, same bytes"
    );
    let trees = |name: &str| {
        let model = ForestModel::from_bytes(&fs::read(folder.join(name)).unwrap()).unwrap();
        model.cameras[0].forest.trees()
    };
    assert_eq!(
        touchline(&folder, "train references.json -o paper.tlf --published").code,
        0
    );
    assert_eq!(
        touchline(
            &folder,
            "train references.json -o two.tlf --published --trees 2"
        )
        .code,
        0
    );
    assert_eq!(
        [trees("forest.tlf"), trees("paper.tlf"), trees("two.tlf")],
        [3, 5, 2]
    );

    let kept = || {
        fs::read_dir(folder.join(".touchline/features"))
            .unwrap()
            .count()
    };
    assert_eq!(kept(), 5, "features are found once");

    let ran = touchline(
        &folder,
        "relocalize forest.tlf ask.json -o answers.json --timings",
    );
    assert_eq!(kept(), 10);
    for output in ["first.json", "second.json"] {
        assert!(
            touchline(
                &folder,
                &format!("relocalize forest.tlf ask.json -o {output}")
            )
            .code
                < 2
        );
    }
    let bytes = |name: &str| fs::read_to_string(folder.join(name)).unwrap();
    assert!(
        bytes("first.json") == bytes("second.json") && !bytes("first.json").contains("timings_ms")
    );
    let (truth, answers) = (
        load(folder.join("truth.json")),
        load(folder.join("answers.json")),
    );
    let mut answered = 0;
    for (index, (frame, truth)) in answers.frames.iter().zip(&truth.frames).enumerate() {
        if index % 2 == 0 {
            assert_eq!(
                (frame.status, &frame.ptz),
                (FrameStatus::Reference, &truth.ptz),
                "left as it was"
            );
            continue;
        }
        let solution = frame.solution.as_ref().unwrap();
        let timings = solution.timings_ms.as_ref().unwrap();
        assert!(
            timings.features > 0.0 && timings.predict >= 0.0 && timings.pose >= 0.0,
            "{timings:?}"
        );
        assert_eq!(solution.source, Some(SolutionSource::Forest));
        let Some(ptz) = &frame.ptz else {
            assert_eq!(
                (frame.status, solution.warnings.len()),
                (FrameStatus::New, 1)
            );
            continue;
        };
        answered += 1;
        assert_eq!(frame.status, FrameStatus::Suggested);
        assert!(solution.confidence.unwrap() >= 0.5 && solution.covariance.is_some());
        let (found, truth) = (ptz.ptz(), truth.ptz.as_ref().unwrap().ptz());
        let turned = |ptz: touchline::camera::Ptz| q_tilt(ptz.tilt) * q_pan(ptz.pan);
        assert!(
            angle_between(&turned(found), &turned(truth)).degrees() < 0.1,
            "frame {index}: {found:?} {truth:?}"
        );
    }
    assert!(answered >= 3, "{answered} of 5: {}", ran.stderr);
    // One frame may be without an answer, or uncertain: then it is the one to label.
    let sure = |frame: &Frame| {
        frame
            .solution
            .as_ref()
            .and_then(|solution| solution.confidence)
            >= Some(CERTAIN)
    };
    let next = answers
        .frames
        .iter()
        .filter(|frame| frame.status != FrameStatus::Reference && !sure(frame));
    let named = |frame: &Frame| {
        ran.stderr
            .contains(&format!("Begin with {}.", frame.name()))
    };
    assert_eq!(
        next.clone().any(|frame| named(frame)),
        next.count() > 0,
        "{}",
        ran.stderr
    );
    assert_eq!(ran.code, i32::from(answered < 5), "{}", ran.stderr);
    let again = touchline(
        &folder,
        "relocalize forest.tlf answers.json --resume -o again.json",
    );
    let said = format!(
        "touchline: 0 frames answered, {} not, {} left unchanged",
        5 - answered,
        5 + answered
    );
    again.assert_says(&said);
    for (frame, before) in load(folder.join("again.json"))
        .frames
        .iter()
        .zip(&answers.frames)
    {
        assert!(
            frame.status != FrameStatus::Suggested || frame == before,
            "what was answered stays: {}",
            frame.name()
        );
    }
}

#[test]
fn images_alone_are_answered_and_a_damaged_one_is_skipped() {
    let place = tempfile::tempdir().unwrap();
    drawn_match(place.path());
    let folder = place.path().join("match");
    assert_eq!(
        touchline(&folder, "train references.json -o forest.tlf --no-cache").code,
        0
    );
    assert!(!folder.join(".touchline").exists());
    fs::create_dir(folder.join("some")).unwrap();
    fs::copy(folder.join("images/0001.jpg"), folder.join("some/1.jpg")).unwrap();
    fs::write(folder.join("some/2.jpg"), "no picture").unwrap();
    let ran = touchline(&folder, "relocalize forest.tlf some -o out.jsonl");
    assert_eq!(ran.code, 1, "{}", ran.stderr);
    ran.assert_says("2.jpg: ");
    let lines = fs::read_to_string(folder.join("out.jsonl")).unwrap();
    let frames: Vec<serde_json::Value> = lines
        .lines()
        .map(|line| serde_json::from_str(line).unwrap())
        .collect();
    assert_eq!(frames.len(), 1);
    assert_eq!(
        (&frames[0]["image"], &frames[0]["status"]),
        (&"some/1.jpg".into(), &"suggested".into())
    );
}

#[test]
fn what_does_not_fit_is_one_line_and_exit_two() {
    let place = tempfile::tempdir().unwrap();
    drawn_match(place.path());
    let folder = place.path().join("match");
    let none = touchline(&folder, "train ask.json -o none.tlf --features 10");
    assert_eq!(none.code, 2, "too few features are refused");
    let mut suggestions = load(folder.join("references.json"));
    for frame in &mut suggestions.frames {
        frame.solution.get_or_insert_default().source = Some(SolutionSource::Forest);
    }
    save(folder.join("suggestions.json"), &suggestions);
    let refused = touchline(&folder, "train suggestions.json -o none.tlf");
    assert_eq!(refused.code, 2);
    refused.assert_says("no references to train with");
    assert!(!folder.join("none.tlf").exists());
    assert_eq!(
        touchline(
            &folder,
            "train suggestions.json -o forest.tlf --all-references"
        )
        .code,
        0
    );

    let mut moved = load(folder.join("ask.json"));
    moved.cameras[0].position_m.as_mut().unwrap().x += 0.5;
    save(folder.join("moved.json"), &moved);
    let refused = touchline(&folder, "relocalize forest.tlf moved.json -o out.json");
    assert_eq!(refused.code, 2);
    refused.assert_says("train the forest again");
    let mut bytes = fs::read(folder.join("forest.tlf")).unwrap();
    let middle = bytes.len() / 2;
    bytes[middle] ^= 1;
    fs::write(folder.join("damaged.tlf"), bytes).unwrap();
    let refused = touchline(&folder, "relocalize damaged.tlf ask.json -o out.json");
    assert_eq!(
        refused.stderr,
        "touchline: damaged.tlf: this forest is damaged (its checksum does not fit); train it again\n"
    );
    assert_eq!(refused.code, 2);
    assert!(!folder.join("out.json").exists());
}
