//! The shown frame is derived again only where something changed.

use super::*;
use crate::app::{Action, App, Opened, Settings};
use touchline_core::geometry::{ImagePoint, ImageSize};
use touchline_core::testing::{TestBase, base_at, landmark_in, soccer};
use touchline_documents::document::Target;
use touchline_documents::testing::{match_from, new_frame};

const SIZE: ImageSize = ImageSize::new(1280, 720);

fn pointed() -> PtzCamera {
    base_at([0.0, -60.0, 18.0], SIZE).aim(0.0, -12.0, 1000.0)
}

fn image_of(landmark: &str) -> ImagePoint {
    let field = soccer();
    landmark_in(&pointed(), &field, landmark)
}

/// A frame with two clicks, solved.
fn project() -> OpenProject {
    let mut document = match_from(pointed().base(), SIZE);
    let mut frame = new_frame("0.jpg", SIZE);
    frame.clicks = ["centre_mark", "halfway_far"]
        .map(|id| Click::landmark(id.into(), image_of(id)))
        .into_iter()
        .collect();
    document.frames.push(frame.into());
    OpenProject::with_document(document)
}

/// Whether a refresh recomputes the frame: it then removes a mark left in the derived values.
fn derives(current: &mut Current, open: &mut OpenProject, session: &Session) -> bool {
    current.readiness.left_out = 99;
    current.refresh(Some(open), session, None, None);
    current.readiness.left_out != 99
}

#[test]
fn only_what_changed_is_derived_again() {
    let (mut open, mut session, mut current) = (project(), Session::default(), Current::default());
    assert!(derives(&mut current, &mut open, &session));
    assert!(current.click_solution().is_some());
    session.points.hover = Some(SIZE.centre());
    session.picture.fit_scale = 0.5;
    session.points.selected = Some(1);
    assert!(
        !derives(&mut current, &mut open, &session),
        "nothing that the frame's camera rests on has changed"
    );
    open.document.frames[0].clicks[0].check = true;
    assert!(derives(&mut current, &mut open, &session));
    assert!(
        current.click_solution().is_none(),
        "one click is not enough"
    );
}

#[test]
fn the_preview_follows_the_pointer_and_the_frame_stays_solved() {
    let (mut open, mut session, mut current) = (project(), Session::default(), Current::default());
    current.refresh(Some(&mut open), &session, None, None);
    session.mode = Mode::Placing(Target::Landmark("centre_circle_left".into()));
    session.points.hover = Some(image_of("centre_circle_left"));
    assert!(!derives(&mut current, &mut open, &session));
    let first = current.preview.unwrap().ptz();
    session.points.hover = session
        .points
        .hover
        .map(|at| ImagePoint::new(at.x + 20.0, at.y));
    assert!(!derives(&mut current, &mut open, &session));
    assert_ne!(current.preview.unwrap().ptz(), first);
    session.points.hover = None;
    current.refresh(Some(&mut open), &session, None, None);
    assert!(current.preview.is_none());
}

#[test]
fn an_alignment_is_described_by_the_numbers_that_are_known_of_it() {
    let mut solution = Solution::default();
    let judgement = judge_snapped(&solution, None, SIZE);
    assert_eq!(judgement.reason, "painted lines fit");
    assert_eq!(judgement.verdict, Verdict::Check);
    (solution.samples, solution.rms_px) = (Some(212), Some(0.81));
    assert_eq!(
        judge_snapped(&solution, Some(1.3), SIZE).reason,
        "worst corner ±1.3 px; 212 points on painted lines fit to 0.8 px"
    );
}

#[test]
fn what_was_just_solved_is_not_solved_again() {
    let (mut open, session, mut current) = (project(), Session::default(), Current::default());
    let given = Err(CalibrationError::UnknownCamera {
        camera: "supplied".to_owned(),
    });
    let fresh = |version| FreshSolve {
        frame: 0,
        version,
        result: given.clone(),
    };
    let version = open.document.version();
    current.refresh(Some(&mut open), &session, Some(fresh(version)), None);
    assert_eq!(
        current
            .solution
            .as_ref()
            .and_then(|solution| solution.as_ref().err()),
        given.as_ref().err()
    );
    open.document.frames[0].comment = Some("rain".to_owned());
    current.refresh(Some(&mut open), &session, Some(fresh(version)), None);
    assert!(
        current.click_solution().is_some(),
        "the document has changed since"
    );
}

#[test]
fn another_document_is_derived_although_its_version_is_the_same() {
    let mut app = App::new(Settings::default());
    let mut empty = project().document.clone();
    empty.frames[0].clicks.clear();
    for (document, solved) in [(project().document.clone(), true), (empty, false)] {
        app.update(Action::Opened(Box::new(Opened::new(
            document,
            "/match/project.json",
        ))));
        assert_eq!(app.current().click_solution().is_some(), solved);
    }
}
