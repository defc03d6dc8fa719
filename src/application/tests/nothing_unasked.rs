//! Nothing is lost unasked: saving that fails, another program's changes, edits of another version.

use crate::headless::{Headless, project_of};
use std::fs;
use std::path::{Path, PathBuf};
use tempfile::TempDir;
use touchline_application::app::session::{Dialog, Leaving, Saving};
use touchline_application::app::{
    Action, Command, EditAction, Navigation, Opening, OutsideChoice, Question, ViewAction,
};
use touchline_application::jobs::Request;
use touchline_core::testing::HD;
use touchline_documents::document::Document;
use touchline_documents::store::{Access, open, read};
use touchline_documents::testing::{WithFrames, save, soccer_document};

const FRAMES: [&str; 3] = ["a.jpg", "b.jpg", "c.jpg"];

fn new_project() -> (TempDir, PathBuf) {
    project_of(&soccer_document().with_pictures(FRAMES, HD))
}

/// Writes a comment on a frame.
fn comment(headless: &mut Headless, frame: usize, text: &str) {
    headless.act(Action::Navigate(Navigation::GoTo(frame)));
    headless.act(Action::Edit(EditAction::SetComment(text.to_owned())));
}

fn wait_until_saved(headless: &mut Headless) {
    headless.wait_until_saved();
}

fn comments(document: &Document) -> Vec<String> {
    document
        .frames
        .iter()
        .map(|frame| frame.comment.clone().unwrap_or_default())
        .collect()
}

/// Another program writes a comment on a frame into the file.
fn write_outside(path: &Path, frame: usize, text: &str) {
    let file = path.join("project.json");
    let bytes = fs::read(&file).unwrap();
    let mut document = touchline_documents::document::document_from_bytes(&bytes).unwrap();
    document.frames[frame].comment = Some(text.to_owned());
    save(&file, &document);
}

/// A window on a project whose disk takes nothing any more, with an edit that is only in memory.
fn with_a_refusing_disk(root: &TempDir, path: &Path) -> (Headless, PathBuf) {
    let mut headless = Headless::open(path);
    let away = root.path().join("away");
    fs::rename(path, &away).unwrap();
    comment(&mut headless, 0, "only in memory");
    headless.wait_until("the refusal", |app| {
        matches!(app.session.disk.saving, Saving::Failed { .. })
    });
    (headless, away)
}

#[test]
fn a_window_that_cannot_save_asks_before_it_closes_and_does_close() {
    let ways: [fn() -> Action; 2] = [|| Action::Command(Command::Quit), || Action::CloseRequested];
    for close in ways {
        let (root, path) = new_project();
        let (mut headless, _) = with_a_refusing_disk(&root, &path);
        for _ in 0..2 {
            headless.act(close());
            assert_eq!(
                headless.app.session.dialog,
                Some(Dialog::NotSaved(Leaving::Close))
            );
            assert!(
                !headless.requests.contains(&Request::Close),
                "nothing goes unasked"
            );
            headless.act(Action::View(ViewAction::CloseDialog));
        }
        headless.act(close());
        headless.act(Action::LeaveUnsaved);
        assert!(headless.requests.contains(&Request::Close), "it does close");
    }
}

#[test]
fn a_disk_that_refuses_only_while_the_window_closes_is_reported() {
    let (root, path) = new_project();
    let mut headless = Headless::open(&path);
    comment(&mut headless, 0, "in the journal");
    wait_until_saved(&mut headless);
    fs::rename(&path, root.path().join("away")).unwrap();
    headless.act(Action::CloseRequested);
    headless.wait_until("the question", |app| {
        app.session.dialog == Some(Dialog::NotSaved(Leaving::Close))
    });
    assert!(!headless.requests.contains(&Request::Close));
}

#[test]
fn a_disk_that_takes_again_what_it_refused_lets_the_window_close() {
    let (root, path) = new_project();
    let (mut headless, away) = with_a_refusing_disk(&root, &path);
    fs::rename(away, &path).unwrap();
    headless.act(Action::CloseRequested);
    headless.wait_until_saved();
    headless.wait_until("closing", |app| app.session.dialog.is_none());
    assert!(headless.requests.contains(&Request::Close));
    assert!(headless.runner.close().is_empty());
    assert_eq!(comments(&read(&path).unwrap().1)[0], "only in memory");
}

#[test]
fn a_copy_elsewhere_holds_everything() {
    let (root, path) = new_project();
    let (mut headless, _) = with_a_refusing_disk(&root, &path);
    let copy = root.path().join("copy");
    headless.answer(Question::CopyTo, &copy);
    headless.wait_until("the copy", |app| {
        app.session
            .messages
            .notices
            .iter()
            .any(|n| n.text.starts_with("Copy written"))
    });
    assert_eq!(comments(&read(&copy).unwrap().1)[0], "only in memory");
    headless.act(Action::CloseRequested);
    assert!(headless.requests.contains(&Request::Close) && headless.app.session.dialog.is_none());
}

#[test]
fn opening_another_document_asks_as_well() {
    let (root, path) = new_project();
    let (_other_root, other) = new_project();
    let (mut headless, _) = with_a_refusing_disk(&root, &path);
    headless.act(Action::Open(other.clone()));
    assert_eq!(
        headless.app.session.dialog,
        Some(Dialog::NotSaved(Leaving::Open(Opening::Path(
            other.clone()
        ))))
    );
    assert!(headless.app.session.disk.opening.is_none());
    headless.act(Action::LeaveUnsaved);
    headless.wait_until("opening", |app| {
        app.open()
            .unwrap()
            .file
            .starts_with(fs::canonicalize(&other).unwrap())
    });
}

#[test]
fn the_document_that_is_open_is_not_opened_again() {
    let (_root, path) = new_project();
    let mut headless = Headless::open(&path);
    comment(&mut headless, 1, "mine");
    for way in [
        path.clone(),
        path.join("project.json"),
        path.join("../match/project.json"),
    ] {
        headless.act(Action::Open(way));
        headless.wait_until("the word", |app| app.session.disk.opening.is_none());
        let notice = headless.app.session.messages.notices.last().unwrap();
        assert!(
            notice.text.ends_with("project.json is already open."),
            "{}",
            notice.text
        );
        assert_eq!(headless.app.open().unwrap().read_only, None);
    }
    comment(&mut headless, 2, "still mine");
    wait_until_saved(&mut headless);
    assert!(headless.runner.close().is_empty());
    assert_eq!(
        comments(&read(&path).unwrap().1),
        ["", "mine", "still mine"]
    );
}

/// A window whose document another program has changed: it commented b, the window a.
fn changed_outside(path: &Path) -> Headless {
    let mut headless = Headless::open(path);
    comment(&mut headless, 0, "mine");
    wait_until_saved(&mut headless);
    write_outside(path, 1, "theirs");
    headless.act(Action::Command(Command::Save));
    headless.wait_until("the question", |app| {
        app.session.dialog == Some(Dialog::ChangedOutside)
    });
    headless
}

fn kept_version(path: &Path) -> Vec<String> {
    comments(&read(&path.join("project.json.outside-1")).unwrap().1)
}

#[test]
fn changes_of_another_program_are_merged() {
    let (_root, path) = new_project();
    let mut headless = changed_outside(&path);
    headless.act(Action::ResolveOutside(OutsideChoice::Merge));
    headless.wait_until("merging", |app| app.session.disk.changed_outside.is_none());
    assert_eq!(
        comments(&headless.app.open().unwrap().document),
        ["mine", "theirs", ""]
    );
    assert_eq!(comments(&read(&path).unwrap().1), ["mine", "theirs", ""]);
    assert_eq!(kept_version(&path), ["", "theirs", ""]);
    headless.act(Action::Command(Command::Undo));
    assert_eq!(
        comments(&headless.app.open().unwrap().document),
        ["mine", "", ""],
        "one step of undo"
    );
}

#[test]
fn a_version_of_another_program_is_replaced_and_kept_beside() {
    let (_root, path) = new_project();
    let mut headless = changed_outside(&path);
    headless.act(Action::View(ViewAction::CloseDialog));
    headless.act(Action::CloseRequested);
    assert_eq!(
        headless.app.session.dialog,
        Some(Dialog::NotSaved(Leaving::Close)),
        "nothing goes unasked"
    );
    headless.act(Action::AskOutside);
    headless.act(Action::ResolveOutside(OutsideChoice::Replace));
    headless.wait_until("replacing", |app| {
        app.session.disk.changed_outside.is_none()
    });
    assert_eq!(comments(&read(&path).unwrap().1), ["mine", "", ""]);
    assert_eq!(kept_version(&path), ["", "theirs", ""]);
}

#[test]
fn edits_that_were_set_aside_are_taken_in_later_or_become_a_document() {
    let (_root, path) = new_project();
    let mut headless = changed_outside(&path);
    headless.act(Action::ResolveOutside(OutsideChoice::TakeTheirs));
    headless.wait_until("the other version", |app| {
        app.open().unwrap().document.frames[1].comment.is_some()
    });
    assert_eq!(
        comments(&headless.app.open().unwrap().document),
        ["", "theirs", ""]
    );
    let [orphan] = &headless.app.session.disk.orphans[..] else {
        panic!("{:?}", headless.app.session.disk.orphans)
    };
    let orphan = orphan.path.clone();
    assert!(
        headless
            .app
            .session
            .messages
            .notices
            .iter()
            .any(|n| n.text.starts_with("1 edit of another version"))
    );
    headless.act(Action::SaveOrphan(orphan.clone()));
    headless.wait_until("the document", |app| {
        app.session
            .messages
            .notices
            .iter()
            .any(|n| n.text.contains(".recovered-1.json"))
    });
    headless.act(Action::MergeOrphan(orphan));
    headless.wait_until("taking in", |app| app.session.disk.orphans.is_empty());
    assert_eq!(
        comments(&headless.app.open().unwrap().document),
        ["mine", "theirs", ""]
    );
    wait_until_saved(&mut headless);
    assert!(headless.runner.close().is_empty());
    let again = Headless::open(&path);
    assert!(again.app.session.disk.orphans.is_empty(), "offered once");
    let recovered = comments(&read(&path.join("project.json.recovered-1.json")).unwrap().1);
    assert_eq!(recovered[0], "mine");
}

#[test]
fn an_orphan_finds_the_version_it_starts_from() {
    let (_root, path) = new_project();
    let mut headless = Headless::open(&path);
    comment(&mut headless, 0, "mine");
    wait_until_saved(&mut headless);
    // The version that the edits start from is still there, under another name.
    fs::copy(path.join("project.json"), path.join("project.json.before")).unwrap();
    write_outside(&path, 0, "theirs");
    drop(headless);
    let Access::Writable(store) = open(&path).unwrap().access else {
        panic!("read-only")
    };
    let location = store.location().clone();
    let [orphan] = &touchline_documents::store::orphans(&location)[..] else {
        panic!("no orphan")
    };
    assert_eq!(orphan.edits.len(), 1);
    let edits = touchline_documents::store::read_orphan(&location, &orphan.path).unwrap();
    assert!(edits.base.is_some());
    let merged = edits.merge_with(&read(&path).unwrap().1);
    assert_eq!(
        (
            comments(&merged.document)[0].as_str(),
            &merged.conflicts[..]
        ),
        ("mine", &["a.jpg".to_owned()][..])
    );
}
