//! Real matches in one document: whose camera took a frame, and where another camera begins.

use crate::parts::{Test, frames_folder, tests};
use std::path::Path;
use touchline::calibrate::{
    BaseProblem, FrameLookup, better_camera, calibrate, camera_change, solve_document,
};
use touchline::document::{CameraId, Document, Fields};
use touchline::progress::Progress;
use touchline::solve::base::BaseOptions;
use touchline_documents::testing::soccer_document;

pub const TESTS: &[Test] = tests![
    [Frames] real_matches_are_told_apart_and_give_no_false_alarm;
    [Frames] the_first_frame_of_another_match_is_where_the_camera_stops_fitting;
];

const SETS: [&str; 3] = ["08fd33", "42ba34", "d82e7a"];

/// A real set with the base that the program finds.
fn real(set: &str) -> Document {
    let path = frames_folder().join(format!("scouting-{set}/clicks.json"));
    let mut document = touchline::store::read(&path).unwrap().1;
    let camera = document.cameras[0].id.clone();
    let problem = BaseProblem::from_document(document.at(Path::new(".")), &camera).unwrap();
    let estimated = problem
        .estimate(&document, &BaseOptions::default(), &Progress::default())
        .unwrap();
    estimated.write_to(&mut document, Path::new(".")).unwrap();
    document
}

/// Three matches in one document, each with its camera and field.
fn three_matches() -> Document {
    let mut all = soccer_document();
    for set in SETS {
        let document = real(set);
        let mut camera = (*document.cameras[0]).clone();
        camera.id = set.into();
        camera.field = Some(document.field.clone());
        all.cameras.push(camera.into());
        for frame in &document.frames {
            let mut frame = (**frame).clone();
            frame.camera = set.into();
            all.frames.push(frame.into());
        }
    }
    solve_document(&mut all, Path::new("."), &Progress::default()).unwrap();
    all
}

fn real_matches_are_told_apart_and_give_no_false_alarm() {
    let document = three_matches();
    let fields = Fields::from_document(document.at(Path::new("."))).unwrap();
    let of_cameras = fields.per_camera(&document);
    for (camera, field) in document.cameras.iter().zip(&of_cameras) {
        let change = camera_change(
            &document,
            &FrameLookup::from_document(&document),
            &camera.id,
            field,
        );
        assert_eq!(change, None, "{}: nobody bumped it", camera.id);
    }
    // The right camera, then each wrong one.
    let (mut alarms, mut tested, mut found, mut given) = (0, 0, 0, 0);
    for index in 0..document.frames.len() {
        for camera in &document.cameras {
            let mut asked = document.clone();
            let right = asked.frames[index].camera.clone();
            asked.frames[index].camera = camera.id.clone();
            let frame = &asked.frames[index];
            let (lookup, field) = (
                FrameLookup::from_document(&asked),
                fields.for_frame(&asked, frame),
            );
            let Ok(solved) = calibrate(&asked, &lookup, frame, field, index) else {
                continue;
            };
            let better =
                better_camera(&asked, frame, &solved, &of_cameras).map(|better| better.camera);
            if camera.id == right {
                tested += 1;
                alarms += usize::from(better.is_some());
            } else if solved.redundancy >= 5 {
                given += 1;
                found += usize::from(better == Some(right));
            }
        }
    }
    println!(
        "frames told to be another camera's: {alarms} of {tested}; wrongly given found: {found} of {given}"
    );
    assert!(
        10 * tested >= 9 * document.frames.len(),
        "only {tested} frames were asked"
    );
    assert!(
        given > tested,
        "only {given} frames were given to a wrong camera"
    );
    assert!(alarms <= tested / 100, "{alarms} of {tested}");
    assert!(10 * found >= 8 * given, "{found} of {given}");
}

fn the_first_frame_of_another_match_is_where_the_camera_stops_fitting() {
    let mut document = three_matches();
    let first: CameraId = SETS[0].into();
    let (here, there) = (document.cameras[0].clone(), document.cameras[2].id.clone());
    document
        .frames
        .retain(|frame| frame.camera == here.id || frame.camera == there);
    let begins = document
        .frames
        .iter()
        .position(|frame| frame.camera == there)
        .unwrap();
    document.cameras = vec![here];
    for frame in &mut document.frames {
        frame.camera = first.clone();
    }
    solve_document(&mut document, Path::new("."), &Progress::default()).unwrap();
    let fields = Fields::from_document(document.at(Path::new("."))).unwrap();
    let change = camera_change(
        &document,
        &FrameLookup::from_document(&document),
        &first,
        &fields.per_camera(&document)[0],
    )
    .unwrap();
    println!("{} ({begins})", change.describe(&document));
    assert!(
        change.frame.abs_diff(begins) <= 2,
        "{} for {begins}",
        change.frame
    );
}
