//! A trainer is paused, shows features, meets panics and ends, at every stage of its work.

use super::fake_backend::{BackendCall, ScriptedEnd, no_features};
use super::{Controller, document};
use crate::app::TrainerActivity;
use touchline_calibration::proposals::NoProposal;

#[test]
fn every_stage_can_be_paused_and_taken_up_again() {
    let mut controller = Controller::start(0.95);
    controller.document(&document(1, 1));
    controller.expect(&BackendCall::Recall, ScriptedEnd::Stopped);
    for stage in [
        BackendCall::Learn(vec![0]),
        BackendCall::Propose(vec![1]),
        BackendCall::Measure,
    ] {
        controller.expect(&stage, ScriptedEnd::Stopped);
        controller.until(|status| status.doing != TrainerActivity::Paused);
        controller.wish(|wishes| wishes.paused = true);
        controller.until(|status| status.doing == TrainerActivity::Paused);
        controller.nothing_begun();
        controller.wish(|wishes| wishes.paused = false);
        controller.expect(&stage, ScriptedEnd::Well);
    }
    controller.until_idle();
}

#[test]
fn every_stage_ends_when_the_trainer_is_dropped() {
    for stages in 0..3 {
        let mut controller = Controller::start(0.95);
        controller.document(&document(1, 1));
        controller.expect(&BackendCall::Recall, ScriptedEnd::Stopped);
        let all = [
            BackendCall::Learn(vec![0]),
            BackendCall::Propose(vec![1]),
            BackendCall::Measure,
        ];
        for (number, stage) in all.into_iter().take(stages + 1).enumerate() {
            controller.expect(
                &stage,
                if number == stages {
                    ScriptedEnd::Stopped
                } else {
                    ScriptedEnd::Well
                },
            );
        }
        drop(controller.trainer.take());
    }
}

#[test]
fn a_panic_is_shown_and_work_goes_on() {
    let mut controller = Controller::start(0.95);
    let mut all = document(1, 1);
    controller.document(&all);
    // A forest is trained instead of one that cannot be read.
    controller.expect(&BackendCall::Recall, ScriptedEnd::Panic);
    controller.expect(&BackendCall::Learn(vec![0]), ScriptedEnd::Panic);
    controller.until(|status| {
        let trouble = status.trouble.as_deref().unwrap_or_default();
        trouble.contains("while learning")
    });
    assert!(
        controller
            .status
            .trouble
            .as_ref()
            .unwrap()
            .contains("while learning (please report it): the saw broke"),
        "{:?}",
        controller.status
    );
    // Training is not repeated with the same references unless the user pauses and resumes.
    all.frames[1].comment = Some("rain".to_owned());
    controller.document(&all);
    controller.until(|status| status.doing == TrainerActivity::Nothing);
    controller.nothing_begun();
    controller.wish(|wishes| wishes.paused = true);
    controller.until(|status| status.doing == TrainerActivity::Paused);
    controller.wish(|wishes| wishes.paused = false);
    controller.expect(&BackendCall::Learn(vec![0]), ScriptedEnd::Fail);
    controller.until(|status| status.trouble == Some(no_features()));
    all.frames.push(document(2, 0).frames[1].clone());
    controller.document(&all);
    controller.expect(&BackendCall::Learn(vec![0, 2]), ScriptedEnd::Well);
    controller.expect(&BackendCall::Propose(vec![1]), ScriptedEnd::Panic);
    controller.expect(&BackendCall::Measure, ScriptedEnd::Panic);
    controller.until(|status| {
        status
            .trouble
            .as_ref()
            .is_some_and(|trouble| trouble.contains("the check failed"))
    });
    controller.until_idle();
    let [failed] = &controller.proposals[..] else {
        panic!("{:?}", controller.proposals)
    };
    assert_eq!(
        failed.outcome,
        Err(NoProposal::Panicked {
            message: "the forest burns".to_owned()
        })
    );
}

#[test]
fn features_are_shown_while_they_are_wanted_and_follow_the_shown_frame() {
    let mut controller = Controller::start(0.95);
    let all = document(1, 1);
    let [first, second] = [0, 1].map(|position| all.frames[position].id.clone());
    controller.document(&all);
    controller.expect(&BackendCall::Recall, ScriptedEnd::Well);
    controller.expect(&BackendCall::Propose(vec![1]), ScriptedEnd::Well);
    controller.expect(&BackendCall::Measure, ScriptedEnd::Well);
    controller.until_idle();
    controller.wish(|wishes| wishes.features = true);
    controller.woken.recv().unwrap();
    controller.wish(|wishes| wishes.frame = Some(second.clone()));
    while controller.features.last() != Some(&second) {
        controller.woken.recv().unwrap();
        controller.poll();
    }
    assert!(
        controller.features == [first, second.clone()] || controller.features == [second],
        "{:?}",
        controller.features
    );
    controller.nothing_begun();
}
