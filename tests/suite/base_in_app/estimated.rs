//! An estimate is shown, used, discarded, replaced and compared.

use super::{Fixture, document, truth};
use crate::drawn::clicked_match;
use touchline::app::guidance::next_step;
use touchline::app::operation::{Breakdown, Failure, Report};
use touchline::app::operations::BaseEstimate;
use touchline::app::{Action, App, Command, DiskReport, EditAction, Navigation};
use touchline::camera::CameraBase;
use touchline::document::{Document, FieldSize, Frame, SolutionSource, document_to_string};
use touchline::geometry::Vec3;
use touchline::store::Outside;
use touchline_application::testing::without_counts;

/// Camera, residuals and verdict belong to one solution with the base that was found; a frame
/// without points shows nothing of another base and says so.
fn all_that_is_shown_is_of_the_estimated_base(fixture: &mut Fixture) {
    let found = fixture
        .app
        .operations
        .base_estimate
        .proposed_base()
        .unwrap()
        .estimate
        .base;
    let shown = fixture.app.shown_values();
    let (camera, solved) = (shown.camera.unwrap(), shown.click_solution().unwrap());
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
    let shown = fixture.app.shown_values();
    assert!(
        shown.is_estimated
            && shown.camera.is_none()
            && shown.click_solution().is_none()
            && shown.judgement.is_none()
    );
    assert!(
        next_step(&fixture.app)
            .text
            .starts_with("This frame has no points to draw the estimated base with.")
    );
    fixture.act(Action::Navigate(Navigation::GoTo(0)));
}

/// The rows of an estimate name frames by their index.
#[test]
fn an_estimate_is_forgotten_when_a_merge_removes_frames() {
    let mut fixture = Fixture::on(document(5, 4));
    fixture.estimate();
    let base = fixture.document().clone();
    let mut merge = |theirs: Document| {
        let base = base.clone();
        let outside = DiskReport::Outside(Outside { base, theirs }.into());
        // There is no disk behind this project, so the effects are not carried out.
        drop(fixture.app.update(Action::Disk(outside)));
        fixture
            .app
            .operations
            .base_estimate
            .proposed_base()
            .is_some()
    };
    assert!(merge(base.clone()), "no frame is moved");
    let mut theirs = base.clone();
    drop(theirs.frames.remove(4));
    assert!(!merge(theirs));
}

#[test]
fn the_key_that_shows_the_current_base_is_the_one_that_the_user_chose() {
    let mut fixture = Fixture::on(document(5, 4));
    fixture.estimate();
    fixture.command(Command::UseEstimatedBase);
    let keys = &mut fixture.app.settings.keys;
    keys.assign(Command::Compare, "F8".parse().unwrap());
    fixture.estimate();
    let guidance = next_step(&fixture.app).text;
    assert!(
        guidance.ends_with("Hold F8 for the current one."),
        "{guidance}"
    );
    let notices = &fixture.app.session.messages.notices;
    assert!(
        notices
            .iter()
            .any(|notice| notice.text.contains("; hold F8 for the current base.")),
        "{notices:?}"
    );
}

#[test]
fn a_base_is_found_looked_at_taken_over_and_undone_in_one_step() {
    let mut fixture = Fixture::on(document(5, 4));
    let before = document_to_string(fixture.document()).unwrap();
    assert!(fixture.app.missing_base().unwrap().ready.is_enough());
    fixture.estimate();
    let found = fixture
        .app
        .operations
        .base_estimate
        .proposed_base()
        .unwrap();
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
        document_to_string(&without_counts(fixture.document())).unwrap(),
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
        .proposed_base()
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
        document_to_string(&without_counts(fixture.document())).unwrap(),
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
    let found = fixture
        .app
        .operations
        .base_estimate
        .proposed_base()
        .unwrap();
    let names: Vec<&str> = found.sizes.iter().map(|size| size.name.as_str()).collect();
    assert_eq!(names, ["length_m", "width_m"]);
    for (size, real) in found.sizes.iter().zip([105.0, 68.0]) {
        assert!(
            (size.value_m - real).abs() < 3.0 * size.error.sigma_m && size.error.sigma_m < 1.0,
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
    assert!(
        fixture
            .app
            .operations
            .base_estimate
            .proposed_base()
            .is_some()
    );
    fixture.command(Command::Cancel);
    assert!(is_idle(&fixture.app));
    assert!(fixture.base().is_none());
}

/// Nothing is being estimated, and nothing was found.
fn is_idle(app: &App) -> bool {
    let state = &app.operations.base_estimate;
    !state.is_open() && state.estimated_base().is_none()
}

#[test]
fn a_second_estimate_replaces_the_first() {
    let mut fixture = Fixture::on(document(4, 4));
    fixture.command(Command::EstimateBase);
    let first = fixture.app.operations.base_estimate.running().unwrap().id();
    fixture.estimate();
    let before = fixture.app.session.messages.notices.len();
    assert!(
        fixture
            .app
            .operations
            .base_estimate
            .proposed_base()
            .is_some()
    );
    let late = Failure::Broken(Breakdown::Panicked("too late".to_owned()));
    fixture.act(Action::Report(Report::from_result::<BaseEstimate>(
        first,
        Err(late),
    )));
    assert!(
        fixture
            .app
            .operations
            .base_estimate
            .proposed_base()
            .is_some(),
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
        .proposed_base()
        .unwrap()
        .estimate;
    assert!(estimate.previous_median_px.unwrap() > estimate.median_px);
    assert_eq!(fixture.app.why_not(Command::Compare), None);
    fixture.act(Action::Hold(Command::Compare, true));
    assert!(fixture.app.session.picture.held.compare);
    fixture.act(Action::Hold(Command::Compare, false));
    assert!(!fixture.app.session.picture.held.compare);
}
