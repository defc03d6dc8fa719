//! What is suggested stays beside what people do: outside undo, on disk at once, in the file as the
//! format has it.

use crate::bench::Bench;
use crate::headless::Headless;
use crate::reviewing::review_in_app::proposal;
use std::fs;
use touchline_application::app::session::Saving;
use touchline_application::app::{
    Action, App, Command, EditAction, Navigation, PointerAction, TrainerReport,
};
use touchline_application::testing::proposed::{blank, proposal_in, suggestions};
use touchline_application::testing::without_counts;
use touchline_core::geometry::ImagePoint;
use touchline_documents::document::{
    Document, FrameStatus, document_from_bytes, document_to_string,
};
use touchline_documents::store::{Location, write_document};

fn suggested_frames(document: &Document) -> Vec<usize> {
    let frames = document.frames.iter().enumerate();
    frames
        .filter(|(_, frame)| frame.status == FrameStatus::Suggested)
        .map(|(position, _)| position)
        .collect()
}

fn document(app: &App) -> &Document {
    &app.open().unwrap().document
}

#[test]
fn a_document_is_written_byte_for_byte_as_it_was_read() {
    let text = document_to_string(&suggestions(&[Some(0.7), None, Some(0.99), Some(0.9)])).unwrap();
    assert_eq!(text.matches(r#""status": "suggested""#).count(), 3);
    let read = document_from_bytes(text.as_bytes()).unwrap();
    let mut bench = Bench::new(read.clone());
    assert_eq!(document_to_string(document(&bench.app)).unwrap(), text);
    // An edit of a frame is all that differs, and undo takes it back to the byte.
    bench.command(Command::AcceptAndStay);
    bench.act(Action::Edit(EditAction::SetComment("rain".into())));
    let journalled = bench.replay_journal(&read);
    assert_eq!(journalled, *document(&bench.app));
    assert_eq!(suggested_frames(&journalled), [2, 3]);
    bench.command(Command::Undo);
    bench.command(Command::Undo);
    assert_eq!(
        document_to_string(&without_counts(document(&bench.app))).unwrap(),
        text
    );
}

#[test]
fn accepting_is_one_step_and_taken_back_the_frame_shows_what_is_suggested_by_then() {
    let mut bench = Bench::new(blank(2));
    bench.act(Action::Trainer(TrainerReport::Proposals(vec![
        proposal(&bench, 0, 1, Some(1.0)),
        proposal(&bench, 1, 1, Some(1.0)),
    ])));
    let meanwhile = proposal(&bench, 0, 2, Some(2.0));
    assert_eq!(bench.app.open().unwrap().history.next_undo(), None);
    bench.command(Command::AcceptAndStay);
    assert_eq!(
        bench.app.open().unwrap().history.next_undo().unwrap().name,
        "Accept"
    );
    bench.act(Action::Trainer(TrainerReport::Proposals(vec![meanwhile])));
    assert_eq!(
        (bench.statuses().as_str(), bench.pan_deg(0)),
        ("RS", Some(1.0)),
        "accepted is accepted"
    );
    bench.command(Command::Undo);
    assert_eq!(
        bench.app.open().unwrap().history.next_undo(),
        None,
        "it was one step"
    );
    assert_eq!(
        (bench.statuses().as_str(), bench.pan_deg(0)),
        ("SS", Some(2.0))
    );
    assert!(bench.row_frames().contains(&0), "it waits for review again");
    bench.command(Command::Redo);
    assert_eq!(
        (bench.statuses().as_str(), bench.pan_deg(0)),
        ("RS", Some(1.0))
    );
}

#[test]
fn an_answer_for_an_earlier_revision_of_a_frame_is_dropped() {
    let mut bench = Bench::new(blank(1));
    bench.act(Action::Trainer(TrainerReport::Proposals(vec![proposal(
        &bench,
        0,
        1,
        Some(1.0),
    )])));
    let stale = proposal(&bench, 0, 1, Some(2.0));
    bench.act(Action::Edit(EditAction::SetComment("rain".into())));
    assert_eq!(
        bench.pan_deg(0),
        Some(1.0),
        "a comment leaves what is suggested"
    );
    bench.act(Action::Trainer(TrainerReport::Proposals(vec![stale])));
    assert_eq!(bench.pan_deg(0), Some(1.0));
    bench.act(Action::Trainer(TrainerReport::Proposals(vec![proposal(
        &bench,
        0,
        1,
        Some(3.0),
    )])));
    assert_eq!(bench.pan_deg(0), Some(3.0));
}

#[test]
fn five_hundred_suggestions_are_no_steps_and_in_none() {
    let mut bench = Bench::new(blank(501));
    bench.act(Action::Edit(EditAction::SetComment("rain".into())));
    for batch in 0..10 {
        let frames =
            (50 * batch + 1..=50 * (batch + 1)).map(|frame| proposal(&bench, frame, 1, Some(3.0)));
        bench.act(Action::Trainer(TrainerReport::Proposals(frames.collect())));
        bench.act(Action::Edit(EditAction::SetComment(format!(
            "rain {batch}"
        ))));
    }
    assert_eq!(suggested_frames(document(&bench.app)).len(), 500);
    bench.act(Action::Pointer(PointerAction::Press {
        at: ImagePoint::new(900.0, 600.0),
        on: None,
    }));
    let before = bench.app.open().unwrap().history.before().unwrap();
    assert_eq!(
        (before.frames.len(), suggested_frames(before).len()),
        (501, 0),
        "what undo keeps has none of them"
    );
    bench.command(Command::Cancel);
    let mut steps = 0;
    while bench.app.open().unwrap().history.next_undo().is_some() {
        bench.command(Command::Undo);
        steps += 1;
    }
    assert_eq!(
        (steps, suggested_frames(document(&bench.app)).len()),
        (11, 500)
    );
}

/// Waits until everything that was done is on disk.
fn settle(headless: &mut Headless) {
    headless.wait_until("the journal", |app| {
        matches!(app.session.disk.saving, Saving::Saved { .. })
    });
}

#[test]
fn suggestions_survive_a_kill_and_the_file_has_them() {
    let root = tempfile::tempdir().unwrap();
    let folder = root.path().join("match");
    write_document(
        &Location::for_new_document(&folder.join("")).unwrap(),
        &blank(4),
        false,
    )
    .unwrap();
    let mut headless = Headless::open(&folder);
    let answers = [0, 1, 2]
        .map(|frame| proposal_in(document(&headless.app), frame, 1, Some(frame as f64)))
        .to_vec();
    headless.act(Action::Trainer(TrainerReport::Proposals(answers)));
    headless.act(Action::Command(Command::AcceptAndStay));
    settle(&mut headless);

    // What a killed program leaves: the file and the journal as they are now.
    let killed = root.path().join("killed");
    fs::create_dir(&killed).unwrap();
    for entry in fs::read_dir(&folder).unwrap().map(|entry| entry.unwrap()) {
        if entry.file_type().unwrap().is_file()
            && entry.path().extension().is_none_or(|end| end != "lock")
        {
            fs::copy(entry.path(), killed.join(entry.file_name())).unwrap();
        }
    }
    assert!(
        !fs::read_to_string(killed.join("project.json"))
            .unwrap()
            .contains("suggested"),
        "only the journal has them"
    );
    let mut again = Headless::open(&killed);
    assert_eq!(*document(&again.app), *document(&headless.app));
    assert_eq!(suggested_frames(document(&again.app)), [1, 2]);
    again.act(Action::Command(Command::Save));
    settle(&mut again);
    let expected = document_to_string(document(&again.app)).unwrap();
    assert!(again.runner.close().is_empty());
    assert_eq!(
        fs::read_to_string(killed.join("project.json")).unwrap(),
        expected
    );
    assert_eq!(expected.matches(r#""status": "suggested""#).count(), 2);

    // The acceptance was not in the way of suggestions, and can be undone in another session.
    let mut later = Headless::open(&killed);
    later.act(Action::Navigate(Navigation::GoTo(0)));
    assert_eq!(
        later.app.open().unwrap().history.next_undo().unwrap().name,
        "Accept"
    );
    later.act(Action::Command(Command::Undo));
    assert_eq!(suggested_frames(document(&later.app)), [0, 1, 2]);
    let (undone, accepted) = (
        &document(&later.app).frames[0],
        &document(&headless.app).frames[0],
    );
    assert_eq!(
        (&undone.ptz, &undone.solution),
        (&accepted.ptz, &accepted.solution)
    );
    later.act(Action::Command(Command::Redo));
    assert_eq!(
        without_counts(document(&later.app)),
        without_counts(document(&headless.app))
    );
}
