//! A model of two people and a sync client at one document: whatever is edited, saved, replaced
//! outside, answered, killed, opened again and merged, in any order, each edit of a person stays in
//! the window, the document, a copy beside it or a journal, until that person takes it back.
//! `TOUCHLINE_SEQUENCES=10000` makes more of it; each sequence follows from its number.

use crate::headless::Headless;
use crate::outside::{accept, new_project};
use rand::RngExt;
use rand_pcg::Pcg64Mcg;
use std::collections::{BTreeMap, BTreeSet};
use std::ffi::OsString;
use std::fs;
use std::path::{Path, PathBuf};
use std::time::Duration;
use tempfile::TempDir;
use touchline_application::app::session::{Dialog, Notice, Saving};
use touchline_application::app::{
    Action, App, Command, EditAction, Navigation, OutsideChoice, TrainerReport, ViewAction,
};
use touchline_application::testing::proposed::proposal_in;
use touchline_application::testing::{base, landmark_in};
use touchline_calibration::calibrate::{check_solutions, solve_document};
use touchline_core::camera::{CameraBase, Ptz, PtzCamera};
use touchline_core::geometry::{ImagePoint, Vec3};
use touchline_core::progress::Progress;
use touchline_core::testing::SIZE;
use touchline_core::testing::seeded::rng;
use touchline_documents::document::{
    Click, Document, Frame, FrameStatus, document_from_bytes, document_to_string,
};

const FRAMES: usize = 4;
const STEPS: usize = 16;

/// How many sequences are tried.
fn sequences() -> usize {
    std::env::var("TOUCHLINE_SEQUENCES").map_or(24, |number| number.parse().unwrap())
}

/// A window on a project, a sync client beside it, and what people have done that must not get
/// lost.
struct World {
    random: Pcg64Mcg,
    folder: TempDir,
    other: PathBuf,
    _other_root: TempDir,
    window: Option<Headless>,
    /// What the sync client has seen of the document.
    seen: Vec<Vec<u8>>,
    /// The marks of edits that were not undone.
    live: BTreeSet<String>,
    /// Those of them that others have just written over: only the window has them, and has not seen
    /// it yet.
    exposed: BTreeSet<String>,
    made: usize,
    story: Vec<String>,
}

impl World {
    fn new(number: usize) -> Self {
        let (root, path) = new_project(FRAMES);
        let (other_root, other) = new_project(1);
        let mut window = Headless::open(&path);
        for frame in 0..2 {
            accept(&mut window, frame, -4.0 - frame as f64);
        }
        settle(&mut window);
        window.runner.close();
        drop(window);
        // Without the history: undo leaves these labels alone.
        let folder = tempfile::tempdir().unwrap();
        fs::copy(
            path.join("project.json"),
            folder.path().join("project.json"),
        )
        .unwrap();
        drop(root);
        let random = rng(&format!("kept_edits {number}"));
        let (window, seen) = (
            None,
            vec![fs::read(folder.path().join("project.json")).unwrap()],
        );
        Self {
            random,
            folder,
            other,
            _other_root: other_root,
            window,
            seen,
            live: BTreeSet::new(),
            exposed: BTreeSet::new(),
            made: 0,
            story: vec![format!("sequence {number}")],
        }
    }

    fn file(&self) -> PathBuf {
        self.folder.path().join("project.json")
    }

    fn mark(&mut self) -> String {
        self.made += 1;
        format!("mark-{:04}-", self.made)
    }

    fn tell(&mut self, what: impl Into<String>) {
        self.story.push(what.into());
    }

    /// One random step of the user, the trainer or another program.
    fn step(&mut self) {
        let Some(mut window) = self.window.take() else {
            if self.random.random_range(0..3) == 0 {
                self.write_outside();
            } else {
                self.tell("open");
                self.window = Some(Headless::open(self.folder.path()));
            }
            return;
        };
        let dialog = window.app.session.dialog.clone();
        match self.random.random_range(0..20) {
            _ if dialog == Some(Dialog::ChangedOutside) && self.random.random_range(0..4) > 0 => {
                self.answer(&mut window);
            }
            0..6 => self.edit(&mut window),
            6 => self.undo(&mut window),
            7..9 => self.propose(&mut window),
            9..12 => {
                self.tell("save");
                save(&mut window);
            }
            12..15 => {
                self.window = Some(window);
                return self.write_outside();
            }
            15 => return self.kill(window),
            16 => {
                self.tell("close");
                let is_untouched = window.app.session.disk.saving == Saving::Untouched;
                leave(&mut window, || Action::CloseRequested);
                window.runner.close();
                return self.forget_exposed(is_untouched);
            }
            17 => {
                self.tell("open another project, and this one again");
                let (other, here) = (self.other.clone(), self.folder.path().to_path_buf());
                let is_untouched = window.app.session.disk.saving == Saving::Untouched;
                leave(&mut window, || Action::Open(other.clone()));
                window.wait_until("the other project", |app| {
                    app.open().unwrap().document.frames.len() == 1
                });
                self.forget_exposed(is_untouched);
                window.act(Action::Open(here));
                window.wait_until("this project", |app| {
                    app.open().unwrap().document.frames.len() == FRAMES
                });
            }
            _ => self.merge_set_aside(&mut window),
        }
        self.window = Some(window);
    }

    fn edit(&mut self, window: &mut Headless) {
        let frame = self.random.random_range(0..FRAMES);
        window.act(Action::View(ViewAction::CloseDialog));
        window.act(Action::Navigate(Navigation::GoTo(frame)));
        let mark = self.mark();
        self.tell(format!("comment {mark} on {frame}"));
        for taken_back in marks(window.app.frame().unwrap()) {
            self.live.remove(&taken_back);
        }
        window.act(Action::Edit(EditAction::SetComment(mark.clone())));
        if self.random.random_range(0..3) == 0 {
            window.act(Action::Command(Command::AcceptAndStay));
        }
        self.live.insert(mark);
        settle(window);
    }

    fn undo(&mut self, window: &mut Headless) {
        self.tell("undo");
        window.act(Action::View(ViewAction::CloseDialog));
        let before = marks_in(&window.app);
        for _ in 0..2 {
            window.act(Action::Command(Command::Undo));
        }
        let now = marks_in(&window.app);
        self.live
            .retain(|mark| !before.contains(mark) || now.contains(mark));
        // What it brings back, and not what others have taken back meanwhile.
        self.live.extend(now.difference(&before).cloned());
        settle(window);
    }

    /// The machine proposes cameras, except for frames that a person has decided on.
    fn propose(&mut self, window: &mut Headless) {
        self.tell("proposals");
        let document = window.app.open().unwrap().document.clone();
        let pan_deg = self.random.random_range(-6.0..6.0);
        let proposals = (0..FRAMES)
            .map(|frame| proposal_in(&document, frame, self.made as u64 + 1, Some(pan_deg)));
        window.act(Action::Trainer(TrainerReport::Proposals(
            proposals.collect(),
        )));
        settle(window);
    }

    /// A colleague's program or a sync client replaces the document: from what is there, or from an
    /// earlier state of it. What it destroys by that while no window has it is its own loss.
    fn write_outside(&mut self) {
        let file = self.file();
        self.seen.push(fs::read(&file).unwrap());
        let from = if self.random.random_range(0..2) == 0 {
            self.seen.len() - 1
        } else {
            self.random.random_range(0..self.seen.len())
        };
        let mut document = document_from_bytes(&self.seen[from]).unwrap();
        let frame = self.random.random_range(0..document.frames.len());
        let mark = self.mark();
        self.tell(format!(
            "outside: state {from} of {}, {mark} on {frame}",
            self.seen.len()
        ));
        match self.random.random_range(0..6) {
            0 => {
                let moved = Vec3::new(self.random.random_range(-3.0..3.0), -62.0, 17.0);
                document.cameras[0].set_base(&CameraBase {
                    position_m: moved,
                    ..base()
                });
                solve_document(&mut document, self.folder.path(), &Progress::default()).unwrap();
            }
            1 => click(&mut document, frame),
            _ => {}
        }
        // What its author has before them and writes over is taken back, as in the window.
        for taken_back in marks(&document.frames[frame]) {
            self.live.remove(&taken_back);
        }
        document.frames[frame].comment = Some(mark.clone());
        // Another touchline counts its edits, a script does not.
        document.frames[frame].revision += self.random.random_range(0..2);
        let before = self.everything();
        touchline_documents::testing::save(&file, &document);
        let after = self.lasting();
        self.live
            .retain(|mark| after.contains(mark) || !before.contains(mark));
        self.live.insert(mark);
        let on_disk = self.files(false);
        self.exposed = self
            .live
            .iter()
            .filter(|mark| !on_disk.contains(*mark))
            .cloned()
            .collect();
    }

    /// The window is gone. What others wrote over is their loss where the window was killed before
    /// it could look, or had nothing of its own to look for.
    fn forget_exposed(&mut self, cannot_look: bool) {
        let exposed = std::mem::take(&mut self.exposed);
        if cannot_look {
            let on_disk = self.files(false);
            self.live
                .retain(|mark| !exposed.contains(mark) || on_disk.contains(mark));
        }
    }

    fn answer(&mut self, window: &mut Headless) {
        let choices = [
            OutsideChoice::Merge,
            OutsideChoice::Replace,
            OutsideChoice::TakeTheirs,
        ];
        let choice = choices[self.random.random_range(0..3)];
        self.tell(format!("answer {choice:?}"));
        let before = marks_in(&window.app);
        window.act(Action::ResolveOutside(choice));
        if choice == OutsideChoice::TakeTheirs {
            window.wait_until("the other version", |app| {
                app.session.disk.opening.is_none()
            });
        } else {
            window.wait_until("the answer", |app| {
                app.session.disk.changed_outside.is_none()
            });
        }
        if choice == OutsideChoice::Merge {
            self.take_back_named(window, &before);
        }
        settle(window);
    }

    /// The program is killed: what is on disk then is all there is.
    fn kill(&mut self, mut window: Headless) {
        self.tell("kill");
        settle(&mut window);
        let left = tempfile::tempdir().unwrap();
        copy_files(self.folder.path(), left.path());
        drop(window);
        self.folder = left;
        self.forget_exposed(true);
    }

    fn merge_set_aside(&mut self, window: &mut Headless) {
        window.act(Action::View(ViewAction::CloseDialog));
        let Some(orphan) = window
            .app
            .session
            .disk
            .orphans
            .first()
            .map(|orphan| orphan.path.clone())
        else {
            return;
        };
        self.tell(format!(
            "merge {}",
            orphan.file_name().unwrap().to_string_lossy()
        ));
        let before = marks_in(&window.app);
        let last_before = window
            .app
            .session
            .messages
            .notices
            .last()
            .map_or(0, |notice| notice.id);
        window.act(Action::MergeOrphan(orphan));
        // What the window holds may be set aside again at once, under the same name; or it was put
        // away with what it replaced.
        let ends = ["The edits are merged", "cannot read"];
        let is_reported = |notice: &Notice| {
            notice.id > last_before && ends.iter().any(|end| notice.text.starts_with(end))
        };
        window.wait_until("merging", |app| {
            app.session.messages.notices.iter().any(is_reported)
        });
        self.take_back_named(window, &before);
        settle(window);
    }

    /// A message after a merge shows which edits it replaces, with a button for undo: these edits
    /// count as undone. An edit that a merge replaces without a message is lost.
    fn take_back_named(&mut self, window: &Headless, before: &BTreeSet<String>) {
        let now = marks_in(&window.app);
        let is_named = |text: &str| {
            text.contains("Changed on both sides") || text.contains("Taken from the other version")
        };
        if window
            .app
            .session
            .messages
            .notices
            .iter()
            .any(|notice| is_named(&notice.text))
        {
            self.live
                .retain(|mark| !before.contains(mark) || now.contains(mark));
        }
    }

    /// What is kept on disk, as text. Steps of undo and the state that a version set aside started
    /// from keep nothing: they serve one version of the document.
    fn files(&self, with_backup: bool) -> String {
        let mut text = String::new();
        for (name, bytes) in contents(self.folder.path()) {
            let name = name.to_string_lossy();
            if !name.ends_with(".history")
                && !name.ends_with(".base")
                && (with_backup || !name.ends_with(".bak"))
            {
                text += &String::from_utf8_lossy(&bytes);
            }
        }
        text
    }

    /// All that is kept anywhere, as text.
    fn everything(&self) -> String {
        self.files(true) + &self.open_document()
    }

    /// What stays whatever is saved next: the backup is of one version only, and the next save
    /// replaces it.
    fn lasting(&self) -> String {
        self.files(false) + &self.open_document()
    }

    fn open_document(&self) -> String {
        let open = self.window.as_ref().and_then(|window| window.app.open());
        open.map(|open| document_to_string(&open.document).unwrap())
            .unwrap_or_default()
    }

    /// What is on disk again, beside the document or in it, is not exposed any more. That the window
    /// has seen a change says nothing of a later one.
    fn look(&mut self) {
        let on_disk = self.files(false);
        self.exposed.retain(|mark| !on_disk.contains(mark));
    }

    /// The marks that are nowhere.
    fn lost(&self) -> Vec<&String> {
        let kept = self.everything();
        self.live
            .iter()
            .filter(|mark| !kept.contains(*mark))
            .collect()
    }

    fn check(&self) {
        // A file may be replaced between the listing of the folder and the reading of the file.
        let mut lost = self.lost();
        for _ in 0..5 {
            if !lost.is_empty() {
                std::thread::sleep(Duration::from_millis(50));
                lost = self.lost();
            }
        }
        assert!(
            lost.is_empty(),
            "{lost:?} is nowhere after\n{}",
            self.story.join("\n")
        );
        if let Some(open) = self.window.as_ref().and_then(|window| window.app.open()) {
            self.check_document(&open.document);
        }
    }

    fn check_document(&self, document: &Document) {
        let stale = check_solutions(document.at(self.folder.path()));
        assert!(
            stale.is_empty(),
            "{stale:?} after\n{}",
            self.story.join("\n")
        );
        let replaced = document
            .frames
            .iter()
            .take(2)
            .filter(|frame| frame.status != FrameStatus::Reference);
        assert_eq!(
            replaced.count(),
            0,
            "a label gave way to a machine after\n{}",
            self.story.join("\n")
        );
    }
}

/// Waits until every edit is on disk, or the user has to decide.
fn settle(window: &mut Headless) {
    window.wait_until("the disk", |app| {
        !matches!(app.session.disk.saving, Saving::Pending)
    });
}

/// Saves, and waits for the document or for the question whose version it is to be.
fn save(window: &mut Headless) {
    window.act(Action::Command(Command::Save));
    window.wait_until("saving", |app| {
        app.session.disk.changed_outside.is_some()
            || app.open().is_some_and(crate::outside::is_written)
    });
}

/// Leaves the document as a person does who insists.
fn leave(window: &mut Headless, how: impl Fn() -> Action) {
    settle(window);
    window.act(how());
    let shows_question = |app: &App| {
        matches!(
            app.session.dialog,
            Some(Dialog::ChangedOutside | Dialog::NotSaved(_))
        )
    };
    if window.app.session.disk.leaving.is_some() {
        window.wait_until("leaving or a question", |app| {
            app.session.disk.leaving.is_none() || shows_question(app)
        });
    }
    if shows_question(&window.app) {
        window.act(Action::View(ViewAction::CloseDialog));
        window.act(how());
        window.act(Action::LeaveUnsaved);
    }
}

fn click(document: &mut Document, frame: usize) {
    let camera = PtzCamera::new(
        document.cameras[0].base().unwrap(),
        Ptz::from_degrees(-3.0, -14.0, 2300.0),
    );
    let at = landmark_in(&camera, "centre_mark");
    document.frames[frame]
        .clicks
        .push(Click::without_name(ImagePoint::new(
            at.x.clamp(1.0, f64::from(SIZE.width)),
            500.0,
        )));
}

fn marks(frame: &Frame) -> Vec<String> {
    frame.comment.iter().cloned().collect()
}

fn marks_in(app: &App) -> BTreeSet<String> {
    app.open()
        .unwrap()
        .document
        .frames
        .iter()
        .flat_map(|frame| marks(frame))
        .collect()
}

/// Copies the files of a folder as they are at one moment, as a kill leaves them.
pub fn copy_files(from: &Path, to: &Path) {
    let mut before = contents(from);
    loop {
        let now = contents(from);
        if now == before {
            break;
        }
        before = now;
    }
    for (name, bytes) in before {
        fs::write(to.join(name), bytes).unwrap();
    }
}

/// The files of a folder by name; one that is renamed between listing and reading is left out.
fn contents(folder: &Path) -> BTreeMap<OsString, Vec<u8>> {
    let entries = fs::read_dir(folder).unwrap().flatten();
    entries
        .filter_map(|entry| Some((entry.file_name(), fs::read(entry.path()).ok()?)))
        .collect()
}

#[test]
fn no_edit_of_a_person_is_lost_whatever_happens() {
    for number in 0..sequences() {
        let mut world = World::new(number);
        for _ in 0..STEPS {
            world.step();
            world.look();
            world.check();
        }
    }
}
