//! `touchline refine-base`: from clicks alone to a base, as a script sees it.

use crate::drawn::clicked_match;
use crate::program::touchline;
use std::collections::BTreeMap;
use std::fs;
use std::path::Path;
use touchline::camera::{CameraBase, FocalCurve};
use touchline::document::{Click, Document, FrameStatus, SolutionSource};
use touchline::field::builtin;
use touchline::geometry::Vec2;
use touchline::store::read;
use touchline_core::testing::seeded::{self, normal};
use touchline_core::testing::{SIZE, TestBase, ground_landmarks, turned_base};
use touchline_documents::testing::{a_match, new_frame, save};

fn truth() -> CameraBase {
    CameraBase {
        distortion: FocalCurve {
            at_focal_px: 2000.0,
            value: -0.04,
            per_1000_px: 0.2,
            ..FocalCurve::NONE
        },
        ..turned_base([1.5, -64.0, 18.0], [0.0, -0.5, 0.0], SIZE)
    }
}

/// Ten frames from left to right, 1.5 px of noise, a camera of which only the picture's size is
/// known.
fn document(name: &str) -> Document {
    document_on(name, &BTreeMap::new())
}

/// The same on a field of another size, which the document does not say.
fn document_on(name: &str, params: &BTreeMap<String, f64>) -> Document {
    let mut rng = seeded::rng(name);
    let field = builtin("soccer").unwrap().model(params, 0.15).unwrap();
    let mut document = a_match(SIZE);
    for index in 0..10 {
        let share = f64::from(index) / 9.0;
        let camera = truth().aim(-30.0 + 60.0 * share, -12.5, 1700.0 + 900.0 * share);
        let mut frame = new_frame(&format!("images/{index}.png"), SIZE);
        frame.status = FrameStatus::Draft;
        for (_, landmark, exact) in ground_landmarks(&field, &camera) {
            let image = exact.translate(Vec2::new(normal(&mut rng), normal(&mut rng)) * 1.5);
            if SIZE.contains(image) {
                frame
                    .clicks
                    .push(Click::landmark(landmark.id.clone(), image));
            }
        }
        document.frames.push(frame.into());
    }
    document
}

fn write(document: &Document, folder: &Path) {
    save(folder.join("doc.json"), document);
}

#[test]
fn a_camera_is_found_from_clicks_alone_and_every_frame_solved() {
    let folder = tempfile::tempdir().unwrap();
    let mut document = document("a_camera_is_found_from_clicks_alone_and_every_frame_solved");
    // One frame was named from the wrong side, one landmark of another is wrong, one frame is
    // rejected.
    for click in &mut document.frames[4].clicks {
        let exchanged = click
            .target
            .as_ref()
            .unwrap()
            .as_str()
            .replace("near", "FAR")
            .replace("far", "near");
        *click = Click::landmark(exchanged.replace("FAR", "far").as_str().into(), click.image);
    }
    let wrong = document.frames[8]
        .clicks
        .iter()
        .position(|click| click.target.as_ref().unwrap().as_str() == "goal_area_far_right_front");
    let wrong = wrong.unwrap();
    let image = document.frames[8].clicks[wrong].image;
    document.frames[8].clicks[wrong] = Click::landmark("penalty_mark_right".into(), image);
    document.frames[8].clicks.retain(|click| {
        click.image == image || click.target.as_ref().unwrap().as_str() != "penalty_mark_right"
    });
    let wrong = document.frames[8]
        .clicks
        .iter()
        .position(|click| click.image == image)
        .unwrap();
    document.frames[9].status = FrameStatus::Rejected;
    save(folder.path().join("doc.json"), &document);

    let ran = touchline(folder.path(), "refine-base doc.json -o out/refined.json").done();
    for line in [
        "main: position (",
        "k1 linear in f, crowned pitch: ",
        "main: all clicks ",
        "1 camera estimated, 10 frames",
    ] {
        assert!(ran.stderr.contains(line), "{line}: {}", ran.stderr);
    }
    ran.assert_says("images/4.png: the names look mirrored: ");
    ran.assert_says("goal_area_far_right_front would fit");

    let (_, refined, _) = read(&folder.path().join("out/refined.json")).unwrap();
    let base = refined.cameras[0].base().unwrap();
    let z = (base.position_m - truth().position_m).component_div(&base.sigma.position_m);
    assert!(
        z.amax() < 4.0 && base.sigma.position_m.amax() < 1.0,
        "{base:?}"
    );
    assert!((refined.field.params["crown_m"] - 0.15).abs() < 0.1);
    let marked = refined.frames[4].solution.as_ref().unwrap();
    assert_eq!(
        marked
            .warnings
            .iter()
            .filter(|warning| warning.code == "mirrored")
            .count(),
        1,
        "told once"
    );
    let disputed = refined.frames[8].solution.as_ref().unwrap();
    assert_eq!(disputed.disputed, [wrong]);
    let warning = disputed
        .warnings
        .iter()
        .find(|warning| warning.code == "wrong_line")
        .unwrap();
    assert!(
        warning.clicks == [wrong]
            && warning
                .message
                .ends_with(" px as Goal area, far right, front corner.")
    );
    for (frame, before) in refined.frames.iter().zip(&document.frames) {
        assert_eq!(
            (frame.status, &frame.clicks),
            (before.status, &before.clicks)
        );
    }
    let printed = touchline(&folder.path().join("out"), "refine-base ../doc.json");
    assert_eq!(
        printed.stdout,
        fs::read_to_string(folder.path().join("out/refined.json")).unwrap(),
        "same bytes"
    );
    assert_eq!(
        touchline(folder.path(), "refine-base doc.json -o out/refined.json").code,
        2,
        "it exists"
    );
    // From its own result on it says what it was before.
    let again = touchline(
        folder.path(),
        "refine-base out/refined.json -o again.json --distortion k1-focal --crown 0.15",
    );
    assert!(
        again.code == 0 && again.stderr.contains(" px before; crown 0.15 m"),
        "{}",
        again.stderr
    );
}

#[test]
fn what_is_missing_is_said_in_one_line() {
    let folder = tempfile::tempdir().unwrap();
    let mut document = document("what_is_missing_is_said_in_one_line");
    for frame in &mut document.frames {
        frame.clicks.truncate(2);
    }
    save(folder.path().join("doc.json"), &document);
    let ran = touchline(folder.path(), "refine-base doc.json -o refined.json");
    assert_eq!((ran.code, ran.stdout.as_str()), (2, ""));
    ran.assert_says("camera \"main\": no frame determines a camera by itself");
    assert_eq!(ran.stderr.lines().count(), 1, "{}", ran.stderr);
    assert!(!folder.path().join("refined.json").exists());
    let usage = touchline(folder.path(), "refine-base doc.json --crown high");
    assert!(
        usage.code == 2 && usage.stderr.contains("auto or a number of metres"),
        "{}",
        usage.stderr
    );
    document.frames[0].clicks = vec![Click::landmark("nowhere".into(), SIZE.centre())];
    save(folder.path().join("doc.json"), &document);
    let ran = touchline(folder.path(), "refine-base doc.json");
    assert!(
        ran.code == 2 && ran.stderr.contains("has no landmark \"nowhere\""),
        "{}",
        ran.stderr
    );
}

#[test]
fn the_size_of_the_field_is_found_where_it_is_asked_for() {
    let folder = tempfile::tempdir().unwrap();
    let real = BTreeMap::from([("length_m".to_owned(), 103.4), ("width_m".to_owned(), 66.8)]);
    write(
        &document_on(
            "the_size_of_the_field_is_found_where_it_is_asked_for",
            &real,
        ),
        folder.path(),
    );
    let asked =
        "refine-base doc.json -o sized.json --field-size --distortion k1-focal --crown 0.15";
    let ran = touchline(folder.path(), asked).done();
    assert!(
        ran.stderr.contains("main: field length 103.") && ran.stderr.contains("(105 m assumed)"),
        "{}",
        ran.stderr
    );
    let (_, sized, _) = read(&folder.path().join("sized.json")).unwrap();
    for (name, real) in &real {
        assert!(
            (sized.field.params[name] - real).abs() < 0.4,
            "{name}: {} {}",
            sized.field.params[name],
            ran.stderr
        );
    }
    let z = |document: &Document| {
        let base = document.cameras[0].base().unwrap();
        (base.position_m - truth().position_m)
            .component_div(&base.sigma.position_m)
            .amax()
    };
    assert!(z(&sized) < 3.0, "{:?}", sized.cameras[0].base());
}

#[test]
fn a_field_outside_the_rules_is_refused_with_the_range() {
    let folder = tempfile::tempdir().unwrap();
    let mut document = document("a_field_outside_the_rules_is_refused_with_the_range");
    document.field.params.insert("length_m".to_owned(), 150.0);
    save(folder.path().join("doc.json"), &document);
    let ran = touchline(folder.path(), "refine-base doc.json -o refined.json");
    ran.assert_refused(2);
    assert!(
        ran.stderr.contains("length_m") && ran.stderr.contains("90") && ran.stderr.contains("120"),
        "{}",
        ran.stderr
    );
    assert!(!folder.path().join("refined.json").exists());
}

#[test]
fn painted_lines_and_clicks_together_find_the_camera_and_pull_the_frames() {
    let place = tempfile::tempdir().unwrap();
    let (folder, truth, mut clicked) = clicked_match(place.path());
    // The last frame has no picture: its clicks count all the same.
    let last = clicked.frames.len() - 1;
    clicked.frames[last].image = Some("images/none.png".into());
    write(&clicked, &folder);
    let ran = touchline(&folder, "refine-base doc.json --markings -o refined.json");
    assert_eq!(ran.code, 1, "{}", ran.stderr);
    for line in [
        "main: painted lines: ",
        "main: paint held out: ",
        "main: 5 of 6 frames pulled onto their painted lines",
    ] {
        assert!(ran.stderr.contains(line), "{line}: {}", ran.stderr);
    }
    ran.assert_says("images/none.png");
    let (_, refined, _) = read(&folder.join("refined.json")).unwrap();
    let away_m = |document: &Document| {
        (document.cameras[0].base().unwrap().position_m
            - truth.cameras[0].base().unwrap().position_m)
            .norm()
    };
    assert!(away_m(&refined) < 0.5, "{} m", away_m(&refined));
    for (was, is) in truth.frames.iter().zip(&refined.frames).take(last) {
        let middle = was.image_size.centre();
        let ground = truth
            .ptz_camera(was)
            .unwrap()
            .plane_from_image(middle, 0.0)
            .unwrap();
        let off_px = refined
            .ptz_camera(is)
            .unwrap()
            .image_from_world(ground)
            .unwrap()
            .distance_px(middle);
        assert!(off_px < 1.0, "{}: {off_px} px", was.name());
        assert_eq!(
            is.solution.as_ref().unwrap().source,
            Some(SolutionSource::Markings)
        );
        assert_eq!(is.status, was.status);
    }
}

#[test]
fn without_painted_lines_the_base_is_refused_by_name() {
    let place = tempfile::tempdir().unwrap();
    let document = document("without_painted_lines");
    save(place.path().join("doc.json"), &document);
    let ran = touchline(
        place.path(),
        "refine-base doc.json --markings -o refined.json",
    );
    assert_eq!(ran.code, 2, "{}", ran.stderr);
    ran.assert_says("painted lines are seen in 0 frames");
    assert!(!place.path().join("refined.json").exists());
}
