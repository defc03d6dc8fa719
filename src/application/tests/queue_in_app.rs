//! A queue of matches: opened from a file or from dropped paths, and worked through.

use crate::headless::Headless;
use std::fs;
use std::path::{Path, PathBuf};
use touchline_application::app::{Action, App, Command, ReviewQueue};
use touchline_application::scene::match_list::MatchState;
use touchline_core::geometry::ImageSize;
use touchline_documents::document::FrameStatus;
use touchline_documents::testing::{WithFrames, load, save, soccer_document};
use touchline_season::queue::Queue;

/// A file that is no video, two projects of two frames, and a folder of two pictures.
fn matches(root: &Path) -> [PathBuf; 4] {
    let paths = ["broken.mp4", "one", "two", "frames"].map(|name| root.join(name));
    let [broken, one, two, frames] = &paths;
    fs::write(broken, "no video").unwrap();
    for folder in [one, two, frames] {
        fs::create_dir(folder).unwrap();
        for name in ["a.png", "b.png"] {
            image::RgbImage::new(64, 36)
                .save(folder.join(name))
                .unwrap();
        }
    }
    let document = soccer_document().with_pictures(["a.png", "b.png"], ImageSize::new(64, 36));
    for project in [one, two] {
        save(project.join("project.json"), &document);
    }
    paths
}

/// What the rows of the queue say.
fn rows(app: &App) -> Vec<String> {
    let rows = app.queue().map(ReviewQueue::rows).unwrap_or_default();
    let says = |state: &MatchState| state.describe();
    rows.iter()
        .map(|row| row.state.as_ref().map(says).unwrap_or_default())
        .collect()
}

/// Whether the project in a folder is open.
fn shows(app: &App, folder: &Path) -> bool {
    let file = folder.join("project.json");
    app.open().is_some_and(|open| open.file == file)
}

#[test]
fn dropped_matches_are_worked_through_past_one_that_is_broken() {
    let root = tempfile::tempdir().unwrap();
    let root = root.path().canonicalize().unwrap();
    let [broken, one, two, frames] = matches(&root);
    let mut headless = Headless::new();
    let paths = vec![broken, one.clone(), two.clone(), frames.clone()];
    headless.act(Action::OpenAny(paths));
    headless.wait_until("the first that opens", |app| shows(app, &one));
    headless.wait_until("a look at all", |app| {
        rows(app).iter().all(|says| !says.is_empty())
    });
    let says = rows(&headless.app);
    assert!(says[0].starts_with("failed: "), "{says:?}");
    assert_eq!(says[1..], ["no camera yet", "no camera yet", "not begun"]);
    assert_eq!(headless.app.queue().unwrap().at(), 1);

    headless.act(Action::Command(Command::NextMatch));
    headless.wait_until("the second", |app| shows(app, &two));
    // What is changed is saved before the next one opens, and its row shows it.
    headless.wait_for_picture();
    headless.act(Action::Command(Command::Reject));
    headless.act(Action::Edit(
        touchline_application::app::EditAction::RejectAs(
            touchline_documents::document::RejectReason::Blur,
        ),
    ));
    headless.act(Action::Command(Command::NextMatch));
    let made = root.join("frames.touchline");
    headless.wait_until("the third, made", |app| shows(app, &made));
    assert_eq!(
        load(two.join("project.json")).frames[0].status,
        FrameStatus::Rejected
    );
    assert_eq!(rows(&headless.app)[3], "no camera yet");
    headless.act(Action::Command(Command::NextMatch));
    assert!(shows(&headless.app, &made), "it is the last");
    headless.act(Action::OpenMatch(1));
    headless.wait_until("the one that was clicked", |app| shows(app, &one));
}

#[test]
fn a_queue_file_opens_however_it_is_laid_out_and_bad_ones_say_why() {
    let root = tempfile::tempdir().unwrap();
    let root = root.path().canonicalize().unwrap();
    let [_, one, two, _] = matches(&root);
    let queue = Queue::from_paths(&[one.clone(), two])
        .unwrap()
        .relative_to(&root);
    let value: serde_json::Value = serde_json::from_str(&queue.to_text()).unwrap();
    let file = root.join("queue.json");
    fs::write(&file, serde_json::to_string_pretty(&value).unwrap()).unwrap();
    let mut headless = Headless::open(&file);
    assert!(shows(&headless.app, &one));
    headless.wait_until("a look at all", |app| rows(app) == ["no camera yet"; 2]);

    for (text, says) in [
        (
            r#"{"format": "touchline queue", "version": 1}"#,
            "no match and no frame",
        ),
        (r#"{"format": "touchline queue", "#, "is not a queue"),
        (
            r#"{"format": "touchline queue", "version": 1,
                "matches": [{"match": "a", "project": "gone/project.json"}]}"#,
            "gone",
        ),
    ] {
        fs::write(&file, text).unwrap();
        let mut headless = Headless::new();
        headless.act(Action::Open(file.clone()));
        headless.wait_for_notice("the reason", says);
        assert!(headless.app.open().is_none() && headless.app.queue().is_none());
    }
}
