//! Suggestions accepted and rejected together by their pictures.

use crate::bench::Bench;
use touchline_application::app::review::ReviewOrder;
use touchline_application::app::session::Dialog;
use touchline_application::app::{Action, Command, EditAction, ViewAction};
use touchline_application::testing::proposed::suggestions;
use touchline_core::geometry::ImagePoint;
use touchline_documents::document::{Click, RejectReason};

fn gallery() -> Bench {
    let mut bench = Bench::new(suggestions(&[Some(0.9); 5]));
    bench.command(Command::Gallery);
    assert_eq!(bench.app.session.dialog, Some(Dialog::Gallery));
    bench
}

fn select(bench: &mut Bench, frames: impl IntoIterator<Item = usize>) {
    let frames = frames.into_iter().collect();
    bench.act(Action::View(ViewAction::SelectFrames(frames)));
}

#[test]
fn what_is_selected_is_accepted_or_rejected_in_one_step_of_undo() {
    let mut bench = gallery();
    select(&mut bench, [0, 2, 99]);
    bench.act(Action::Edit(EditAction::AcceptSelected));
    assert_eq!(bench.statuses(), "RSRSS");
    assert_eq!(bench.app.session.dialog, Some(Dialog::Gallery), "it stays");
    assert!(bench.app.session.frames_selected.is_empty());
    select(&mut bench, [1, 4]);
    bench.act(Action::Edit(EditAction::RejectSelected(
        RejectReason::Replay,
    )));
    assert_eq!(bench.statuses(), "RXRSX");
    assert_eq!(bench.frames()[4].reason, Some(RejectReason::Replay));
    bench.command(Command::Undo);
    assert_eq!(bench.statuses(), "RSRSS");
    bench.command(Command::Undo);
    assert_eq!(bench.statuses(), "SSSSS");
    bench.command(Command::Gallery);
    assert_eq!(bench.app.session.dialog, None, "the same key closes it");
}

#[test]
fn what_cannot_be_accepted_stays_selected() {
    let mut document = suggestions(&[Some(0.9); 3]);
    let mut unnamed = Click::landmark("centre_mark".into(), ImagePoint::new(10.0, 10.0));
    unnamed.target = None;
    document.frames[1].clicks.push(unnamed);
    document.frames[2].ptz = None;
    let mut bench = Bench::new(document);
    bench.command(Command::Gallery);
    select(&mut bench, 0..3);
    bench.act(Action::Edit(EditAction::AcceptSelected));
    assert_eq!(bench.statuses(), "RSS");
    assert_eq!(bench.app.session.frames_selected, [1, 2].into());
    bench.act(Action::Edit(EditAction::AcceptSelected));
    assert_eq!(
        bench.last_notice(),
        "None of the selected frames is a suggestion that can be accepted."
    );
}

#[test]
fn in_the_order_of_pan_frames_that_look_alike_stand_together() {
    let mut bench = gallery();
    bench.act(Action::View(ViewAction::SetReviewOrder(ReviewOrder::Pan)));
    let pans: Vec<f64> = bench
        .row_frames()
        .into_iter()
        .map(|place| bench.frames()[place].ptz.as_ref().unwrap().pan_deg)
        .collect();
    assert!(pans.is_sorted(), "{pans:?}");
}
