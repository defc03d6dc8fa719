//! The runner's tasks: slow work besides the operations, each on a thread of its own.
//!
//! A task ends with an opened document, an action or an error. What it depends on decides when the
//! runner stops it and discards its result.

use super::Runner;
use crate::app::{Action, DiskReport, TemplateOrder};
use crate::jobs::opening::{Ready, refuse_unwritable};
use crate::jobs::{Background, BackgroundReport, JobError, Reporter, look_at_match};
use std::io::ErrorKind;
use std::ops::ControlFlow;
use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};
use touchline_calibration::pipelines::{VENUE_ENDING, Venue};
use touchline_core::field::{Template, template_named, template_text};
use touchline_documents::document::{Camera, DocumentAt};
use touchline_documents::store::{self, Location, Store};
use touchline_season::queue::QueuedMatch;

/// The result of a task.
pub(super) enum Outcome {
    Opened(Box<Ready>),
    Action(Action),
    Nothing,
}

/// What a task depends on; decides when its result is discarded.
#[derive(Clone, Copy, PartialEq, Eq)]
pub(super) enum Kind {
    /// Opens a document. Discarded when the user opens another one or cancels.
    Opening,
    /// Reads something for the open document. Discarded when another document replaces that one.
    Beside,
    /// Looks at the matches of a queue. Discarded when another queue is opened.
    Queue,
    /// Independent of the open document; always runs to its end.
    Other,
}

/// The reporter of a task. It answers `Break` when the result is no longer needed.
#[derive(Clone, Copy)]
pub(super) struct TaskWatch<'a>(&'a Reporter<Action, Result<Outcome, JobError>>);

impl TaskWatch<'_> {
    /// Reports progress and says whether the task should continue.
    pub(super) fn notify(self, action: Action) -> ControlFlow<()> {
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
pub(super) struct Task {
    background: Background<Action, Result<Outcome, JobError>>,
    /// What the task depends on.
    kind: Kind,
    /// The result is to be discarded.
    given_up: bool,
}

impl Runner {
    /// Starts a task on a thread of its own; its result arrives with a later poll.
    pub(super) fn begin(
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

    /// The reports of the tasks. A document that a task has opened waits in `ready` until the next
    /// poll.
    pub(super) fn poll_tasks(&mut self) -> Vec<Action> {
        let mut actions = Vec::new();
        for task in &mut self.tasks {
            // A task that is given up is polled, too: taking its last report ends it.
            while let Some(report) = task.background.poll() {
                match report {
                    _ if task.given_up => {}
                    BackgroundReport::Done(Ok(Outcome::Nothing)) => {}
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
        actions
    }

    /// Stops the tasks of some kinds and discards their results.
    pub(super) fn give_up(&mut self, concerned: impl Fn(Kind) -> bool) {
        for task in self.tasks.iter_mut().filter(|task| concerned(task.kind)) {
            task.given_up = true;
            task.background.stop();
        }
    }
}

/// Looks at matches, one after the other, until another queue is opened.
pub(super) fn look_at_matches(matches: &[QueuedMatch], watch: TaskWatch<'_>) {
    for queued in matches {
        let seen = DiskReport::MatchSeen {
            project: queued.project.clone(),
            state: Box::new(look_at_match(queued)),
        };
        if watch.notify(Action::Disk(seen)).is_break() {
            return;
        }
    }
}

/// Writes a document into another folder; fails if that has a project.
pub(super) fn save_copy(document: DocumentAt<'_>, folder: &Path) -> Result<(), JobError> {
    std::fs::create_dir_all(folder).map_err(JobError::io(folder))?;
    let location = Location::for_new_document(folder)?;
    let copy = document.relocate(location.folder());
    refuse_unwritable(&copy, location.folder())?;
    Store::create(&location, &copy)?;
    Ok(())
}

/// Reads or writes one of the user's own field templates.
pub(super) fn carry_out_on_template(
    of: PathBuf,
    folder: &Path,
    name: String,
    order: TemplateOrder,
) -> Result<DiskReport, JobError> {
    Ok(match order {
        TemplateOrder::Read => {
            let template = template_named(&name, folder).map(Box::new);
            DiskReport::TemplateRead { of, name, template }
        }
        TemplateOrder::ReadText => {
            let text = template_text(&folder.join(&name))?;
            DiskReport::TemplateText { of, name, text }
        }
        TemplateOrder::Write { text, replaces } => {
            let template = write_template(&folder.join(&name), &text, replaces)?;
            DiskReport::TemplateWritten { of, name, template }
        }
    })
}

/// Writes a field template into a file. One that exists is replaced only if it is an earlier
/// version of it.
fn write_template(path: &Path, text: &str, replaces: bool) -> Result<Box<Template>, JobError> {
    let template = Template::from_json(text, &path.display().to_string())?;
    if replaces {
        store::write_atomically(path, text.as_bytes())
    } else {
        store::write_new(path, text.as_bytes())
    }
    .map_err(|error| match error.kind() {
        ErrorKind::AlreadyExists => JobError::TemplateExists {
            path: path.to_path_buf(),
        },
        _ => JobError::io(path)(error),
    })?;
    Ok(Box::new(template))
}

/// Shows a folder in the system's file manager.
pub(super) fn show_folder(folder: &Path) -> Result<(), JobError> {
    let opener = if cfg!(target_os = "macos") {
        "open"
    } else if cfg!(windows) {
        "explorer"
    } else {
        "xdg-open"
    };
    // Its output is no output of this program, and its result says little: Windows' is never zero.
    let started = Command::new(opener)
        .arg(folder)
        .stdin(Stdio::null())
        .stdout(Stdio::null())
        .stderr(Stdio::null())
        .status();
    started.map_err(|source| JobError::NoFileManager {
        opener,
        folder: folder.to_path_buf(),
        source,
    })?;
    Ok(())
}

/// The first camera of a document that has a base.
pub(super) fn camera_with_base(path: &Path) -> Result<Camera, JobError> {
    let document = if path
        .extension()
        .is_some_and(|ending| ending == VENUE_ENDING)
    {
        Venue::read(path)?.document().clone()
    } else {
        store::read(path)?.1
    };
    let camera = document
        .cameras
        .iter()
        .find(|camera| camera.base().is_some());
    camera
        .map(|camera| (**camera).clone())
        .ok_or_else(|| JobError::NoBase {
            path: path.to_path_buf(),
        })
}

#[cfg(target_os = "linux")]
#[cfg(test)]
mod tests {
    use super::*;
    use std::ffi::OsStr;
    use std::os::unix::ffi::OsStrExt as _;
    use touchline_core::geometry::ImageSize;
    use touchline_documents::testing::{new_frame, soccer_document};

    #[test]
    fn a_copy_that_could_not_name_its_pictures_is_refused() {
        let root = tempfile::tempdir().unwrap();
        let root = root.path().canonicalize().unwrap();
        let clip = root.join(OsStr::from_bytes(b"clip-\xff"));
        std::fs::create_dir(&clip).unwrap();
        std::fs::write(clip.join("1.png"), "picture").unwrap();
        let mut document = soccer_document();
        let frame = new_frame("1.png", ImageSize::new(64, 36));
        document.frames.push(frame.into());
        let copy = root.join("copy");
        let refused = save_copy(document.at(&clip), &copy).unwrap_err();
        assert!(
            refused.to_string().ends_with("rename the folder"),
            "{refused}"
        );
        assert!(!copy.join("project.json").exists());
        save_copy(document.at(&clip), &clip.join("copy")).unwrap();
    }
}
