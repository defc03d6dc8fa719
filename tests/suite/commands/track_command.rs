//! Cameras carried through drawn clips with exact cameras: by `touchline track` and in the
//! application.
#![cfg(feature = "opencv")]

use crate::drawn_clip::{drawn_clip, landmark_errors_px, visible_landmarks};
use crate::headless::Headless;
use crate::program::touchline;
use std::fs;
use std::path::Path;
use touchline::app::{Action, App, Command, EditAction, Navigation, PointerAction};
use touchline::camera::Ptz;
use touchline::document::{
    Camera, Click, Clip, Document, Frame, FramePtz, FrameStatus, SolutionSource, Target,
};
use touchline::field::LandmarkId;
use touchline::geometry::{Angle, ImagePoint, Mat3, Vec2, Vec3};
use touchline_documents::testing::{load, save};

/// How far a frame's overlay is off at the corners of the picture and in its middle, px: the
/// greatest.
fn worst_px(found: &Document, truth: &Document, frame: usize) -> f64 {
    let [one, exact] =
        [found, truth].map(|document| document.ptz_camera(&document.frames[frame]).unwrap());
    let size = truth.frames[frame].image_size;
    let apart = |at: ImagePoint| {
        one.image_from_ray(exact.ray_from_image(at).unwrap())
            .unwrap()
            .distance_px(at)
    };
    size.corners()
        .into_iter()
        .chain([size.centre()])
        .map(apart)
        .fold(0.0, f64::max)
}

#[test]
fn known_frames_are_carried_to_all_others_of_the_clip_past_graphics_that_stand_still() {
    let place = tempfile::tempdir().unwrap();
    let truth = drawn_clip(place.path());
    let folder = place.path().join("match");
    touchline(&folder, "track ask.json -o tracked.json --paint-every 0").done();
    let tracked = load(folder.join("tracked.json"));
    for index in 1..tracked.frames.len() - 1 {
        let (frame, off_px) = (&tracked.frames[index], worst_px(&tracked, &truth, index));
        assert_eq!(frame.status, FrameStatus::Suggested);
        let solution = frame.solution.as_ref().unwrap();
        assert_eq!(solution.source, Some(SolutionSource::Tracking));
        assert!(off_px < 1.5, "frame {index}: {off_px} px");
        assert!(
            solution.confidence.unwrap() > 0.9 && solution.covariance.is_some(),
            "{solution:?}"
        );
    }
    for end in [0, tracked.frames.len() - 1] {
        assert_eq!(
            tracked.frames[end].ptz, truth.frames[end].ptz,
            "what is known stays"
        );
    }
    let again = touchline(&folder, "track ask.json -o again.json --paint-every 0");
    assert_eq!(again.code, 0);
    assert!(
        fs::read(folder.join("again.json")).unwrap()
            == fs::read(folder.join("tracked.json")).unwrap()
    );

    touchline(
        &folder,
        "track ask.json -o smooth.json --smooth --frames 0..12",
    )
    .done();
    let smoothed = load(folder.join("smooth.json"));
    let solution = smoothed.frames[6].solution.as_ref().unwrap();
    assert!(
        solution.extra.contains_key("raw_ptz") && worst_px(&smoothed, &truth, 6) < 2.0,
        "{solution:?}"
    );
    assert!(
        smoothed.frames[13].ptz.is_none(),
        "only the frames asked for"
    );
}

#[test]
fn nothing_is_carried_across_a_cut_or_from_nothing() {
    let place = tempfile::tempdir().unwrap();
    let mut asked = {
        drawn_clip(place.path());
        load(place.path().join("match/ask.json"))
    };
    let folder = place.path().join("match");
    // The clip shows something else from its middle on: a picture of noise.
    let noise = |index: u32| {
        image::RgbImage::from_fn(640, 360, |x, y| {
            let value = (x * 7919 + y * 104_729 + index * 31).wrapping_mul(2_654_435_761) >> 24;
            image::Rgb([value as u8; 3])
        })
    };
    for (at, frame) in asked.frames.iter_mut().enumerate().skip(15) {
        let name = format!("images/noise{at}.png");
        noise(at as u32).save(folder.join(&name)).unwrap();
        let frame: &mut Frame = frame;
        frame.image = Some(name);
        frame.sha256 = None;
        (frame.status, frame.ptz) = (FrameStatus::New, None);
    }
    save(folder.join("cut.json"), &asked);
    let ran = touchline(&folder, "track cut.json -o out.json --paint-every 0");
    assert_eq!(ran.code, 1, "{}", ran.stderr);
    ran.assert_says("noise15.png: not tracked to this frame");
    let out = load(folder.join("out.json"));
    assert!(
        out.frames[14].ptz.is_some() && out.frames.iter().skip(15).all(|frame| frame.ptz.is_none())
    );

    for frame in &mut asked.frames {
        let frame: &mut Frame = frame;
        (frame.status, frame.ptz) = (FrameStatus::New, None);
    }
    save(folder.join("nothing.json"), &asked);
    let ran = touchline(&folder, "track nothing.json -o none.json");
    assert_eq!(ran.code, 1);
    ran.assert_says("none of its 30 frames has a camera to track from");
    let wrong = touchline(&folder, "track ask.json -o never.json --frames 9..3");
    wrong.assert_refused(2);
}

#[test]
fn the_lines_of_a_whole_clip_refine_a_base_of_which_one_frame_is_known() {
    let place = tempfile::tempdir().unwrap();
    let truth = drawn_clip(place.path());
    let folder = place.path().join("match");
    let mut asked = load(folder.join("ask.json"));
    for (at, frame) in asked.frames.iter_mut().enumerate() {
        frame.clip = Some(Clip::Number(1));
        if at > 0 {
            (frame.status, frame.ptz, frame.solution) = (FrameStatus::New, None, None);
        }
    }
    save(folder.join("one.json"), &asked);
    let ran = touchline(&folder, "refine-base one.json --markings -o refined.json").done();
    for line in [
        "only 1 frame known: tracking the clip first",
        "30 of 30 frames pulled onto their painted lines",
    ] {
        assert!(ran.stderr.contains(line), "{line}: {}", ran.stderr);
    }
    let refined = load(folder.join("refined.json"));
    let worst = (0..truth.frames.len())
        .map(|frame| worst_px(&refined, &truth, frame))
        .fold(0.0, f64::max);
    assert!(worst < 3.0, "{worst} px");
}

/// The drawn clip with clicks in its first frame and no more: its camera has no base.
fn with_one_clicked_frame(folder: &Path, truth: &Document) -> Document {
    let mut asked = load(folder.join("ask.json"));
    let camera = asked.cameras[0].id.clone();
    *asked.camera_mut(&camera).unwrap() = Camera::new(camera.clone(), asked.frames[0].image_size);
    for (at, frame) in asked.frames.iter_mut().enumerate() {
        (frame.status, frame.ptz, frame.solution) = (FrameStatus::New, None, None);
        frame.clip = Some(Clip::Number(1));
        if at == 0 {
            // A hand that is up to a pixel off.
            let off = |index: usize| {
                Vec2::new((index * 37 % 5) as f64 - 2.0, (index * 53 % 7) as f64 - 3.0) * 0.3
            };
            let clicked = |(index, (landmark, at)): (usize, (LandmarkId, ImagePoint))| {
                Click::landmark(landmark, at.translate(off(index)))
            };
            frame.clicks = visible_landmarks(truth, 0)
                .into_iter()
                .enumerate()
                .map(clicked)
                .collect();
        }
    }
    assert!(asked.frames[0].clicks.len() >= 4);
    asked
}

/// How far the landmarks that all frames of a clip show are off, px: the greatest.
fn worst_of_all_px(found: &Document, truth: &Document) -> f64 {
    let of_frame = |frame| landmark_errors_px(found, truth, frame).unwrap();
    (0..truth.frames.len())
        .flat_map(of_frame)
        .fold(0.0, f64::max)
}

#[test]
fn one_clicked_frame_and_one_command_give_the_cameras_of_a_clip_that_had_no_base() {
    let place = tempfile::tempdir().unwrap();
    let truth = drawn_clip(place.path());
    let folder = place.path().join("match");
    save(
        folder.join("clicked.json"),
        &with_one_clicked_frame(&folder, &truth),
    );
    let ran = touchline(&folder, "track clicked.json -o plain.json");
    assert_eq!(ran.code, 1, "{}", ran.stderr);
    ran.assert_says("has no base yet");

    let ran = touchline(&folder, "track clicked.json --refine-base -o refined.json").done();
    ran.assert_says("main: the base is refined on");
    let refined = load(folder.join("refined.json"));
    let worst = worst_of_all_px(&refined, &truth);
    assert!(worst < 3.0, "{worst} px");
    let confidence = |frame: &Frame| {
        frame
            .solution
            .as_ref()
            .and_then(|solution| solution.confidence)
    };
    assert!(
        refined
            .frames
            .iter()
            .skip(1)
            .all(|frame| confidence(frame).unwrap() > 0.9)
    );
}

#[test]
fn in_the_application_the_base_is_refined_on_a_shot_that_is_carried_with_it() {
    let place = tempfile::tempdir().unwrap();
    let truth = drawn_clip(place.path());
    let folder = place.path().join("match");
    save(
        folder.join("project.json"),
        &with_one_clicked_frame(&folder, &truth),
    );
    let mut headless = Headless::open(&folder);
    assert!(
        headless.app.why_not(Command::Track).is_some(),
        "there is no base"
    );
    headless.act(Action::Command(Command::RefineBaseOnShot));
    assert!(
        headless.app.why_not(Command::RefineBaseOnShot).is_some(),
        "one at a time"
    );
    headless.act(Action::Command(Command::StopTracking));
    assert!(
        headless.app.why_not(Command::RefineBaseOnShot).is_none(),
        "stopped"
    );

    headless.act(Action::Command(Command::RefineBaseOnShot));
    headless.wait_until("the cameras", |app| tracked_count(app) == 29);
    let worst = worst_of_all_px(&headless.app.open().unwrap().document, &truth);
    assert!(worst < 3.0, "{worst} px");
    let has_base = |app: &App| app.open().unwrap().document.cameras[0].base().is_some();
    headless.act(Action::Command(Command::Undo));
    assert!(!has_base(&headless.app), "the base is one step");
    assert_eq!(
        tracked_count(&headless.app),
        0,
        "what was carried with it goes, too"
    );
}

#[test]
fn a_clip_that_cannot_be_read_is_named_and_the_others_are_carried() {
    let place = tempfile::tempdir().unwrap();
    drawn_clip(place.path());
    let folder = place.path().join("match");
    let mut asked = load(folder.join("ask.json"));
    for (at, frame) in asked.frames.iter_mut().enumerate() {
        let frame: &mut Frame = frame;
        frame.clip = Some(Clip::Number(i64::from(at >= 15)));
    }
    let gone = asked.frames[20].image.clone().unwrap();
    fs::remove_file(folder.join(&gone)).unwrap();
    save(folder.join("two.json"), &asked);
    let ran = touchline(&folder, "track two.json -o out.json --paint-every 0");
    assert_eq!(ran.code, 1, "{}", ran.stderr);
    assert!(
        ran.stderr.contains(gone.rsplit('/').next().unwrap()),
        "{}",
        ran.stderr
    );
    let out = load(folder.join("out.json"));
    let solved =
        |frames: std::ops::Range<usize>| out.frames.iter().skip(frames.start).take(frames.len());
    assert!(
        solved(0..15).all(|frame| frame.ptz.is_some()),
        "the first clip is carried"
    );
    assert!(
        solved(15..29).all(|frame| frame.ptz.is_none()),
        "the second keeps what it had"
    );
}

/// Frames with a tracked camera.
fn tracked_count(app: &App) -> usize {
    let source = |frame: &Frame| frame.solution.as_ref().and_then(|solution| solution.source);
    app.open()
        .unwrap()
        .document
        .frames
        .iter()
        .filter(|frame| source(frame) == Some(SolutionSource::Tracking))
        .count()
}

#[test]
fn in_the_application_the_cameras_are_suggestions_and_it_can_be_stopped() {
    let place = tempfile::tempdir().unwrap();
    let truth = drawn_clip(place.path());
    let folder = place.path().join("match");
    fs::copy(folder.join("ask.json"), folder.join("project.json")).unwrap();
    let mut headless = Headless::open(&folder);
    headless.act(Action::Command(Command::Track));
    assert_eq!(headless.app.under_way()[0].stop, Command::StopTracking);
    assert!(
        headless.app.why_not(Command::Track).is_some(),
        "one at a time"
    );
    headless.act(Action::Command(Command::StopTracking));
    assert!(
        headless.app.why_not(Command::StopTracking).is_some() && tracked_count(&headless.app) == 0
    );

    headless.act(Action::Command(Command::Track));
    headless.wait_until("the cameras", |app| tracked_count(app) == 28);
    let document = (*headless.app.open().unwrap().document).clone();
    for index in 1..29 {
        let off_px = worst_px(&document, &truth, index);
        assert!(off_px < 1.5, "frame {index}: {off_px} px");
    }
    // They stand beside what people did: accepting one is a step of undo, after which it is a
    // suggestion again.
    headless.act(Action::Navigate(Navigation::GoTo(5)));
    headless.wait_for_picture();
    headless.act(Action::Command(Command::AcceptAndStay));
    assert_eq!(headless.app.frame().unwrap().status, FrameStatus::Reference);
    headless.act(Action::Command(Command::Undo));
    assert_eq!(headless.app.frame().unwrap().status, FrameStatus::Suggested);
    assert_eq!(tracked_count(&headless.app), 28);

    // They go as they came.
    headless.act(Action::Command(Command::DiscardTracked));
    assert_eq!(tracked_count(&headless.app), 0);
    assert!(headless.app.why_not(Command::DiscardTracked).is_some());
    let decided = |app: &App| {
        app.open()
            .unwrap()
            .document
            .frames
            .iter()
            .filter(|frame| !frame.is_open())
            .count()
    };
    assert_eq!(decided(&headless.app), 2, "the known frames stay");
}

/// The two landmarks of a frame that are farthest apart.
fn far_apart(truth: &Document, frame: usize) -> [LandmarkId; 2] {
    let shown = visible_landmarks(truth, frame);
    let pairs = shown
        .iter()
        .flat_map(|one| shown.iter().map(move |other| (one, other)));
    let apart = |(one, other): &(&(LandmarkId, ImagePoint), &(LandmarkId, ImagePoint))| {
        one.1.distance_px(other.1)
    };
    let (one, other) = pairs.max_by(|a, b| apart(a).total_cmp(&apart(b))).unwrap();
    [one.0.clone(), other.0.clone()]
}

/// Clicks a landmark of the shown frame where it is.
fn click(headless: &mut Headless, truth: &Document, landmark: &LandmarkId) {
    let shown = visible_landmarks(truth, headless.app.session.frame);
    let (_, at) = shown.iter().find(|(id, _)| id == landmark).unwrap();
    headless.act(Action::Pointer(PointerAction::Press { at: *at, on: None }));
    headless.act(Action::Pointer(PointerAction::Release));
    let click = headless.app.frame().unwrap().clicks.len() - 1;
    headless.act(Action::Edit(EditAction::Name {
        click,
        target: Target::Landmark(landmark.clone()),
    }));
}

#[test]
fn the_other_frames_of_the_shot_follow_a_correction_without_reading_its_pictures_again() {
    let place = tempfile::tempdir().unwrap();
    let truth = drawn_clip(place.path());
    let folder = place.path().join("match");
    // The last frame is known wrongly, and hardly.
    let mut asked = load(folder.join("ask.json"));
    let last: &mut Frame = asked.frames.iter_mut().last().unwrap();
    (last.status, last.ptz, last.solution) = (FrameStatus::New, None, None);
    let first: &mut Frame = &mut asked.frames[0];
    let ptz = first.ptz.as_mut().unwrap();
    *ptz = FramePtz::new(
        Ptz {
            pan: ptz.ptz().pan + Angle::from_degrees(0.4),
            ..ptz.ptz()
        },
        None,
    );
    first.solution.as_mut().unwrap().covariance =
        Some(Mat3::from_diagonal(&Vec3::new(0.25, 0.25, 400.0)));
    save(folder.join("project.json"), &asked);
    let mut headless = Headless::open(&folder);
    headless.act(Action::Command(Command::Track));
    headless.wait_until("the cameras", |app| tracked_count(app) == 29);
    let off_px = |app: &App, frame| worst_px(&app.open().unwrap().document, &truth, frame);
    // Without most of its pictures the shot can only follow by what was seen before. Those that are
    // held to their paint are looked at again where masks were found since.
    for at in (0..28).filter(|at| at % 5 != 0) {
        fs::remove_file(folder.join(format!("images/{:04}.jpg", at + 1))).unwrap();
    }
    headless.act(Action::Navigate(Navigation::GoTo(29)));
    headless.wait_for_picture();
    for landmark in far_apart(&truth, 29) {
        click(&mut headless, &truth, &landmark);
    }
    headless.act(Action::Command(Command::AcceptAndStay));
    let followed = |app: &App| {
        app.session
            .messages
            .notices
            .iter()
            .any(|notice| notice.text.contains("follow this correction"))
    };
    headless.wait_until("the others follow", followed);
    assert_eq!(tracked_count(&headless.app), 28);
    assert!(
        off_px(&headless.app, 20) < 2.0,
        "{}",
        off_px(&headless.app, 20)
    );
}
