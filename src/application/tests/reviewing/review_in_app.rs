//! Suggestions in the application: looked through in an order, accepted one by one and together,
//! corrected, rejected.

pub use crate::reviewing::proposals_in_app::proposal;
use touchline_documents::testing::ptz_at;

use crate::bench::Bench;
use std::sync::Arc;
use touchline_application::app::guidance::next_step;
use touchline_application::app::review::ReviewOrder;
use touchline_application::app::session::{Dialog, Filter, Mode, SidePanel};
use touchline_application::app::{
    Action, Command, EditAction, Effect, Navigation, PointerAction, TrainerReport, ViewAction,
};
use touchline_application::testing::proposed::{suggestions, truth};
use touchline_application::testing::{base, landmark_in};
use touchline_core::camera::PtzCamera;
use touchline_core::geometry::ImagePoint;
use touchline_documents::document::{
    Frame, FrameStatus, Frames, RejectReason, SolutionSource, Target,
};

impl Bench {
    pub fn frames(&self) -> &Frames {
        &self.app.open().unwrap().document.frames
    }

    pub fn statuses(&self) -> String {
        let letter = |status| match status {
            FrameStatus::New => 'N',
            FrameStatus::Draft => 'D',
            FrameStatus::Suggested => 'S',
            FrameStatus::Reference => 'R',
            FrameStatus::Rejected => 'X',
        };
        self.frames()
            .iter()
            .map(|frame| letter(frame.status))
            .collect()
    }

    pub fn row_frames(&self) -> Vec<usize> {
        self.app.review().rows.iter().map(|row| row.frame).collect()
    }

    /// Where the truth has a landmark in the shown frame.
    fn point_of(&self, landmark: &str) -> ImagePoint {
        landmark_in(
            &PtzCamera::new(base(), truth(self.app.session.frame)),
            landmark,
        )
    }

    /// Clicks a landmark of the shown frame where the truth has it.
    pub fn label(&mut self, landmark: &str) {
        self.click(self.point_of(landmark));
        if let Mode::Naming(naming) = &self.app.session.mode {
            let click = naming.click;
            self.act(Action::Edit(EditAction::Name {
                click,
                target: Target::Landmark(landmark.into()),
            }));
        }
    }

    fn hint(&self) -> String {
        next_step(&self.app).text
    }
}

#[test]
fn enter_takes_a_suggestion_as_a_label_and_n_follows_the_list() {
    let mut bench = Bench::new(suggestions(&[
        Some(0.7),
        Some(0.99),
        None,
        Some(0.9),
        Some(0.8),
    ]));
    assert_eq!(
        bench.hint(),
        "Dashed = proposed. Enter takes it, a click corrects it, X rejects it."
    );
    bench.command(Command::ReviewPanel);
    assert_eq!(bench.app.session.panel, SidePanel::Review);
    assert_eq!(bench.row_frames(), [0, 4, 3, 1], "the most doubtful first");
    bench.command(Command::PreviousNeedsMe);
    assert_eq!(bench.app.session.frame, 1, "round and round");
    bench.command(Command::Accept);
    assert_eq!(bench.app.session.frame, 0, "the next in the list");
    let accepted = &bench.frames()[1];
    assert_eq!(accepted.status, FrameStatus::Reference);
    assert_eq!(
        accepted.solution.as_ref().unwrap().source,
        Some(SolutionSource::Forest)
    );
    assert!(
        !accepted.is_used_for_training(),
        "a label that is not used for training"
    );
    bench.act(Action::View(ViewAction::SetReviewOrder(ReviewOrder::Time)));
    assert_eq!(bench.row_frames(), [0, 3, 4]);
    bench.command(Command::Accept);
    bench.command(Command::Accept);
    bench.command(Command::Accept);
    assert_eq!(bench.statuses(), "RRNRR");
    assert_eq!(bench.last_notice(), "Accepted. 1 to do.");
    assert_eq!(
        bench.app.session.frame, 2,
        "what has no answer is to do as well"
    );
    bench.act(Action::Navigate(Navigation::GoTo(1)));
    assert_eq!(
        bench.hint(),
        "1 frame has no answer: frame 2 (pan\u{a0}−4°)."
    );
    bench.command(Command::NextUnanswered);
    assert_eq!(
        bench.app.session.frame, 2,
        "the very frame that the sentence names"
    );
    assert!(
        bench.hint().starts_with("No proposal here. Click a spot"),
        "{}",
        bench.hint()
    );
}

#[test]
fn without_the_panel_n_goes_through_every_frame_that_is_neither_accepted_nor_rejected() {
    let mut bench = Bench::new(suggestions(&[Some(0.7), None, Some(0.99)]));
    bench.command(Command::NextNeedsMe);
    assert_eq!(bench.app.session.frame, 1);
    assert!(Filter::ToDo.shows(&bench.frames()[1]) && Filter::Unanswered.shows(&bench.frames()[1]));
    let counts = bench.app.open().unwrap().counts();
    assert_eq!(
        (counts.to_do, counts.describe_to_do().unwrap().as_str()),
        (3, "2 to review, 1 without an answer")
    );
}

#[test]
fn several_are_accepted_in_one_step_after_a_preview() {
    let mut bench = Bench::new(suggestions(&[
        Some(0.7),
        Some(0.99),
        None,
        Some(0.96),
        Some(0.8),
    ]));
    bench.command(Command::AcceptAllAbove);
    assert_eq!(bench.app.session.dialog, Some(Dialog::AcceptAll));
    bench.act(Action::View(ViewAction::SetReviewThreshold(0.75)));
    let taken = |bench: &Bench| {
        bench
            .app
            .bulk_accept()
            .ticked_rows()
            .map(|row| row.frame)
            .collect::<Vec<_>>()
    };
    assert_eq!(taken(&bench), [4, 3, 1], "the least certain first");
    // What follows from it is worked out once for each change.
    let sheet = |bench: &Bench| bench.app.accept_sheet().map(Arc::clone);
    let before = sheet(&bench).unwrap();
    assert!(
        (before.expected_wrong.mean - 0.25).abs() < 1e-9,
        "{:?}",
        before.expected_wrong
    );
    bench.act(Action::Pointer(PointerAction::Hover(None)));
    assert!(Arc::ptr_eq(&before, &sheet(&bench).unwrap()));
    bench.act(Action::View(ViewAction::TickSuggestion {
        frame: 3,
        ticked: false,
    }));
    assert_eq!(taken(&bench), [4, 1]);
    assert!((sheet(&bench).unwrap().expected_wrong.mean - 0.21).abs() < 1e-9);
    bench.act(Action::View(ViewAction::TickSuggestion {
        frame: 3,
        ticked: true,
    }));
    bench.act(Action::Edit(EditAction::AcceptAll));
    assert_eq!((bench.statuses().as_str(), sheet(&bench)), ("SRNRR", None));
    assert_eq!(
        bench
            .effects
            .iter()
            .filter(|effect| matches!(effect, Effect::Journal { .. }))
            .count(),
        1
    );
    assert!(
        bench.last_notice().starts_with("3 suggestions accepted."),
        "{}",
        bench.last_notice()
    );
    bench.command(Command::Undo);
    assert_eq!(bench.statuses(), "SSNSS");
    bench.act(Action::View(ViewAction::SetReviewThreshold(0.999)));
    bench.act(Action::Edit(EditAction::AcceptAll));
    assert_eq!(bench.statuses(), "SSNSS", "none is that certain");
}

#[test]
fn what_comes_while_the_question_stands_is_not_accepted_with_the_others() {
    let mut bench = Bench::new(suggestions(&[
        Some(0.99),
        Some(0.98),
        None,
        None,
        Some(0.97),
    ]));
    bench.command(Command::AcceptAllAbove);
    bench.act(Action::View(ViewAction::SetReviewThreshold(0.0)));
    // The forest answers two more, and the last one otherwise.
    let proposals = [2, 3, 4]
        .map(|frame| proposal(&bench, frame, 1, Some(-3.0)))
        .to_vec();
    bench.act(Action::Trainer(TrainerReport::Proposals(proposals)));
    assert_eq!(bench.statuses(), "SSSSS");
    let sheet = bench.app.accept_sheet().map(Arc::clone).unwrap();
    assert_eq!((sheet.bulk.ticked_rows().count(), sheet.bulk.late), (2, 3));
    bench.act(Action::Edit(EditAction::AcceptAll));
    assert_eq!(bench.statuses(), "RRSSS");
    bench.command(Command::AcceptAllAbove);
    assert_eq!(bench.app.bulk_accept().late, 0, "a new sheet includes them");
}

#[test]
fn one_that_jumps_out_of_its_neighbours_is_not_accepted_with_the_others() {
    let mut document = suggestions(&[Some(0.99); 5]);
    document.frames[2].ptz = ptz_at(7.0, -14.0, 2300.0);
    let mut bench = Bench::new(document);
    bench.command(Command::AcceptAllAbove);
    let rows = &bench.app.review().rows;
    assert!(
        rows.iter()
            .find(|row| row.frame == 2)
            .unwrap()
            .apart_px()
            .unwrap()
            > 300.0,
        "{rows:?}"
    );
    bench.act(Action::Edit(EditAction::AcceptAll));
    assert_eq!(bench.statuses(), "RRSRR");
    bench.command(Command::AcceptAllAbove);
    bench.act(Action::View(ViewAction::SetWithDisagreeing(true)));
    bench.act(Action::Edit(EditAction::AcceptAll));
    assert_eq!(bench.statuses(), "RRRRR");
}

#[test]
fn a_click_corrects_and_taking_it_away_leaves_the_suggestion() {
    let mut bench = Bench::new(suggestions(&[Some(0.9), Some(0.9)]));
    let before = bench.frames()[0].clone();
    let at = bench.point_of("centre_mark");
    bench.act(Action::Pointer(PointerAction::Press {
        at: ImagePoint::new(at.x + 9.0, at.y),
        on: None,
    }));
    bench.act(Action::Pointer(PointerAction::Release));
    assert_eq!(bench.statuses(), "DS");
    assert_eq!(
        bench.frames()[0].clicks[0].target,
        Some(Target::Landmark("centre_mark".into())),
        "named by itself"
    );
    let moved = bench.app.current().camera.unwrap().ptz();
    assert!(
        (moved.pan - truth(0).pan).degrees() < -0.1 && (moved.focal_px - 2300.0).abs() < 5.0,
        "{moved:?}"
    );
    bench.act(Action::Edit(EditAction::DeleteClick(0)));
    assert_eq!(bench.frames()[0].status, FrameStatus::Suggested);
    assert_eq!(bench.frames()[0].ptz, before.ptz);
    bench.command(Command::Undo);
    bench.command(Command::AcceptAndStay);
    assert!(
        !bench.frames()[0].is_used_for_training(),
        "one click moves a proposal, but it stays one"
    );
    bench.command(Command::Undo);
    bench.act(Action::Edit(EditAction::DeleteClick(0)));
    bench.label("centre_mark");
    bench.label("halfway_far");
    let corrected = &bench.frames()[0];
    assert_eq!(
        corrected.solution.as_ref().unwrap().source,
        Some(SolutionSource::Clicks)
    );
    bench.command(Command::AcceptAndStay);
    assert!(
        bench.frames()[0].is_used_for_training(),
        "clicked by a person"
    );
    for _ in 0..12 {
        bench.command(Command::Undo);
    }
    let undone = (*bench.frames()[0]).clone();
    assert_eq!(
        Frame {
            revision: before.revision,
            ..undone
        },
        *before
    );
}

#[test]
fn a_rejected_suggestion_comes_back_as_one() {
    let mut bench = Bench::new(suggestions(&[Some(0.9), Some(0.8), Some(0.7)]));
    bench.command(Command::ReviewPanel);
    bench.command(Command::Reject);
    bench.act(Action::Edit(EditAction::RejectAs(RejectReason::Replay)));
    assert_eq!(
        (bench.statuses().as_str(), bench.app.session.frame),
        ("XSS", 2),
        "the most doubtful"
    );
    bench.act(Action::Navigate(Navigation::GoTo(0)));
    bench.command(Command::Reject);
    assert_eq!(bench.statuses(), "SSS");
}

#[test]
fn using_an_accepted_suggestion_for_training_is_one_step() {
    let mut bench = Bench::new(suggestions(&[Some(0.9)]));
    bench.command(Command::UseForTraining);
    assert!(!bench.frames()[0].is_used_for_training());
    bench.command(Command::AcceptAndStay);
    bench.act(Action::Edit(EditAction::SetUseForTraining {
        frame: 0,
        used: true,
    }));
    assert!(bench.frames()[0].is_used_for_training());
    let name = bench
        .app
        .open()
        .unwrap()
        .history
        .next_undo()
        .unwrap()
        .name
        .clone();
    assert_eq!(name, "Use for training");
    bench.command(Command::Undo);
    assert!(!bench.frames()[0].is_used_for_training());
    bench.command(Command::UseForTraining);
    assert!(bench.frames()[0].is_used_for_training());
}

#[test]
fn ten_thousand_suggestions_are_listed_and_accepted_together() {
    let confidences: Vec<Option<f64>> = (0..10_000)
        .map(|index| (index % 10 != 0).then_some(0.5 + 0.05 * f64::from(index % 10)))
        .collect();
    let mut bench = Bench::new(suggestions(&confidences));
    bench.command(Command::ReviewPanel);
    assert_eq!(bench.row_frames().len(), 9_000);
    bench.act(Action::View(ViewAction::SetReviewThreshold(0.9)));
    bench.act(Action::View(ViewAction::SetWithDisagreeing(true)));
    bench.act(Action::Edit(EditAction::AcceptAll));
    assert_eq!(
        bench.app.open().unwrap().count(FrameStatus::Reference),
        2_000
    );
    bench.act(Action::Pointer(PointerAction::Press {
        at: ImagePoint::new(700.0, 700.0),
        on: None,
    }));
    bench.command(Command::Cancel);
    bench.command(Command::Undo);
    assert_eq!(bench.app.open().unwrap().count(FrameStatus::Reference), 0);
}
