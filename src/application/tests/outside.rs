//! Another program replaces the document while it is open: whatever is chosen, no edit of a person
//! is lost.

use crate::headless::{Headless, project_of};
use crate::kept_edits::copy_files;
use std::fs;
use std::path::{Path, PathBuf};
use tempfile::TempDir;
use touchline_application::app::session::{Dialog, Leaving, Saving};
use touchline_application::app::{
    Action, Command, EditAction, Navigation, Opening, OutsideChoice, PointerAction, ViewAction,
};
use touchline_application::jobs::Request;
use touchline_application::testing::{base, landmark_in};
use touchline_calibration::calibrate::check_solutions;
use touchline_core::camera::CameraBase;
use touchline_core::geometry::Vec3;
use touchline_core::testing::{SIZE, TestBase};
use touchline_documents::document::{
    Document, Frame, FrameStatus, Solution, SolutionSource, Target, document_to_string,
};
use touchline_documents::store::read;
use touchline_documents::testing::{WithFrames, load, match_from, ptz_at};

pub fn new_project(frames: usize) -> (TempDir, PathBuf) {
    project_of(&match_from(&base(), SIZE).with_numbered(frames, SIZE))
}

/// Clicks two landmarks in a frame and accepts it.
pub fn accept(headless: &mut Headless, frame: usize, pan_deg: f64) {
    headless.act(Action::Navigate(Navigation::GoTo(frame)));
    let camera = base().aim(pan_deg, -14.0, 2300.0);
    for landmark in ["centre_mark", "halfway_far"] {
        headless.act(Action::Pointer(PointerAction::Press {
            at: landmark_in(&camera, landmark),
            on: None,
        }));
        headless.act(Action::Pointer(PointerAction::Release));
        let click = headless.app.frame().unwrap().clicks.len() - 1;
        headless.act(Action::Edit(EditAction::Name {
            click,
            target: Target::Landmark(landmark.into()),
        }));
    }
    headless.act(Action::Command(Command::AcceptAndStay));
    assert_eq!(
        headless.app.open().unwrap().document.frames[frame].status,
        FrameStatus::Reference
    );
}

/// What the window says of the edits that lie beside the document.
fn orphaned_edits(headless: &Headless) -> Vec<String> {
    let orphans = headless.app.session.disk.orphans.iter();
    orphans.flat_map(|orphan| orphan.edits.clone()).collect()
}

fn save(headless: &mut Headless) {
    let whole = |app: &touchline_application::app::App| {
        app.session.disk.changed_outside.is_some()
            || matches!(app.session.disk.saving, Saving::Saved { .. })
                && app.open().is_some_and(is_written)
    };
    headless.act(Action::Command(Command::Save));
    headless.wait_until("saving", whole);
}

/// Whether the file holds what the window shows.
pub fn is_written(open: &touchline_application::app::OpenProject) -> bool {
    read(&open.file).is_ok_and(|(_, document, recovery)| {
        recovery.is_empty() && document.frames == open.document.frames
    })
}

/// Another program edits the file.
fn write_outside(path: &Path, edit: impl FnOnce(&mut Document)) -> Vec<u8> {
    let file = path.join("project.json");
    let mut document = load(&file);
    edit(&mut document);
    let text = document_to_string(&document).unwrap();
    fs::write(&file, &text).unwrap();
    text.into_bytes()
}

fn on_disk(path: &Path) -> Document {
    load(path.join("project.json"))
}

fn statuses(document: &Document) -> Vec<FrameStatus> {
    document.frames.iter().map(|frame| frame.status).collect()
}

/// A window that accepted frame 0 and saved, and whose document another program then set back to
/// how it was opened, with a comment on frame 1.
fn set_back(path: &Path) -> Headless {
    let before = fs::read(path.join("project.json")).unwrap();
    let mut headless = Headless::open(path);
    accept(&mut headless, 0, -4.0);
    save(&mut headless);
    assert_eq!(on_disk(path).frames[0].status, FrameStatus::Reference);
    fs::write(path.join("project.json"), before).unwrap();
    write_outside(path, |document| {
        document.frames[1].comment = Some("theirs".to_owned());
    });
    headless
}

fn ask(headless: &mut Headless) {
    headless.act(Action::Command(Command::Save));
    headless.wait_until("the question", |app| {
        app.session.dialog == Some(Dialog::ChangedOutside)
    });
}

#[test]
fn an_edit_after_another_programs_change_keeps_all_that_the_window_has() {
    let (_root, path) = new_project(2);
    let before = fs::read(path.join("project.json")).unwrap();
    let mut headless = Headless::open(&path);
    accept(&mut headless, 0, -4.0);
    save(&mut headless);
    // Their version has the label, so that there is nothing to keep beside it.
    write_outside(&path, |document| {
        document.frames[1].comment = Some("theirs".to_owned());
    });
    ask(&mut headless);
    assert!(!path.join("project.json.mine-1").exists());
    headless.act(Action::View(ViewAction::CloseDialog));
    headless.act(Action::Edit(EditAction::SetComment("mine".to_owned())));
    headless.wait_until("the own version", |app| {
        app.session.disk.own_version.is_some()
    });
    // The next change takes the label away, and the window is killed before it looks again.
    fs::write(path.join("project.json"), before).unwrap();
    let left = tempfile::tempdir().unwrap();
    copy_files(&path, left.path());
    drop(headless);
    let own = load(left.path().join("project.json.mine-1"));
    assert_eq!(statuses(&own), [FrameStatus::Reference, FrameStatus::New]);
    assert_eq!(own.frames[0].comment.as_deref(), Some("mine"));
}

#[test]
fn replace_it_replaces_what_another_program_wrote_although_nothing_was_edited_since() {
    let (_root, path) = new_project(2);
    let mut headless = set_back(&path);
    let theirs = fs::read(path.join("project.json")).unwrap();
    ask(&mut headless);
    headless.act(Action::ResolveOutside(OutsideChoice::Replace));
    headless.wait_until("replacing", |app| {
        app.session.disk.changed_outside.is_none()
    });
    assert_eq!(
        on_disk(&path).frames,
        headless.app.open().unwrap().document.frames
    );
    assert_eq!(
        statuses(&on_disk(&path)),
        [FrameStatus::Reference, FrameStatus::New]
    );
    assert_eq!(
        fs::read(path.join("project.json.outside-1")).unwrap(),
        theirs
    );
    assert!(
        !path.join("project.json.mine-1").exists(),
        "the document holds it"
    );
    assert!(headless.app.session.disk.orphans.is_empty());
}

#[test]
fn what_the_window_holds_is_kept_beside_as_soon_as_a_change_is_seen() {
    let (_root, path) = new_project(2);
    let mut headless = set_back(&path);
    ask(&mut headless);
    let own = load(path.join("project.json.mine-1"));
    assert_eq!(own.frames, headless.app.open().unwrap().document.frames);
    assert_eq!(orphaned_edits(&headless), ["Changes in 0.jpg"]);
    // Edits that come after it are kept as well.
    headless.act(Action::View(ViewAction::CloseDialog));
    headless.act(Action::Navigate(Navigation::GoTo(1)));
    headless.act(Action::Edit(EditAction::SetComment("mine".to_owned())));
    headless.act(Action::ResolveOutside(OutsideChoice::TakeTheirs));
    headless.wait_until("the other version", |app| {
        app.open().unwrap().document.frames[1].comment.as_deref() == Some("theirs")
    });
    let [orphan] = &headless.app.session.disk.orphans[..] else {
        panic!("{:?}", headless.app.session.disk.orphans)
    };
    assert_eq!(orphan.edits, ["Changes in 0.jpg", "Changes in 1.jpg"]);
    let orphan = orphan.path.clone();
    headless.act(Action::MergeOrphan(orphan));
    headless.wait_until("merging", |app| app.session.disk.orphans.is_empty());
    let document = &headless.app.open().unwrap().document;
    assert_eq!(
        (document.frames[0].status, document.frames[0].clicks.len()),
        (FrameStatus::Reference, 2)
    );
    assert_eq!(
        document.frames[1].comment.as_deref(),
        Some("mine"),
        "both wrote one: the edits win"
    );
    assert!(
        path.join("project.json.merged-1").exists()
            && !path.join("project.json.mine-1.base").exists()
    );
}

#[test]
fn merging_with_an_earlier_state_keeps_what_was_saved_since() {
    let (_root, path) = new_project(2);
    let mut headless = set_back(&path);
    ask(&mut headless);
    headless.act(Action::ResolveOutside(OutsideChoice::Merge));
    headless.wait_until("merging", |app| app.session.disk.changed_outside.is_none());
    let document = on_disk(&path);
    assert_eq!(
        (document.frames[0].status, document.frames[0].clicks.len()),
        (FrameStatus::Reference, 2)
    );
    assert_eq!(document.frames[1].comment.as_deref(), Some("theirs"));
    assert!(
        headless.app.session.offers(Command::Undo),
        "{:?}",
        headless.app.session.messages.notices
    );
}

#[test]
fn leaving_the_document_asks_and_keeps_what_another_program_replaced() {
    let (_other_root, other) = new_project(1);
    for (way, leaving) in [
        Leaving::Close,
        Leaving::Close,
        Leaving::Open(Opening::Path(other.clone())),
    ]
    .into_iter()
    .enumerate()
    {
        let leave = || match way {
            0 => Action::CloseRequested,
            1 => Action::Command(Command::Quit),
            _ => Action::Open(other.clone()),
        };
        let (_root, path) = new_project(2);
        let mut headless = set_back(&path);
        headless.act(leave());
        headless.wait_until("the question", |app| {
            app.session.dialog == Some(Dialog::ChangedOutside)
        });
        assert!(
            headless.app.session.disk.opening.is_none()
                && !headless.requests.contains(&Request::Close)
        );
        assert!(path.join("project.json.mine-1").exists());
        headless.act(Action::View(ViewAction::CloseDialog));
        headless.act(leave());
        assert_eq!(
            headless.app.session.dialog,
            Some(Dialog::NotSaved(leaving.clone())),
            "nothing goes unasked"
        );
        headless.act(Action::LeaveUnsaved);
        if leaving == Leaving::Close {
            assert!(headless.requests.contains(&Request::Close));
            headless.runner.close();
        } else {
            headless.wait_until("opening", |app| {
                app.open().unwrap().document.frames.len() == 1
            });
        }
        let again = Headless::open(&path);
        assert_eq!(orphaned_edits(&again), ["Changes in 0.jpg"]);
    }
}

#[test]
fn opening_another_project_after_saving_still_opens_it() {
    let (_root, path) = new_project(2);
    let (_other_root, other) = new_project(1);
    let mut headless = Headless::open(&path);
    accept(&mut headless, 0, -4.0);
    headless.act(Action::Open(other));
    headless.wait_until("opening", |app| {
        app.open().unwrap().document.frames.len() == 1
    });
    assert_eq!(on_disk(&path).frames[0].status, FrameStatus::Reference);
}

/// Shows a proposal in a frame, as the program writes it.
fn propose(frame: &mut Frame) {
    frame.ptz = ptz_at(1.0, -9.0, 900.0);
    frame.status = FrameStatus::Suggested;
    let solution = Solution {
        source: Some(SolutionSource::Forest),
        confidence: Some(0.3),
        ..Solution::default()
    };
    frame.solution = Some(solution);
}

#[test]
fn a_proposal_beats_no_label_of_another_person() {
    let (_root, path) = new_project(3);
    write_outside(&path, |document| {
        document.frames.iter_mut().for_each(|frame| propose(frame));
    });
    let mut headless = Headless::open(&path);
    headless.act(Action::Navigate(Navigation::GoTo(2)));
    headless.act(Action::Edit(EditAction::SetComment("mine".to_owned())));
    headless.wait_until_saved();
    // The colleague accepts the first two.
    let accepted = {
        let (_root, path) = new_project(3);
        let mut other = Headless::open(&path);
        accept(&mut other, 0, -4.0);
        accept(&mut other, 1, -6.0);
        other.app.open().unwrap().document.clone()
    };
    write_outside(&path, |document| {
        for at in 0..2 {
            document.frames[at] = accepted.frames[at].clone();
        }
    });
    ask(&mut headless);
    headless.act(Action::ResolveOutside(OutsideChoice::Merge));
    headless.wait_until("merging", |app| app.session.disk.changed_outside.is_none());
    let document = on_disk(&path);
    assert_eq!(
        statuses(&document),
        [
            FrameStatus::Reference,
            FrameStatus::Reference,
            FrameStatus::Suggested
        ]
    );
    assert_eq!(
        (
            document.frames[0].clicks.len(),
            document.frames[2].comment.as_deref()
        ),
        (2, Some("mine"))
    );
}

#[test]
fn a_reference_is_solved_again_where_the_merge_takes_another_base() {
    let (_root, path) = new_project(2);
    let mut headless = Headless::open(&path);
    accept(&mut headless, 0, -4.0);
    headless.wait_until_saved();
    let moved = CameraBase {
        position_m: Vec3::new(6.0, -60.0, 19.0),
        ..base()
    };
    write_outside(&path, |document| document.cameras[0].set_base(&moved));
    ask(&mut headless);
    headless.act(Action::ResolveOutside(OutsideChoice::Merge));
    headless.wait_until("merging", |app| app.session.disk.changed_outside.is_none());
    let document = on_disk(&path);
    assert_eq!(
        document.cameras[0].base().unwrap().position_m,
        moved.position_m
    );
    assert_eq!(document.frames[0].status, FrameStatus::Reference);
    assert_eq!(check_solutions(document.at(&path)), []);
    let mut stale = document.clone();
    stale.cameras[0].set_base(&base());
    assert_eq!(
        check_solutions(stale.at(&path)).len(),
        1,
        "check names what the base does not give"
    );
}
