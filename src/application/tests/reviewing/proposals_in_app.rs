//! Proposals that arrive in the application while a person works: what they replace, and what undo
//! and a new base make of them.

use crate::bench::Bench;
use touchline_application::app::session::Mode;
use touchline_application::app::{
    Action, Command, EditAction, Effect, Navigation, PointerAction, TrainerReport,
};
use touchline_application::testing::proposed::{blank, proposal_in};
use touchline_calibration::proposals::{FrameRequest, Proposal};
use touchline_core::geometry::{ImagePoint, Vec3};
use touchline_documents::document::{
    Change, Document, Frame, FrameStatus, RejectReason, SolutionSource,
};

/// What the forest says of a frame as it is now.
pub fn proposal(bench: &Bench, frame: usize, generation: u64, pan_deg: Option<f64>) -> Proposal {
    proposal_in(
        &bench.app.open().unwrap().document,
        frame,
        generation,
        pan_deg,
    )
}

impl Bench {
    /// The document that results from reading the journal.
    pub fn replay_journal(&self, start: &Document) -> Document {
        let mut document = start.clone();
        for effect in &self.effects {
            if let Effect::Journal { edit, .. } = effect {
                edit.clone().apply(&mut document).unwrap();
            }
        }
        document
    }

    pub fn pan_deg(&self, frame: usize) -> Option<f64> {
        self.frames()[frame]
            .ptz
            .as_ref()
            .map(|ptz| (1e6 * ptz.pan_deg).round() / 1e6)
    }
}

#[test]
fn proposals_are_for_frames_that_no_person_touched_and_no_step_of_undo() {
    let start = blank(5);
    let mut bench = Bench::new(start.clone());
    bench.label("centre_mark");
    bench.act(Action::Navigate(Navigation::GoTo(1)));
    bench.command(Command::Reject);
    bench.act(Action::Edit(EditAction::RejectAs(RejectReason::Blur)));
    let step = bench.app.open().unwrap().history.next_undo().cloned();
    let batch = [0, 1, 2].map(|frame| proposal(&bench, frame, 1, Some(5.0)));
    let unanswered = proposal(&bench, 3, 1, None);
    bench.act(Action::Trainer(TrainerReport::Proposals(
        batch.into_iter().chain([unanswered]).collect(),
    )));
    assert_eq!(bench.statuses(), "DXSNN");
    assert!(
        bench.frames()[3]
            .no_answer()
            .unwrap()
            .starts_with("3 features look like the references")
    );
    let solution = bench.frames()[2].solution.as_ref().unwrap();
    assert_eq!(
        (solution.confidence, solution.source),
        (Some(0.9), Some(SolutionSource::Forest))
    );
    assert_eq!(
        bench.app.open().unwrap().history.next_undo().cloned(),
        step,
        "no step of undo"
    );
    assert_eq!(
        bench.replay_journal(&start),
        *bench.app.open().unwrap().document
    );
}

#[test]
fn undo_and_redo_neither_lose_nor_resurrect_what_is_proposed() {
    let start = blank(4);
    let mut bench = Bench::new(start.clone());
    let first = [0, 1, 2].map(|frame| proposal(&bench, frame, 1, Some(1.0)));
    bench.act(Action::Edit(EditAction::SetComment("before".into())));
    bench.act(Action::Trainer(TrainerReport::Proposals(first.to_vec())));
    bench.command(Command::AcceptAndStay);
    bench.act(Action::Navigate(Navigation::GoTo(1)));
    bench.label("centre_mark");
    let request_for_untouched = FrameRequest::from_frame(&start, &start.frames[1]);
    let second = [2, 3].map(|frame| proposal(&bench, frame, 2, Some(2.0)));
    // Of frame 1 the answer arrives after it was clicked.
    let late = Proposal {
        request: request_for_untouched,
        ..proposal(&bench, 1, 2, Some(2.0))
    };
    bench.act(Action::Trainer(TrainerReport::Proposals(
        second.into_iter().chain([late]).collect(),
    )));
    assert_eq!(bench.statuses(), "RDSS");
    for _ in 0..8 {
        bench.command(Command::Undo);
    }
    assert!(bench.frames()[0].comment.is_none(), "everything was undone");
    assert_eq!(bench.statuses(), "SSSS");
    assert_eq!(
        [0, 1, 2, 3].map(|frame| bench.pan_deg(frame)),
        [Some(1.0), Some(2.0), Some(2.0), Some(2.0)]
    );
    for _ in 0..8 {
        bench.command(Command::Redo);
    }
    assert_eq!(bench.statuses(), "RDSS");
    assert_eq!([2, 3].map(|frame| bench.pan_deg(frame)), [Some(2.0); 2]);
    assert_eq!(
        bench.replay_journal(&start),
        *bench.app.open().unwrap().document
    );
}

#[test]
fn proposals_that_arrive_in_the_middle_of_a_drag_leave_it_alone() {
    let start = blank(3);
    let mut bench = Bench::new(start.clone());
    let batch: Vec<Proposal> = (0..3)
        .map(|frame| proposal(&bench, frame, 1, Some(3.0)))
        .collect();
    bench.act(Action::Pointer(PointerAction::Press {
        at: ImagePoint::new(900.0, 600.0),
        on: None,
    }));
    bench.act(Action::Pointer(PointerAction::Drag(ImagePoint::new(
        910.0, 600.0,
    ))));
    bench.act(Action::Trainer(TrainerReport::Proposals(batch)));
    assert!(matches!(bench.app.session.mode, Mode::Dragging { .. }));
    assert_eq!(bench.statuses(), "DSS");
    assert!(
        bench.replay_journal(&start).frames[0].clicks.is_empty(),
        "half a drag is not journalled"
    );
    bench.command(Command::Cancel);
    assert_eq!(
        bench.statuses(),
        "SSS",
        "without the point the frame is as it was proposed"
    );
    assert_eq!(
        bench.replay_journal(&start),
        *bench.app.open().unwrap().document
    );
    bench.act(Action::Pointer(PointerAction::Press {
        at: ImagePoint::new(900.0, 600.0),
        on: None,
    }));
    bench.act(Action::Pointer(PointerAction::Release));
    assert_eq!(
        bench.replay_journal(&start),
        *bench.app.open().unwrap().document
    );
    bench.command(Command::Undo);
    assert_eq!(bench.statuses(), "SSS");
}

#[test]
fn answers_that_no_longer_hold_are_dropped() {
    let mut bench = Bench::new(blank(4));
    let old = proposal(&bench, 0, 1, Some(1.0));
    bench.act(Action::Trainer(TrainerReport::Proposals(vec![proposal(
        &bench,
        1,
        2,
        Some(2.0),
    )])));
    bench.act(Action::Trainer(TrainerReport::Proposals(vec![old])));
    assert_eq!(
        bench.statuses(),
        "NSNN",
        "an older forest is not heard any more"
    );
    bench.act(Action::Trainer(TrainerReport::Proposals(vec![proposal(
        &bench, 1, 3, None,
    )])));
    assert_eq!(
        bench.statuses(),
        "NNNN",
        "a better forest takes its suggestion back"
    );
    assert!(bench.frames()[1].is_unanswered() && bench.pan_deg(1).is_none());
    let journalled = bench.effects.len();
    bench.act(Action::Trainer(TrainerReport::Proposals(vec![proposal(
        &bench, 1, 4, None,
    )])));
    assert_eq!(
        bench.effects.len(),
        journalled,
        "the same is not said twice"
    );
    let mut other = proposal(&bench, 2, 4, Some(2.0));
    other.request.sha256 = Some("another picture".into());
    let beyond = Proposal {
        frame: "99".into(),
        ..proposal(&bench, 2, 4, Some(2.0))
    };
    bench.act(Action::Trainer(TrainerReport::Proposals(vec![
        other, beyond,
    ])));
    assert_eq!(bench.statuses(), "NNNN");
}

#[test]
fn a_base_that_moves_takes_what_was_proposed_with_it_and_undo_brings_both_back() {
    let mut bench = Bench::new(blank(4));
    let batch: Vec<Proposal> = (0..4)
        .map(|frame| proposal(&bench, frame, 1, Some(3.0)))
        .collect();
    bench.act(Action::Trainer(TrainerReport::Proposals(batch.clone())));
    bench.command(Command::AcceptAndStay);
    let accepted = bench.frames()[0].ptz.clone();
    let moved = |bench: &mut Bench, height_m: f64| {
        let mut camera = (*bench.app.open().unwrap().document.cameras[0]).clone();
        camera.position_m = Some(Vec3::new(1.0, -62.0, height_m));
        bench.act(Action::Edit(EditAction::Begin("Set height")));
        bench.act(Action::Edit(EditAction::Camera(Box::new(camera))));
        bench.act(Action::Edit(EditAction::End));
    };
    moved(&mut bench, 20.0);
    assert_eq!(bench.statuses(), "RNNN", "what was accepted stays");
    assert_ne!(
        bench.frames()[0].ptz,
        accepted,
        "turned so that its lines stay on the picture"
    );
    assert!(
        bench
            .last_notice()
            .starts_with("3 proposals for the old base were discarded"),
        "{}",
        bench.last_notice()
    );
    bench.act(Action::Trainer(TrainerReport::Proposals(batch)));
    assert_eq!(bench.statuses(), "RNNN", "made for the old base");
    bench.act(Action::Trainer(TrainerReport::Proposals(vec![proposal(
        &bench,
        1,
        2,
        Some(9.0),
    )])));
    assert_eq!(bench.statuses(), "RSNN");
    bench.command(Command::Undo);
    assert_eq!(bench.statuses(), "RSSS");
    assert_eq!(
        [1, 2, 3].map(|frame| bench.pan_deg(frame)),
        [Some(3.0); 3],
        "each state has what was made for its base"
    );
    assert_eq!(bench.frames()[0].ptz, accepted);
    bench.command(Command::Redo);
    assert_eq!(bench.pan_deg(1), Some(9.0));
}

#[test]
fn ten_thousand_proposals_arrive_while_a_person_works() {
    let start = blank(10_000);
    let mut bench = Bench::new(start.clone());
    for step in 0..300 {
        bench.act(Action::Edit(EditAction::SetComment(format!("{step}"))));
    }
    for batch in 0..100 {
        let frames = (100 * batch..100 * (batch + 1))
            .map(|frame| proposal(&bench, frame, 1, Some(3.0)))
            .collect();
        bench.act(Action::Trainer(TrainerReport::Proposals(frames)));
        bench.act(Action::Navigate(Navigation::GoTo(9_999 - batch)));
        bench.act(Action::Pointer(PointerAction::Press {
            at: ImagePoint::new(900.0, 600.0),
            on: None,
        }));
        bench.act(Action::Pointer(PointerAction::Drag(ImagePoint::new(
            910.0, 600.0,
        ))));
        bench.command(Command::Cancel);
    }
    assert_eq!(
        bench.app.open().unwrap().count(FrameStatus::Suggested),
        10_000
    );
    for _ in 0..302 {
        bench.command(Command::Undo);
    }
    assert!(bench.frames()[0].comment.is_none());
    assert_eq!(
        bench.app.open().unwrap().count(FrameStatus::Suggested),
        10_000
    );
    let shared = |frame: usize| bench.frames()[frame].is_same(&bench.journalled_frame(frame));
    assert!(shared(17), "states share what they have in common");
}

impl Bench {
    fn journalled_frame(&self, frame: usize) -> touchline_documents::document::Shared<Frame> {
        let changes = self.effects.iter().rev().filter_map(|effect| match effect {
            Effect::Journal { edit, .. } => Some(&edit.changes),
            _ => None,
        });
        let wanted = &self.frames()[frame].id;
        let found = changes.flatten().find_map(|change| match change {
            Change::Frame {
                id, frame: found, ..
            } if id == wanted => Some(found.clone()),
            _ => None,
        });
        found.unwrap()
    }
}
