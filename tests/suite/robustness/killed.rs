//! A program that is killed while the trainer learns, proposes and answers are accepted: nothing
//! accepted is lost.
#![cfg(feature = "opencv")]

use crate::drawn::drawn_match;
use crate::headless::Headless;
use crate::program::touchline;
use std::collections::BTreeMap;
use std::path::Path;
use touchline::app::session::Saving;
use touchline::app::{Action, App, Navigation, TrainerActivity};
use touchline::document::FrameStatus;
use touchline_core::testing::child::spawn_test;

const CHILD_FILE: &str = "TOUCHLINE_TEST_KILLED_FILE";

fn suggested_frame(app: &App) -> Option<usize> {
    app.open()?
        .document
        .frames
        .iter()
        .position(|frame| frame.status == FrameStatus::Suggested)
}

fn is_done(app: &App) -> bool {
    let status = &app.session.trainer.status;
    status.doing == TrainerActivity::Nothing && status.forest.is_some()
}

/// What the forest proposed and a person accepted: pan by frame.
fn accepted_pans(app: &App) -> BTreeMap<usize, f64> {
    let frames = app.open().unwrap().document.frames.iter().enumerate();
    let labels =
        frames.filter(|(_, frame)| frame.status == FrameStatus::Reference && frame.is_suggestion());
    labels
        .map(|(index, frame)| (index, frame.ptz.as_ref().unwrap().pan_deg))
        .collect()
}

/// Not a test by itself: the program that the next test kills. It says what it does, and what of it
/// is on disk.
#[test]
fn child_that_accepts_until_it_is_killed() {
    let Some(file) = std::env::var_os(CHILD_FILE) else {
        return;
    };
    let mut headless = Headless::open(Path::new(&file));
    headless.wait_until("the trainer", |app| {
        app.session.trainer.status.references > 0
    });
    println!("begun");
    loop {
        headless.wait_until("a proposal", |app| {
            suggested_frame(app).is_some() || is_done(app)
        });
        let Some(frame) = suggested_frame(&headless.app) else {
            break;
        };
        println!("proposed");
        headless.act(Action::Navigate(Navigation::GoTo(frame)));
        headless.act(Action::Command(touchline::app::Command::AcceptAndStay));
        headless.wait_until("the journal", |app| {
            matches!(app.session.disk.saving, Saving::Saved { .. })
        });
        println!("accepted {frame} {}", accepted_pans(&headless.app)[&frame]);
    }
    println!("done");
    std::thread::sleep(std::time::Duration::from_mins(1));
}

/// Runs the program until it has said something, kills it, and returns the last it said was
/// accepted.
fn kill_after(file: &Path, said: &str) -> BTreeMap<usize, f64> {
    let told = [(CHILD_FILE, file.to_str().unwrap())];
    let (mut child, lines) = spawn_test(
        "robustness::killed::child_that_accepts_until_it_is_killed",
        told,
    );
    let mut lines = lines.map_while(Result::ok);
    let mut accepted = BTreeMap::new();
    let mut note = |line: &str| {
        let words: Vec<&str> = line
            .split_whitespace()
            .skip_while(|word| *word != "accepted")
            .collect();
        if let [_, frame, pan_deg] = words[..] {
            accepted.insert(frame.parse().unwrap(), pan_deg.parse().unwrap());
        }
    };
    let heard = lines
        .by_ref()
        .inspect(|line| note(line))
        .any(|line| line.contains(said));
    assert!(heard, "the program never said {said:?}");
    child.kill().unwrap();
    lines.for_each(|line| note(&line));
    child.wait().unwrap();
    accepted
}

#[test]
fn what_was_accepted_survives_a_kill_and_the_forest_is_read_or_made_again() {
    let place = tempfile::tempdir().unwrap();
    drawn_match(place.path());
    let file = place.path().join("match/ask.json");
    let mut acknowledged = BTreeMap::new();
    for (round, said) in ["begun", "proposed", "accepted", "done"]
        .into_iter()
        .enumerate()
    {
        acknowledged.extend(kill_after(&file, said));
        let mut headless = Headless::open(&file);
        let found = accepted_pans(&headless.app);
        let lost: Vec<_> = acknowledged
            .iter()
            .filter(|(frame, pan_deg)| found.get(frame) != Some(pan_deg))
            .collect();
        assert!(
            lost.is_empty(),
            "killed after {said:?}: {lost:?} of {acknowledged:?} are lost, {found:?}"
        );
        acknowledged = found;
        headless.wait_until("the forest", is_done);
        let status = &headless.app.session.trainer.status;
        assert_eq!(
            (status.trouble.as_ref(), status.training_frames),
            (None, 5),
            "killed after {said:?}"
        );
        assert_eq!(
            status.withheld,
            acknowledged.len(),
            "accepted suggestions are not used for training"
        );
        if round > 0 {
            assert_eq!(
                status.forest.unwrap().took,
                None,
                "the forest of an earlier session serves"
            );
        }
        assert!(headless.runner.close().is_empty());
        let checked = touchline(file.parent().unwrap(), "check ask.json");
        assert_eq!(
            checked.code, 0,
            "killed after {said:?}: {}{}",
            checked.stdout, checked.stderr
        );
    }
    assert!(
        acknowledged.len() >= 3,
        "the program did accept: {acknowledged:?}"
    );
}
