//! Painted lines from outside: drawn pictures with exact cameras.

use crate::drawn::draw;
use crate::program::touchline;
use std::fs;
use touchline::camera::{CameraBase, Ptz, PtzCamera, Radial};
use touchline::document::{FramePtz, FrameStatus, ImportedCamera, SolutionSource};
use touchline::field::FieldModel;
use touchline::geometry::{Angle, ImagePoint, ImageSize};
use touchline_core::testing::TestBase;
use touchline_documents::testing::{load, save};

/// How far apart the overlays of two cameras are on the playing area, px: the median over the
/// picture.
fn apart_px(field: &FieldModel, one: &PtzCamera, other: &PtzCamera, size: ImageSize) -> f64 {
    let at = |index: u32, extent: u32| (f64::from(index % 8) + 0.5) / 8.0 * f64::from(extent);
    let mut distances: Vec<f64> = (0..64)
        .map(|index| ImagePoint::new(at(index, size.width), at(index / 8, size.height)))
        .filter_map(|pixel| {
            let ground = one.plane_from_image(pixel, 0.0)?;
            let on_field =
                ground.x.abs() <= field.length_m / 2.0 && ground.y.abs() <= field.width_m / 2.0;
            on_field.then(|| {
                other
                    .image_from_world(ground)
                    .map_or(f64::INFINITY, |image| image.distance_px(pixel))
            })
        })
        .collect();
    distances.sort_by(f64::total_cmp);
    distances[distances.len() / 2]
}

fn turn_view(camera: &PtzCamera, pan_px: f64, tilt_px: f64, zoom: f64) -> PtzCamera {
    let ptz = camera.ptz();
    let angle = |px: f64| Angle::from_radians(px / ptz.focal_px);
    let turned = Ptz {
        pan: ptz.pan + angle(pan_px),
        tilt: ptz.tilt + angle(tilt_px),
        focal_px: ptz.focal_px * zoom,
    };
    PtzCamera::new(*camera.base(), turned)
}

#[test]
fn a_drawn_match_is_snapped_back_by_the_command() {
    let place = tempfile::tempdir().unwrap();
    draw(
        place.path(),
        "--frames 4 --seed 11 --size 1280x720 --preset easy",
    );
    let folder = place.path().join("match");
    let truth = load(folder.join("truth.json"));
    let mut off = truth.clone();
    for frame in &mut off.frames {
        frame.clicks.clear();
        let camera = truth.ptz_camera(frame).unwrap();
        let ptz = turn_view(&camera, 12.0, -8.0, 1.005).ptz();
        frame.ptz = Some(FramePtz::new(ptz, None));
    }
    // One frame came from beside the base of its camera.
    let came = off.ptz_camera(&off.frames[1]).unwrap();
    let mut beside_m = came.base().position_m;
    beside_m.x += 0.15;
    let beside = CameraBase {
        position_m: beside_m,
        ..*came.base()
    };
    let came = ImportedCamera::new(&PtzCamera::new(beside, came.ptz()), None, None);
    off.frames[1].ptz.as_mut().unwrap().imported = came.clone().map(Box::new);
    assert_eq!(
        off.ptz_camera(&off.frames[1]).unwrap().base().position_m,
        beside_m
    );
    // One frame has no camera and stays as it is.
    off.frames[3].ptz = None;
    off.frames[3].solution = None;
    save(folder.join("off.json"), &off);
    let ran = touchline(&folder, "snap off.json -o snapped.json").done();
    let snapped = load(folder.join("snapped.json"));
    let field = truth.field.model(&folder).unwrap();
    for (was, is) in truth.frames.iter().zip(&snapped.frames).take(3) {
        let apart = apart_px(
            &field,
            &truth.ptz_camera(was).unwrap(),
            &snapped.ptz_camera(is).unwrap(),
            was.image_size,
        );
        let solution = is.solution.as_ref().unwrap();
        assert!(apart < 0.5, "{}: {apart} px, {solution:?}", was.name());
        assert_eq!(solution.source, Some(SolutionSource::Markings));
        assert!(
            solution.samples.is_some_and(|samples| samples > 40) && solution.covariance.is_some()
        );
        // It stands on the base of its camera, and says where it stood.
        assert_eq!(is.ptz.as_ref().unwrap().imported, None);
        let came = came.clone().filter(|_| was.id == truth.frames[1].id);
        assert_eq!(solution.imported, came);
        assert!(
            solution
                .line_check
                .as_ref()
                .is_some_and(|check| check.score > 0.9),
            "{solution:?}"
        );
        assert_eq!(is.status, was.status);
    }
    assert!(snapped.frames[3].ptz.is_none() && snapped.frames[3].solution.is_none());
    assert!(
        ran.stderr
            .contains("3 frames snapped, 0 not, 1 left unchanged (without a camera"),
        "{}",
        ran.stderr
    );
    assert_eq!(
        touchline(&folder, "snap off.json -o snapped.json").code,
        2,
        "it exists"
    );
    let again = touchline(&folder, "snap off.json -o again.json");
    assert_eq!(again.code, 0);
    assert!(
        fs::read(folder.join("again.json")).unwrap()
            == fs::read(folder.join("snapped.json")).unwrap()
    );
}

#[test]
fn the_lens_of_each_frame_is_found_on_request_unless_the_camera_has_one() {
    let place = tempfile::tempdir().unwrap();
    draw(
        place.path(),
        "--frames 2 --seed 11 --size 1280x720 --preset easy",
    );
    let folder = place.path().join("match");
    let truth = load(folder.join("truth.json"));
    let mut bare = truth.clone();
    for frame in &mut bare.frames {
        frame.clicks.clear();
        let off = Radial::k1(truth.ptz_camera(frame).unwrap().lens().k1 - 0.05);
        frame.ptz = Some(FramePtz::new(
            truth.ptz_camera(frame).unwrap().ptz(),
            Some(off),
        ));
    }
    save(folder.join("bare.json"), &bare);
    touchline(&folder, "snap bare.json --k1 -o bent.json").done();
    let bent = load(folder.join("bent.json"));
    for (was, is) in truth.frames.iter().zip(&bent.frames) {
        let right = truth.ptz_camera(was).unwrap();
        let k1 = is.ptz.as_ref().unwrap().k1.unwrap();
        assert!(
            (k1 - right.lens().k1).abs() < 0.015,
            "{}: {k1}, {:?}",
            was.name(),
            right.lens()
        );
        assert_eq!(
            bent.ptz_camera(is).unwrap().lens().k1,
            k1,
            "it is drawn with it"
        );
    }
    let mut with_lens = truth.clone();
    let base = truth.cameras[0].base().unwrap();
    with_lens.cameras[0].set_base(&base.bent(0.01));
    save(folder.join("with_lens.json"), &with_lens);
    let ran = touchline(&folder, "snap with_lens.json --k1 -o refused.json");
    assert_eq!(ran.code, 1, "{}", ran.stderr);
    ran.assert_says("its camera has lens distortion, which all its frames share");
}

#[test]
fn a_camera_far_off_is_refused_by_name_and_keeps_its_numbers() {
    let place = tempfile::tempdir().unwrap();
    draw(
        place.path(),
        "--frames 1 --seed 11 --size 1280x720 --preset easy",
    );
    let folder = place.path().join("match");
    let mut off = load(folder.join("truth.json"));
    let camera = off.ptz_camera(&off.frames[0]).unwrap();
    let before = FramePtz::new(turn_view(&camera, 400.0, 150.0, 1.2).ptz(), None);
    off.frames[0].ptz = Some(before.clone());
    off.frames[0].clicks.clear();
    save(folder.join("off.json"), &off);
    let ran = touchline(&folder, "snap off.json -o snapped.json");
    assert_eq!(ran.code, 1, "{}", ran.stderr);
    let frame = &load(folder.join("snapped.json")).frames[0];
    assert_eq!(frame.ptz, Some(before));
    let warnings = &frame.solution.as_ref().unwrap().warnings;
    assert!(
        warnings.iter().any(|warning| warning.code == "not_snapped"),
        "{warnings:?}"
    );
}

#[test]
fn frames_without_a_camera_are_found_from_nothing_on_request() {
    let place = tempfile::tempdir().unwrap();
    draw(
        place.path(),
        "--frames 1 --seed 11 --size 960x540 --preset easy",
    );
    let folder = place.path().join("match");
    let truth = load(folder.join("truth.json"));
    let mut bare = truth.clone();
    for frame in &mut bare.frames {
        frame.clicks.clear();
        frame.ptz = None;
        frame.solution = None;
        frame.status = FrameStatus::New;
    }
    save(folder.join("bare.json"), &bare);
    let ran = touchline(&folder, "snap bare.json --from-nothing -o found.json");
    let found = load(folder.join("found.json"));
    let field = truth.field.model(&folder).unwrap();
    let mut solved = 0;
    for (was, is) in truth.frames.iter().zip(&found.frames) {
        let Some(camera) = found.ptz_camera(is) else {
            let warnings = &is.solution.as_ref().unwrap().warnings;
            assert!(
                warnings
                    .iter()
                    .any(|warning| warning.code == "not_found_by_paint"),
                "{warnings:?}"
            );
            assert_eq!(is.status, FrameStatus::New);
            continue;
        };
        solved += 1;
        let apart = apart_px(
            &field,
            &truth.ptz_camera(was).unwrap(),
            &camera,
            was.image_size,
        );
        let solution = is.solution.as_ref().unwrap();
        assert!(apart < 1.0, "{}: {apart} px, {solution:?}", was.name());
        assert_eq!(
            (is.status, solution.source),
            (FrameStatus::Suggested, Some(SolutionSource::Markings))
        );
        assert!(
            solution
                .confidence
                .is_some_and(|confidence| confidence > 0.9)
        );
    }
    assert!(solved > 0, "{}", ran.stderr);
    assert_eq!(
        ran.code,
        i32::from(solved < truth.frames.len()),
        "{}",
        ran.stderr
    );
    ran.assert_says(&format!("{solved} found from nothing"));
}
