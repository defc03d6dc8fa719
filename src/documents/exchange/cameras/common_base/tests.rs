use super::*;
use crate::document::{Document, FieldSpec, document_from_bytes, document_to_string};
use crate::exchange::cameras::frame_camera::FrameProjection;
use crate::exchange::cameras::into_document::document_of;
use crate::exchange::cameras::one_place::put_on_one_place;
use crate::exchange::tests::{export_as, text_of};
use crate::exchange::{Format, ImportOptions, import};
use nalgebra::Rotation3;
use std::f64::consts::TAU;
use touchline_core::testing::{SIZE, TestBase, base_at};

const MAIN_M: [f64; 3] = [2.0, -60.0, 18.0];

/// The view of one frame of a camera that pans to and fro: at an offset, m, and rolled, degrees.
fn view(name: &str, number: usize, offset_m: Vec3, roll_deg: f64) -> View {
    let base = base_at(Vec3::from(MAIN_M) + offset_m, SIZE);
    let phase = number as f64 * 0.02;
    let camera = base.aim(
        25.0 * phase.sin(),
        -11.0 + phase.cos(),
        2600.0 + 400.0 * phase.sin(),
    );
    let mut pinhole = Pinhole::from_ptz_camera(&camera);
    let roll = Rotation3::from_axis_angle(&Vec3::z_axis(), roll_deg.to_radians());
    pinhole.cam_from_world = roll.matrix() * pinhole.cam_from_world;
    let read = FrameCamera {
        image: Some(name.to_owned()),
        ..FrameCamera::new(name, Some(SIZE), FrameProjection::Camera(pinhole))
    };
    (read, SIZE, pinhole)
}

/// Noise of up to `size` along each axis, the same for each number: multiples of three irrational
/// numbers fill the unit interval evenly and without order.
fn noise(number: usize, size: f64) -> Vec3 {
    let steps = Vec3::new(3.0_f64.sqrt(), 7.0_f64.sqrt(), 19.0_f64.sqrt());
    (steps * (number + 1) as f64).map(|value| size * (2.0 * value.fract() - 1.0))
}

/// Noise as `noise`, but each number knows nothing of the one before.
fn white_noise(number: usize, size: f64) -> Vec3 {
    let seeds = Vec3::new(12.9898, 78.233, 37.719) * (number + 1) as f64;
    seeds.map(|seed| {
        let value = (43_758.545_3 * seed.sin()).rem_euclid(1.0);
        size * (2.0 * value - 1.0)
    })
}

/// A video whose places waver by up to `place_m` along each axis, and that rolls by up to
/// `roll_deg`.
fn video(frames: usize, place_m: f64, roll_deg: f64) -> Vec<View> {
    let one = |number: usize| {
        let (offset_m, roll_deg) = (noise(number, place_m), noise(3 * number, roll_deg).x);
        view(&format!("{number:05}.jpg"), number, offset_m, roll_deg)
    };
    (0..frames).map(one).collect()
}

/// The document that an import makes of views, and what it says.
fn imported(views: &[View]) -> (Document, Vec<String>) {
    let mut views = views.to_vec();
    let exact = Exactness::default();
    let notes = find_common_bases(&mut views, exact);
    put_on_one_place(&mut views);
    (document_of(FieldSpec::new("soccer"), &views, exact), notes)
}

/// How far any frame of a document shows the ground from where its view does, px.
fn farthest_px(document: &Document, views: &[View]) -> f64 {
    assert_eq!(document.frames.len(), views.len());
    let frames = document.frames.iter().zip(views);
    let off_px = frames.map(|(frame, (_, size, view))| {
        let (made, given) = (
            document.ptz_camera(frame).unwrap(),
            view.ptz_camera().unwrap(),
        );
        let pixels = size.cell_centres(3, 3);
        let seen = pixels.filter_map(|pixel| Some((given.plane_from_image(pixel, 0.0)?, pixel)));
        seen.map(|(ground, pixel)| made.image_from_world(ground).unwrap().distance_px(pixel))
            .fold(0.0, f64::max)
    });
    off_px.fold(0.0, f64::max)
}

#[test]
fn twenty_thousand_frames_that_waver_are_one_camera_and_keep_what_came() {
    let views = video(20_000, 0.1, 0.0);
    let (document, notes) = imported(&views);
    assert_eq!(document.cameras.len(), 1);
    assert_eq!(notes.len(), 1, "{notes:?}");
    let base = document.cameras[0].base().unwrap();
    assert!((base.position_m - Vec3::from(MAIN_M)).amax() < 0.01);
    // The cameras all have the same error, perhaps; the base does not claim to be exact.
    assert!(base.sigma.position_m.min() >= 0.05);
    let off_px = farthest_px(&document, &views);
    assert!(off_px < 1e-9, "{off_px} px");
    // The same after it was saved and loaded.
    let text = document_to_string(&document).unwrap();
    let again = document_from_bytes(text.as_bytes()).unwrap();
    assert_eq!(farthest_px(&again, &views), off_px);
    // On the base the ground stays nearly in place.
    let camera = &document.cameras[0];
    for (frame, (_, _, view)) in document.frames.iter().zip(&views).step_by(50) {
        let on_base = camera.ptz_camera_on_base(frame).unwrap();
        let middle = view
            .ptz_camera()
            .unwrap()
            .plane_from_image(SIZE.centre(), 0.0);
        let shown = on_base.image_from_world(middle.unwrap()).unwrap();
        assert!(shown.distance_px(SIZE.centre()) < 0.5, "{shown:?}");
    }
}

#[test]
fn a_roll_that_wavers_is_kept_in_one_camera() {
    for (place_m, roll_deg) in [(0.0, 0.003), (0.0, 0.05), (0.3, 0.5), (2e-3, 0.01)] {
        let views = video(400, place_m, roll_deg);
        let (document, notes) = imported(&views);
        assert_eq!(document.cameras.len(), 1, "±{place_m} m, ±{roll_deg}°");
        assert!(notes[0].contains("waver about one place"), "{notes:?}");
        let off_px = farthest_px(&document, &views);
        assert!(off_px < 1e-9, "{off_px} px");
        // Sensors that waver by less than anybody measures state an exact place.
        let sigma = document.cameras[0].base().unwrap().sigma;
        assert_eq!(sigma.position_m == Vec3::zeros(), place_m < 5e-3);
    }
}

#[test]
fn a_lens_of_each_frame_is_kept_beside_its_place() {
    let mut views = video(60, 0.1, 0.02);
    for (number, (_, _, view)) in views.iter_mut().enumerate() {
        view.lens.k1 = 0.01 + 1e-3 * (number as f64).sin();
        view.principal_point.x += 0.1 * number as f64;
    }
    let (document, _) = imported(&views);
    assert_eq!(document.cameras.len(), 1);
    let off_px = farthest_px(&document, &views);
    assert!(off_px < 1e-9, "{off_px} px");
}

#[test]
fn two_places_with_a_gap_and_two_names_are_two_cameras() {
    // One video that cuts to and fro between two places.
    let cut = |number: usize| (number / 40) % 2 == 1;
    let one = |number: usize| {
        let place_m = Vec3::new(if cut(number) { 1.2 } else { 0.0 }, 0.0, 0.0);
        let offset_m = place_m + noise(number, 0.1);
        view(&format!("{number:04}.jpg"), number, offset_m, 0.0)
    };
    let views: Vec<View> = (0..400).map(one).collect();
    let (document, _) = imported(&views);
    assert_eq!(document.cameras.len(), 2);
    let other = &document.frames[40].camera;
    for (number, frame) in document.frames.iter().enumerate() {
        assert_eq!(frame.camera == *other, cut(number), "{number}");
    }
    assert!(farthest_px(&document, &views) < 1e-9);

    // Two videos from places 30 cm apart.
    let mut views = Vec::new();
    for (name, side_m) in [("a", 0.0), ("b", 0.3)] {
        for number in 0..50 {
            let offset_m = Vec3::new(side_m, 0.0, 0.0) + noise(number, 0.1);
            views.push(view(&format!("{name}{number}.jpg"), number, offset_m, 0.0));
        }
    }
    let (document, notes) = imported(&views);
    assert_eq!((document.cameras.len(), notes.len()), (2, 2));
    // Also where the camera's name alone tells them apart.
    for (at, (frame, _, _)) in views.iter_mut().enumerate() {
        frame.camera = Some(["left", "right"][at / 50].to_owned());
        frame.image = None;
        frame.frame_index = Some(at as u64 % 50);
    }
    let (document, _) = imported(&views);
    let names: Vec<&str> = document
        .cameras
        .iter()
        .map(|camera| camera.id.as_str())
        .collect();
    assert_eq!(names, ["left", "right"]);
}

#[test]
fn a_camera_that_moves_is_said_and_has_no_base() {
    type Way = fn(f64) -> Vec3;
    let drone: Way = |at| Vec3::new(12.0 * at, 3.0 * at, 5.0 * at);
    let circling: Way = |at| 8.0 * Vec3::new((TAU * at).cos(), (TAU * at).sin(), 0.0);
    for (way, said) in [(drone, "drift by 1"), (circling, "are spread by ±")] {
        let one = |number: usize| {
            let offset_m = way(number as f64 / 300.0) + noise(number, 0.02);
            view(&format!("{number:04}.jpg"), number, offset_m, 0.0)
        };
        let views: Vec<View> = (0..300).map(one).collect();
        let (document, notes) = imported(&views);
        assert!(document.cameras.len() > 290);
        let is_said = notes.len() == 1 && notes[0].contains(said) && notes[0].contains("moves");
        assert!(is_said, "{notes:?}");
    }
}

#[test]
fn frames_that_err_each_by_itself_do_not_move() {
    // Along the axis of the view, where distance and focal length are traded, by far the most.
    let one = |number: usize, size_m: f64| {
        let offset_m = Vec3::new(0.2, 1.0, 0.3).component_mul(&white_noise(number, size_m));
        view(&format!("{number:04}.jpg"), number, offset_m, 0.0)
    };
    for (frames, size_m) in [(400, 12.0), (12, 4.0), (30, 6.0)] {
        let views: Vec<View> = (0..frames).map(|number| one(number, size_m)).collect();
        let (document, notes) = imported(&views);
        assert_eq!(
            document.cameras.len(),
            1,
            "{frames} of ±{size_m} m: {notes:?}"
        );
        assert!(farthest_px(&document, &views) < 1e-9);
    }
    // The same spread in a slow walk is a camera that moves.
    let walk = |number: usize| {
        let offset_m = Vec3::new(0.0, 9.0 * (number as f64 / 60.0).sin(), 0.0);
        view(
            &format!("{number:04}.jpg"),
            number,
            offset_m + white_noise(number, 0.1),
            0.0,
        )
    };
    let (document, notes) = imported(&(0..400).map(walk).collect::<Vec<_>>());
    assert!(document.cameras.len() > 1, "{notes:?}");
    assert!(notes[0].contains("a camera that moves"), "{notes:?}");
}

#[test]
fn outliers_stand_where_they_say() {
    let mut views = video(200, 0.2, 0.1);
    for index in [20, 77] {
        let far = views[index].2.position_m + Vec3::new(0.0, -14.0, index as f64);
        views[index].2.position_m = far;
    }
    let (document, _) = imported(&views);
    assert_eq!(document.cameras.len(), 3);
    assert!(farthest_px(&document, &views) < 1e-9);
}

#[test]
fn stills_of_a_stadium_and_exact_cameras_stay_as_they_are() {
    // Stills are numbered as the frames of a video are, but look anywhere.
    let one = |number: usize| {
        let offset_m = noise(number, 0.3);
        let looks = 37 * number;
        view(&format!("{number:03}.jpg"), looks, offset_m, 0.0)
    };
    let stills: Vec<View> = (0..60).map(one).collect();
    let exact = video(60, 0.0, 0.0);
    let unnumbered: Vec<View> = video(26, 0.1, 0.0)
        .into_iter()
        .zip('a'..='z')
        .map(|((frame, size, pinhole), letter)| {
            let image = Some(format!("{letter}.jpg"));
            (FrameCamera { image, ..frame }, size, pinhole)
        })
        .collect();
    for views in [stills, exact, unnumbered] {
        let mut found = views.clone();
        assert!(find_common_bases(&mut found, Exactness::default()).is_empty());
        assert_eq!(found, views);
    }
}

#[test]
fn a_few_frames_of_such_a_video_are_exported_as_exactly() {
    let views = video(40, 0.0, 0.01);
    let (mut document, _) = imported(&views);
    document
        .frames
        .retain(|frame| frame.image.as_deref() < Some("00003.jpg"));
    for format in [Format::Csv, Format::SoccerNet, Format::OpenTrackIo] {
        assert!(export_as(&document, format).worst_px < 1e-6, "{format}");
    }
}

#[test]
fn every_table_of_cameras_has_what_came_and_gives_it_back() {
    let views = video(40, 0.1, 0.05);
    let (document, _) = imported(&views);
    let folder = tempfile::tempdir().unwrap();
    for format in [
        Format::Csv,
        Format::OpenCv,
        Format::Colmap,
        Format::BroadTrack,
    ] {
        let exported = export_as(&document, format);
        let path = folder.path().join(format.name());
        exported.write(&path, false).unwrap();
        let options = ImportOptions {
            size: Some(SIZE),
            ..ImportOptions::default()
        };
        let document = import(&path, format, &options).unwrap().document;
        assert_eq!(document.cameras.len(), 1, "{format}");
        let off_px = farthest_px(&document, &views);
        assert!(off_px < 1e-6, "{format}: {off_px} px");
    }
    let table = text_of(&export_as(&document, Format::Csv).files, "cameras.csv");
    let at = views[7].2.position_m;
    assert!(table.contains(&format!("{},{},{}", at.x, at.y, at.z)));
}
