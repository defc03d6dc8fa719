//! The runner carries out the application's effects and turns what happens into actions.
//!
//! The application (`app`) changes its state only in response to actions, and returns effects: what
//! is to happen outside it. Each effect goes to one of these:
//!
//! | effect | goes to |
//! |---|---|
//! | an operation | [`Background`], one thread for each [`Job`] |
//! | reading a template, a camera, edits set aside; copying | [`Background`], one thread for each |
//! | an edit, writing the document | [`Saver`] |
//! | an order for the forest | [`Trainer`] |
//! | a question, the settings, closing | the window, as a [`Request`] |
//!
//! [`Runner::poll`] collects the reports of all of them as actions, each time the window is drawn.
//! The saver and the trainer of a newly opened document replace those of the one before.

use super::opening::{Ready, open_anything};
use super::tasks::{camera_with_base, save_copy};
use super::{
    Background, BackgroundReport, JobError, Reporter, Saver, SaverOptions, SaverReport,
    SharedPictures, Trainer, TrainerOptions, Wake, demo,
};
use crate::app::operation::{Job, Report};
use crate::app::session::Level;
use crate::app::{
    Action, DiskReport, Effect, Opening, OrphanOrder, Question, Snapshot, ViewAction,
};
use std::ops::ControlFlow;
use std::path::{Path, PathBuf};
use touchline_core::field::template_named;
use touchline_core::progress::Progress;
use touchline_documents::store::{Location, Orphan, put_orphan_away, read_orphan, save_orphan};

/// An effect that only the window can carry out.
#[derive(Clone, Debug, PartialEq)]
pub enum Request {
    /// Ask the user for a path.
    Ask(Question),
    /// Write the settings.
    SaveSettings,
    /// Close the window.
    Close,
}

/// The result of a task.
enum Outcome {
    Opened(Box<Ready>),
    Action(Action),
}

/// What a task depends on; decides when its result is discarded.
#[derive(Clone, Copy, PartialEq, Eq)]
enum Kind {
    /// Opens a document. Discarded when the user opens another one or cancels.
    Opening,
    /// Reads something for the open document. Discarded when another document replaces that one.
    Beside,
    /// Independent of the open document; always runs to its end.
    Other,
}

/// The reporter of a task. It answers `Break` when the result is no longer needed.
#[derive(Clone, Copy)]
struct TaskWatch<'a>(&'a Reporter<Action, Result<Outcome, JobError>>);

impl TaskWatch<'_> {
    /// Reports progress and says whether the task should continue.
    fn tell(self, action: Action) -> ControlFlow<()> {
        self.0.progress(action);
        self.goes_on()
    }

    /// Says whether the task should continue.
    fn goes_on(self) -> ControlFlow<()> {
        if self.0.is_stopped() {
            ControlFlow::Break(())
        } else {
            ControlFlow::Continue(())
        }
    }
}

/// A running task.
struct Task {
    background: Background<Action, Result<Outcome, JobError>>,
    /// What the task depends on.
    kind: Kind,
    /// The result is to be discarded.
    given_up: bool,
}

/// A running operation.
struct RunningJob {
    job: Job,
    background: Background<Report, Report>,
}

impl Drop for RunningJob {
    /// Dropping `background`, the next field, joins the thread; the operation must stop first.
    fn drop(&mut self) {
        self.job.cancel();
    }
}

/// Carries out effects; reports are actions.
pub struct Runner {
    wake: Wake,
    pictures: SharedPictures,
    saver: Option<Saver>,
    /// The document that the saver writes.
    held: Option<Location>,
    trainer: Option<Trainer>,
    jobs: Vec<RunningJob>,
    tasks: Vec<Task>,
    reports: Vec<Action>,
    /// An opened document. It replaces the one before at the next poll, so that the application
    /// takes in the remaining reports of that one first.
    ready: Option<Box<Ready>>,
}

impl Runner {
    /// A runner without an open document. `wake` is called when there is something to poll.
    /// `pictures` are the decoded frames of the window, which operations and the trainer reuse.
    #[must_use]
    pub const fn new(wake: Wake, pictures: SharedPictures) -> Self {
        Self {
            wake,
            pictures,
            saver: None,
            held: None,
            trainer: None,
            jobs: Vec::new(),
            tasks: Vec::new(),
            reports: Vec::new(),
            ready: None,
        }
    }

    /// Starts what an effect demands; returns effects that only a window can carry out.
    pub fn carry_out(&mut self, effect: Effect) -> Option<Request> {
        match effect {
            Effect::Start(job) => self.start(job),
            Effect::Open(opening) => self.open(opening),
            Effect::ReadTemplate { of, folder, name } => {
                self.begin("field template", Kind::Other, move |_| {
                    let template = template_named(&name, &folder).map(Box::new);
                    Ok(Outcome::Action(Action::Disk(DiskReport::TemplateRead {
                        of,
                        name,
                        template,
                    })))
                });
            }
            Effect::CancelOpening => {
                self.give_up(|kind| kind == Kind::Opening);
                self.ready = None;
            }
            Effect::Trainer(order) => {
                if let Some(trainer) = &self.trainer {
                    trainer.tell(order);
                }
            }
            Effect::Journal { edit, to } => match &self.saver {
                Some(saver) => saver.edit(*edit, *to),
                None => {
                    self.reports.push(Action::Disk(DiskReport::SaveFailed(
                        "nothing is open for writing".to_owned(),
                    )));
                }
            },
            Effect::WriteDocument => self.tell_saver(Saver::write),
            Effect::Save { request } => self.tell_saver(|saver| saver.save(request)),
            Effect::SaveOver => self.tell_saver(Saver::save_over),
            Effect::ReadOutside => self.tell_saver(Saver::read_outside),
            Effect::Orphan { file, order } => self.begin_with_orphan(file, order),
            Effect::SaveCopy {
                document,
                from,
                folder,
            } => self.begin("copy", Kind::Other, move |_| {
                save_copy(document.at(&from), &folder)?;
                Ok(Outcome::Action(Action::Disk(DiskReport::Copied(folder))))
            }),
            Effect::LoadCamera(path) => self.begin("camera", Kind::Beside, move |_| {
                camera_with_base(&path).map(|camera| {
                    Outcome::Action(Action::Disk(DiskReport::CameraLoaded(Box::new(camera))))
                })
            }),
            Effect::Ask(question) => return Some(Request::Ask(question)),
            Effect::SaveSettings => return Some(Request::SaveSettings),
            Effect::Close => return Some(Request::Close),
        }
        None
    }

    /// The actions that have arrived since the last call.
    pub fn poll(&mut self) -> Vec<Action> {
        // The application has taken in the actions of the previous poll, which still concern the
        // document before.
        if let Some(ready) = self.ready.take() {
            return self.let_in(*ready);
        }
        let mut actions = std::mem::take(&mut self.reports);
        actions.extend(self.poll_jobs());
        // A document that a task has opened waits in `ready` until the next poll.
        for task in &mut self.tasks {
            while let Some(report) = task.background.poll() {
                match report {
                    _ if task.given_up => {}
                    BackgroundReport::Done(Ok(Outcome::Opened(ready))) => self.ready = Some(ready),
                    BackgroundReport::Progress(action)
                    | BackgroundReport::Done(Ok(Outcome::Action(action))) => {
                        actions.push(action);
                    }
                    BackgroundReport::Done(Err(JobError::AlreadyOpen { file })) => {
                        actions.push(Action::Disk(DiskReport::AlreadyOpen(file)));
                    }
                    BackgroundReport::Done(Err(error)) => {
                        actions.push(Action::Disk(DiskReport::Failed(error.to_string())));
                    }
                    BackgroundReport::Panicked(message) => {
                        actions.push(Action::Disk(DiskReport::Failed(format!(
                            "internal error (please report it): {message}"
                        ))));
                    }
                }
            }
        }
        self.tasks.retain(|task| !task.background.is_over());
        // Without this, nothing might cause the next poll.
        if self.ready.is_some() {
            (self.wake)();
        }
        let reports = self.trainer.as_ref().map(Trainer::poll).unwrap_or_default();
        actions.extend(reports.into_iter().map(Action::Trainer));
        let reports = self.saver.as_ref().map(Saver::reports).unwrap_or_default();
        actions.extend(reports.into_iter().flat_map(actions_of));
        actions
    }

    /// Replaces the open document by one that has been opened.
    ///
    /// By now the application has taken in all reports about the document before, and its edits are
    /// with that document's saver. Later reports about it are discarded.
    fn let_in(&mut self, ready: Ready) -> Vec<Action> {
        self.give_up(|kind| !matches!(kind, Kind::Opening | Kind::Other));
        // Write the document before first. Of its last reports only failures matter.
        let mut actions = self.close();
        actions.push(match self.start_saver(ready) {
            Ok(opened) => opened,
            Err(error) => Action::Disk(DiskReport::Failed(error.to_string())),
        });
        actions
    }

    /// Ends the trainer, writes the open document and waits for the disk. Returns failures, and
    /// where the user's version of a conflicting document is.
    pub fn close(&mut self) -> Vec<Action> {
        self.trainer = None;
        self.held = None;
        let failure = |action: Action| match action {
            Action::Disk(DiskReport::SaveFailed(_)) => Some(action),
            // The document is closed, so that the user cannot choose between the versions any more.
            Action::Disk(DiskReport::ChangedOutside {
                path,
                own: Some(own),
            }) => Some(Action::View(ViewAction::Notify(
                Level::Warning,
                kept_own(&path, &own),
            ))),
            _ => None,
        };
        let reports = self.saver.take().map(Saver::close).unwrap_or_default();
        reports
            .into_iter()
            .flat_map(actions_of)
            .filter_map(failure)
            .collect()
    }

    /// Whether an operation or task is running or an opened document waits.
    #[must_use]
    pub fn is_busy(&self) -> bool {
        !self.jobs.is_empty() || !self.tasks.is_empty() || self.ready.is_some()
    }

    /// Starts an operation on a thread of its own.
    fn start(&mut self, job: Job) {
        let (task, pictures) = (job.clone(), self.pictures.clone());
        let background = Background::spawn(job.name(), self.wake.clone(), move |reporter| {
            task.run(&pictures, &|progress| reporter.progress(progress))
        });
        match background {
            Ok(background) => self.jobs.push(RunningJob { job, background }),
            Err(error) => self.reports.push(Action::Report(job.not_started(&error))),
        }
    }

    /// The reports of the operations. The application ignores those that it has stopped waiting
    /// for.
    fn poll_jobs(&mut self) -> Vec<Action> {
        let mut actions = Vec::new();
        for RunningJob { job, background } in &mut self.jobs {
            while let Some(report) = background.poll() {
                actions.push(Action::Report(match report {
                    BackgroundReport::Progress(report) | BackgroundReport::Done(report) => report,
                    BackgroundReport::Panicked(message) => job.panicked(message),
                }));
            }
        }
        self.jobs.retain(|running| !running.background.is_over());
        actions
    }

    /// Stops the tasks of some kinds and discards their results.
    fn give_up(&mut self, concerned: impl Fn(Kind) -> bool) {
        for task in self.tasks.iter_mut().filter(|task| concerned(task.kind)) {
            task.given_up = true;
            task.background.stop();
        }
    }

    /// Starts the saver and the trainer of a document; neither if it is read-only.
    fn start_saver(&mut self, ready: Ready) -> Result<Action, JobError> {
        if let Some(store) = ready.store {
            let (document, history) = (
                ready.opened.document().clone(),
                ready.opened.history.clone(),
            );
            let opened = Snapshot {
                document,
                history,
                revision: 0,
            };
            let held = store.location().clone();
            let saver = Saver::start(store, opened, SaverOptions::default(), self.wake.clone());
            self.saver = Some(saver.map_err(|source| JobError::NoThread {
                what: "saving".to_owned(),
                source,
            })?);
            self.held = Some(held);
            self.start_trainer(ready.opened.file.clone());
        }
        Ok(Action::Opened(Box::new(ready.opened)))
    }

    /// Starts the trainer of a writable document. If that fails, everything but the forest works.
    fn start_trainer(&mut self, file: PathBuf) {
        if cfg!(not(feature = "opencv")) {
            return;
        }
        match Trainer::start(
            file,
            TrainerOptions::default(),
            self.pictures.clone(),
            self.wake.clone(),
        ) {
            Ok(trainer) => self.trainer = Some(trainer),
            Err(error) => {
                let text = format!("The system could not start a thread for the trainer: {error}");
                self.reports
                    .push(Action::View(ViewAction::Notify(Level::Warning, text)));
            }
        }
    }

    /// Starts opening a document; discards an earlier one that is still being opened.
    fn open(&mut self, opening: Opening) {
        self.give_up(|kind| kind == Kind::Opening);
        self.ready = None;
        if matches!(opening, Opening::Again(_)) {
            // If writing fails, the edits are in the journal, from which opening recovers them.
            let last = self.close();
            self.reports.extend(last);
        }
        let held = self.held.clone();
        self.begin("open", Kind::Opening, move |watch| {
            let progress =
                Progress::new(|text| watch.tell(Action::Disk(DiskReport::Progress(text))));
            let path = match opening {
                Opening::Path(path) | Opening::Again(path) => path,
                Opening::Demo => demo::fresh_copy(&progress)?,
            };
            open_anything(&path, held.as_ref(), &progress)
                .map(|ready| Outcome::Opened(Box::new(ready)))
        });
    }

    /// Starts reading, saving or renaming edits that were set aside beside the open document.
    fn begin_with_orphan(&mut self, orphan: PathBuf, order: OrphanOrder) {
        let Some(location) = self.held.clone() else {
            return;
        };
        self.begin("edits set aside", Kind::Beside, move |_| {
            Ok(Outcome::Action(match order {
                OrphanOrder::Read => {
                    let edits = Box::new(read_orphan(&location, &orphan)?);
                    Action::Disk(DiskReport::OrphanRead { orphan, edits })
                }
                OrphanOrder::Save => Action::Disk(DiskReport::OrphanSaved {
                    document: save_orphan(&location, &orphan)?,
                }),
                OrphanOrder::PutAway => {
                    let renamed = put_orphan_away(&location, &orphan)?;
                    Action::Disk(DiskReport::OrphanPutAway { orphan, renamed })
                }
            }))
        });
    }

    fn tell_saver(&self, order: impl FnOnce(&Saver)) {
        if let Some(saver) = &self.saver {
            order(saver);
        }
    }

    /// Starts a task on a thread of its own; its result arrives with a later poll.
    fn begin(
        &mut self,
        name: &str,
        kind: Kind,
        task: impl FnOnce(TaskWatch<'_>) -> Result<Outcome, JobError> + Send + 'static,
    ) {
        let background = Background::spawn(name, self.wake.clone(), move |reporter| {
            task(TaskWatch(reporter))
        });
        match background {
            Ok(background) => self.tasks.push(Task {
                background,
                kind,
                given_up: false,
            }),
            Err(source) => {
                let error = JobError::NoThread {
                    what: format!("“{name}”"),
                    source,
                };
                self.reports
                    .push(Action::Disk(DiskReport::Failed(error.to_string())));
            }
        }
    }
}

/// Translates a report of the saver for the application.
fn actions_of(report: SaverReport) -> Vec<Action> {
    match report {
        SaverReport::Journaled { revision, at } => {
            vec![Action::Disk(DiskReport::Saved {
                revision,
                at: clock(at),
                document: None,
            })]
        }
        SaverReport::Saved {
            revision,
            at,
            request,
            set_aside,
        } => {
            let said = set_aside.map(|path| {
                let text = format!(
                    "Another program changed the document; its version is kept as {}.",
                    path.display()
                );
                Action::View(ViewAction::Notify(Level::Warning, text))
            });
            said.into_iter()
                .chain([Action::Disk(DiskReport::Saved {
                    revision,
                    at: clock(at),
                    document: Some(request),
                })])
                .collect()
        }
        SaverReport::Failed { error, .. } => {
            vec![Action::Disk(DiskReport::SaveFailed(error.to_string()))]
        }
        SaverReport::ChangedOutside { path, own } => {
            vec![Action::Disk(DiskReport::ChangedOutside { path, own })]
        }
        SaverReport::Outside(outside) => vec![Action::Disk(DiskReport::Outside(outside))],
        SaverReport::Broken { message } => {
            vec![Action::Disk(DiskReport::SaveFailed(format!(
                "saving failed: {message}"
            )))]
        }
    }
}

/// The message for a document that is closed after another program has changed it.
fn kept_own(path: &Path, own: &Orphan) -> String {
    let (path, own) = (path.display(), own.path.display());
    format!("Another program changed {path}; your version is kept as {own}.")
}

/// The time of day as the window shows it: "12:03:41".
fn clock(at: jiff::civil::Time) -> String {
    format!("{:02}:{:02}:{:02}", at.hour(), at.minute(), at.second())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::app::operation::probe::{Probe, Step};
    use crate::app::operation::{Breakdown, Failure};
    use crate::app::{App, Opened, Settings};
    use std::sync::Arc;
    use std::sync::mpsc::{Receiver, channel};
    use touchline_documents::document::{Document, FieldSpec};

    /// An application with an open document, and its runner.
    struct Bench {
        app: App,
        runner: Runner,
        woken: Receiver<()>,
    }

    impl Bench {
        fn new() -> Self {
            let (wake, woken) = channel();
            let runner = Runner::new(
                Arc::new(move || wake.send(()).unwrap_or_default()),
                SharedPictures::none(),
            );
            let mut app = App::new(Settings::default());
            app.update(opened());
            Self { app, runner, woken }
        }

        fn start(&mut self, probe: Probe) {
            let effect = self.app.start_probe(probe);
            self.runner.carry_out(effect);
        }

        /// Passes actions to the application until nothing runs any more.
        fn wait(&mut self) {
            while self.runner.is_busy() {
                self.woken.recv().unwrap();
                for action in self.runner.poll() {
                    self.app.update(action);
                }
            }
        }
    }

    fn opened() -> Action {
        Action::Opened(Box::new(Opened::new(
            Document::new(FieldSpec::new("soccer")),
            "/match/project.json",
        )))
    }

    #[test]
    fn progress_and_result_of_an_operation_reach_it() {
        let mut bench = Bench::new();
        let (probe, steps) = Probe::new();
        bench.start(probe);
        steps.send(Step::Report(40)).unwrap();
        bench.woken.recv().unwrap();
        for action in bench.runner.poll() {
            bench.app.update(action);
        }
        assert_eq!(
            bench
                .app
                .operations
                .probe
                .slot
                .running()
                .unwrap()
                .progress(),
            Some(&40)
        );
        steps.send(Step::Return(7)).unwrap();
        bench.wait();
        assert_eq!(bench.app.operations.probe.taken, [Ok(7)]);
    }

    #[test]
    fn a_panic_of_any_operation_is_its_failure() {
        let mut bench = Bench::new();
        bench.start(Probe::of([Step::Panic]));
        bench.wait();
        let message = "the probe broke".to_owned();
        assert_eq!(
            bench.app.operations.probe.taken,
            [Err(Failure::Broken(Breakdown::Panicked(message)))]
        );
    }

    #[test]
    fn another_document_ends_the_work() {
        let mut bench = Bench::new();
        bench.start(Probe::of([Step::WaitUntilCancelled]));
        bench.app.update(opened());
        bench.wait();
        assert!(bench.app.operations.probe.taken.is_empty());
    }

    /// A folder with a document of `frames` frames.
    fn project(frames: usize) -> tempfile::TempDir {
        let folder = tempfile::tempdir().unwrap();
        let mut document = Document::new(FieldSpec::new("soccer"));
        let frame = |index: usize| {
            touchline_documents::document::Frame::from_image(
                &index.to_string(),
                "main".into(),
                SIZE,
            )
            .into()
        };
        document.frames.extend((0..frames).map(frame));
        let location = Location::for_new_document(&folder.path().join("project.json")).unwrap();
        touchline_documents::store::write_document(&location, &document, false).unwrap();
        folder
    }

    const SIZE: touchline_core::geometry::ImageSize =
        touchline_core::geometry::ImageSize::new(64, 48);

    #[test]
    fn what_was_reported_before_a_document_opened_still_concerns_the_one_before() {
        let mut bench = Bench::new();
        let folder = project(1);
        bench
            .runner
            .carry_out(Effect::Open(Opening::Path(folder.path().to_path_buf())));
        bench.runner.begin("word", Kind::Other, |_| {
            Ok(Outcome::Action(Action::View(ViewAction::Notify(
                Level::Info,
                "a word".to_owned(),
            ))))
        });
        let mut batches = Vec::new();
        while bench.runner.is_busy() {
            bench.woken.recv().unwrap();
            batches.push(bench.runner.poll());
        }
        let opened = |batch: &Vec<Action>| {
            batch
                .iter()
                .any(|action| matches!(action, Action::Opened(_)))
        };
        let last = batches.iter().position(opened).unwrap();
        assert_eq!(batches[last].len(), 1, "nothing is reported along with it");
        assert!(
            batches[..last]
                .iter()
                .chain(&batches[last + 1..])
                .flatten()
                .count()
                > 0,
            "the word is not lost"
        );
    }

    #[test]
    fn the_document_that_is_asked_for_last_opens_alone() {
        let mut bench = Bench::new();
        let (first, last) = (project(1), project(2));
        bench
            .runner
            .carry_out(Effect::Open(Opening::Path(first.path().to_path_buf())));
        bench
            .runner
            .carry_out(Effect::Open(Opening::Path(last.path().to_path_buf())));
        bench.wait();
        assert_eq!(bench.app.open().unwrap().document.frames.len(), 2);
        assert!(
            !first.path().join("project.json.lock").exists(),
            "the other one is let go of"
        );
    }

    #[test]
    fn what_was_read_for_another_document_is_passed_over() {
        let mut bench = Bench::new();
        let folder = project(1);
        let (go_on, wait) = channel();
        bench.runner.begin("read", Kind::Beside, move |_| {
            let _: Result<(), _> = wait.recv();
            Ok(Outcome::Action(Action::View(ViewAction::Notify(
                Level::Info,
                "of another document".to_owned(),
            ))))
        });
        bench
            .runner
            .carry_out(Effect::Open(Opening::Path(folder.path().to_path_buf())));
        while bench
            .app
            .open()
            .is_none_or(|open| open.document.frames.is_empty())
        {
            bench.woken.recv().unwrap();
            for action in bench.runner.poll() {
                bench.app.update(action);
            }
        }
        go_on.send(()).unwrap();
        bench.wait();
        assert!(
            bench
                .app
                .session
                .messages
                .notices
                .iter()
                .all(|notice| notice.text != "of another document")
        );
    }

    #[test]
    fn dropping_the_runner_ends_the_work_and_waits_for_it() {
        let mut bench = Bench::new();
        bench.start(Probe::of([Step::WaitUntilCancelled]));
        drop(bench.runner);
        assert!(
            bench.app.operations.probe.slot.is_running(),
            "the application was not asked"
        );
        assert!(
            bench.woken.try_iter().count() > 0,
            "it has reported its end"
        );
    }
}
