use super::super::kept::{MENDED, NO_PLACE};
use super::*;
use touchline_core::camera::{Ptz, Radial};
use touchline_core::geometry::Vec3;
use touchline_core::testing::{SIZE, base_at};
use touchline_documents::document::{Clip, Frame, ImportedCamera, VideoFrame};
use touchline_documents::testing::{soccer_document, solved_by};

const MAIN_M: Vec3 = Vec3::new(1.0, -70.0, 18.0);
const BESIDE_M: Vec3 = Vec3::new(-30.0, -50.0, 10.0);

/// A document of frames with these names, each with a camera of its own, as it is imported.
fn document_of(frames: impl IntoIterator<Item = (String, Vec3, Ptz)>) -> Document {
    let mut document = soccer_document();
    for (index, (name, position_m, ptz)) in frames.into_iter().enumerate() {
        let id = CameraId::from(format!("main-{index}").as_str());
        let mut camera = Camera::new(id.clone(), SIZE);
        camera.set_base(&base_at(position_m, SIZE));
        document.cameras.push(camera.into());
        let mut frame = Frame::from_image(&name, id, SIZE);
        frame.point(ptz, Radial::default());
        frame.status = FrameStatus::Suggested;
        frame.solution = solved_by(SolutionSource::Import);
        document.frames.push(frame.into());
    }
    document
}

fn pan_of(index: usize) -> f64 {
    -6.0 + 0.3 * index as f64
}

/// Frames of a camera that pans by 0.3° a frame, each 2 cm beside the common place.
fn document(frames: usize) -> Document {
    document_of((0..frames).map(|index| {
        let off_m = Vec3::new(0.02 * (index % 3) as f64, 0.0, 0.0);
        let ptz = Ptz::from_degrees(pan_of(index), -12.0, 2400.0);
        (format!("{index:03}.jpg"), MAIN_M + off_m, ptz)
    }))
}

fn mend(document: &mut Document) -> MendedNumbers {
    mend_numbers(document, Path::new("/match")).unwrap()
}

fn pan_deg(document: &Document, index: usize) -> f64 {
    let ptz = document.frames[index].ptz.as_ref().unwrap().ptz();
    ptz.pan.degrees()
}

/// The code and the message of the only warning of a frame.
fn warning(document: &Document, index: usize) -> (String, String) {
    let solution = document.frames[index].solution.as_ref().unwrap();
    assert_eq!(solution.warnings.len(), 1, "{index}: {solution:?}");
    let warning = &solution.warnings[0];
    (warning.code.clone(), warning.message.clone())
}

/// How far the ground is from where the cameras that came have it, px: the worst frame's median.
fn worst_moved_px(before: &Document, after: &Document) -> f64 {
    let moved = |index: usize| {
        let camera = |document: &Document| document.ptz_camera(&document.frames[index]);
        let (came, now) = (camera(before).unwrap(), camera(after).unwrap());
        crate::calibrate::ground_moved_px(&came, &now, SIZE).unwrap()
    };
    (0..before.frames.len()).map(moved).fold(0.0, f64::max)
}

#[test]
fn cameras_out_of_line_are_replaced_by_those_between_their_neighbours() {
    let mut document = document(40);
    document.frames[10].point(Ptz::from_degrees(12.0, -12.0, 2400.0), Radial::default());
    document.frames[20].point(Ptz::from_degrees(0.0, -12.0, 3.0e6), Radial::default());
    let mended = mend(&mut document);
    assert_eq!(
        (mended.came, mended.impossible, mended.out_of_line),
        (40, 1, 1)
    );
    assert_eq!((mended.interpolated, mended.left.len()), (2, 0));
    assert_eq!(document.cameras.len(), 1);
    for index in 0..40 {
        let off_deg = (pan_deg(&document, index) - pan_of(index)).abs();
        assert!(off_deg < 0.1, "{index}: {off_deg}");
        // None is suggested without a σ, and no smaller one than given cameras have.
        let solution = document.frames[index].solution.as_ref().unwrap();
        let sigma_px = solution.worst_corner_sigma_px.unwrap();
        assert!(
            sigma_px > 10.0 && solution.covariance.is_some(),
            "{index}: {sigma_px}"
        );
    }
    let source = |index: usize| document.frames[index].source();
    assert_eq!(source(10), Some(SolutionSource::Interpolated));
    assert_eq!(source(11), Some(SolutionSource::Import));
    // What came is kept, with the reason and the distance; what hardly moved has no warning.
    let solution = |index: usize| document.frames[index].solution.as_ref().unwrap();
    let came = solution(10).imported.as_ref().unwrap();
    assert!((came.heading_deg - 12.0).abs() < 1e-9, "{came:?}");
    let (code, message) = warning(&document, 10);
    assert!(
        code == MENDED && message.contains("out of line"),
        "{message}"
    );
    let far_px = mended.moved_far[0].1;
    assert!(
        message.contains(&format!("{far_px:.0} px from the one")),
        "{message}"
    );
    assert!((600.0..700.0).contains(&far_px), "{far_px}");
    assert!(warning(&document, 20).1.contains("focal length"));
    assert!(solution(11).warnings.is_empty());
    assert!(!mended.has_moved_many());
}

#[test]
fn frames_that_waver_about_one_camera_are_mended_as_if_each_had_its_own() {
    let mut apart = document(40);
    apart.frames[10].point(Ptz::from_degrees(12.0, -12.0, 2400.0), Radial::default());
    // The same cameras as frames of the first one, which keep what they came with.
    let mut together = apart.clone();
    for (index, frame) in apart.frames.iter().enumerate() {
        let came = ImportedCamera::new(&apart.ptz_camera(frame).unwrap(), None, None);
        let frame: &mut Frame = &mut together.frames[index];
        frame.camera = "main-0".into();
        frame.ptz.as_mut().unwrap().imported = came.map(Box::new);
    }
    together.cameras.truncate(1);
    let before = together.clone();
    let [of_apart, of_together] = [&mut apart, &mut together].map(mend);
    assert_eq!(of_together.places[0].members, of_apart.places[0].members);
    assert_eq!(of_together.moved_far.len(), of_apart.moved_far.len());
    assert_eq!((together.cameras.len(), apart.cameras.len()), (1, 1));
    assert!(worst_moved_px(&apart, &together) < 1e-6);
    for (now, came) in together.frames.iter().zip(&before.frames) {
        let came = came.ptz.as_ref().unwrap().imported.as_ref().unwrap();
        assert_eq!(now.ptz.as_ref().unwrap().imported, None);
        let kept = now.solution.as_ref().unwrap().imported.as_ref().unwrap();
        assert_eq!(kept.position_m, came.position_m);
        assert!((kept.heading_deg - came.heading_deg).abs() < 1e-9);
    }
}

#[test]
fn where_many_cameras_moved_far_a_person_looks_at_the_list() {
    let mut document = document(60);
    // Every seventh frame of the clip looks elsewhere.
    for index in (3..60).step_by(7) {
        document.frames[index].point(Ptz::from_degrees(14.0, -9.0, 2400.0), Radial::default());
    }
    let mended = mend(&mut document);
    // All but the last one, which has a neighbour on one side only.
    assert_eq!((mended.out_of_line, mended.interpolated), (8, 8));
    assert_eq!(mended.moved_far.len(), 8);
    assert!(mended.has_moved_many());
}

#[test]
fn long_gaps_stay_and_are_named() {
    let mut document = document(60);
    for index in 20..40 {
        document.frames[index].point(Ptz::from_degrees(0.0, -12.0, 3.0e6), Radial::default());
    }
    let mended = mend(&mut document);
    assert_eq!((mended.impossible, mended.interpolated), (20, 0));
    assert_eq!(mended.left.len(), 20);
    assert_eq!(mended.left[0].id, document.frames[20].id);
    assert!(
        mended.left[0].why.contains("focal length"),
        "{:?}",
        mended.left[0]
    );
    // The camera that came is not lost with its place in the document.
    let frame = &document.frames[20];
    let imported = frame.solution.as_ref().unwrap().imported.as_ref().unwrap();
    assert!(frame.ptz.is_none() && imported.fault.is_some());
    assert!((imported.focal_px - 3.0e6).abs() < 1e-3);
}

#[test]
fn cameras_of_two_places_get_a_camera_each() {
    // 60 frames of one camera, and 40 of another in their midst.
    let is_beside = |index: usize| (40..80).contains(&index);
    let before = document_of((0..100).map(|index| {
        let off_m = Vec3::new(0.1, -0.1, 0.05) * ((index % 5) as f64 - 2.0);
        let place_m = if is_beside(index) { BESIDE_M } else { MAIN_M };
        let ptz = Ptz::from_degrees(0.2 * pan_of(index), -10.0, 2400.0);
        (format!("{index:03}.jpg"), place_m + off_m, ptz)
    }));
    let mut document = before.clone();
    let mended = mend(&mut document);
    let frames = |place: &SharedPlace| place.members.len();
    assert_eq!(
        mended.places.iter().map(frames).collect::<Vec<_>>(),
        [60, 40]
    );
    assert_eq!(document.cameras.len(), 2);
    for index in 0..100 {
        let camera = document.ptz_camera(&document.frames[index]).unwrap();
        let place_m = if is_beside(index) { BESIDE_M } else { MAIN_M };
        let off_m = (camera.base().position_m - place_m).norm();
        assert!(off_m < 0.3, "{index}: {off_m}");
    }
    let moved_px = worst_moved_px(&before, &document);
    assert!(moved_px < 5.0, "{moved_px}");
}

#[test]
fn a_camera_that_fits_no_place_is_left_to_a_person_as_it_came() {
    // A single camera behind the goal among stills, and one that looks the other way round: the
    // mirrored place is that of another camera of the match.
    let mut frames: Vec<(String, Vec3, Ptz)> = (0..8)
        .map(|index| {
            let ptz = Ptz::from_degrees(9.0 * f64::from(index) - 30.0, -9.0, 2400.0);
            (format!("{index}.jpg"), Vec3::new(36.0, -72.0, 14.0), ptz)
        })
        .collect();
    frames[3].1 = Vec3::new(85.0, 1.0, 14.0);
    frames[3].2 = Ptz::from_degrees(-88.0, -9.0, 2400.0);
    frames[5].1 = Vec3::new(-36.0, -72.0, 14.0);
    let before = document_of(frames);
    let mut document = before.clone();
    let mended = mend(&mut document);
    let left: Vec<&FrameId> = mended.left.iter().map(|left| &left.id).collect();
    assert_eq!(left, [&before.frames[3].id, &before.frames[5].id]);
    assert_eq!(
        (mended.mirrored, mended.interpolated, document.cameras.len()),
        (0, 0, 3)
    );
    for index in [3, 5] {
        assert_eq!(document.frames[index].ptz, before.frames[index].ptz);
        assert_eq!(
            document.camera_of(&document.frames[index]),
            before.camera_of(&before.frames[index])
        );
        assert_eq!(document.frames[index].status, FrameStatus::Draft);
        assert_eq!(warning(&document, index).0, NO_PLACE);
    }
}

#[test]
fn frames_that_do_not_follow_each_other_in_time_are_never_neighbours() {
    let swings = |index: usize| if index.is_multiple_of(2) { -20.0 } else { 25.0 };
    let names: [fn(usize) -> String; 4] = [
        // One a second.
        |index| format!("camera_{:06}.jpg", 25 * index),
        // Sampled, and then numbered in ones.
        |index| format!("{:04}.jpg", index + 1),
        // By the alphabet.
        |index| format!("{}.jpg", "goal".repeat(index + 1)),
        // Of several runs.
        |index| format!("{index}/7.jpg"),
    ];
    for name in names {
        let before = document_of((0..24).map(|index| {
            let ptz = Ptz::from_degrees(swings(index), -10.0, 2400.0);
            (name(index), MAIN_M, ptz)
        }));
        let mut document = before.clone();
        let mended = mend(&mut document);
        assert_eq!(
            (mended.interpolated, mended.out_of_line),
            (0, 0),
            "{}",
            name(1)
        );
        let moved_px = worst_moved_px(&before, &document);
        assert!(moved_px < 1e-6, "{}: {moved_px}", name(1));
    }
}

#[test]
fn a_mirrored_camera_joins_the_neighbours_that_it_is_in_line_with() {
    let mut document = document(40);
    let given =
        |document: &Document, index: usize| document.ptz_camera(&document.frames[index]).unwrap();
    for (index, way) in [
        (12, mirror as fn(&PtzCamera) -> PtzCamera),
        (25, PtzCamera::after_half_turn),
    ] {
        let camera = way(&given(&document, index));
        let id = document.frames[index].camera.clone();
        document.camera_mut(&id).unwrap().set_base(camera.base());
        document.frames[index].point(camera.ptz(), Radial::default());
    }
    let mended = mend(&mut document);
    assert_eq!(
        (mended.mirrored, mended.interpolated, mended.left.len()),
        (1, 0, 0)
    );
    for index in [12, 25] {
        let off_deg = (pan_deg(&document, index) - pan_of(index)).abs();
        assert!(off_deg < 0.1, "{index}: {off_deg}");
    }
    assert!(warning(&document, 12).1.contains("mirrored"));
}

#[test]
fn frames_of_other_shots_in_a_gap_stay_as_they_are() {
    let changes: [fn(&mut Frame); 3] = [
        |frame| frame.camera = "main-19".into(),
        |frame| frame.clip = Some(Clip::Number(2)),
        |frame| frame.video = Some(VideoFrame::new("other.mp4", 0, None)),
    ];
    for change in changes {
        let mut document = document(20);
        // The last one is that of another place, where it has a single frame.
        let id = document.frames[19].camera.clone();
        let base = document.camera(&id).and_then(Camera::base).unwrap();
        let beside = CameraBase {
            position_m: BESIDE_M,
            ..base
        };
        document.camera_mut(&id).unwrap().set_base(&beside);
        for index in [10, 11] {
            withdraw(&mut document.frames[index]);
        }
        change(&mut document.frames[11]);
        let before = document.frames[11].clone();
        assert_eq!(mend(&mut document).interpolated, 1);
        assert_eq!(document.frames[11], before);
        assert!((pan_deg(&document, 10) - pan_of(10)).abs() < 0.05);
    }
}

#[test]
fn a_gap_is_as_long_as_it_is_in_the_video() {
    for (times, filled) in [(1, 2), (3, 2), (5, 0)] {
        let mut document = document(30);
        for index in 0..30 {
            let number = times * index as u64;
            document.frames[index].video = Some(VideoFrame::new("match.mp4", number, None));
        }
        for index in [10, 11] {
            withdraw(&mut document.frames[index]);
        }
        let mended = mend(&mut document);
        assert_eq!(mended.interpolated, filled, "{times}");
        if filled > 0 {
            assert!((pan_deg(&document, 10) - pan_of(10)).abs() < 0.05);
        }
    }
}

#[test]
fn a_rejected_camera_is_no_end_of_a_gap() {
    let mut document = document(30);
    for index in [11, 12] {
        withdraw(&mut document.frames[index]);
    }
    document.frames[13].point(Ptz::from_degrees(40.0, -12.0, 2400.0), Radial::default());
    document.frames[13].status = FrameStatus::Rejected;
    assert_eq!(mend(&mut document).interpolated, 2);
    assert!((pan_deg(&document, 11) - pan_of(11)).abs() < 0.05);
}

#[test]
fn nothing_possible_is_an_error_and_changes_nothing() {
    let mut document = document(5);
    for frame in &mut document.frames {
        frame.point(Ptz::from_degrees(0.0, -12.0, 3.0e6), Radial::default());
    }
    let before = document.clone();
    let error = mend_numbers(&mut document, Path::new("/match")).unwrap_err();
    assert!(
        matches!(error, MendError::NonePossible { cameras: 5, .. }),
        "{error}"
    );
    assert_eq!(document, before);
}
