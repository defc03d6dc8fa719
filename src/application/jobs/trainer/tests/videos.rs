//! In a video the forest answers key frames, and tracking answers the frames between them.

use super::fake_backend::{BackendCall, ScriptedEnd};
use super::{Controller, accept, document};
use crate::app::TrainerActivity;
use touchline_core::progress::Share;
use touchline_documents::document::{Document, VideoFrame};

/// Consecutive frames of a video; the first is a reference.
fn video(frames: usize) -> Document {
    let mut all = document(1, frames - 1);
    for index in 0..frames {
        all.frames[index].image = None;
        all.frames[index].video = Some(VideoFrame::new("match.mp4", index as u64, None));
    }
    all
}

#[test]
fn in_a_video_the_forest_answers_key_frames_and_the_rest_is_tracked() {
    let mut controller = Controller::start(0.95);
    let mut all = video(61);
    controller.document(&all);
    controller.expect(&BackendCall::Recall, ScriptedEnd::Well);
    controller.expect(&BackendCall::Propose(vec![1, 2, 3, 4]), ScriptedEnd::Well);
    controller.expect(&BackendCall::Propose(vec![5, 6, 7, 8]), ScriptedEnd::Well);
    controller.expect(&BackendCall::Measure, ScriptedEnd::Well);
    controller.expect(&BackendCall::Propose(vec![25, 50, 60]), ScriptedEnd::Well);
    let keys = BackendCall::Carry(vec![0, 25, 50, 60]);
    controller.expect(&keys, ScriptedEnd::Stopped);
    controller.until(|status| {
        matches!(
            status.doing,
            TrainerActivity::Carrying(Share { of: 57, .. })
        )
    });
    controller.wish(|wishes| wishes.paused = true);
    controller.until(|status| status.doing == TrainerActivity::Paused);
    controller.wish(|wishes| wishes.paused = false);
    controller.expect(&keys, ScriptedEnd::Well);
    controller.until_idle();
    // Tracking also adjusts key frames that the forest answered, but not the user's reference.
    assert_eq!(controller.tracked.len(), 60);
    controller.nothing_begun();

    // A document that shows all cameras, and a shown frame near the other end, cause no more work.
    for proposal in controller.proposals.drain(..) {
        proposal.record(all.frames.by_id_mut(&proposal.frame).unwrap());
    }
    for tracked in controller.tracked.drain(..) {
        tracked.record(all.frames.by_id_mut(&tracked.frame).unwrap());
    }
    controller.document(&all);
    controller.wish(|wishes| wishes.frame = Some(all.frames[40].id.clone()));
    controller.until_idle();
    controller.nothing_begun();

    // Another reference between the key frames: the whole window is propagated again.
    accept(&mut all.frames[30], 30.5);
    all.frames[30].solution = None;
    controller.document(&all);
    controller.expect(&BackendCall::Learn(vec![0, 30]), ScriptedEnd::Well);
    controller.expect(&BackendCall::Measure, ScriptedEnd::Well);
    controller.expect(&keys, ScriptedEnd::Well);
    while controller.tracked.is_empty() {
        controller.woken.recv().unwrap();
        controller.poll();
    }
    assert_eq!(controller.tracked.len(), 59);
}

#[test]
fn frames_that_tracking_does_not_reach_are_queried() {
    let mut controller = Controller::start(0.95);
    controller.document(&video(31));
    controller.expect(&BackendCall::Recall, ScriptedEnd::Well);
    for near in [vec![1, 2, 3, 4], vec![5, 6, 7, 8]] {
        controller.expect(&BackendCall::Propose(near), ScriptedEnd::Well);
    }
    controller.expect(&BackendCall::Measure, ScriptedEnd::Well);
    controller.expect(&BackendCall::Propose(vec![25, 30]), ScriptedEnd::Well);
    controller.expect(&BackendCall::Carry(vec![0, 25, 30]), ScriptedEnd::Panic);
    for left in [9..13, 13..17, 17..21, 21..25, 26..30] {
        controller.expect(&BackendCall::Propose(left.collect()), ScriptedEnd::Well);
    }
    controller.until_idle();
    assert_eq!(controller.tracked, []);
    assert!(
        controller
            .status
            .trouble
            .as_ref()
            .is_some_and(|trouble| trouble.contains("tracking"))
    );
}
