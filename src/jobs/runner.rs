//! Carries out what the application asks for, in the background.

use super::opening::{Ready, camera_with_base, open_anything};
use super::{
    Background, BackgroundReport, Saver, SaverOptions, SaverReport, Trainer, TrainerOptions, TrainerReport, Wake, demo,
};
use crate::app::session::Level;
use crate::app::{Action, Compared, Effect, Question};
use crate::calibrate::{BaseProblem, EstimatedBase};
use crate::document::{CameraId, Document, document_to_string};
use crate::evaluate::agreement;
use crate::solve::base::{BaseOptions, WatchBase};
use crate::store::{Location, Store, write_output};
use std::ops::ControlFlow;
use std::path::{Path, PathBuf};

/// What is left for the window to do.
#[derive(Clone, Debug, PartialEq)]
pub enum Request {
    /// Ask for a path.
    Ask(Question),
    /// Keep the settings.
    SaveSettings,
    /// Close.
    Close,
}

/// What a task ends with.
enum Outcome {
    Opened(Box<Ready>),
    Action(Action),
}

/// What a task is about.
#[derive(Clone, Copy, PartialEq, Eq)]
enum Kind {
    /// It opens a document.
    Opening,
    /// It estimates a base.
    Estimate,
    /// Anything that runs to its end.
    Other,
}

/// Tells the window how far a task has come; a break says that nobody waits any more.
type Tell<'a> = &'a (dyn Fn(Action) -> ControlFlow<()> + Sync);

/// Something under way.
struct Task {
    background: Background<Action, Result<Outcome, String>>,
    /// What it is about: the user may give some up.
    kind: Kind,
    /// Nobody waits for its result any more.
    given_up: bool,
}

/// Carries out effects; its reports are actions.
pub struct Runner {
    wake: Wake,
    saver: Option<Saver>,
    trainer: Option<Trainer>,
    tasks: Vec<Task>,
    reports: Vec<Action>,
}

impl Runner {
    /// Nothing to do yet. `wake` is called when there is something to poll.
    #[must_use]
    pub const fn new(wake: Wake) -> Self {
        Self { wake, saver: None, trainer: None, tasks: Vec::new(), reports: Vec::new() }
    }

    /// Carries an effect out, or begins to; what only a window can do comes back.
    pub fn carry_out(&mut self, effect: Effect) -> Option<Request> {
        match effect {
            Effect::Open(path) => self.begin("open", Kind::Opening, move |watch| {
                open_anything(&path, &|text| watch(Action::Progress(text)))
                    .map(|ready| Outcome::Opened(Box::new(ready)))
            }),
            Effect::OpenDemo => self.begin("open the demo", Kind::Opening, move |watch| {
                open_anything(&demo::fresh_copy()?, &|text| watch(Action::Progress(text)))
                    .map(|ready| Outcome::Opened(Box::new(ready)))
            }),
            Effect::CancelOpening => self.give_up(Kind::Opening),
            Effect::EstimateBase { with_size, document, folder, camera } => {
                self.begin("base", Kind::Estimate, move |watch| {
                    let found = estimate(&document, &folder, &camera, with_size, &|progress| {
                        watch(Action::BaseProgress(progress))
                    });
                    Ok(Outcome::Action(Action::BaseEstimated(found)))
                });
            }
            Effect::CancelEstimate => self.give_up(Kind::Estimate),
            Effect::Trainer(order) => {
                if let Some(trainer) = &self.trainer {
                    trainer.tell(order);
                }
            }
            Effect::Journal { edit, revision } => match &mut self.saver {
                Some(saver) => saver.edit(edit, revision),
                None => self.reports.push(Action::SaveFailed("nothing is open for writing".to_owned())),
            },
            Effect::Save => {
                if let Some(saver) = &mut self.saver {
                    saver.save();
                }
            }
            Effect::SaveCopy { document, from, folder } => self.begin("copy", Kind::Other, move |_| {
                save_copy(&document, &from, &folder)?;
                Ok(Outcome::Action(Action::Copied(folder)))
            }),
            Effect::Export { document, from, file } => self.begin("export", Kind::Other, move |_| {
                export(&document, &from, &file)?;
                Ok(Outcome::Action(Action::Exported(file)))
            }),
            Effect::LoadCamera(path) => self.begin("camera", Kind::Other, move |_| {
                camera_with_base(&path).map(|camera| Outcome::Action(Action::CameraLoaded(Box::new(camera))))
            }),
            Effect::Compare { document, folder, revision, with } => self.begin("compare", Kind::Other, move |_| {
                compared(&document, &folder, revision, with)
                    .map(|compared| Outcome::Action(Action::Compared(Box::new(compared))))
            }),
            Effect::Ask(question) => return Some(Request::Ask(question)),
            Effect::SaveSettings => return Some(Request::SaveSettings),
            Effect::Close => return Some(Request::Close),
        }
        None
    }

    /// What has happened since the last call.
    pub fn poll(&mut self) -> Vec<Action> {
        let mut actions = std::mem::take(&mut self.reports);
        let mut opened = None;
        for task in &mut self.tasks {
            while let Some(report) = task.background.poll() {
                match report {
                    _ if task.given_up => {}
                    BackgroundReport::Done(Ok(Outcome::Opened(ready))) => opened = Some(ready),
                    BackgroundReport::Progress(action) | BackgroundReport::Done(Ok(Outcome::Action(action))) => {
                        actions.push(action);
                    }
                    BackgroundReport::Done(Err(message)) => actions.push(Action::Failed(message)),
                    BackgroundReport::Panicked(message) if task.kind == Kind::Estimate => {
                        actions
                            .push(Action::BaseEstimated(Err(format!("internal error (please report it): {message}"))));
                    }
                    BackgroundReport::Panicked(message) => {
                        actions.push(Action::Failed(format!("internal error (please report it): {message}")));
                    }
                }
            }
        }
        self.tasks.retain(|task| !task.background.is_over());
        if let Some(ready) = opened {
            // What was open before is written first; its last words matter no more than a failure.
            actions.extend(self.close());
            match self.start_saver(*ready) {
                Ok(action) => actions.push(action),
                Err(message) => actions.push(Action::Failed(message)),
            }
        }
        let reports = self.trainer.as_ref().map(Trainer::poll).unwrap_or_default();
        actions.extend(reports.into_iter().map(|report| match report {
            TrainerReport::Status(status) => Action::Trainer(status),
            TrainerReport::Proposals(proposals) => Action::Proposals(proposals),
            TrainerReport::Features(used) => Action::Features(used),
        }));
        let reports = self.saver.as_mut().map(Saver::reports).unwrap_or_default();
        actions.extend(reports.into_iter().flat_map(actions_of));
        actions
    }

    /// Writes what is left of the open document and waits for the disk.
    pub fn close(&mut self) -> Vec<Action> {
        self.trainer = None;
        let failures = |action: &Action| matches!(action, Action::SaveFailed(_));
        let reports = self.saver.take().map(Saver::close).unwrap_or_default();
        reports.into_iter().flat_map(actions_of).filter(failures).collect()
    }

    /// Whether something is still under way.
    #[must_use]
    pub fn is_busy(&self) -> bool {
        !self.tasks.is_empty()
    }

    /// Nobody waits any more for what tasks of a kind are at.
    fn give_up(&mut self, kind: Kind) {
        for task in self.tasks.iter_mut().filter(|task| task.kind == kind) {
            task.given_up = true;
            task.background.stop();
        }
    }

    fn start_saver(&mut self, ready: Ready) -> Result<Action, String> {
        if let Some(store) = ready.store {
            let document = ready.opened.document.clone();
            let saver = Saver::start(store, document, SaverOptions::default(), self.wake.clone());
            self.saver = Some(saver.map_err(|error| format!("the system starts no thread for saving: {error}"))?);
            self.start_trainer(ready.opened.file.clone());
        }
        Ok(Action::Opened(Box::new(ready.opened)))
    }

    /// Starts the trainer of a document that can be written; without one everything else works.
    fn start_trainer(&mut self, file: PathBuf) {
        if cfg!(not(feature = "opencv")) {
            return;
        }
        match Trainer::start(file, TrainerOptions::default(), self.wake.clone()) {
            Ok(trainer) => self.trainer = Some(trainer),
            Err(error) => {
                let text = format!("The system starts no thread for the trainer: {error}");
                self.reports.push(Action::Notify(Level::Warning, text));
            }
        }
    }

    fn begin(
        &mut self,
        name: &str,
        kind: Kind,
        task: impl FnOnce(Tell<'_>) -> Result<Outcome, String> + Send + 'static,
    ) {
        let background = Background::spawn(name, self.wake.clone(), move |reporter| {
            task(&|action| {
                reporter.progress(action);
                if reporter.is_stopped() { ControlFlow::Break(()) } else { ControlFlow::Continue(()) }
            })
        });
        match background {
            Ok(background) => self.tasks.push(Task { background, kind, given_up: false }),
            Err(error) => {
                self.reports.push(Action::Failed(format!("the system starts no thread for “{name}”: {error}")));
            }
        }
    }
}

fn actions_of(report: SaverReport) -> Vec<Action> {
    match report {
        SaverReport::Journaled { revision, at } => vec![Action::Saved { revision, at: clock(at), whole: false }],
        SaverReport::Saved { revision, at, set_aside } => {
            let said = set_aside.map(|path| {
                let text = format!("Another program changed the document; its version is kept as {}.", path.display());
                Action::Notify(Level::Warning, text)
            });
            said.into_iter().chain([Action::Saved { revision, at: clock(at), whole: true }]).collect()
        }
        SaverReport::Failed { error, .. } => vec![Action::SaveFailed(error.to_string())],
        SaverReport::Broken { message } => vec![Action::SaveFailed(format!("saving broke down: {message}"))],
    }
}

/// The time of day as the window shows it: "12:03:41".
fn clock(at: jiff::civil::Time) -> String {
    format!("{:02}:{:02}:{:02}", at.hour(), at.minute(), at.second())
}

fn estimate(
    document: &Document,
    folder: &Path,
    camera: &CameraId,
    with_size: bool,
    watch: WatchBase<'_>,
) -> Result<Box<EstimatedBase>, String> {
    let problem = BaseProblem::of(document.at(folder), camera).map_err(|error| error.to_string())?;
    let options = BaseOptions::default();
    let found = if with_size {
        problem.estimate_with_size(document.at(folder), &options, watch)
    } else {
        problem.estimate_watched(document, &options, watch)
    };
    found.map(Box::new).map_err(|error| error.to_string())
}

/// Reads another annotator's document and compares the open one with it.
fn compared(document: &Document, folder: &Path, revision: u64, with: PathBuf) -> Result<Compared, String> {
    let (location, other, _) = crate::store::read(&with).map_err(|error| error.to_string())?;
    let agreement = agreement(document.at(folder), other.at(location.folder())).map_err(|error| error.to_string())?;
    Ok(Compared { file: with, revision, agreement })
}

/// Writes a document into another folder; an existing project there is not touched.
fn save_copy(document: &Document, from: &Path, folder: &Path) -> Result<(), String> {
    std::fs::create_dir_all(folder).map_err(|error| format!("{}: {error}", folder.display()))?;
    let location = Location::for_new_document(folder).map_err(|error| error.to_string())?;
    let moved = document.relocated(from, location.folder());
    Store::create(&location, &moved).map(drop).map_err(|error| error.to_string())
}

/// Writes a dataset; the file dialog has asked before replacing one.
fn export(document: &Document, from: &Path, file: &Path) -> Result<(), String> {
    let folder = file.parent().filter(|folder| !folder.as_os_str().is_empty()).unwrap_or(Path::new("."));
    let folder = std::fs::canonicalize(folder).map_err(|error| format!("{}: {error}", folder.display()))?;
    let text = document_to_string(&document.relocated(from, &folder)).map_err(|error| error.to_string())?;
    write_output(file, text.as_bytes()).map_err(|error| format!("{}: {error}", file.display()))
}
