//! A window on a project on disk, which can be killed and closed.

use crate::headless::Headless;
use crate::kept_edits::copy_files;
use std::any::Any;
use std::time::{Duration, Instant};
use tempfile::TempDir;
use touchline_application::app::operation::{Job, Operation, Report};
use touchline_application::app::session::Saving;
use touchline_application::app::{
    Action, App, Command, EditAction, Effect, Navigation, PointerAction,
};
use touchline_application::jobs::SharedPictures;
use touchline_application::testing::without_counts;
use touchline_documents::document::{Document, Target, document_to_string};
use touchline_documents::store::{Location, Store};

/// What the window shows, as it is written, without the counts of edits.
pub fn bytes(app: &App) -> String {
    document_to_string(&without_counts(&app.open().unwrap().document)).unwrap()
}

/// The result of a piece of work, once it is known.
pub type Known = Option<Box<dyn Any>>;

pub struct Scene {
    pub folder: TempDir,
    pub window: Headless,
    /// Whether slow work is held back, so that the test gives its result.
    holds: bool,
    jobs: Vec<Job>,
}

impl Scene {
    pub fn open(document: &Document, holds: bool) -> Self {
        let folder = tempfile::tempdir().unwrap();
        let place = Location::for_new_document(&folder.path().join("")).unwrap();
        drop(Store::create(&place, document).unwrap());
        let mut scene = Self::open_folder(folder, holds);
        scene.act(Action::Navigate(Navigation::GoTo(0)));
        scene
    }

    fn open_folder(folder: TempDir, holds: bool) -> Self {
        let mut scene = Self {
            window: Headless::new(),
            folder,
            holds,
            jobs: Vec::new(),
        };
        scene.window.app.session.trainer.paused = true;
        scene.act(Action::Open(scene.folder.path().to_path_buf()));
        scene.wait_until("opening", |app| app.open().is_some());
        scene.settle();
        scene
    }

    pub fn act(&mut self, action: Action) {
        for effect in self.window.app.update(action) {
            match effect {
                Effect::Start(job) if self.holds => self.jobs.push(job),
                effect => drop(self.window.runner.carry_out(effect)),
            }
        }
    }

    pub fn command(&mut self, command: Command) {
        self.act(Action::Command(command));
    }

    pub fn edit(&mut self, edit: EditAction) {
        self.act(Action::Edit(edit));
    }

    pub fn pick(&mut self, landmark: &str) {
        self.edit(EditAction::Pick(Target::Landmark(landmark.into())));
    }

    /// Selects a click of the shown frame.
    pub fn select(&mut self, click: usize) {
        let at = self.window.app.frame().unwrap().clicks[click].image;
        let on = Some(click);
        self.act(Action::Pointer(PointerAction::Press { at, on }));
        self.act(Action::Pointer(PointerAction::Release));
    }

    /// The operation that was started last has ended.
    pub fn report<O: Operation>(&mut self, output: O::Output) {
        let mut jobs = self.jobs.iter().rev();
        let job = jobs.find(|job| job.name() == O::NAME).unwrap();
        let report = Report::from_result::<O>(job.id(), Ok(output));
        self.act(Action::Report(report));
    }

    /// The work that was started last has ended; it is done if its result is not known from another
    /// scene in which the same was started.
    pub fn end<O: Operation<Output: Clone>>(&mut self, known: &mut Known) {
        let output = known.get_or_insert_with(|| {
            let mut jobs = self.jobs.iter().rev();
            let job = jobs.find(|job| job.name() == O::NAME).unwrap();
            let output = job.output::<O>(&SharedPictures::none()).unwrap();
            Box::new(output.map_err(|error| error.to_string()).unwrap())
        });
        let output: &O::Output = output.downcast_ref().unwrap();
        self.report::<O>(output.clone());
    }

    pub fn wait_until(&mut self, what: &str, holds: impl Fn(&App) -> bool) {
        let begin = Instant::now();
        while !holds(&self.window.app) {
            assert!(
                begin.elapsed() < Duration::from_mins(3),
                "{what}: {:?}",
                self.last_notice()
            );
            for action in self.window.runner.poll() {
                self.act(action);
            }
            std::thread::sleep(Duration::from_millis(2));
        }
    }

    /// Waits until every edit is on disk.
    pub fn settle(&mut self) {
        self.wait_until("the disk", |app| {
            !matches!(app.session.disk.saving, Saving::Pending)
        });
    }

    /// Waits until no work is under way that the user waits for.
    pub fn wait_for_work(&mut self) {
        self.wait_until("the work", |app| {
            app.operations.under_way().next().is_none()
                && app.operations.frame_snap.running().is_none()
        });
    }

    pub fn last_notice(&self) -> Option<String> {
        let notices = &self.window.app.session.messages.notices;
        notices.last().map(|notice| notice.text.clone())
    }

    pub fn bytes(&self) -> String {
        bytes(&self.window.app)
    }

    /// The number of frames of the document.
    pub fn frames(&self) -> usize {
        self.window.app.open().unwrap().document.frames.len()
    }

    /// The number of steps that can be undone.
    pub fn steps(&self) -> usize {
        self.window.app.open().unwrap().history.num_done()
    }

    /// Whether the window shows this.
    pub fn is(&self, expected: &str, when: &str) -> Result<(), String> {
        let here = self.bytes();
        if here == expected {
            return Ok(());
        }
        let mut lines = here.lines().zip(expected.lines());
        let differ = lines.find(|(here, expected)| here != expected);
        Err(format!("{when}: {differ:?}"))
    }

    /// Takes a step back or does it again, and compares what the window shows then.
    pub fn expect(&mut self, command: Command, expected: &str, when: &str) -> Result<(), String> {
        let steps = self.steps();
        // The first press may only go to the frame of the step.
        for _ in 0..2 {
            if self.steps() == steps {
                self.command(command);
            }
        }
        self.settle();
        if self.steps() == steps {
            return Err(format!("{when}: nothing to do: {:?}", self.last_notice()));
        }
        self.is(expected, when)
    }

    /// The same project as a kill leaves it, opened again.
    pub fn kill(&self) -> Self {
        let left = tempfile::tempdir().unwrap();
        copy_files(self.folder.path(), left.path());
        Self::open_folder(left, true)
    }

    /// Closes the window and opens the project again.
    pub fn close(mut self) -> Self {
        self.act(Action::CloseRequested);
        self.wait_until("leaving", |app| app.session.disk.leaving.is_none());
        let Self {
            folder, mut window, ..
        } = self;
        window.runner.close();
        drop(window);
        Self::open_folder(folder, true)
    }
}
