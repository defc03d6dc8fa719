//! `touchline refine-base`: from clicks alone to a base, as a script sees it.

use crate::program::touchline;
use crate::seeded::{self, normal};
use std::collections::BTreeMap;
use std::fs;
use std::path::Path;
use touchline::camera::{BaseAngles, CameraBase, FocalCurve, Ptz, PtzCamera};
use touchline::document::{
    Camera, Click, Document, FieldSpec, Frame, FrameStatus, SolutionSource, document_to_string,
};
use touchline::field::builtin;
use touchline::geometry::{Angle, ImageSize, Vec2, Vec3};
use touchline::store::read;

const SIZE: ImageSize = ImageSize::new(1920, 1080);

fn truth() -> CameraBase {
    let angles = BaseAngles {
        pitch: Angle::from_degrees(-0.5),
        ..BaseAngles::default()
    };
    CameraBase {
        distortion: FocalCurve {
            at_focal_px: 2000.0,
            value: -0.04,
            per_1000_px: 0.2,
            ..FocalCurve::NONE
        },
        ..CameraBase::new(
            Vec3::new(1.5, -64.0, 18.0),
            angles.base_from_world(),
            SIZE.centre(),
        )
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
    let mut document = Document::new(FieldSpec::new("soccer"));
    document
        .cameras
        .push(Camera::new("main".into(), SIZE).into());
    for index in 0..10 {
        let share = f64::from(index) / 9.0;
        let camera = PtzCamera::new(
            truth(),
            Ptz::from_degrees(-30.0 + 60.0 * share, -12.5, 1700.0 + 900.0 * share),
        );
        let mut frame = Frame::from_image(&format!("images/{index}.png"), "main".into(), SIZE);
        frame.status = FrameStatus::Draft;
        for landmark in field
            .landmarks
            .iter()
            .filter(|landmark| landmark.nominal_m.z == 0.0)
        {
            let Ok(exact) = camera.image_from_world(field.landmark_in_world(landmark)) else {
                continue;
            };
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
    fs::write(
        folder.join("doc.json"),
        document_to_string(document).unwrap(),
    )
    .unwrap();
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
    write(&document, folder.path());

    let ran = touchline(folder.path(), "refine-base doc.json -o out/refined.json");
    assert_eq!(ran.code, 0, "{}", ran.stderr);
    for line in [
        "main: position (",
        "k1 linear in f, crowned pitch: ",
        "main: all clicks ",
        "1 camera estimated, 10 frames",
    ] {
        assert!(ran.stderr.contains(line), "{line}: {}", ran.stderr);
    }
    assert!(
        ran.stderr
            .contains("images/4.png: the names look mirrored: "),
        "{}",
        ran.stderr
    );
    assert!(
        ran.stderr.contains("goal_area_far_right_front would fit"),
        "{}",
        ran.stderr
    );

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
    write(&document, folder.path());
    let ran = touchline(folder.path(), "refine-base doc.json -o refined.json");
    assert_eq!((ran.code, ran.stdout.as_str()), (2, ""));
    assert!(
        ran.stderr
            .contains("camera \"main\": no frame determines a camera by itself"),
        "{}",
        ran.stderr
    );
    assert_eq!(ran.stderr.lines().count(), 1, "{}", ran.stderr);
    assert!(!folder.path().join("refined.json").exists());
    let usage = touchline(folder.path(), "refine-base doc.json --crown high");
    assert!(
        usage.code == 2 && usage.stderr.contains("auto or a number of metres"),
        "{}",
        usage.stderr
    );
    document.frames[0].clicks = vec![Click::landmark("nowhere".into(), SIZE.centre())];
    write(&document, folder.path());
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
    let ran = touchline(folder.path(), asked);
    assert_eq!(ran.code, 0, "{}", ran.stderr);
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
    write(&document, folder.path());
    let ran = touchline(folder.path(), "refine-base doc.json -o refined.json");
    assert_eq!(
        (ran.code, ran.stderr.lines().count()),
        (2, 1),
        "{}",
        ran.stderr
    );
    assert!(
        ran.stderr.contains("length_m") && ran.stderr.contains("90") && ran.stderr.contains("120"),
        "{}",
        ran.stderr
    );
    assert!(!folder.path().join("refined.json").exists());
}

/// A drawn match whose clicks scatter, in a new folder: the folder and the exact document.
fn drawn_match(place: &Path) -> (std::path::PathBuf, Document) {
    let drawn = touchline(
        place,
        "synth -o match --frames 6 --seed 5 --size 960x540 --preset easy",
    );
    assert_eq!(drawn.code, 0, "{}", drawn.stderr);
    let folder = place.join("match");
    let (_, truth, _) = read(&folder.join("truth.json")).unwrap();
    (folder, truth)
}

/// The same, and the document without cameras and with clicks that scatter.
pub fn clicked_match(place: &Path) -> (std::path::PathBuf, Document, Document) {
    let (folder, truth) = drawn_match(place);
    let mut rng = seeded::rng("painted_lines_and_clicks_together");
    let mut clicked = truth.clone();
    for camera in &mut clicked.cameras {
        *camera = Camera::new("main".into(), truth.frames[0].image_size).into();
    }
    let field = truth.field.model(&folder).unwrap();
    for (frame, was) in clicked.frames.iter_mut().zip(&truth.frames) {
        let camera = truth.ptz_camera(was).unwrap();
        (frame.ptz, frame.solution) = (None, None);
        for landmark in field
            .landmarks
            .iter()
            .filter(|landmark| landmark.nominal_m.z == 0.0)
        {
            let Ok(exact) = camera.image_from_world(field.landmark_in_world(landmark)) else {
                continue;
            };
            let image = exact.translate(Vec2::new(normal(&mut rng), normal(&mut rng)) * 0.8);
            if was.image_size.contains(image) {
                frame
                    .clicks
                    .push(Click::landmark(landmark.id.clone(), image));
            }
        }
    }
    (folder, truth, clicked)
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
    assert!(ran.stderr.contains("images/none.png"), "{}", ran.stderr);
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
    write(&document, place.path());
    let ran = touchline(
        place.path(),
        "refine-base doc.json --markings -o refined.json",
    );
    assert_eq!(ran.code, 2, "{}", ran.stderr);
    assert!(
        ran.stderr.contains("painted lines are seen in 0 frames"),
        "{}",
        ran.stderr
    );
    assert!(!place.path().join("refined.json").exists());
}
