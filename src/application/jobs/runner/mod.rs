//! The runner carries out the application's effects and reports what happens as actions.
//!
//! The application (`app`) changes its state only in response to actions, and returns effects: what
//! is to happen outside it. Each effect goes to one of these:
//!
//! | effect | goes to |
//! |---|---|
//! | an operation | [`Background`], one thread for each [`Job`] |
//! | reading a template, other documents, edits set aside; copying | [`Background`], one each |
//! | an edit, writing the document | [`Saver`] |
//! | an order for the forest | [`Trainer`] |
//! | a question, the settings, closing | the window, as a [`Request`] |
//!
//! [`Runner::poll`] collects the reports of all of them as actions, each time the window is drawn.
//! The saver and the trainer of a newly opened document replace those of the one before.
//!
//! Here are the effects, the reports and the operations. `document.rs` replaces, saves and closes
//! the open document; `task.rs` runs the short tasks.

mod document;
mod task;

use self::document::actions_of;
use self::task::{
    Kind, Outcome, Task, camera_with_base, carry_out_on_template, look_at_matches, save_copy,
    show_folder,
};
use super::opening::Ready;
use super::{Background, BackgroundReport, Saver, SharedPictures, Trainer, Wake};
use crate::app::operation::{Job, Report};
use crate::app::{Action, Beside, DiskReport, Effect, OutsideOrder, Question};
use touchline_documents::store::Location;

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
            Effect::Template {
                of,
                folder,
                name,
                order,
            } => self.begin("field template", Kind::Other, move |_| {
                let report = carry_out_on_template(of, &folder, name, order)?;
                Ok(Outcome::Action(Action::Disk(report)))
            }),
            Effect::CancelOpening => {
                self.give_up(|kind| kind == Kind::Opening);
                self.ready = None;
            }
            Effect::Trainer(order) => {
                if let Some(trainer) = &self.trainer {
                    trainer.notify(order);
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
            Effect::WriteDocument => self.notify_saver(Saver::write),
            Effect::Save { request } => self.notify_saver(|saver| saver.save(request)),
            Effect::Outside(OutsideOrder::SaveOver) => self.notify_saver(Saver::save_over),
            Effect::Outside(OutsideOrder::Read) => self.notify_saver(Saver::read_outside),
            Effect::Orphan { file, order } => self.begin_with_orphan(file, order),
            Effect::SaveCopy {
                of,
                document,
                revision,
                from,
                folder,
            } => self.begin("copy", Kind::Other, move |_| {
                save_copy(document.at(&from), &folder)?;
                Ok(Outcome::Action(Action::Disk(DiskReport::Copied {
                    of,
                    revision,
                    folder,
                })))
            }),
            Effect::ReadBeside(Beside::Camera(path)) => {
                self.begin("camera", Kind::Beside, move |_| {
                    camera_with_base(&path).map(|camera| {
                        Outcome::Action(Action::Disk(DiskReport::CameraLoaded(Box::new(camera))))
                    })
                });
            }
            Effect::ReadBeside(Beside::Matches(matches)) => {
                self.give_up(|kind| kind == Kind::Queue);
                self.begin("matches of the queue", Kind::Queue, move |watch| {
                    look_at_matches(&matches, watch);
                    Ok(Outcome::Nothing)
                });
            }
            Effect::ShowFolder(folder) => self.begin("file manager", Kind::Other, move |_| {
                show_folder(&folder)?;
                Ok(Outcome::Nothing)
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
        actions.extend(self.poll_tasks());
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

    /// Whether an operation or task is running or an opened document waits.
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
                    BackgroundReport::Panicked(message) => job.panic_report(message),
                }));
            }
        }
        self.jobs.retain(|running| !running.background.is_over());
        actions
    }

    fn notify_saver(&self, order: impl FnOnce(&Saver)) {
        if let Some(saver) = &self.saver {
            order(saver);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::app::operation::probe::{Probe, Step};
    use crate::app::operation::{Breakdown, Failure};
    use crate::app::{App, Opened, Settings};
    use std::sync::Arc;
    use std::sync::mpsc::{Receiver, channel};
    use touchline_documents::testing::soccer_document;

    /// An application with an open document, and its runner.
    pub(super) struct Bench {
        pub(super) app: App,
        pub(super) runner: Runner,
        pub(super) woken: Receiver<()>,
    }

    impl Bench {
        pub(super) fn new() -> Self {
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
        pub(super) fn wait(&mut self) {
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
            soccer_document(),
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
        bench.start(Probe::from_steps([Step::Panic]));
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
        bench.start(Probe::from_steps([Step::WaitUntilCancelled]));
        bench.app.update(opened());
        bench.wait();
        assert!(bench.app.operations.probe.taken.is_empty());
    }

    #[test]
    fn dropping_the_runner_ends_the_work_and_waits_for_it() {
        let mut bench = Bench::new();
        bench.start(Probe::from_steps([Step::WaitUntilCancelled]));
        drop(bench.runner);
        assert!(
            bench.app.operations.probe.slot.is_running(),
            "the application was not involved"
        );
        assert!(
            bench.woken.try_iter().count() > 0,
            "it has reported its end"
        );
    }
}
