//! Suggestions that arrive, are accepted, withdrawn and discarded, with undo, redo and restarts.

use super::super::super::suggestions::KEPT_BASES;
use super::super::Project;
use super::{Desk, SIZE, base, document, proposal};
use crate::proposals::{FrameRequest, Proposal};
use touchline_core::geometry::ImagePoint;
use touchline_documents::document::{
    Click, FrameStatus, Solution, SolutionSource, document_from_bytes, document_to_string,
};
use touchline_documents::testing::{new_frame, ptz_at};

#[test]
fn a_file_is_split_and_written_as_it_was() {
    let mut document = document(4);
    proposal(&document, 0, Some(1.0)).record(&mut document.frames[0]);
    proposal(&document, 1, None).record(&mut document.frames[1]);
    proposal(&document, 2, Some(2.0)).record(&mut document.frames[2]);
    document.frames[2].status = FrameStatus::Reference;
    let text = document_to_string(&document).unwrap();
    let project = Project::from_document(document_from_bytes(text.as_bytes()).unwrap());
    let untouched: Vec<bool> = project
        .edited_document()
        .frames
        .iter()
        .map(|frame| frame.is_untouched())
        .collect();
    assert_eq!(untouched, [true, true, false, true]);
    assert_eq!(project.suggestions.frames().count(), 2);
    assert_eq!(document_to_string(project.view()).unwrap(), text);
    assert_eq!(
        document_to_string(&project.view_with(project.edited_document())).unwrap(),
        text
    );
}

#[test]
fn accepting_is_one_step_and_taking_it_back_shows_what_is_suggested_by_then() {
    let mut desk = Desk::of(document(2));
    desk.suggest(&[proposal(&desk.now, 0, Some(1.0))]);
    assert_eq!(desk.history.next_undo(), None, "a suggestion is not a step");
    desk.accept(0);
    let accepted = &desk.project.edited_document().frames[0];
    assert_eq!(
        (accepted.status, accepted.revision),
        (FrameStatus::Reference, 1)
    );
    let meanwhile = Proposal {
        request: FrameRequest::from_frame(&desk.start, &desk.start.frames[0]),
        ..proposal(&desk.now, 0, Some(2.0))
    };
    desk.suggest(&[meanwhile]);
    assert_eq!(desk.pans(), [Some(1.0), None], "what was accepted stays");
    assert!(desk.step(true));
    assert_eq!(desk.now.frames[0].status, FrameStatus::Suggested);
    assert_eq!(desk.pans(), [Some(2.0), None]);
    assert!(desk.step(false));
    assert_eq!(desk.pans(), [Some(1.0), None]);
    desk.check();
}

#[test]
fn what_was_accepted_or_corrected_before_a_restart_is_suggested_again_when_that_is_undone() {
    let mut desk = Desk::of(document(2));
    desk.suggest(&[
        proposal(&desk.now, 0, Some(1.0)),
        proposal(&desk.now, 1, Some(2.0)),
    ]);
    desk.accept(0);
    desk.edit("Click", |document| {
        let frame = &mut document.frames[1];
        let proposed = frame.proposed_camera();
        frame
            .clicks
            .push(Click::without_name(ImagePoint::new(3.0, 1.0)));
        frame.status = FrameStatus::Draft;
        frame.ptz = ptz_at(2.5, -9.0, 900.0);
        frame.solution = Some(Solution {
            source: Some(SolutionSource::Forest),
            proposed,
            ..Solution::default()
        });
    });
    desk.project = Project::from_document(desk.now.clone());
    while desk.step(true) {}
    assert_eq!(desk.pans(), [Some(1.0), Some(2.0)]);
    assert!(
        desk.now
            .frames
            .iter()
            .all(|frame| frame.status == FrameStatus::Suggested)
    );
    desk.check();
}

#[test]
fn an_answer_for_an_earlier_revision_does_not_replace_a_later_one() {
    let mut desk = Desk::of(document(1));
    let early = proposal(&desk.now, 0, Some(1.0));
    desk.edit("Comment", |document| {
        document.frames[0].comment = Some("rain".to_owned());
    });
    let late = proposal(&desk.now, 0, Some(2.0));
    desk.suggest(&[late]);
    desk.suggest(&[early]);
    assert_eq!(desk.pans(), [Some(2.0)]);
    let mut other = proposal(&desk.now, 0, Some(3.0));
    other.request.sha256 = Some("another picture".to_owned());
    desk.suggest(&[other]);
    assert_eq!(desk.pans(), [Some(2.0)], "it is of another picture");
    let journalled = desk.journal.len();
    desk.suggest(&[proposal(&desk.now, 0, Some(2.0))]);
    assert_eq!(desk.journal.len(), journalled, "the same is not said twice");
    desk.check();
}

#[test]
fn each_base_has_what_was_suggested_for_it() {
    let mut desk = Desk::of(document(1));
    let moved = |desk: &mut Desk, height_m| {
        desk.edit("Move camera", |document| {
            document.cameras[0].set_base(&base(height_m));
            document.frames[0] = document.frames[0].without_suggestion().into();
        });
    };
    desk.suggest(&[proposal(&desk.now, 0, Some(1.0))]);
    moved(&mut desk, 20.0);
    assert_eq!(desk.pans(), [None]);
    desk.suggest(&[proposal(&desk.now, 0, Some(2.0))]);
    assert_eq!(desk.pans(), [Some(2.0)]);
    moved(&mut desk, 18.0);
    assert_eq!(desk.pans(), [Some(1.0)]);
    desk.step(true);
    assert_eq!(desk.pans(), [Some(2.0)]);
    for height in 21..21 + KEPT_BASES {
        moved(&mut desk, height as f64);
        desk.suggest(&[proposal(&desk.now, 0, Some(3.0))]);
    }
    let id = &desk.now.frames[0].id;
    assert_eq!(
        desk.project.suggestions.topmost(id, Some(&base(18.0))),
        None,
        "it was too long ago"
    );
    desk.check();
}

#[test]
fn frames_that_come_go_and_come_back_bring_what_is_suggested_for_them() {
    let mut desk = Desk::of(document(3));
    desk.suggest(&[
        proposal(&desk.now, 0, Some(1.0)),
        proposal(&desk.now, 2, Some(3.0)),
    ]);
    desk.edit("Remove", |document| {
        document.frames.remove(0);
        let mut coming = new_frame("new.jpg", SIZE);
        proposal(document, 0, Some(4.0)).record(&mut coming);
        document.frames.push(coming.into());
    });
    desk.check();
    assert_eq!(desk.pans(), [None, Some(3.0), Some(4.0)]);
    desk.step(true);
    assert_eq!(desk.pans(), [Some(1.0), None, Some(3.0)]);
    desk.step(false);
    assert_eq!(desk.pans(), [None, Some(3.0), Some(4.0)]);
    desk.check();
}

#[test]
fn a_discarded_batch_gives_back_what_was_suggested_before() {
    let mut desk = Desk::of(document(3));
    desk.suggest(&[
        proposal(&desk.now, 0, Some(1.0)),
        proposal(&desk.now, 1, Some(2.0)),
    ]);
    let before = desk.now.clone();
    let batch = desk.carry(&[(0, 5.0), (1, 6.0), (2, 7.0)]);
    desk.accept(1);
    assert_eq!(desk.pans(), [Some(5.0), Some(6.0), Some(7.0)]);
    let discarded = desk.discard(batch);
    assert_eq!(
        (discarded.emptied, discarded.given_back, discarded.refused),
        (1, 1, None)
    );
    assert_eq!(
        desk.pans(),
        [Some(1.0), Some(6.0), None],
        "what was accepted stays"
    );
    assert_eq!(
        desk.history.next_undo().map(|step| step.name.as_str()),
        Some("Accept"),
        "it is no step"
    );
    assert_eq!(desk.now.frames[0], before.frames[0]);
    assert!(desk.step(true));
    assert_eq!(
        desk.pans(),
        [Some(1.0), Some(6.0), None],
        "the camera that the frame shows again was not discarded"
    );
    desk.discard(batch);
    assert_eq!(desk.now.frames[1].ptz, before.frames[1].ptz);
    desk.check();
}

#[test]
fn what_was_discarded_does_not_come_back_when_its_acceptance_is_redone_and_undone() {
    let mut desk = Desk::of(document(1));
    desk.suggest(&[proposal(&desk.now, 0, Some(1.0))]);
    desk.accept(0);
    assert!(desk.step(true));
    let batch = desk.project.batch_shown_in(&desk.now.frames[0]).unwrap();
    desk.discard(batch);
    assert!(desk.step(false));
    assert_eq!(desk.now.frames[0].status, FrameStatus::Reference);
    assert!(desk.step(true));
    assert_eq!(desk.pans(), [None]);
    desk.check();
}

#[test]
fn a_forest_that_answers_late_does_not_cover_a_camera_that_was_tracked_meanwhile() {
    let mut desk = Desk::of(document(2));
    let late = [
        proposal(&desk.now, 0, Some(1.0)),
        proposal(&desk.now, 1, Some(2.0)),
    ];
    let batch = desk.carry(&[(0, 5.0)]);
    desk.suggest(&late);
    assert_eq!(desk.pans(), [Some(5.0), Some(2.0)]);
    desk.discard(batch);
    assert_eq!(
        desk.pans(),
        [Some(1.0), Some(2.0)],
        "beneath it the answer was kept"
    );
    desk.check();
}

#[test]
fn a_forest_whose_answers_were_discarded_is_not_listened_to_again() {
    let mut desk = Desk::of(document(2));
    desk.suggest(&[
        proposal(&desk.now, 0, Some(1.0)),
        proposal(&desk.now, 1, None),
    ]);
    let batch = desk.project.batch_shown_in(&desk.now.frames[0]).unwrap();
    assert_eq!(
        desk.project.batch_shown_in(&desk.now.frames[1]),
        Some(batch)
    );
    let refused = desk.discard(batch).refused.unwrap();
    assert_eq!((refused.frames.len(), refused.generation), (2, 1));
    assert_eq!(desk.project.batch_shown_in(&desk.now.frames[0]), None);
    desk.suggest(&[
        proposal(&desk.now, 0, Some(1.0)),
        proposal(&desk.now, 1, Some(2.0)),
    ]);
    assert_eq!(desk.pans(), [None, None]);
    let later = Proposal {
        generation: 2,
        ..proposal(&desk.now, 0, Some(1.0))
    };
    desk.suggest(&[later]);
    assert_eq!(desk.pans(), [Some(1.0), None]);
    desk.check();
}
