//! A base from real clicks in the application.

use crate::headless::Headless;
use crate::parts::{Test, frames_folder, tests};
use touchline::app::base::BaseWork;
use touchline::app::{Action, Command};

pub const TESTS: &[Test] = tests![
    [Frames] real_frames_from_their_clicks_alone;
];

fn real_frames_from_their_clicks_alone() {
    let folder = tempfile::tempdir().unwrap();
    let project = folder.path().join("project.json");
    std::fs::copy(frames_folder().join("scouting-d82e7a/clicks.json"), &project).unwrap();
    let mut desk = Headless::new();
    desk.act(Action::Open(project));
    desk.wait_until("opening", |app| app.open().is_some());
    desk.act(Action::Command(Command::EstimateBase));
    desk.wait_until("the estimate", |app| !matches!(app.session.base, BaseWork::Estimating(_)));
    let estimate = &desk.app.session.base.proposed().unwrap().estimate;
    assert!(estimate.median_px < 3.5, "{}", estimate.median_px);
    desk.act(Action::Command(Command::UseEstimatedBase));
    let frames = &desk.app.open().unwrap().document.frames;
    let solved = frames.iter().filter(|frame| frame.is_solved_by_clicks()).count();
    assert!(solved * 10 >= frames.len() * 9, "{solved} of {}", frames.len());
}
