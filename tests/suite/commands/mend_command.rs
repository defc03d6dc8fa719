//! Cameras of another program on a drawn clip with exact cameras, mended by `touchline mend`.
#![cfg(feature = "opencv")]

use crate::drawn_clip::{drawn_clip, landmark_errors_px};
use crate::program::touchline;
use std::path::Path;
use touchline::camera::{CameraBase, FocalCurve, Ptz};
use touchline::document::{Camera, CameraId, Document, FramePtz, FrameStatus, SolutionSource};
use touchline::geometry::{Angle, Mat3, Vec3};
use touchline_documents::testing::{load, save, solved_by};

/// The clip with one camera for each frame, as another program gives them: without a lens, each at
/// a place of its own, and `spoil` may spoil those of some frames.
fn foreign_clip(truth: &Document, spoil: impl Fn(usize, &mut CameraBase, &mut Ptz)) -> Document {
    let mut given = truth.clone();
    given.cameras.clear();
    for index in 0..given.frames.len() {
        let exact = truth.ptz_camera(&truth.frames[index]).unwrap();
        let off_m = Vec3::new(0.1, 0.2, -0.1) * ((index % 5) as f64 - 2.0) / 2.0;
        let mut base = CameraBase {
            position_m: exact.base().position_m + off_m,
            distortion: FocalCurve::NONE,
            ..*exact.base()
        };
        let mut ptz = exact.ptz();
        spoil(index, &mut base, &mut ptz);
        let id = CameraId::from(format!("main-{index}").as_str());
        let frame = &mut given.frames[index];
        let mut camera = Camera::new(id.clone(), frame.image_size);
        camera.set_base(&base);
        given.cameras.push(camera.into());
        frame.camera = id;
        frame.clicks.clear();
        frame.ptz = Some(FramePtz::new(ptz, None));
        frame.status = FrameStatus::Suggested;
        frame.solution = solved_by(SolutionSource::Import);
    }
    given
}

/// The greatest distance of a landmark from where it is in the pictures, px at the worst frame.
fn worst_px(folder: &Path, truth: &Document) -> f64 {
    let mended = load(folder.join("mended.json"));
    assert_eq!(mended.cameras.len(), 1, "one camera that stands still");
    let worst = |index: usize| {
        let errors = landmark_errors_px(&mended, truth, index);
        errors.unwrap().into_iter().fold(0.0, f64::max)
    };
    (0..truth.frames.len()).map(worst).fold(0.0, f64::max)
}

#[test]
fn absurd_and_displaced_cameras_come_back_onto_the_lines() {
    let place = tempfile::tempdir().unwrap();
    let truth = drawn_clip(place.path());
    let folder = place.path().join("match");
    // A stretch that is 20 px off, a focal length of three million px, a camera under the ground.
    let given = foreign_clip(&truth, |index, base, ptz| match index {
        6..=9 => ptz.pan = ptz.pan + Angle::from_radians(20.0 / ptz.focal_px),
        13 => ptz.focal_px = 3e6,
        17 => base.position_m.z = -4.0,
        _ => {}
    });
    save(folder.join("given.json"), &given);
    let ran = touchline(&folder, "mend given.json -o mended.json").done();
    let worst = worst_px(&folder, &truth);
    assert!(worst < 2.0, "{worst} px\n{}{}", ran.stderr, ran.stdout);
    let mended = load(folder.join("mended.json"));
    let imported = |index: usize| {
        let solution = mended.frames[index].solution.clone().unwrap();
        solution.imported.unwrap()
    };
    assert!((imported(13).focal_px - 3e6).abs() < 1e-6);
    assert!(imported(13).fault.unwrap().contains("focal length"));
    assert!(imported(17).position_m.z < 0.0 && imported(17).fault.is_some());
    let moved_px = imported(7).moved_px.unwrap();
    assert!((moved_px - 20.0).abs() < 4.0, "{moved_px}");
    ran.assert_prints("of these impossible");
    ran.assert_says("agree on 1 place");
}

#[test]
fn cameras_that_are_all_mirrored_are_named_as_such() {
    let place = tempfile::tempdir().unwrap();
    let truth = drawn_clip(place.path());
    let folder = place.path().join("match");
    let reflection = Vec3::new(-1.0, 1.0, 1.0);
    let reflect = Mat3::from_diagonal(&reflection);
    let given = foreign_clip(&truth, |_, base, ptz| {
        base.position_m.component_mul_assign(&reflection);
        base.base_from_world = reflect * base.base_from_world * reflect;
        ptz.pan = -ptz.pan;
    });
    save(folder.join("given.json"), &given);
    let ran = touchline(&folder, "mend given.json -o mended.json").done();
    ran.assert_says("mirrored left to right");
    let worst = worst_px(&folder, &truth);
    assert!(worst < 2.0, "{worst} px");
}

#[test]
fn what_cannot_be_mended_is_said_in_one_line_and_nothing_is_written() {
    let place = tempfile::tempdir().unwrap();
    let truth = drawn_clip(place.path());
    let folder = place.path().join("match");
    let mut empty = truth.clone();
    for frame in &mut empty.frames {
        frame.clicks.clear();
        frame.ptz = None;
        frame.solution = None;
        frame.status = FrameStatus::New;
    }
    let absurd = foreign_clip(&truth, |_, _, ptz| ptz.focal_px = 3e6);
    let scattered = foreign_clip(&truth, |index, base, _| {
        base.position_m *= 1.0 + 0.5 * index as f64;
    });
    for (given, expected) in [
        (empty, "no frame has a camera to mend"),
        (absurd, "cameras is possible"),
        (scattered, "do not agree on a place"),
    ] {
        save(folder.join("given.json"), &given);
        let ran = touchline(&folder, "mend given.json -o mended.json");
        assert_eq!(ran.code, 2, "{}", ran.stderr);
        ran.assert_says(expected);
        assert_eq!(ran.stderr.trim().lines().count(), 1, "{}", ran.stderr);
        assert!(!folder.join("mended.json").exists());
    }
}

#[test]
fn cameras_without_a_video_are_compared_with_each_other() {
    let place = tempfile::tempdir().unwrap();
    let truth = drawn_clip(place.path());
    let folder = place.path().join("match");
    let given = foreign_clip(&truth, |index, base, ptz| match index {
        7 => ptz.pan = ptz.pan + Angle::from_degrees(9.0),
        13 => ptz.focal_px = 3e6,
        17 => base.position_m.z = -4.0,
        _ => {}
    });
    save(folder.join("given.json"), &given);
    touchline(&folder, "export given.json --format soccernet -o cameras").done();
    let size = truth.frames[0].image_size;
    let order = format!(
        "mend cameras --size {}x{} -o numbers.json",
        size.width, size.height
    );
    let ran = touchline(&folder, &order).done();
    ran.assert_says("nothing was compared with a picture");
    let mended = load(folder.join("numbers.json"));
    assert_eq!(mended.cameras.len(), 1);
    let sources = [7, 13, 17].map(|index| mended.frames[index].solution.clone().unwrap().source);
    assert_eq!(sources, [Some(SolutionSource::Interpolated); 3]);
    for index in 0..truth.frames.len() {
        let [is, was] =
            [&mended, &truth].map(|document| document.ptz_camera(&document.frames[index]));
        let (is, was) = (is.unwrap().ptz(), was.unwrap().ptz());
        let off_deg = (is.pan - was.pan).degrees().abs();
        assert!(off_deg < 0.5, "{index}: {off_deg}");
    }
    // What came stays with each frame, with how far and why it was moved.
    let solution = mended.frames[7].solution.clone().unwrap();
    assert_eq!(solution.warnings[0].code, "mended");
    let moved_px = solution.imported.unwrap().moved_px.unwrap();
    assert!(moved_px > 50.0, "{moved_px}");
    // A camera that stands elsewhere is as it came, and left to a person.
    let apart = foreign_clip(&truth, |index, base, _| {
        if index + 1 == truth.frames.len() {
            base.position_m += Vec3::new(12.0, -9.0, 5.0);
        }
    });
    save(folder.join("apart.json"), &apart);
    touchline(&folder, "export apart.json --format soccernet -o apart").done();
    let order = format!(
        "mend apart --size {}x{} -o two.json",
        size.width, size.height
    );
    let ran = touchline(&folder, &order);
    assert_eq!(ran.code, 1, "{}", ran.stderr);
    ran.assert_says("it is as it came");
    let two = load(folder.join("two.json"));
    let last = two.frames.last().unwrap();
    assert_eq!((two.cameras.len(), last.status), (2, FrameStatus::Draft));
    // A video alone has no cameras.
    let ran = touchline(&folder, "mend cameras --format json -o none.json");
    assert_eq!(ran.code, 2);
    assert!(!folder.join("none.json").exists());
}
