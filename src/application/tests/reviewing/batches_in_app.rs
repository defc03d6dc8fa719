//! Suggestions come in batches, and a batch is discarded by one command, in one step of undo.

use crate::bench::Bench;
use crate::reviewing::review_in_app::proposal;
use touchline_application::app::session::Dialog;
use touchline_application::app::{Action, Command, EditAction, Navigation, TrainerReport};
use touchline_application::testing::proposed::{blank, proposal_in};
use touchline_calibration::proposals::Proposal;
use touchline_documents::document::{
    Frame, FrameStatus, ImportedCamera, SolutionSource, document_to_string,
};
use touchline_documents::testing::{ptz_at, solved_by};

fn propose(bench: &mut Bench, generation: u64, pans_deg: &[(usize, Option<f64>)]) {
    let proposals = pans_deg
        .iter()
        .map(|(frame, pan_deg)| proposal(bench, *frame, generation, *pan_deg));
    let proposals: Vec<Proposal> = proposals.collect();
    bench.act(Action::Trainer(TrainerReport::Proposals(proposals)));
}

#[test]
fn a_batch_is_discarded_where_no_person_has_changed_its_frames() {
    let start = blank(4);
    let mut bench = Bench::new(start.clone());
    assert_eq!(
        bench.app.why_not(Command::DiscardBatch),
        Some("Nothing is suggested for this frame.")
    );
    propose(
        &mut bench,
        1,
        &[(0, Some(1.0)), (1, Some(2.0)), (2, Some(3.0)), (3, None)],
    );
    bench.act(Action::Navigate(Navigation::GoTo(1)));
    bench.command(Command::AcceptAndStay);
    assert!(
        bench.app.why_not(Command::DiscardBatch).is_some(),
        "an accepted frame shows no suggestion"
    );
    bench.act(Action::Navigate(Navigation::GoTo(0)));
    assert_eq!(bench.app.why_not(Command::DiscardBatch), None);

    bench.command(Command::DiscardBatch);
    assert_eq!(bench.statuses(), "NRNN");
    assert_eq!(bench.last_notice(), "3 frames have no suggestion now.");
    assert!(bench.app.why_not(Command::DiscardBatch).is_some());
    bench.command(Command::Undo);
    assert_eq!(bench.statuses(), "SRSN");
    assert_eq!(bench.app.why_not(Command::DiscardBatch), None);
    bench.command(Command::Redo);
    assert_eq!(bench.statuses(), "NRNN");
    assert_eq!(
        bench.replay_journal(&start),
        *bench.app.open().unwrap().document
    );
}

#[test]
fn a_large_batch_is_discarded_after_a_question_with_its_number_of_frames() {
    let mut bench = Bench::new(blank(60));
    let pans: Vec<_> = (0..51).map(|frame| (frame, Some(1.0))).collect();
    propose(&mut bench, 1, &pans);
    bench.act(Action::Navigate(Navigation::GoTo(0)));
    bench.command(Command::DiscardBatch);
    let Some(Dialog::DiscardBatch { batch, frames: 51 }) = bench.app.session.dialog else {
        panic!("{:?}", bench.app.session.dialog)
    };
    let suggested = |bench: &Bench| bench.app.open().unwrap().count(FrameStatus::Suggested);
    bench.command(Command::Cancel);
    assert_eq!(suggested(&bench), 51, "nothing happens without the answer");
    bench.act(Action::Edit(EditAction::DiscardBatch(batch)));
    assert_eq!(suggested(&bench), 0);
    bench.command(Command::Undo);
    assert_eq!(suggested(&bench), 51);
}

#[test]
fn imported_cameras_are_not_discarded_and_come_back_where_they_were_replaced() {
    let mut document = blank(3);
    for frame in &mut document.frames {
        let frame: &mut Frame = frame;
        frame.status = FrameStatus::Suggested;
        frame.ptz = ptz_at(1.0, -12.0, 1800.0);
        frame.solution = solved_by(SolutionSource::Import);
    }
    let came = document.clone();
    let mut bench = Bench::new(document.clone());
    assert!(bench.app.why_not(Command::DiscardBatch).is_some());
    bench.command(Command::DiscardBatch);
    assert_eq!(bench.statuses(), "SSS");

    // As after mending and opening again: the record alone tells what came.
    let recorded = ImportedCamera::new(&came.ptz_camera(&came.frames[0]).unwrap(), None, None);
    let mut base = document.cameras[0].base().unwrap();
    base.position_m.x += 2.0;
    document.cameras[0].set_base(&base);
    for frame in &mut document.frames {
        let frame: &mut Frame = frame;
        let solution = frame.solution.as_mut().unwrap();
        solution.source = Some(SolutionSource::Markings);
        solution.imported.clone_from(&recorded);
    }
    let mut bench = Bench::new(document);
    bench.command(Command::DiscardBatch);
    assert_eq!(bench.statuses(), "SSS");
    let now = &bench.app.open().unwrap().document;
    assert_eq!(now.cameras.len(), 1, "no camera for each that came");
    for (frame, came_frame) in now.frames.iter().zip(&came.frames) {
        let [now, came] = [now.ptz_camera(frame), came.ptz_camera(came_frame)].map(Option::unwrap);
        let off = now.base().position_m - came.base().position_m;
        assert!(off.norm() < 1e-9, "{off}");
        assert!((now.cam_from_world() - came.cam_from_world()).abs().max() < 1e-9);
        assert_eq!(frame.source(), Some(SolutionSource::Import));
    }
    bench.command(Command::Undo);
    assert_eq!(bench.app.open().unwrap().document.cameras.len(), 1);
    let source = |frame: usize| bench.app.open().unwrap().document.frames[frame].source();
    assert_eq!(source(2), Some(SolutionSource::Markings));
}

#[test]
fn undo_gives_back_what_was_discarded_and_takes_back_nothing_that_was_suggested() {
    let mut bench = Bench::new(blank(2));
    propose(&mut bench, 1, &[(0, Some(1.0)), (1, Some(2.0))]);
    bench.act(Action::Edit(EditAction::SetComment("rain".into())));
    bench.command(Command::DiscardBatch);
    propose(&mut bench, 2, &[(1, Some(4.0))]);
    let shown = |bench: &Bench| (bench.statuses(), bench.pan_deg(1));
    assert_eq!(shown(&bench), ("NS".to_owned(), Some(4.0)));
    for _ in 0..2 {
        bench.command(Command::Undo);
        assert_eq!(shown(&bench), ("SS".to_owned(), Some(2.0)));
    }
    assert!(
        bench.app.why_not(Command::Undo).is_some(),
        "the comment and the batch were all that a person did"
    );
    for _ in 0..2 {
        bench.command(Command::Redo);
    }
    assert_eq!(shown(&bench), ("NS".to_owned(), Some(4.0)));
}

#[test]
fn a_forest_whose_batch_was_discarded_answers_no_more_and_a_later_one_does() {
    let mut bench = Bench::new(blank(2));
    propose(&mut bench, 1, &[(0, Some(1.0)), (1, Some(2.0))]);
    bench.command(Command::DiscardBatch);
    propose(&mut bench, 1, &[(0, Some(1.0)), (1, Some(3.0))]);
    assert_eq!(bench.statuses(), "NN");
    propose(&mut bench, 2, &[(0, Some(1.0))]);
    assert_eq!(
        (bench.statuses().as_str(), bench.pan_deg(0)),
        ("SN", Some(1.0))
    );
}

#[test]
fn what_an_earlier_session_left_is_a_batch_too() {
    let mut document = blank(3);
    proposal_in(&document, 0, 1, Some(1.0)).record(&mut document.frames[0]);
    proposal_in(&document, 2, 1, None).record(&mut document.frames[2]);
    let mut bench = Bench::new(document);
    bench.act(Action::Navigate(Navigation::GoTo(0)));
    bench.command(Command::DiscardBatch);
    assert_eq!(bench.last_notice(), "2 frames have no suggestion now.");
    let text = |document| document_to_string(document).unwrap();
    assert_eq!(text(&bench.app.open().unwrap().document), text(&blank(3)));
}

#[cfg(feature = "opencv")]
mod orders_to_the_trainer {
    use super::*;
    use touchline_application::app::{Effect, TrainerOrder};

    /// The orders that the trainer has got since they were looked at last.
    fn orders(bench: &mut Bench) -> Vec<TrainerOrder> {
        let orders = bench.effects.drain(..).filter_map(|effect| match effect {
            Effect::Trainer(order) => Some(order),
            _ => None,
        });
        orders.collect()
    }

    #[test]
    fn the_trainer_hears_of_its_own_answers_by_their_keys_and_gets_the_document_after_edits() {
        let mut bench = Bench::new(blank(3));
        bench.act(Action::Edit(EditAction::SetComment("rain".into())));
        assert!(matches!(
            &orders(&mut bench)[..],
            [TrainerOrder::Document(_)]
        ));
        propose(&mut bench, 1, &[(0, Some(1.0)), (2, None)]);
        let sent = orders(&mut bench);
        let [TrainerOrder::Shown(keys)] = &sent[..] else {
            panic!("{sent:?}")
        };
        let frames = &bench.app.open().unwrap().document.frames;
        let expected =
            [0, 2].map(|position| (frames[position].id.clone(), frames[position].revision, 1));
        let keys: Vec<_> = keys
            .iter()
            .map(|key| (key.frame.clone(), key.revision, key.generation))
            .collect();
        assert_eq!(keys, expected);

        propose(&mut bench, 1, &[(0, Some(1.0))]);
        assert_eq!(orders(&mut bench), [], "nothing new is shown");
        bench.command(Command::DiscardBatch);
        let sent = orders(&mut bench);
        let [
            TrainerOrder::Refused(refused),
            TrainerOrder::Document(document),
        ] = &sent[..]
        else {
            panic!("{sent:?}")
        };
        assert_eq!((refused.frames.len(), refused.generation), (2, 1));
        assert!(
            document
                .frames
                .iter()
                .all(|frame| !frame.shows_suggestion())
        );
    }
}
