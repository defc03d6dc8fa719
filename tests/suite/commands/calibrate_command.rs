//! `touchline calibrate`: the camera of a drawn match without a click.
#![cfg(feature = "opencv")]

use crate::drawn::draw;
use crate::program::touchline;
use std::collections::BTreeSet;
use std::fs;
use std::path::Path;
use touchline::autocalibrate::{AutocalibrationAnswer, camera_without_clicks};
use touchline::calibrate::record_found;
use touchline::document::{Click, Document, FrameStatus, SolutionSource, document_to_string};
use touchline::field::Landmark;
use touchline::geometry::ImagePoint;
use touchline::markings::project_landmarks;
use touchline::media::FrameReader;
use touchline::progress::Progress;
use touchline::proposals::read_picture;
use touchline_documents::testing::{load, save};

/// How far a frame's overlay is off at the corners of a grid over the ground it shows, px: the
/// greatest.
fn worst_px(found: &Document, truth: &Document, frame: usize) -> f64 {
    let (found_frame, exact) = (&found.frames[frame], &truth.frames[frame]);
    let (found, exact) = (
        found.ptz_camera(found_frame).unwrap(),
        truth.ptz_camera(exact).unwrap(),
    );
    let size = found_frame.image_size;
    let pixels = (0..48).map(|index| {
        let share = |at: u32, of: u32| (f64::from(at) + 0.5) / f64::from(of);
        ImagePoint::new(
            share(index % 8, 8) * f64::from(size.width),
            share(index / 8, 6) * f64::from(size.height),
        )
    });
    let apart = |pixel: ImagePoint| {
        let ground = exact
            .plane_from_image(pixel, 0.0)
            .filter(|at| at.x.abs() < 52.0 && at.y.abs() < 34.0)?;
        Some(
            found
                .image_from_world(ground)
                .map_or(f64::INFINITY, |image| image.distance_px(pixel)),
        )
    };
    pixels.filter_map(apart).fold(0.0, f64::max)
}

/// What the search makes of a new project in which somebody has clicked wrong places all over,
/// written without these clicks.
fn without_a_click(folder: &Path) -> String {
    let bare = load(folder.join("project.json"));
    let mut clicked = bare.clone();
    for (index, frame) in clicked.frames.iter_mut().enumerate() {
        let at = ImagePoint::new(100.0 + 50.0 * index as f64, 300.0);
        frame.clicks = ["centre_mark", "halfway_far", "penalty_mark_left"]
            .map(|landmark| {
                Click::landmark(
                    landmark.into(),
                    at.translate(touchline::geometry::Vec2::new(9.0, 4.0)),
                )
            })
            .to_vec();
    }
    let mut reader = FrameReader::new();
    let mut picture = |index: usize| read_picture(&mut reader, &clicked.frames[index], folder).ok();
    let camera = clicked.cameras[0].id.clone();
    let answer = camera_without_clicks(
        clicked.at(folder),
        &camera,
        40,
        &mut picture,
        &Progress::default(),
    )
    .unwrap();
    let AutocalibrationAnswer::Found(found) = answer else {
        panic!("{answer:?}")
    };
    let mut written = bare;
    record_found(&mut written, &camera, &found);
    document_to_string(&written).unwrap()
}

/// Clicks the two landmarks of the ground that lie farthest apart in the first frame's picture.
fn click_two(project: &Path, truth: &Document) {
    let frame = &truth.frames[0];
    let (camera, field) = (
        truth.ptz_camera(frame).unwrap(),
        truth.field.model(Path::new("")).unwrap(),
    );
    let shown = project_landmarks(&field, &camera, frame.image_size, 0.0);
    let seen: Vec<(&Landmark, ImagePoint)> = shown
        .iter()
        .map(|seen| (&field.landmarks[seen.landmark], seen.image))
        .filter(|(landmark, _)| landmark.nominal_m.z == 0.0)
        .collect();
    let pairs = seen
        .iter()
        .flat_map(|one| seen.iter().map(move |other| [one, other]));
    let apart_m =
        |[one, other]: &[&(&Landmark, ImagePoint); 2]| (one.0.nominal_m - other.0.nominal_m).norm();
    let farthest = pairs.max_by(|a, b| apart_m(a).total_cmp(&apart_m(b)));
    let mut clicked = load(project);
    clicked.frames[0].clicks = farthest
        .unwrap()
        .map(|(landmark, at)| Click::landmark(landmark.id.clone(), *at))
        .to_vec();
    save(project, &clicked);
}

#[test]
fn a_drawn_match_is_calibrated_without_a_click_and_other_sports_are_not_found_in_it() {
    let place = tempfile::tempdir().unwrap();
    draw(
        place.path(),
        "--frames 12 --seed 5 --size 960x540 --preset easy",
    );
    let ran = touchline(
        place.path(),
        "calibrate match/images -o found --panorama map.png",
    )
    .done();
    let (found, truth) = (
        load(place.path().join("found/project.json")),
        load(place.path().join("match/truth.json")),
    );
    let (base, exact) = (
        found.cameras[0].base().unwrap(),
        truth.cameras[0].base().unwrap(),
    );
    let off_m = (base.position_m - exact.position_m).norm();
    assert!(
        off_m < 0.2 && off_m < 4.0 * base.sigma.position_m.norm(),
        "{off_m} m: {}",
        ran.stderr
    );
    for frame in 0..found.frames.len() {
        assert!(found.frames[frame].clicks.is_empty());
        assert_eq!(found.frames[frame].status, FrameStatus::Suggested);
        let source = found.frames[frame]
            .solution
            .as_ref()
            .and_then(|solution| solution.source);
        assert_eq!(source, Some(SolutionSource::Markings));
        let off_px = worst_px(&found, &truth, frame);
        assert!(off_px < 1.5, "frame {frame}: {off_px} px");
    }
    let map = image::open(place.path().join("map.png")).unwrap().to_rgb8();
    let colours: BTreeSet<[u8; 3]> = map.pixels().map(|pixel| pixel.0).collect();
    assert!(
        colours.contains(&[255, 138, 36]) && colours.contains(&[235, 238, 235]),
        "lines and paint: {colours:?}"
    );

    touchline(
        place.path(),
        "new again --frames match/images --field soccer",
    )
    .done();
    let again = without_a_click(&place.path().join("again"));
    let text = fs::read_to_string(place.path().join("found/project.json")).unwrap();
    assert_eq!(
        text, again,
        "the same input gives the same bytes, whatever people clicked"
    );

    for (arguments, named) in [
        ("calibrate found -o twice", "camera main has a base already"),
        (
            "calibrate again -o twice --field soccer",
            "states its field",
        ),
    ] {
        let ran = touchline(place.path(), arguments);
        assert_eq!((ran.code, ran.stderr.trim_end().lines().count()), (2, 1));
        assert!(ran.stderr.contains(named), "{arguments}: {}", ran.stderr);
        assert!(!place.path().join("twice").exists(), "{arguments}");
    }
    click_two(&place.path().join("again/project.json"), &truth);
    touchline(place.path(), "calibrate again -o by_clicks --found-only").done();
    let by_clicks = load(place.path().join("by_clicks/project.json"));
    assert_eq!(by_clicks.frames[0].clicks.len(), 2, "they are kept");
    let at_m = by_clicks.cameras[0].base().unwrap().position_m;
    assert!((at_m - exact.position_m).norm() < 0.2, "{at_m:?}");

    // Four frames that cover the field: each adds to the time.
    fs::create_dir(place.path().join("four")).unwrap();
    for name in ["0001.jpg", "0004.jpg", "0007.jpg", "0010.jpg"] {
        let [from, to] =
            ["match/images", "four"].map(|folder| place.path().join(folder).join(name));
        fs::copy(from, to).unwrap();
    }
    let other = touchline(place.path(), "calibrate four -o other --field tennis");
    assert_eq!(other.code, 1, "{}", other.stderr);
    let refusal = "no picture shows enough of the court's lines; click 4 landmarks";
    assert!(other.stderr.contains(refusal), "{}", other.stderr);
    // Where clicks would help, there is a project to make them in.
    let project = place.path().join("other/project.json");
    assert_eq!(project.exists(), other.stderr.contains("to click in"));
    if project.exists() {
        assert!(load(project).cameras[0].base().is_none());
    }
}

/// A folder with four pictures that match nothing.
pub fn grey_pictures(folder: &Path) {
    fs::create_dir(folder).unwrap();
    for index in 0..4_u8 {
        let picture = image::RgbImage::from_fn(320, 180, |x, y| {
            image::Rgb([(x / 40 * 30) as u8, (y / 30 * 20) as u8, 40 * index])
        });
        picture.save(folder.join(format!("{index}.png"))).unwrap();
    }
}

#[cfg(unix)]
#[test]
fn the_pictures_of_a_document_are_found_from_a_project_behind_a_link() {
    let place = tempfile::tempdir().unwrap();
    grey_pictures(&place.path().join("grey"));
    fs::create_dir_all(place.path().join("far/away")).unwrap();
    std::os::unix::fs::symlink(place.path().join("far/away"), place.path().join("link")).unwrap();
    let made = touchline(place.path(), "new match --frames grey --field soccer");
    assert_eq!(made.code, 0, "{}", made.stderr);
    let ran = touchline(place.path(), "calibrate match -o link/found");
    assert_eq!(ran.code, 1, "{}", ran.stderr);
    ran.assert_says("no two of the 4 frames match each other");
}

#[test]
fn what_cannot_be_calibrated_is_one_line_and_leaves_nothing() {
    let place = tempfile::tempdir().unwrap();
    grey_pictures(&place.path().join("grey"));
    let badminton = concat!(env!("CARGO_MANIFEST_DIR"), "/assets/fields/badminton.json");
    fs::copy(badminton, place.path().join("mine.json")).unwrap();
    fs::create_dir(place.path().join("empty")).unwrap();
    fs::create_dir(place.path().join("empty.png")).unwrap();
    for (arguments, named) in [
        (
            "calibrate grey -o found",
            "no two of the 4 frames match each other",
        ),
        ("calibrate empty -o found", "holds no image"),
        ("calibrate nowhere -o found", "nowhere"),
        (
            "calibrate grey -o found --field cricket",
            "no field template is named",
        ),
        ("calibrate grey -o found --set length_m=3", "length_m"),
        (
            "calibrate grey -o found --field mine.json",
            "no picture shows enough of the court's lines",
        ),
        ("calibrate grey -o found --field other.json", "other.json"),
        (
            "calibrate grey -o found --panorama empty.png",
            "is a folder; give the name of a file",
        ),
        ("calibrate grey -o empty --look-at 2", "--look-at"),
        (
            "calibrate grey -o found --panorama map.jpg",
            "must end with .png",
        ),
    ] {
        let ran = touchline(place.path(), arguments);
        // That there is no answer is no mistake of the user's.
        let is_unanswered = named.contains("match each other") || named.contains("no picture");
        let code = if is_unanswered { 1 } else { 2 };
        assert_eq!(
            (ran.code, ran.stderr.trim_end().lines().count()),
            (code, 1),
            "{arguments}: {}",
            ran.stderr
        );
        assert!(ran.stderr.contains(named), "{arguments}: {}", ran.stderr);
        assert!(!place.path().join("found").exists(), "{arguments}");
    }
}
