//! Undo survives closing the window, a kill and another program's changes: by actions, with files
//! on disk.

use crate::headless::{Headless, project_of};
use std::fs;
use std::path::{Path, PathBuf};
use tempfile::TempDir;
use touchline_application::app::session::Saving;
use touchline_application::app::{
    Action, Command, EditAction, Navigation, OutsideChoice, PointerAction,
};
use touchline_application::testing::{base, landmark_in, without_counts};
use touchline_core::geometry::{ImagePoint, Vec3};
use touchline_core::testing::child::{numbers_behind, spawn_test};
use touchline_core::testing::{SIZE, TestBase, pixel_box};
use touchline_documents::document::{
    Camera, Document, FieldSpec, RejectReason, Target, document_to_string,
};
use touchline_documents::testing::{WithFrames, load, match_from};

fn document(frames: usize) -> Document {
    let names = (0..frames).map(|index| format!("images/{index:04}.jpg"));
    match_from(&base(), SIZE).with_pictures(names, SIZE)
}

fn new_project(frames: usize) -> (TempDir, PathBuf) {
    project_of(&document(frames))
}

fn notices(headless: &Headless) -> Vec<&str> {
    headless
        .app
        .session
        .messages
        .notices
        .iter()
        .map(|notice| notice.text.as_str())
        .collect()
}

impl Headless {
    fn document(&self) -> Document {
        without_counts(&self.app.open().unwrap().document)
    }

    /// Clicks where the truth sees a landmark, and names it.
    fn place(&mut self, landmark: &str) {
        let camera = base().aim(-4.0, -14.0, 2300.0);
        let at = landmark_in(&camera, landmark);
        self.act(Action::Pointer(PointerAction::Press { at, on: None }));
        self.act(Action::Pointer(PointerAction::Release));
        let click = self.app.frame().unwrap().clicks.len() - 1;
        self.act(Action::Edit(EditAction::Name {
            click,
            target: Target::Landmark(landmark.into()),
        }));
    }

    fn drag(&mut self, click: usize) {
        let at = self.app.frame().unwrap().clicks[click].image;
        self.act(Action::Pointer(PointerAction::Press {
            at,
            on: Some(click),
        }));
        for step in 1..9 {
            self.act(Action::Pointer(PointerAction::Drag(ImagePoint::new(
                at.x + f64::from(step),
                at.y,
            ))));
        }
        self.act(Action::Pointer(PointerAction::Release));
    }

    fn comment(&mut self, frame: usize, text: &str) {
        self.act(Action::Navigate(Navigation::GoTo(frame)));
        self.act(Action::Edit(EditAction::SetComment(text.to_owned())));
    }

    /// Takes one step back or does it again; false where there is none.
    fn undo(&mut self, command: Command) -> bool {
        let next = |headless: &Self| {
            let history = &headless.app.open().unwrap().history;
            if command == Command::Undo {
                history.next_undo().cloned()
            } else {
                history.next_redo().cloned()
            }
        };
        let Some(step) = next(self) else { return false };
        let frame = step
            .frame
            .and_then(|id| self.app.open().unwrap().document.frames.position_of(&id));
        self.act(Action::Navigate(Navigation::GoTo(
            frame.unwrap_or(self.app.session.frame),
        )));
        self.act(Action::Command(command));
        true
    }

    /// The documents along every step back, or on.
    fn all(&mut self, command: Command) -> Vec<Document> {
        let mut documents = vec![self.document()];
        while self.undo(command) {
            documents.push(self.document());
        }
        documents
    }

    fn close(mut self) {
        // Where another program's version is kept may still be said; nothing is left unsaved.
        let said = self.runner.close();
        assert!(
            said.iter().all(|action| matches!(action, Action::View(_))),
            "{said:?}"
        );
    }
}

/// One edit of each kind.
fn edit_in_many_ways(headless: &mut Headless) {
    headless.place("centre_mark");
    headless.place("halfway_far");
    headless.drag(1);
    headless.act(Action::Navigate(Navigation::Select(Some(0))));
    for _ in 0..3 {
        headless.act(Action::Edit(EditAction::Nudge {
            dx_px: 0.25,
            dy_px: 0.0,
            held: true,
        }));
    }
    headless.comment(1, "rain");
    headless.act(Action::Navigate(Navigation::GoTo(2)));
    headless.act(Action::Edit(EditAction::RejectAs(RejectReason::CloseUp)));
    headless.act(Action::Edit(EditAction::AddMask {
        of_camera: true,
        mask: pixel_box(10.0, 20.0, 300.0, 80.0),
    }));
    // The base moves, and with it what the clicks of the first frame say.
    let mut camera = Camera::clone(&headless.app.open().unwrap().document.cameras[0]);
    let mut moved = base();
    moved.position_m += Vec3::new(0.0, -1.0, 0.5);
    camera.set_base(&moved);
    headless.act(Action::Edit(EditAction::Begin("Move camera")));
    headless.act(Action::Edit(EditAction::Camera(Box::new(camera))));
    headless.act(Action::Edit(EditAction::End));
    let mut longer = FieldSpec::new("soccer");
    longer.params.insert("length_m".to_owned(), 103.5);
    headless.act(Action::Edit(EditAction::Begin("Change field")));
    headless.act(Action::Edit(EditAction::Field(longer)));
    headless.act(Action::Edit(EditAction::End));
}

#[test]
fn every_step_of_earlier_sessions_is_undone_and_redone() {
    let (_root, path) = new_project(4);
    let mut headless = Headless::open(&path);
    edit_in_many_ways(&mut headless);
    // Another program adds frames, which are taken in.
    let theirs = {
        let mut theirs = document(4);
        theirs
            .frames
            .extend(document(6).frames.iter().skip(4).cloned());
        document_to_string(&theirs).unwrap()
    };
    fs::write(path.join("project.json"), theirs).unwrap();
    headless.act(Action::Command(Command::Save));
    headless.wait_until("the other version", |app| {
        app.session.disk.changed_outside.is_some()
    });
    headless.act(Action::ResolveOutside(OutsideChoice::Merge));
    headless.wait_until("the merge", |app| {
        app.open().unwrap().document.frames.len() == 6
    });
    headless.comment(5, "from outside");
    headless.comment(0, "taken back");
    assert!(headless.undo(Command::Undo));
    headless.wait_until_saved();
    let last = headless.document();
    let open = headless.app.open().unwrap();
    let (document, history) = (open.document.clone(), open.history.clone());
    headless.close();

    let mut again = Headless::open(&path);
    assert_eq!(
        (&again.app.open().unwrap().history, &again.document()),
        (&history, &last)
    );
    assert_eq!(
        *again.app.open().unwrap().document,
        document,
        "with its counts"
    );
    let redone = again.all(Command::Redo);
    assert_eq!(redone.len(), 2, "what was taken back is done again");
    let back = again.all(Command::Undo);
    assert!(back.len() >= 14, "{}", back.len());
    assert_eq!(
        back.last().unwrap(),
        &without_counts(&self::document(4)),
        "as it was when it was made"
    );
    again.close();

    // Forward again in a third session, and what is written is what was written.
    let mut third = Headless::open(&path);
    let mut forward = third.all(Command::Redo);
    forward.reverse();
    assert_eq!(forward, back);
    assert!(third.undo(Command::Undo));
    assert_eq!(third.document(), last);
    third.close();
    let written = load(path.join("project.json"));
    assert_eq!(
        document_to_string(&without_counts(&written)).unwrap(),
        document_to_string(&last).unwrap()
    );
}

#[test]
fn steps_that_lead_to_another_version_are_left_out_and_said_so() {
    let (_root, path) = new_project(2);
    let mut headless = Headless::open(&path);
    headless.comment(0, "ours");
    headless.close();
    let file = path.join("project.json");
    fs::write(
        &file,
        fs::read_to_string(&file).unwrap().replace("ours", "theirs"),
    )
    .unwrap();
    let mut other = Headless::open(&path);
    let notice =
        "Steps of earlier sessions cannot be undone: they lead to another version of the document.";
    assert_eq!(notices(&other), [notice]);
    assert!(other.app.open().unwrap().history.is_empty());
    other.comment(1, "new");
    other.close();
    let mut again = Headless::open(&path);
    assert!(notices(&again).is_empty());
    assert_eq!(
        again.all(Command::Undo).len(),
        2,
        "from the other version on"
    );
}

#[test]
fn a_document_to_look_at_only_offers_no_undo() {
    let (_root, path) = new_project(2);
    let mut headless = Headless::open(&path);
    headless.comment(0, "rain");
    headless.wait_until_saved();
    let second = Headless::open(&path);
    let open = second.app.open().unwrap();
    assert!(open.read_only.is_some() && open.history.is_empty());
    assert_eq!(second.document(), headless.document());
}

const CHILD_FOLDER: &str = "TOUCHLINE_TEST_UNDO_FOLDER";

/// Not a test by itself: the program that the next test kills. It edits, takes back and saves for
/// ever, and says how many steps can be undone by what is on disk.
#[test]
fn child_that_edits_until_it_is_killed() {
    let Some(path) = std::env::var_os(CHILD_FOLDER) else {
        return;
    };
    let mut headless = Headless::open(Path::new(&path));
    for number in 0.. {
        if number % 5 == 4 {
            assert!(headless.undo(Command::Undo));
        } else {
            // No comment that is there already.
            headless.comment(
                number % 3,
                &format!("{number} of process {}", std::process::id()),
            );
        }
        if number % 3 == 0 {
            headless.act(Action::Command(Command::Save));
        }
        headless.wait_until("the journal", |app| {
            matches!(app.session.disk.saving, Saving::Saved { .. })
        });
        let open = headless.app.open().unwrap();
        println!(
            "undoable {}",
            open.history.undo_edits(&open.document).count()
        );
    }
}

#[test]
fn undo_survives_a_kill() {
    let (_root, path) = new_project(3);
    let start = without_counts(&document(3));
    for round in 0..6 {
        let (mut child, lines) = spawn_test(
            "undo_in_app::child_that_edits_until_it_is_killed",
            [(CHILD_FOLDER, path.to_str().unwrap())],
        );
        let mut counts = numbers_behind("undoable ", lines);
        let mut steps: Vec<usize> = counts.by_ref().take(4 + round).collect();
        child.kill().unwrap();
        steps.extend(counts);
        child.wait().unwrap();
        let mut headless = Headless::open(&path);
        let found = headless.all(Command::Undo);
        // The last edit may be on disk without having been acknowledged.
        let acknowledged = *steps.last().unwrap();
        assert!(
            (found.len() - 1).abs_diff(acknowledged) <= 1,
            "round {round}: {acknowledged} steps, {}",
            found.len() - 1
        );
        assert_eq!(found.last().unwrap(), &start, "round {round}");
        let forward = headless.all(Command::Redo);
        assert!(
            forward.iter().take(found.len()).rev().eq(found.iter()),
            "round {round}"
        );
        // The next round goes on from the middle.
        for _ in 0..2 {
            headless.undo(Command::Undo);
        }
        headless.close();
    }
}
