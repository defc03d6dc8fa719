//! Changes after which many frames are solved again: in the background, as one step of undo,
//! and without overwriting edits.

use std::ops::ControlFlow;
use std::sync::Mutex;
use touchline_application::app::operation::{Job, Operation};
use touchline_application::app::operations::BulkSolving;
use touchline_application::app::selection::Scope;
use touchline_application::app::{
    Action, App, CameraChoice, Command, EditAction, Effect, Navigation, PointerAction,
};
use touchline_application::jobs::SharedPictures;
use touchline_application::testing::without_counts;
use touchline_calibration::calibrate::{BulkChange, BulkError, BulkSolve};
use touchline_core::camera::{CameraBase, Ptz, PtzCamera};
use touchline_core::geometry::ImagePoint;
use touchline_core::progress::{Progress, Share};
use touchline_core::testing::{SIZE, base_at, ground_landmarks, pixel_box, soccer};
use touchline_documents::document::{
    Camera, Click, Document, FramePtz, FrameStatus, SolutionSource,
};
use touchline_documents::testing::{match_from, new_frame, solved_by};

const FRAMES: usize = 210;
/// A frame that is edited while the others are solved.
const EDITED: usize = 7;

fn base(height_m: f64) -> CameraBase {
    base_at([1.0, -64.0, height_m], SIZE)
}

/// Frames that are clicked, solved and accepted; the last one is a suggestion without clicks.
fn document() -> Document {
    let field = soccer();
    let mut document = match_from(&base(18.0), SIZE);
    for index in 0..FRAMES {
        let ptz = Ptz::from_degrees(20.0 * (index as f64 / 40.0).sin(), -13.0, 2300.0);
        let pointed = PtzCamera::new(base(18.0), ptz);
        let mut frame = new_frame(&format!("{index}.jpg"), SIZE);
        frame.clicks = ground_landmarks(&field, &pointed)
            .filter(|(_, _, image)| SIZE.contains(*image))
            .take(2)
            .map(|(_, landmark, image)| Click::landmark(landmark.id.clone(), image))
            .collect();
        frame.status = FrameStatus::Reference;
        frame.ptz = Some(FramePtz::new(ptz, None));
        frame.solution = solved_by(SolutionSource::Clicks);
        if index + 1 == FRAMES {
            frame.clicks.clear();
            frame.status = FrameStatus::Suggested;
            frame.solution = solved_by(SolutionSource::Forest);
        }
        document.frames.push(frame.into());
    }
    document
}

fn open(document: Document) -> App {
    App::with_document(document)
}

/// The camera with another height.
fn higher(app: &App, height_m: f64) -> Action {
    let mut camera = (*app.open().unwrap().document.cameras[0]).clone();
    camera.set_base(&base(height_m));
    Action::Edit(EditAction::Camera(Box::new(camera)))
}

fn bulk_job(effects: Vec<Effect>) -> Option<Job> {
    effects.into_iter().find_map(|effect| match effect {
        Effect::Start(job) if job.name() == BulkSolving::NAME => Some(job),
        _ => None,
    })
}

/// What the job reports in the end.
fn report_of(job: &Job) -> Action {
    Action::Report(job.run(&SharedPictures::none(), &|_| ()))
}

fn now(app: &App) -> &Document {
    &app.open().unwrap().document
}

fn height_m(document: &Document) -> f64 {
    document.cameras[0].base().unwrap().position_m.z
}

/// The clicks lie where the frame's camera has them.
fn is_solved_for(document: &Document, index: usize, height: f64) -> bool {
    let frame = &document.frames[index];
    let mut alone = document.clone();
    alone.frames = std::iter::once(frame.clone()).collect();
    alone.cameras[0] = {
        let mut camera = (*document.cameras[0]).clone();
        camera.set_base(&base(height));
        camera.into()
    };
    touchline_calibration::calibrate::solve_document(
        &mut alone,
        "/match".as_ref(),
        &Progress::default(),
    )
    .unwrap();
    let [known, wanted] = [frame, &alone.frames[0]].map(|frame| frame.ptz.as_ref().unwrap().ptz());
    (known.tilt - wanted.tilt).abs().degrees() < 1e-6
        && (known.focal_px - wanted.focal_px).abs() < 1e-3
}

#[test]
fn many_frames_are_solved_in_the_background_in_one_step_and_edits_made_meanwhile_survive() {
    let before = document();
    let mut app = open(before.clone());
    let change = higher(&app, 18.5);
    let order = bulk_job(app.update(change)).expect("many frames");
    assert_eq!(*now(&app), before, "nothing has changed yet");
    assert!(app.operations.bulk_solve.is_running() && app.why_not(Command::StopSolving).is_none());

    app.update(Action::Navigate(Navigation::GoTo(EDITED)));
    app.update(Action::Navigate(Navigation::Select(Some(0))));
    app.update(Action::Edit(EditAction::Nudge {
        dx_px: 3.0,
        dy_px: 0.0,
        held: false,
    }));
    let clicks = now(&app).frames[EDITED].clicks.clone();
    assert_ne!(clicks, before.frames[EDITED].clicks);
    let edited = now(&app).clone();

    let effects = app.update(report_of(&order));
    assert!(!app.operations.bulk_solve.is_running());
    let journalled = effects
        .iter()
        .filter(|effect| matches!(effect, Effect::Journal { .. }))
        .count();
    assert_eq!((height_m(now(&app)), journalled), (18.5, 1));
    assert_eq!(
        now(&app).frames[EDITED].clicks,
        clicks,
        "the edit is not overwritten"
    );
    assert!(
        [0, 1, EDITED, 100, FRAMES - 2]
            .into_iter()
            .all(|index| is_solved_for(now(&app), index, 18.5))
    );
    assert_eq!(
        now(&app).frames[FRAMES - 1].status,
        FrameStatus::New,
        "it was proposed for the old base"
    );
    assert!(
        app.session
            .messages
            .notices
            .iter()
            .any(|notice| notice.text.starts_with("1 proposal "))
    );

    app.update(Action::Command(Command::Undo));
    assert_eq!(
        without_counts(now(&app)),
        without_counts(&edited),
        "one step takes all of it back, and nothing else"
    );
    app.update(Action::Command(Command::Redo));
    assert_eq!(height_m(now(&app)), 18.5);
    app.update(Action::Command(Command::Undo));
    app.update(Action::Command(Command::Undo));
    assert_eq!(without_counts(now(&app)), without_counts(&before));
}

#[test]
fn it_can_be_stopped_and_then_nothing_has_changed() {
    let before = document();
    let mut app = open(before.clone());
    let change = higher(&app, 19.0);
    let order = bulk_job(app.update(change)).unwrap();
    let change = higher(&app, 20.0);
    assert!(bulk_job(app.update(change)).is_none(), "one at a time");
    let late = report_of(&order);
    app.update(Action::Command(Command::StopSolving));
    assert!(order.is_cancelled() && !app.operations.bulk_solve.is_running());
    app.update(late);
    assert_eq!(*now(&app), before, "its result is no longer needed");
    assert!(app.open().unwrap().history.next_undo().is_none());
    assert!(app.why_not(Command::StopSolving).is_some());
}

#[test]
fn no_sport_is_said_to_be_chosen_while_another_change_is_computed() {
    let mut app = open(document());
    let change = higher(&app, 19.0);
    assert!(bulk_job(app.update(change)).is_some(), "many frames");
    app.update(Action::Edit(EditAction::ChooseSport("handball".to_owned())));
    assert_eq!(now(&app).field.template, "soccer");
    let notices = &app.session.messages.notices;
    assert!(
        notices
            .iter()
            .any(|notice| notice.text.starts_with("Not while another change"))
            && !notices
                .iter()
                .any(|notice| notice.text.starts_with("Field:")),
        "{notices:?}"
    );
}

#[test]
fn the_work_tells_how_far_it_is_and_ends_when_it_is_stopped() {
    let mut numbers = document();
    numbers.cameras[0].set_base(&base(19.0));
    let work = || BulkSolve {
        document: document(),
        folder: ".".into(),
        change: BulkChange::Numbers(Box::new(numbers.clone())),
    };
    let done = Mutex::new(Vec::new());
    let all = Progress::new(|progress: Share| {
        done.lock().unwrap().push(progress.done);
        ControlFlow::Continue(())
    });
    work().run(&all).unwrap();
    drop(all);
    let mut done = done.into_inner().unwrap();
    done.sort_unstable();
    assert_eq!(done, (1..=FRAMES).collect::<Vec<_>>(), "each frame once");
    let some = Progress::new(|progress: Share| {
        if progress.done > 20 {
            ControlFlow::Break(())
        } else {
            ControlFlow::Continue(())
        }
    });
    assert_eq!(work().run(&some).unwrap_err(), BulkError::Stopped);
}

#[test]
fn a_drag_is_not_cut_in_two() {
    let mut app = open(document());
    let change = higher(&app, 18.5);
    let order = bulk_job(app.update(change)).unwrap();
    app.update(Action::Navigate(Navigation::GoTo(EDITED)));
    let at = app.frame().unwrap().clicks[0].image;
    app.update(Action::Pointer(PointerAction::Press { at, on: Some(0) }));
    app.update(Action::Pointer(PointerAction::Drag(ImagePoint::new(
        at.x + 2.0,
        at.y,
    ))));
    app.update(report_of(&order));
    assert_eq!(
        height_m(now(&app)),
        18.0,
        "it waits for the end of the drag"
    );
    app.update(Action::Pointer(PointerAction::Drag(ImagePoint::new(
        at.x + 5.0,
        at.y,
    ))));
    app.update(Action::Pointer(PointerAction::Release));
    assert_eq!(
        (
            height_m(now(&app)),
            now(&app).frames[EDITED].clicks[0].image.x
        ),
        (18.5, at.x + 5.0)
    );
    app.update(Action::Command(Command::Undo));
    assert_eq!(
        (
            height_m(now(&app)),
            now(&app).frames[EDITED].clicks[0].image.x
        ),
        (18.0, at.x + 5.0)
    );
    app.update(Action::Command(Command::Undo));
    assert_eq!(
        now(&app).frames[EDITED].clicks[0].image,
        at,
        "the drag was one step"
    );
}

#[test]
fn where_the_cameras_have_changed_meanwhile_it_is_worked_out_again() {
    let mut app = open(document());
    let change = higher(&app, 18.5);
    let first = bulk_job(app.update(change)).unwrap();
    app.update(report_of(&first));
    let change = higher(&app, 19.0);
    let second = bulk_job(app.update(change)).unwrap();
    app.update(Action::Command(Command::Undo));
    assert_eq!(height_m(now(&app)), 18.0);
    let again = bulk_job(app.update(report_of(&second)))
        .expect("the camera is not the one it was worked out for");
    assert!(again.id() != second.id() && height_m(now(&app)) == 18.0);
    app.update(report_of(&again));
    assert_eq!(height_m(now(&app)), 19.0);
    assert!(is_solved_for(now(&app), 3, 19.0));
}

#[test]
fn a_frame_that_is_given_away_while_it_is_edited_keeps_its_edit_and_gets_its_camera() {
    let mut document = document();
    let mut second = Camera::new("second".into(), SIZE);
    second.set_base(&base(21.0));
    document.cameras.push(second.into());
    let mut app = open(document);
    app.update(Action::Navigate(Navigation::GoTo(3)));
    let give = Action::Edit(EditAction::AssignToCamera {
        scope: Scope::Onwards,
        camera: CameraChoice::Known("second".into()),
    });
    let order = bulk_job(app.update(give)).expect("many frames");
    app.update(Action::Navigate(Navigation::GoTo(EDITED)));
    app.update(Action::Edit(EditAction::SetComment("rain".to_owned())));
    app.update(report_of(&order));
    let frames = &now(&app).frames;
    assert!((3..FRAMES).all(|index| frames[index].camera.as_str() == "second"));
    assert_eq!(
        (frames[2].camera.as_str(), frames[EDITED].comment.as_deref()),
        ("main", Some("rain"))
    );
    assert!(frames[EDITED].ptz.is_some() && frames[EDITED].ptz != frames[2].ptz);
    app.update(Action::Command(Command::Undo));
    assert!(
        now(&app)
            .frames
            .iter()
            .all(|frame| frame.camera.as_str() == "main")
    );
    assert_eq!(now(&app).frames[EDITED].comment.as_deref(), Some("rain"));
}

#[test]
fn what_cannot_be_done_is_reported_and_changes_nothing() {
    let mut app = open(document());
    let before = now(&app).clone();
    let change = higher(&app, 19.0);
    let order = bulk_job(app.update(change)).unwrap();
    app.update(Action::Report(
        order.panic_report("out of grass".to_owned()),
    ));
    assert_eq!(*now(&app), before);
    assert!(
        app.session
            .messages
            .notices
            .iter()
            .any(|notice| notice.text.contains("out of grass"))
    );
    assert!(!app.operations.bulk_solve.is_running());
}

#[test]
fn undo_in_a_blind_round_takes_back_its_own_click() {
    let mut gold = document();
    gold.frames[EDITED].gold = true;
    let mut app = open(gold);
    let change = higher(&app, 18.5);
    let order = bulk_job(app.update(change)).expect("many frames");
    app.update(Action::Command(Command::ClickAgain));
    let question = app
        .round()
        .and_then(|round| round.target().cloned())
        .expect("a round");
    let at = now(&app).frames[question.frame].clicks[0].image;
    app.update(Action::Pointer(PointerAction::Press { at, on: None }));
    app.update(Action::Pointer(PointerAction::Release));
    let repeats = |app: &App| now(app).frames[EDITED].repeats.len();
    assert_eq!(repeats(&app), 1);
    app.update(report_of(&order));
    assert_eq!(height_m(now(&app)), 18.5, "it became a step meanwhile");
    app.update(Action::Command(Command::Undo));
    assert_eq!(
        (repeats(&app), height_m(now(&app))),
        (0, 18.5),
        "nothing else is taken back"
    );
    let again = app.round().and_then(|round| round.target().cloned());
    assert_eq!(
        again.map(|question| question.landmark),
        Some(question.landmark),
        "the question comes again"
    );
}

#[test]
fn a_mask_that_is_drawn_meanwhile_stays() {
    let mut app = open(document());
    let change = higher(&app, 18.5);
    let order = bulk_job(app.update(change)).expect("many frames");
    let mask = pixel_box(60.0, 40.0, 300.0, 50.0);
    app.update(Action::Edit(EditAction::AddMask {
        of_camera: true,
        mask,
    }));
    let again = bulk_job(app.update(report_of(&order)))
        .expect("the camera changed meanwhile: it is worked out again");
    app.update(report_of(&again));
    assert_eq!(
        (height_m(now(&app)), &now(&app).cameras[0].masks[..]),
        (18.5, &[mask][..])
    );
}
