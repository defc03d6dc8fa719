//! A base from scratch in the application: clicks, the guidance that counts them, the estimate, the
//! decision, undo.

use crate::bench::uncounted;
use crate::refine_base_command::clicked_match;
use std::path::PathBuf;
use std::sync::Arc;
use std::sync::mpsc::{Receiver, channel};
use std::time::Duration;
use touchline::app::guidance::next_step;
use touchline::app::operation::{Breakdown, Failure, Report};
use touchline::app::operations::BaseEstimate;
use touchline::app::{
    Action, App, Command, EditAction, Effect, Navigation, Opened, PointerAction, Settings,
};
use touchline::camera::{BaseAngles, CameraBase, Ptz, PtzCamera};
use touchline::document::{
    Camera, Click, Document, FieldSize, FieldSpec, Frame, FrameStatus, SolutionSource, Target,
    document_to_string,
};
use touchline::field::{FieldModel, Symmetry, builtin};
use touchline::geometry::{Angle, ImagePoint, ImageSize, Vec3};
use touchline::jobs::{Runner, SharedPictures};

const SIZE: ImageSize = ImageSize::new(1280, 720);

fn field() -> FieldModel {
    builtin("soccer").unwrap().default_model().unwrap()
}

fn truth(frame: usize) -> PtzCamera {
    let angles = BaseAngles {
        pitch: Angle::from_degrees(-0.4),
        ..BaseAngles::default()
    };
    let base = CameraBase::new(
        Vec3::new(2.0, -63.0, 19.0),
        angles.base_from_world(),
        SIZE.centre(),
    );
    let pan = [-28.0, 0.0, 27.0, -14.0, 14.0, 5.0][frame % 6];
    PtzCamera::new(
        base,
        Ptz::from_degrees(pan, -12.0, 1300.0 + 60.0 * frame as f64),
    )
}

/// The landmarks on the ground that a frame shows, well inside.
fn visible(frame: usize) -> Vec<(Target, ImagePoint)> {
    let field = field();
    let inside = |at: &ImagePoint| at.x > 20.0 && at.x < 1260.0 && at.y > 20.0 && at.y < 700.0;
    let on_ground = field
        .landmarks
        .iter()
        .filter(|landmark| landmark.nominal_m.z == 0.0);
    on_ground
        .filter_map(|landmark| {
            let at = truth(frame)
                .image_from_world(field.landmark_in_world(landmark))
                .ok()
                .filter(inside)?;
            Some((Target::Landmark(landmark.id.clone()), at))
        })
        .collect()
}

/// A project whose first `clicked` of `frames` frames have points, off by up to a px.
fn document(frames: usize, clicked: usize) -> Document {
    let mut document = Document::new(FieldSpec::new("soccer"));
    document
        .cameras
        .push(Camera::new("main".into(), SIZE).into());
    for index in 0..frames {
        let mut frame = Frame::from_image(&format!("{index}.png"), "main".into(), SIZE);
        if index < clicked {
            frame.status = FrameStatus::Draft;
            frame.clicks = visible(index)
                .into_iter()
                .enumerate()
                .map(|(number, (target, at))| {
                    let (dx, dy) = (
                        f64::from((number * 7 % 5) as u8) - 2.0,
                        f64::from((number * 3 % 5) as u8) - 2.0,
                    );
                    Click::new(target, ImagePoint::new(at.x + 0.4 * dx, at.y + 0.4 * dy))
                })
                .collect();
        }
        document.frames.push(frame.into());
    }
    document
}

struct Fixture {
    app: App,
    runner: Runner,
    woken: Receiver<()>,
}

impl Fixture {
    fn on(document: Document) -> Self {
        Self::at(document, "/match/project.json".into())
    }

    fn at(document: Document, file: PathBuf) -> Self {
        let (wake, woken) = channel();
        // Nobody listens once the test has seen enough.
        let wake = Arc::new(move || {
            let _ = wake.send(());
        });
        let runner = Runner::new(wake, SharedPictures::none());
        let mut fixture = Self {
            app: App::new(Settings::default()),
            runner,
            woken,
        };
        fixture.act(Action::Opened(Box::new(Opened::new(document, file))));
        fixture
    }

    fn act(&mut self, action: Action) {
        for effect in self.app.update(action) {
            // There is no disk behind this project.
            if !matches!(effect, Effect::Journal { .. }) {
                self.runner.carry_out(effect);
            }
        }
    }

    fn command(&mut self, command: Command) {
        self.act(Action::Command(command));
    }

    fn estimate(&mut self) {
        self.run(Command::EstimateBase);
    }

    /// Asks for an estimate and waits for it.
    fn run(&mut self, command: Command) {
        self.command(command);
        while self.app.operations.base_estimate.running().is_some() {
            self.woken.recv_timeout(Duration::from_mins(1)).unwrap();
            for action in self.runner.poll() {
                self.act(action);
            }
        }
    }

    fn document(&self) -> &Document {
        &self.app.open().unwrap().document
    }

    fn base(&self) -> Option<CameraBase> {
        self.document().cameras[0].base()
    }
}

/// Camera, residuals and verdict belong to one solution with the base that was found; a frame
/// without points shows nothing of another base and says so.
fn all_that_is_shown_is_of_the_estimated_base(fixture: &mut Fixture) {
    let found = fixture
        .app
        .operations
        .base_estimate
        .proposed()
        .unwrap()
        .estimate
        .base;
    let shown = fixture.app.shown();
    let (camera, solved) = (shown.camera.unwrap(), shown.solved().unwrap());
    assert!(shown.is_estimated && shown.judgement.is_some());
    assert_eq!(shown.base.unwrap().position_m, camera.base().position_m);
    assert!((camera.base().position_m - found.position_m).norm() < 1e-9);
    assert_eq!(camera.ptz(), solved.ptz);
    let clicks = &fixture.app.frame().unwrap().clicks;
    assert!(
        (0..clicks.len()).all(|click| shown.residual(click).is_some()),
        "a residual for each point"
    );
    assert!(
        next_step(&fixture.app)
            .text
            .starts_with("Lines and numbers are those of the estimated base.")
    );
    fixture.act(Action::Navigate(Navigation::GoTo(4)));
    let shown = fixture.app.shown();
    assert!(
        shown.is_estimated
            && shown.camera.is_none()
            && shown.solved().is_none()
            && shown.judgement.is_none()
    );
    assert!(
        next_step(&fixture.app)
            .text
            .starts_with("This frame has no points to draw the estimated base with.")
    );
    fixture.act(Action::Navigate(Navigation::GoTo(0)));
}

#[test]
fn a_base_is_found_looked_at_taken_over_and_undone_in_one_step() {
    let mut fixture = Fixture::on(document(5, 4));
    let before = document_to_string(fixture.document()).unwrap();
    assert!(
        next_step(&fixture.app)
            .offers
            .contains(&("Estimate the base now", Command::EstimateBase))
    );
    fixture.estimate();
    let found = fixture.app.operations.base_estimate.proposed().unwrap();
    assert_eq!(found.frames, [0, 1, 2, 3]);
    assert!(
        found.estimate.median_px < 2.0,
        "{}",
        found.estimate.median_px
    );
    assert!(!found.landmarks.is_empty());
    assert_eq!(
        document_to_string(fixture.document()).unwrap(),
        before,
        "nothing is changed before it is decided"
    );
    assert!(
        fixture
            .app
            .current()
            .proposal
            .as_ref()
            .unwrap()
            .camera
            .is_some(),
        "but the picture shows it"
    );
    assert_eq!(
        next_step(&fixture.app).offers,
        [],
        "the big button decides, and nothing else"
    );
    assert!(fixture.app.decides_about_base());
    assert_eq!(
        fixture.app.unacceptable().unwrap(),
        "An estimated base is shown. Use it or discard it first."
    );
    all_that_is_shown_is_of_the_estimated_base(&mut fixture);

    fixture.command(Command::UseEstimatedBase);
    let (base, sigma) = (
        fixture.base().unwrap(),
        fixture.base().unwrap().sigma.position_m,
    );
    let miss = base.position_m - truth(0).base().position_m;
    assert!(miss.norm() < 1.0, "{miss:?}");
    assert!(sigma.iter().all(|sigma| *sigma > 0.0), "{sigma:?}");
    for frame in fixture.document().frames.range(..4) {
        assert!(frame.is_solved_by_clicks(), "{}", frame.name());
    }
    assert!(fixture.document().frames[4].ptz.is_none());
    fixture.command(Command::Undo);
    assert_eq!(
        document_to_string(&uncounted(fixture.document())).unwrap(),
        before
    );
    fixture.command(Command::Redo);
    assert_eq!(fixture.base(), Some(base));
}

#[test]
fn painted_lines_take_part_where_that_is_ticked_and_all_is_one_step() {
    let place = tempfile::tempdir().unwrap();
    let (folder, _, clicked) = clicked_match(place.path());
    let mut fixture = Fixture::at(clicked, folder.join("project.json"));
    let before = document_to_string(fixture.document()).unwrap();
    fixture.command(Command::BaseOnPaint);
    assert!(fixture.app.settings.base_on_paint);
    fixture.command(Command::EstimateBase);
    assert!(
        fixture
            .app
            .operations
            .base_estimate
            .running()
            .is_some_and(|work| work.operation().from.contains("painted lines"))
    );
    fixture.command(Command::DropEstimatedBase);
    assert!(is_idle(&fixture.app), "it can be stopped");
    fixture.estimate();
    let found = fixture
        .app
        .operations
        .base_estimate
        .proposed()
        .unwrap()
        .clone();
    let on_paint = found.on_paint.clone().unwrap();
    let [held_out, was] =
        [on_paint.seen.after, on_paint.seen.before].map(|errors| errors.paint.unwrap().median_px);
    assert!(
        held_out < 0.4 && held_out <= was,
        "{held_out} px, {was} px before"
    );
    let told = &fixture.app.session.messages.notices.last().unwrap().text;
    assert!(
        told.contains("Painted lines that were not used are"),
        "{told}"
    );
    assert_eq!(
        document_to_string(fixture.document()).unwrap(),
        before,
        "nothing is changed before it is decided"
    );

    fixture.command(Command::UseEstimatedBase);
    // Its σ are written in degrees.
    let used = fixture.base().unwrap();
    let placed = |base: &CameraBase| {
        (
            base.position_m,
            base.base_from_world,
            base.principal_point,
            base.distortion,
        )
    };
    assert_eq!(placed(&used), placed(&found.estimate.base));
    let on_lines = |frame: &Frame| {
        frame
            .solution
            .as_ref()
            .is_some_and(|s| s.source == Some(SolutionSource::Markings))
    };
    assert!(
        fixture
            .document()
            .frames
            .iter()
            .all(|frame| on_lines(frame))
    );
    fixture.command(Command::Undo);
    assert_eq!(
        document_to_string(&uncounted(fixture.document())).unwrap(),
        before,
        "one step"
    );
}

#[test]
fn a_frame_that_is_edited_after_the_estimate_keeps_its_edit() {
    let place = tempfile::tempdir().unwrap();
    let (folder, _, clicked) = clicked_match(place.path());
    let mut fixture = Fixture::at(clicked, folder.join("project.json"));
    fixture.command(Command::BaseOnPaint);
    fixture.estimate();
    fixture.act(Action::Navigate(Navigation::Select(Some(0))));
    fixture.command(Command::DeleteClick);
    fixture.command(Command::UseEstimatedBase);
    let source = |index: usize| {
        fixture.document().frames[index]
            .solution
            .as_ref()
            .and_then(|solution| solution.source)
    };
    assert_eq!(
        (source(0), source(1)),
        (Some(SolutionSource::Clicks), Some(SolutionSource::Markings))
    );
}

#[test]
fn the_size_of_the_field_is_fitted_with_the_base_in_one_step() {
    let mut fixture = Fixture::on(document(6, 6));
    fixture.run(Command::FitFieldSize);
    let found = fixture.app.operations.base_estimate.proposed().unwrap();
    let names: Vec<&str> = found.sizes.iter().map(|size| size.name.as_str()).collect();
    assert_eq!(names, ["length_m", "width_m"]);
    for (size, real) in found.sizes.iter().zip([105.0, 68.0]) {
        assert!(
            (size.value_m - real).abs() < 3.0 * size.sigma_m && size.sigma_m < 1.0,
            "{size:?}"
        );
    }
    let told = &fixture.app.session.messages.notices.last().unwrap().text;
    assert!(
        told.contains("Field length 10") && told.contains("m assumed)"),
        "{told}"
    );
    assert!(
        fixture.document().field.assumed_size().is_some(),
        "nothing is changed before it is decided"
    );
    fixture.command(Command::UseEstimatedBase);
    assert_eq!(*fixture.document().field.size(), FieldSize::Fitted);
    fixture.command(Command::Undo);
    assert!(
        fixture.document().field.assumed_size().is_some() && fixture.base().is_none(),
        "one step"
    );
}

#[test]
fn what_was_found_can_be_discarded_and_the_estimation_stopped() {
    let mut fixture = Fixture::on(document(4, 4));
    fixture.command(Command::EstimateBase);
    fixture.command(Command::DropEstimatedBase);
    assert!(is_idle(&fixture.app));
    fixture.estimate();
    assert!(fixture.app.operations.base_estimate.proposed().is_some());
    fixture.command(Command::Cancel);
    assert!(is_idle(&fixture.app));
    assert!(fixture.base().is_none());
}

/// Nothing is being estimated, and nothing was found.
fn is_idle(app: &App) -> bool {
    let state = &app.operations.base_estimate;
    !state.is_open() && state.found().is_none()
}

#[test]
fn a_second_estimate_replaces_the_first() {
    let mut fixture = Fixture::on(document(4, 4));
    fixture.command(Command::EstimateBase);
    let first = fixture.app.operations.base_estimate.running().unwrap().id();
    fixture.estimate();
    let before = fixture.app.session.messages.notices.len();
    assert!(fixture.app.operations.base_estimate.proposed().is_some());
    let late = Failure::Broken(Breakdown::Panicked("too late".to_owned()));
    fixture.act(Action::Report(Report::of_end::<BaseEstimate>(
        first,
        Err(late),
    )));
    assert!(
        fixture.app.operations.base_estimate.proposed().is_some(),
        "of the second one"
    );
    assert_eq!(fixture.app.session.messages.notices.len(), before);
}

#[test]
fn a_compared_base_shows_the_one_before_while_the_key_is_held() {
    let mut fixture = Fixture::on(document(4, 4));
    fixture.estimate();
    fixture.command(Command::UseEstimatedBase);
    let mut off = (*fixture.document().cameras[0]).clone();
    off.position_m = off
        .position_m
        .map(|position| position + Vec3::new(0.0, 2.0, -1.0));
    fixture.act(Action::Edit(EditAction::Camera(Box::new(off))));
    fixture.estimate();
    let estimate = &fixture
        .app
        .operations
        .base_estimate
        .proposed()
        .unwrap()
        .estimate;
    assert!(estimate.previous_median_px.unwrap() > estimate.median_px);
    assert_eq!(fixture.app.why_not(Command::Compare), None);
    fixture.act(Action::Hold(Command::Compare, true));
    assert!(fixture.app.session.picture.held.compare);
    fixture.act(Action::Hold(Command::Compare, false));
    assert!(!fixture.app.session.picture.held.compare);
}

#[test]
fn a_frame_is_left_out_and_put_back() {
    let mut fixture = Fixture::on(document(4, 4));
    fixture.act(Action::Edit(EditAction::UseForBase {
        frame: 1,
        used: false,
    }));
    let text = document_to_string(fixture.document()).unwrap();
    assert!(text.contains("\"use_for_base\": false"), "{text}");
    assert_eq!(
        (
            fixture.app.base_readiness().frames,
            fixture.app.base_readiness().left_out
        ),
        (3, 1)
    );
    fixture.estimate();
    assert_eq!(
        fixture
            .app
            .operations
            .base_estimate
            .proposed()
            .unwrap()
            .frames,
        [0, 2, 3]
    );
    fixture.command(Command::DropEstimatedBase);
    fixture.act(Action::Edit(EditAction::UseForBase {
        frame: 1,
        used: true,
    }));
    assert!(
        !document_to_string(fixture.document())
            .unwrap()
            .contains("use_for_base")
    );
    fixture.command(Command::UseForBase);
    assert!(
        !fixture.document().frames[0].use_for_base,
        "the command is about the shown frame"
    );
}

#[test]
fn a_mirrored_frame_is_found_and_mended_in_one_step() {
    let mut document = document(6, 6);
    let field = field();
    for click in &mut document.frames[2].clicks {
        let Some(Target::Landmark(id)) = &click.target else {
            continue;
        };
        let twin = Symmetry::MirrorX
            .landmark_twin(&field, field.landmark(id.as_str()).unwrap())
            .unwrap();
        click.target = Some(Target::Landmark(twin.id.clone()));
    }
    let mut fixture = Fixture::on(document);
    fixture.estimate();
    let mirrored = fixture
        .app
        .operations
        .base_estimate
        .proposed()
        .unwrap()
        .estimate
        .mirrored
        .clone();
    assert_eq!(
        mirrored
            .iter()
            .map(|mirrored| mirrored.frame)
            .collect::<Vec<_>>(),
        [2]
    );
    fixture.act(Action::Edit(EditAction::MirrorNames {
        frame: 2,
        symmetry: mirrored[0].symmetry,
    }));
    assert_eq!(fixture.app.session.frame, 2);
    let names: Vec<_> = fixture
        .app
        .frame()
        .unwrap()
        .clicks
        .iter()
        .map(|click| click.target.clone().unwrap())
        .collect();
    let right: Vec<_> = visible(2).into_iter().map(|(target, _)| target).collect();
    assert_eq!(names, right);
    assert!(
        fixture
            .app
            .operations
            .base_estimate
            .found()
            .unwrap()
            .estimate
            .mirrored
            .is_empty()
    );
}

#[test]
fn without_a_base_guidance_counts_and_four_landmarks_name_the_next() {
    let mut fixture = Fixture::on(document(3, 0));
    assert!(
        next_step(&fixture.app)
            .text
            .starts_with("Two clicks need a known camera.")
    );
    let (landmarks, last) = {
        let mut landmarks = visible(0);
        let last = landmarks.pop().unwrap();
        (landmarks, last)
    };
    for (count, (target, at)) in landmarks.into_iter().enumerate() {
        fixture.act(Action::Edit(EditAction::Pick(target)));
        fixture.act(Action::Pointer(PointerAction::Press { at, on: None }));
        fixture.act(Action::Pointer(PointerAction::Release));
        if count == 1 {
            assert!(
                next_step(&fixture.app)
                    .text
                    .starts_with("2 of 4 landmarks or lines here"),
                "{}",
                next_step(&fixture.app).text
            );
        }
    }
    assert!(next_step(&fixture.app).text.ends_with("Done: 1 of 3."));
    assert!(
        fixture.app.current().preview.is_some(),
        "the lines show what four landmarks tell"
    );
    fixture.act(Action::Pointer(PointerAction::Press {
        at: last.1,
        on: None,
    }));
    fixture.act(Action::Pointer(PointerAction::Release));
    assert_eq!(
        fixture.app.frame().unwrap().clicks.last().unwrap().target,
        Some(last.0),
        "it names itself"
    );
}

#[test]
fn too_little_is_said_and_changes_nothing() {
    let mut fixture = Fixture::on(document(3, 0));
    fixture.estimate();
    assert!(
        fixture
            .app
            .session
            .messages
            .notices
            .iter()
            .any(|notice| notice.text.starts_with("Not enough points yet."))
    );
    let mut contradicting = document(3, 3);
    for frame in &mut contradicting.frames {
        let names: Vec<_> = frame
            .clicks
            .iter()
            .map(|click| click.target.clone())
            .collect();
        let count = names.len();
        for (index, click) in frame.clicks.iter_mut().enumerate() {
            click.target.clone_from(&names[(index * 5 + 3) % count]);
        }
    }
    let mut fixture = Fixture::on(contradicting);
    let before = document_to_string(fixture.document()).unwrap();
    fixture.estimate();
    assert!(
        fixture.app.operations.base_estimate.found().is_none(),
        "{:?}",
        fixture.app.operations.base_estimate
    );
    assert!(
        fixture
            .app
            .session
            .messages
            .notices
            .iter()
            .any(|notice| notice.text.starts_with("No base: "))
    );
    assert_eq!(document_to_string(fixture.document()).unwrap(), before);
}
