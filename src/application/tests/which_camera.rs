//! Which camera took a frame: one that stops fitting, another that fits better, frames given away.

use rand::RngExt;
use rand_pcg::Pcg64Mcg;
use std::path::Path;
use touchline_application::app::operation::{Job, Operation};
use touchline_application::app::operations::{BaseEstimate, CameraWatch};
use touchline_application::app::selection::{Scope, Selecting};
use touchline_application::app::{
    Action, App, CameraChoice, Command, DiskReport, EditAction, Effect, Navigation, Opened,
    Settings,
};
use touchline_application::jobs::SharedPictures;
use touchline_application::testing::without_counts;
use touchline_calibration::calibrate::{
    AssignError, BaseProblem, BulkChange, BulkSolve, FrameLookup, add_camera_like,
    assign_to_camera, camera_change, check_cameras, solve_document,
};
use touchline_core::camera::{BaseAngles, CameraBase, Ptz, PtzCamera};
use touchline_core::field::builtin;
use touchline_core::geometry::{Angle, ImageSize, Vec2, Vec3};
use touchline_core::progress::Progress;
use touchline_core::solve::base::BaseOptions;
use touchline_core::solve::{Verdict, WarningCode};
use touchline_core::testing::seeded::{self, normal};
use touchline_core::testing::{SIZE, base_at, ground_landmarks, soccer, turned_base};
use touchline_documents::document::{Camera, Click, Document, FieldSpec, Fields, FrameStatus};
use touchline_documents::testing::{match_from, new_frame};

fn base() -> CameraBase {
    turned_base([2.0, -66.0, 19.0], [0.0, -0.4, 0.2], SIZE)
}

/// The base after a person walked into the tripod.
fn bumped_base() -> CameraBase {
    let angles = BaseAngles {
        roll: Angle::from_degrees(1.2),
        ..base().angles()
    };
    let moved = base().position_m + Vec3::new(0.5, 0.3, -0.3);
    CameraBase::new(moved, angles.base_from_world(), SIZE.centre())
}

/// A camera that stands elsewhere.
fn elsewhere() -> CameraBase {
    base_at([14.0, -72.0, 26.0], SIZE)
}

/// Frames of a camera that is bumped after the first `before` of them.
pub fn document(frames: usize, before: usize, noise_px: f64, rng: &mut Pcg64Mcg) -> Document {
    document_of(frames, before, &bumped_base(), noise_px, rng)
}

/// Frames that pan to and fro with 4 to 8 clicks each of 1-σ `noise_px`, the first `before` of them
/// with [`base`], the others with another one. The camera's base is the first.
fn document_of(
    frames: usize,
    before: usize,
    other: &CameraBase,
    noise_px: f64,
    rng: &mut Pcg64Mcg,
) -> Document {
    let field = soccer();
    let mut document = match_from(&base(), SIZE);
    while document.frames.len() < frames {
        let index = document.frames.len();
        let truth = if index < before { base() } else { *other };
        let ptz = Ptz::from_degrees(
            28.0 * (index as f64 * 0.9).sin(),
            rng.random_range(-14.0..-11.0),
            rng.random_range(1600.0..3000.0),
        );
        let camera = PtzCamera::new(truth, ptz);
        let mut frame = new_frame(&format!("{index:04}.jpg"), SIZE);
        for (_, landmark, exact) in ground_landmarks(&field, &camera) {
            let image = exact.translate(Vec2::new(normal(rng), normal(rng)) * noise_px);
            if SIZE.contains(image) {
                frame
                    .clicks
                    .push(Click::landmark(landmark.id.clone(), image));
            }
        }
        let wanted = rng.random_range(4..=8);
        while frame.clicks.len() > wanted {
            frame
                .clicks
                .swap_remove(rng.random_range(0..frame.clicks.len()));
        }
        if frame.clicks.len() >= 4 {
            frame.status = FrameStatus::Reference;
            document.frames.push(frame.into());
        }
    }
    solve(&mut document);
    document
}

fn solve(document: &mut Document) {
    solve_document(document, Path::new("."), &Progress::default()).unwrap();
}

#[test]
fn a_bump_is_found_where_it_was_and_the_frames_after_it_get_their_own_camera() {
    let mut found = 0;
    for round in 0..10 {
        let mut rng = seeded::rng(&format!("a_bump_is_found {round}"));
        let (frames, before) = (30, 12 + round);
        let mut document = document(frames, before, 2.0, &mut rng);
        let Some(change) = camera_change(
            &document,
            &FrameLookup::from_document(&document),
            &"main".into(),
            &soccer(),
        ) else {
            continue;
        };
        println!("{before}: {} {}", change.frame, change.describe(&document));
        assert!(
            change.frame.abs_diff(before) <= 2,
            "{} for {before}",
            change.frame
        );
        assert!(
            (change.base.position_m - bumped_base().position_m).norm() < 1.0,
            "{:?}",
            change.base.position_m
        );
        found += 1;

        let given = change.assignment(&document);
        let name = given.camera.clone();
        let work = BulkSolve {
            document: document.clone(),
            folder: ".".into(),
            change: BulkChange::Assign(Box::new(given)),
        };
        let solved = work.run(&Progress::default()).unwrap();
        document = solved.join(&document).unwrap().unwrap().document;
        assert_eq!(name.as_str(), "main 2");
        assert!(
            document
                .frames
                .range(..change.frame)
                .all(|frame| frame.camera.as_str() == "main")
        );
        assert!(
            document
                .frames
                .range(change.frame..)
                .all(|frame| frame.camera == name && frame.ptz.is_some())
        );
        for camera in ["main", "main 2"] {
            assert_eq!(
                camera_change(
                    &document,
                    &FrameLookup::from_document(&document),
                    &camera.into(),
                    &soccer()
                ),
                None,
                "{camera} fits now"
            );
        }
    }
    assert!(found >= 9, "{found} of 10");
}

#[test]
fn a_base_estimated_over_a_bump_fits_neither_side_and_is_reported() {
    let mut rng = seeded::rng("a_base_estimated_over_a_bump");
    let mut document = document(40, 20, 2.0, &mut rng);
    let problem = BaseProblem::from_document(document.at(Path::new(".")), &"main".into()).unwrap();
    let estimated = problem
        .estimate(&document, &BaseOptions::default(), &Progress::default())
        .unwrap();
    estimated.write_to(&mut document, Path::new(".")).unwrap();
    let fields = Fields::from_document(document.at(Path::new("."))).unwrap();
    let change = camera_change(
        &document,
        &FrameLookup::from_document(&document),
        &"main".into(),
        &fields.per_camera(&document)[0],
    )
    .unwrap();
    assert!(change.frame.abs_diff(20) <= 3, "{}", change.frame);
}

#[test]
fn without_a_bump_there_is_no_alarm() {
    for round in 0..40 {
        let mut rng = seeded::rng(&format!("without_a_bump {round}"));
        let document = document(8 + 2 * round, usize::MAX, 2.5, &mut rng);
        assert_eq!(
            camera_change(
                &document,
                &FrameLookup::from_document(&document),
                &"main".into(),
                &soccer()
            ),
            None,
            "round {round}"
        );
    }
}

#[test]
fn frames_are_given_to_a_camera_and_what_rested_on_the_old_one_goes() {
    let mut rng = seeded::rng("frames_are_given_to_a_camera");
    let mut document = document(6, 3, 1.0, &mut rng);
    let fields = Fields::from_document(document.at(Path::new("."))).unwrap();
    add_camera_like(&mut document, &"second".into(), &"main".into()).unwrap();
    assign_to_camera(&mut document, &[3, 4, 5, 99], &"second".into(), &fields).unwrap();
    for frame in document.frames.range(3..) {
        assert!(
            frame.camera.as_str() == "second"
                && frame.ptz.is_none()
                && frame.status == FrameStatus::Draft
        );
    }
    assert!(
        document
            .frames
            .range(..3)
            .all(|frame| frame.ptz.is_some() && frame.status == FrameStatus::Reference)
    );
    document
        .camera_mut(&"second".into())
        .unwrap()
        .set_base(&elsewhere());
    assign_to_camera(&mut document, &[0], &"second".into(), &fields).unwrap();
    let warnings = &document.frames[0].solution.as_ref().unwrap().warnings;
    assert!(
        warnings
            .iter()
            .any(|warning| warning.code == WarningCode::OtherCamera.as_str()),
        "{warnings:?}"
    );
    assert!(
        check_cameras(document.at(Path::new(".")))
            .iter()
            .any(|problem| problem.fault.code() == "other_camera")
    );
}

#[test]
fn frames_that_cannot_be_given_say_why_and_nothing_changes() {
    let mut rng = seeded::rng("frames_that_cannot_be_given");
    let mut document = document(3, 3, 1.0, &mut rng);
    let fields = Fields::from_document(document.at(Path::new("."))).unwrap();
    document
        .cameras
        .push(Camera::new("small".into(), ImageSize::new(1280, 720)).into());
    let before = document.clone();
    let small = assign_to_camera(&mut document, &[0, 1], &"small".into(), &fields).unwrap_err();
    assert!(
        small.to_string().contains("0000.jpg is 1920 × 1080 px"),
        "{small}"
    );
    let unknown = assign_to_camera(&mut document, &[0], &"third".into(), &fields).unwrap_err();
    assert_eq!(
        unknown,
        AssignError::UnknownCamera {
            camera: "third".to_owned()
        }
    );
    assert!(matches!(
        add_camera_like(&mut document, &"main".into(), &"main".into()),
        Err(AssignError::NameTaken { .. })
    ));
    assert_eq!(
        add_camera_like(&mut document, &" ".into(), &"main".into()),
        Err(AssignError::NoName)
    );
    assert_eq!(document, before);
    assert_eq!(document.free_camera_name(&"main".into()).as_str(), "main 2");
    assert_eq!(document.free_camera_name(&"7".into()).as_str(), "camera 2");
}

/// The application on a document.
fn open(document: Document) -> App {
    App::with_document(document)
}

fn camera_of(app: &App, frame: usize) -> String {
    app.open().unwrap().document.frames[frame]
        .camera
        .as_str()
        .to_owned()
}

#[test]
fn the_app_tells_of_a_bump_once_and_makes_the_new_camera_in_one_step() {
    let mut rng = seeded::rng("the_app_tells_of_a_bump");
    let document = document(24, 12, 2.0, &mut rng);
    let before = document.clone();
    let mut app = open(document);
    let notices = |app: &App| {
        app.session
            .messages
            .notices
            .iter()
            .filter(|notice| notice.text.contains("stopped fitting"))
            .count()
    };
    assert_eq!(notices(&app), 1, "{:?}", app.session.messages.notices);
    let open = app.open().unwrap();
    let number = open.frame_number(app.camera_change().unwrap().frame);
    let says = format!("The camera stopped fitting at frame {number} (");
    let mut shown = app.session.messages.notices.iter();
    assert!(shown.any(|notice| notice.text.starts_with(&says)), "{says}");
    app.update(Action::Navigate(Navigation::GoTo(3)));
    app.update(Action::Edit(EditAction::SetComment("rain".into())));
    assert_eq!(notices(&app), 1);
    let change = app.camera_change().unwrap().frame;
    let effects = app.update(Action::Command(Command::NewCameraFromChange));
    assert!(
        effects
            .iter()
            .any(|effect| matches!(effect, Effect::Journal { .. }))
    );
    assert_eq!(
        (camera_of(&app, change - 1), camera_of(&app, change)),
        ("main".into(), "main 2".into())
    );
    assert_eq!((notices(&app), app.camera_change()), (0, None));
    app.update(Action::Command(Command::Undo));
    app.update(Action::Command(Command::Undo));
    assert_eq!(
        without_counts(&app.open().unwrap().document),
        without_counts(&before)
    );
}

#[test]
fn a_base_that_was_estimated_with_another_field_is_discarded() {
    let mut rng = seeded::rng("a_base_that_was_estimated_with_another_field");
    let mut app = open(document(12, 12, 1.0, &mut rng));
    for is_changed in [false, true] {
        let effects = app.update(Action::Command(Command::EstimateBase));
        let mut jobs = effects.into_iter().filter_map(|effect| match effect {
            Effect::Start(job) if job.name() == BaseEstimate::NAME => Some(job),
            _ => None,
        });
        let job = jobs.next().unwrap();
        if is_changed {
            let mut spec = app.shown_field_spec().unwrap().clone();
            spec.params.insert("length_m".to_owned(), 101.0);
            app.update(Action::Edit(EditAction::Field(spec)));
        }
        app.update(Action::Report(job.run(&SharedPictures::none(), &|_| ())));
        assert_eq!(app.operations.proposed_base().is_none(), is_changed);
    }
}

#[test]
fn a_camera_is_looked_at_once_its_field_has_been_read() {
    let mut rng = seeded::rng("the_app_tells_of_a_bump");
    let mut document = document(24, 12, 2.0, &mut rng);
    document.field = FieldSpec::new("own.json");
    let mut app = open(document);
    assert_eq!(app.camera_change(), None);
    app.update(Action::Disk(DiskReport::TemplateRead {
        of: "/match/project.json".into(),
        name: "own.json".to_owned(),
        template: Ok(Box::new(builtin("soccer").unwrap().clone())),
    }));
    assert!(app.camera_change().is_some());
}

#[test]
fn a_camera_with_many_clicked_frames_is_looked_at_in_the_background() {
    let mut rng = seeded::rng("a_camera_with_many_clicked_frames");
    let opened = Opened::new(document(60, 30, 2.0, &mut rng), "/match/project.json");
    let mut app = App::new(Settings::default());
    let looks = |effects: Vec<Effect>| -> Vec<Job> {
        let looks = effects.into_iter().filter_map(|effect| match effect {
            Effect::Start(job) if job.name() == CameraWatch::NAME => Some(job),
            _ => None,
        });
        looks.collect()
    };
    let report = |look: &Job| Action::Report(look.run(&SharedPictures::none(), &|_| ()));
    let first = looks(app.update(Action::Opened(Box::new(opened)))).remove(0);
    assert_eq!(app.camera_change(), None, "nothing is known yet");
    let meanwhile = looks(app.update(Action::Edit(EditAction::SetComment("rain".into()))));
    assert!(meanwhile.is_empty(), "one look at a time");
    let second = looks(app.update(report(&first))).remove(0);
    assert!(
        app.camera_change().unwrap().frame.abs_diff(30) <= 2,
        "{:?}",
        app.camera_change()
    );
    assert!(
        looks(app.update(report(&second))).is_empty(),
        "the document is as it was looked at"
    );
    let before = app.session.messages.notices.len();
    app.update(Action::Report(first.panic_report("too late".to_owned())));
    assert_eq!(
        app.session.messages.notices.len(),
        before,
        "its result is no longer needed"
    );
}

#[test]
fn frames_of_the_wrong_camera_are_reported_and_reassigned_in_one_step() {
    let mut rng = seeded::rng("frames_of_the_wrong_camera");
    let mut document = document_of(9, 5, &elsewhere(), 1.0, &mut rng);
    let mut second = Camera::new("second".into(), SIZE);
    second.set_base(&elsewhere());
    document.cameras.push(second.into());
    solve(&mut document);
    let mut app = open(document);
    app.update(Action::Navigate(Navigation::GoTo(6)));
    assert_eq!(
        app.current().better_camera.as_ref().unwrap().camera,
        "second".into()
    );
    assert_eq!(
        app.current().judgement.as_ref().unwrap().verdict,
        Verdict::Wrong
    );
    let camera = CameraChoice::Known("second".into());
    app.update(Action::Edit(EditAction::AssignToCamera {
        scope: Scope::Frame,
        camera: camera.clone(),
    }));
    assert_eq!(
        (camera_of(&app, 6), app.current().better_camera.clone()),
        ("second".into(), None)
    );
    app.update(Action::Navigate(Navigation::GoTo(5)));
    for frame in [7, 8] {
        app.update(Action::Navigate(Navigation::SelectFrame {
            frame,
            how: Selecting::Toggle,
        }));
    }
    app.update(Action::Edit(EditAction::AssignToCamera {
        scope: Scope::Selected,
        camera,
    }));
    assert!((5..9).all(|frame| camera_of(&app, frame) == "second"));
    assert!(app.session.frames_selected.is_empty());
    app.update(Action::Command(Command::Undo));
    assert_eq!(
        [5, 6, 7, 8].map(|frame| camera_of(&app, frame)),
        ["main", "second", "main", "main"]
    );
}

#[test]
fn a_new_camera_needs_a_name_of_its_own() {
    let mut rng = seeded::rng("a_new_camera_needs_a_name");
    let mut app = open(document(4, 4, 1.0, &mut rng));
    let before = app.open().unwrap().document.clone();
    let give = |app: &mut App, name: &str| {
        app.update(Action::Edit(EditAction::AssignToCamera {
            scope: Scope::Onwards,
            camera: CameraChoice::New(name.into()),
        }));
    };
    give(&mut app, "main");
    assert!(
        app.session
            .messages
            .notices
            .last()
            .unwrap()
            .text
            .contains("choose another name")
    );
    give(&mut app, " ");
    assert_eq!(*app.open().unwrap().document, before);
    app.update(Action::Navigate(Navigation::GoTo(2)));
    give(&mut app, "behind the goal");
    assert_eq!(
        [1, 2, 3].map(|frame| camera_of(&app, frame)),
        ["main", "behind the goal", "behind the goal"]
    );
    assert!(app.current().base.is_none());
    app.update(Action::Command(Command::Undo));
    assert_eq!(
        without_counts(&app.open().unwrap().document),
        without_counts(&before)
    );
}
