//! A base from real clicks in the application.

use crate::headless::Headless;
use crate::parts::{Test, frames_folder, tests};
use touchline::app::{Action, Command, Opened};

pub const TESTS: &[Test] = tests![
    [Frames] real_frames_from_their_clicks_alone;
];

fn real_frames_from_their_clicks_alone() {
    let (_, document, _) =
        touchline::store::read(&frames_folder().join("scouting-d82e7a/clicks.json")).unwrap();
    let mut fixture = Headless::new();
    fixture.act(Action::Opened(Box::new(Opened::new(
        document,
        "/match/project.json",
    ))));
    fixture.act(Action::Command(Command::EstimateBase));
    fixture.wait_until("the estimate", |app| {
        app.operations.base_estimate.running().is_none()
    });
    let estimate = &fixture
        .app
        .operations
        .base_estimate
        .proposed_base()
        .unwrap()
        .estimate;
    assert!(estimate.median_px < 3.5, "{}", estimate.median_px);
    // There is no disk behind this project: nothing is written.
    fixture
        .app
        .update(Action::Command(Command::UseEstimatedBase));
    let frames = &fixture.app.open().unwrap().document.frames;
    let solved = frames
        .iter()
        .filter(|frame| frame.is_solved_by_clicks())
        .count();
    assert!(
        solved * 10 >= frames.len() * 9,
        "{solved} of {}",
        frames.len()
    );
}
