//! What the trainer trains on, when it trains again, and what it then queries.

use super::fake_backend::{BackendCall, ScriptedEnd, proposal};
use super::{Controller, accept, document};
use touchline_documents::document::FrameStatus;

#[test]
fn references_are_learnt_then_frames_are_proposed_then_it_is_measured() {
    let mut controller = Controller::start(0.95);
    let all = document(2, 28);
    controller.wish(|wishes| wishes.frame = Some(all.frames[6].id.clone()));
    controller.document(&all);
    controller.expect(&BackendCall::Recall, ScriptedEnd::Stopped);
    controller.expect(&BackendCall::Learn(vec![0, 1]), ScriptedEnd::Well);
    for near in [
        vec![6, 5, 7, 4],
        vec![8, 3, 9, 2],
        vec![10, 11, 12, 13],
        vec![14],
    ] {
        controller.expect(&BackendCall::Propose(near), ScriptedEnd::Well);
    }
    controller.expect(&BackendCall::Measure, ScriptedEnd::Well);
    for far in [15..19, 19..23, 23..27, 27..30] {
        controller.expect(&BackendCall::Propose(far.collect()), ScriptedEnd::Well);
    }
    controller.until_idle();
    assert_eq!(
        (
            controller.status.references,
            controller.status.training_frames,
            controller.status.answered
        ),
        (2, 2, 28)
    );
    assert_eq!(controller.status.forest.unwrap().generation, 1);
    assert!(controller.status.quality.is_some());
    assert_eq!(controller.status.suspects[0].frame, all.frames[0].id);
    assert_eq!(controller.proposals.len(), 28);
    assert!(
        controller
            .proposals
            .iter()
            .all(|proposal| proposal.generation == 1)
    );
}

#[test]
fn a_burst_is_one_change_and_added_references_let_a_training_end() {
    let mut controller = Controller::start(0.95);
    controller.document(&document(1, 0));
    controller.expect(&BackendCall::Recall, ScriptedEnd::Stopped);
    assert_eq!(
        controller.begun.recv().unwrap(),
        BackendCall::Learn(vec![0])
    );
    for references in 2..=6 {
        controller.document(&document(references, 0));
    }
    controller.go.send(ScriptedEnd::Well).unwrap();
    controller.expect(&BackendCall::Learn((0..6).collect()), ScriptedEnd::Well);
    controller.expect(&BackendCall::Measure, ScriptedEnd::Well);
    controller.until_idle();
    assert_eq!(controller.status.forest.unwrap().generation, 2);
    controller.nothing_begun();
}

#[test]
fn a_withdrawn_reference_stops_the_training_and_its_answers_are_queried_again() {
    let mut controller = Controller::start(0.99);
    let mut all = document(3, 2);
    controller.document(&all);
    controller.expect(&BackendCall::Recall, ScriptedEnd::Stopped);
    assert_eq!(
        controller.begun.recv().unwrap(),
        BackendCall::Learn(vec![0, 1, 2])
    );
    all.frames[1].status = FrameStatus::Draft;
    controller.document(&all);
    controller.go.send(ScriptedEnd::Stopped).unwrap();
    controller.expect(&BackendCall::Learn(vec![0, 2]), ScriptedEnd::Well);
    controller.expect(&BackendCall::Propose(vec![3, 4]), ScriptedEnd::Well);
    controller.expect(&BackendCall::Measure, ScriptedEnd::Well);
    controller.until_idle();

    // Certain answers stay when a reference is added, and are queried again when one is withdrawn.
    for (index, proposal) in controller.proposals.drain(..).enumerate() {
        proposal.record(&mut all.frames[3 + index]);
    }
    accept(&mut all.frames[1], 1.5);
    controller.document(&all);
    controller.expect(&BackendCall::Learn(vec![0, 1, 2]), ScriptedEnd::Well);
    controller.expect(&BackendCall::Measure, ScriptedEnd::Well);
    all.frames[0].ptz.as_mut().unwrap().pan_deg = 0.25;
    controller.document(&all);
    controller.expect(&BackendCall::Learn(vec![0, 1, 2]), ScriptedEnd::Well);
    controller.expect(&BackendCall::Propose(vec![3, 4]), ScriptedEnd::Well);
    controller.expect(&BackendCall::Measure, ScriptedEnd::Well);

    controller.until_idle();
    assert_eq!(controller.status.suspects.len(), 1);
    for index in 0..3 {
        all.frames[index].status = FrameStatus::New;
    }
    controller.document(&all);
    controller.until(|status| status.references == 0);
    assert_eq!(
        (controller.status.forest, &controller.status.quality),
        (None, &None)
    );
    controller.nothing_begun();
}

#[test]
fn a_better_forest_is_queried_again_for_doubtful_answers() {
    let controller = Controller::start(0.6);
    let mut all = document(2, 1);
    controller.document(&all);
    controller.expect(&BackendCall::Recall, ScriptedEnd::Stopped);
    controller.expect(&BackendCall::Learn(vec![0, 1]), ScriptedEnd::Well);
    controller.expect(&BackendCall::Propose(vec![2]), ScriptedEnd::Well);
    controller.expect(&BackendCall::Measure, ScriptedEnd::Well);
    all.frames.push(document(3, 0).frames[2].clone());
    controller.document(&all);
    controller.expect(&BackendCall::Learn(vec![0, 1, 3]), ScriptedEnd::Well);
    controller.expect(&BackendCall::Propose(vec![2]), ScriptedEnd::Well);
    controller.expect(&BackendCall::Measure, ScriptedEnd::Well);
}

#[test]
fn references_wait_for_the_base_of_their_camera() {
    let mut controller = Controller::start(0.95);
    let known = document(2, 0);
    let mut all = known.clone();
    all.cameras[0].position_m = None;
    controller.document(&all);
    controller.until(|status| status.references == 2);
    assert_eq!(
        (
            controller.status.training_frames,
            &controller.status.trouble
        ),
        (0, &None)
    );
    controller.nothing_begun();
    controller.document(&known);
    controller.expect(&BackendCall::Recall, ScriptedEnd::Well);
    controller.expect(&BackendCall::Measure, ScriptedEnd::Well);
    controller.until_idle();
    assert_eq!(controller.status.training_frames, 2);
}

#[test]
fn the_forest_of_an_earlier_session_serves_and_a_damaged_one_is_made_again() {
    let mut controller = Controller::start(0.95);
    let mut all = document(1, 2);
    // A certain proposal of an earlier run is not queried again.
    proposal(&document(1, 2), 1, 1, 0.97).record(&mut all.frames[1]);
    controller.document(&all);
    controller.expect(&BackendCall::Recall, ScriptedEnd::Well);
    controller.expect(&BackendCall::Propose(vec![2]), ScriptedEnd::Well);
    controller.expect(&BackendCall::Measure, ScriptedEnd::Well);
    controller.until_idle();
    assert_eq!(controller.status.forest.unwrap().took, None);

    let mut controller = Controller::start(0.95);
    controller.document(&document(1, 0));
    controller.expect(&BackendCall::Recall, ScriptedEnd::Fail);
    controller.expect(&BackendCall::Learn(vec![0]), ScriptedEnd::Well);
    controller.expect(&BackendCall::Measure, ScriptedEnd::Well);
    controller.until_idle();
    assert_eq!(controller.status.trouble, None, "it has been mended");
}
