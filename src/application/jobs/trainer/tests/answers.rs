//! Which frames the trainer queries again, and which it leaves as they are answered.

use super::fake_backend::{BackendCall, ScriptedEnd, model, proposal};
use super::{Controller, document};
use crate::app::{AnswerKey, TrainerOrder};
use crate::jobs::trainer::answer_cache::{AnswerCache, ForestQuerySettings};
use touchline_calibration::proposals::{Proposal, RefusedForests};
use touchline_core::geometry::Vec3;
use touchline_documents::document::Document;

/// A query without snapping.
const fn by(generation: u64) -> ForestQuerySettings {
    ForestQuerySettings {
        generation,
        snapping: false,
    }
}

#[test]
fn frames_whose_answer_the_document_lost_are_queried_again() {
    let (mut all, forest, mut answer_cache) = (document(1, 3), model(), AnswerCache::default());
    let wanted = |answer_cache: &AnswerCache, document: &Document, generation| -> Vec<usize> {
        (0..4)
            .filter(|&index| answer_cache.wants(document, index, &forest, by(generation)))
            .collect()
    };
    assert_eq!(wanted(&answer_cache, &all, 1), [1, 2, 3]);
    for index in 1..4 {
        let said = proposal(&all, index, 1, if index == 3 { 0.6 } else { 0.95 });
        answer_cache.enter(&said, by(1));
        answer_cache.look_at(&all);
        assert_eq!(
            wanted(&answer_cache, &all, 1).len(),
            3 - index,
            "answered, though not yet in the document"
        );
        said.record(&mut all.frames[index]);
    }
    answer_cache.look_at(&all);
    assert_eq!(
        (
            wanted(&answer_cache, &all, 1),
            wanted(&answer_cache, &all, 2)
        ),
        (vec![], vec![3])
    );
    assert_eq!(
        (
            answer_cache.count_answered(&all),
            answer_cache.count_unanswered(&all),
            answer_cache.count_answers(by(1))
        ),
        (3, 0, 3)
    );

    let mut undone = all.clone();
    undone.frames[1] = document(1, 3).frames[1].clone();
    answer_cache.look_at(&undone);
    assert_eq!(wanted(&answer_cache, &undone, 1), [1]);
    let mut moved = all.clone();
    moved.cameras[0].position_m = Some(Vec3::new(0.0, -60.0, 18.0));
    let mut answer_cache = AnswerCache::default();
    answer_cache.enter(&proposal(&all, 2, 1, 0.95), by(1));
    answer_cache.look_at(&moved);
    // With another base, everything that the forest was trained on is different.
    answer_cache.trust_from(2);
    assert!(
        answer_cache.wants(&moved, 2, &forest, by(2)),
        "an answer for another base is none"
    );
}

#[test]
fn a_forest_whose_answers_were_discarded_is_not_queried_for_them_again() {
    let mut controller = Controller::start(0.6);
    let mut all = document(2, 2);
    let refused = |generation| RefusedForests {
        frames: vec![document(2, 2).frames[2].id.clone()],
        generation,
    };
    controller.document(&all);
    controller.expect(&BackendCall::Recall, ScriptedEnd::Stopped);
    controller.expect(&BackendCall::Learn(vec![0, 1]), ScriptedEnd::Well);
    controller.expect(&BackendCall::Propose(vec![2, 3]), ScriptedEnd::Well);
    controller.expect(&BackendCall::Measure, ScriptedEnd::Well);
    controller.until_idle();
    let key = |proposal: &Proposal| AnswerKey {
        frame: proposal.frame.clone(),
        revision: proposal.request.revision,
        generation: proposal.generation,
        is_tracked: false,
    };
    controller.notify(TrainerOrder::Shown(
        controller.proposals.iter().map(key).collect(),
    ));
    controller.notify(TrainerOrder::Refused(refused(1)));
    // The document has lost both answers, of which only one was discarded.
    controller.document(&all);
    controller.expect(&BackendCall::Propose(vec![3]), ScriptedEnd::Well);
    controller.until_idle();
    controller.nothing_begun();

    // A newer forest is queried.
    all.frames.push(document(3, 0).frames[2].clone());
    controller.document(&all);
    controller.expect(&BackendCall::Learn(vec![0, 1, 4]), ScriptedEnd::Well);
    controller.expect(&BackendCall::Propose(vec![2, 3]), ScriptedEnd::Well);
}

#[test]
fn a_forest_that_goes_on_under_another_number_is_still_refused() {
    let (all, forest, mut answer_cache) = (document(1, 2), model(), AnswerCache::default());
    answer_cache.refuse(RefusedForests {
        frames: vec![all.frames[1].id.clone()],
        generation: 0,
    });
    answer_cache.keep_refusing(0, 1);
    let wants = |answer_cache: &AnswerCache, index, generation| {
        answer_cache.wants(&all, index, &forest, by(generation))
    };
    assert!(!wants(&answer_cache, 1, 1) && wants(&answer_cache, 2, 1));
    assert!(wants(&answer_cache, 1, 2));
    answer_cache.refuse(RefusedForests {
        frames: vec![all.frames[2].id.clone()],
        generation: 0,
    });
    assert!(
        !wants(&answer_cache, 2, 1),
        "refused by the number that it had before"
    );
}

#[test]
fn whether_proposals_are_snapped_can_be_changed_and_then_all_are_queried_again() {
    let mut controller = Controller::start(0.99);
    controller.wish(|wishes| wishes.snapping = true);
    let mut all = document(2, 2);
    controller.document(&all);
    controller.expect(&BackendCall::Recall, ScriptedEnd::Stopped);
    controller.expect(&BackendCall::Learn(vec![0, 1]), ScriptedEnd::Well);
    controller.expect(&BackendCall::Propose(vec![2, 3]), ScriptedEnd::Well);
    controller.expect(&BackendCall::Measure, ScriptedEnd::Well);
    controller.until_idle();
    let mut said = controller.proposals.clone();
    said[0].outcome.as_mut().unwrap().samples = Some(80);
    for (index, proposal) in said.iter().enumerate() {
        proposal.record(&mut all.frames[2 + index]);
    }
    controller.document(&all);
    controller.wish(|wishes| wishes.snapping = false);
    controller.expect(&BackendCall::Propose(vec![2, 3]), ScriptedEnd::Well);
    controller.until_idle();
    controller.nothing_begun();

    // In another run only the frame that is not aligned to its paint is queried.
    let mut controller = Controller::start(0.99);
    controller.wish(|wishes| wishes.snapping = true);
    controller.document(&all);
    controller.expect(&BackendCall::Recall, ScriptedEnd::Well);
    controller.expect(&BackendCall::Propose(vec![3]), ScriptedEnd::Well);
}
