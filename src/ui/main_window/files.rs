//! The system's file dialogs. Each runs on a thread of its own, so that the window never waits.

use std::path::{Path, PathBuf};
use std::time::{Duration, Instant};
use touchline_application::app::{Action, Question, ViewAction};
use touchline_application::jobs::{Background, BackgroundReport, Wake};
use touchline_calibration::pipelines::VENUE_ENDING;

/// Extensions of video files, for the filter of the dialog ([`video_extensions`]).
const VIDEOS: &[&str] = &[
    "mp4", "mov", "mkv", "avi", "m4v", "webm", "ts", "mts", "mxf", "mpg", "mpeg",
];

/// A dialog that was cancelled faster than this never appeared.
///
/// If the system has no dialogs, the library reports "cancelled" at once, on a busy machine after
/// some tenths of a second. A user cannot read and close a dialog that fast.
const NO_DIALOG: Duration = Duration::from_millis(400);

/// The result of a dialog.
enum Picked {
    /// A path was chosen.
    Path(PathBuf),
    /// The user closed it without a choice.
    Nothing,
    /// No dialog appeared.
    NoDialog,
}

/// The file dialog of the window; there is at most one.
pub struct Files {
    wake: Wake,
    /// The question of the open dialog, and the thread that shows it.
    open: Option<(Question, Background<(), Picked>)>,
    /// The question for which no thread could be started.
    failed: Option<Question>,
}

impl Files {
    /// Without an open dialog. `wake` makes the window look at the result.
    pub const fn new(wake: Wake) -> Self {
        Self {
            wake,
            open: None,
            failed: None,
        }
    }

    /// Whether a dialog is open, or about to appear.
    pub const fn is_open(&self) -> bool {
        self.open.is_some()
    }

    /// Opens a dialog, in the folder `near` if given. If one is open already, nothing happens.
    pub fn ask(&mut self, question: Question, near: Option<&Path>) {
        if self.open.is_some() {
            return;
        }
        // `near` is borrowed, so the dialog is built here and only shown on its thread.
        let dialog = dialog(question, near);
        match Background::spawn("file dialog", self.wake.clone(), move |_| {
            ask_and_time(|| pick(question, dialog))
        }) {
            Ok(task) => self.open = Some((question, task)),
            Err(error) => {
                log::warn!("the system started no thread for a file dialog: {error}");
                self.failed = Some(question);
            }
        }
    }

    /// The answer, once there is one; `None` while the dialog is open or if the user cancelled. If
    /// no dialog could appear, the user is shown a field for typing the path.
    pub fn poll(&mut self) -> Option<Action> {
        if let Some(question) = self.failed.take() {
            return Some(Action::View(ViewAction::TypePath(question)));
        }
        let (question, task) = self.open.as_mut()?;
        let (question, report) = (*question, task.poll()?);
        self.open = None;
        // Without a dialog, or if it failed, the user types the path.
        match report {
            BackgroundReport::Done(Picked::Path(path)) => Some(Action::Answer(question, path)),
            BackgroundReport::Done(Picked::NoDialog) | BackgroundReport::Panicked(_) => {
                Some(Action::View(ViewAction::TypePath(question)))
            }
            BackgroundReport::Done(Picked::Nothing) | BackgroundReport::Progress(()) => None,
        }
    }
}

/// Runs a dialog. Its duration is measured here, on its own thread, because the window may look at
/// the result much later.
fn ask_and_time(pick: impl FnOnce() -> Option<PathBuf>) -> Picked {
    let since = Instant::now();
    match pick() {
        Some(path) => Picked::Path(path),
        None if since.elapsed() < NO_DIALOG => Picked::NoDialog,
        None => Picked::Nothing,
    }
}

/// The dialog for a question: title, folder, filter of file names.
fn dialog(question: Question, near: Option<&Path>) -> rfd::FileDialog {
    let dialog = rfd::FileDialog::new().set_title(match question {
        Question::Project => "Open a project or dataset",
        Question::Folder => "Open a folder of frames",
        Question::Video => "Open a video",
        Question::Queue => "Open a queue of matches",
        Question::CopyTo => "Save a copy into a folder",
        Question::ExportAs(_) => "Export",
        Question::DatasetTo => "A folder for the dataset",
        Question::ImportFrom(_) => "Import labels",
        Question::CompareWith => "Compare with another annotator's document",
        Question::CameraFrom => "Load the camera from a project, dataset or venue",
    });
    let dialog = match near {
        Some(near) => dialog.set_directory(near),
        None => dialog,
    };
    // Labels of other programs have any extension, so an import has no filter.
    match question {
        Question::Project | Question::CompareWith => {
            dialog.add_filter("Projects and datasets", &["json"])
        }
        Question::CameraFrom => {
            dialog.add_filter("Projects, datasets and venues", &["json", VENUE_ENDING])
        }
        Question::Video => dialog.add_filter("Videos", &video_extensions()),
        Question::Queue => dialog.add_filter("Queues", &["json"]),
        Question::ExportAs(format) => match format.about().file {
            Some(name) => dialog.set_file_name(name),
            None => dialog,
        },
        Question::Folder | Question::CopyTo | Question::DatasetTo | Question::ImportFrom(_) => {
            dialog
        }
    }
}

/// The extensions in small and in capital letters: dialogs tell these apart, and cameras write
/// capitals.
fn video_extensions() -> Vec<String> {
    VIDEOS
        .iter()
        .flat_map(|small| [(*small).to_owned(), small.to_uppercase()])
        .collect()
}

/// Shows the dialog in the variant for the question: a folder, an existing file, or a file to be
/// written.
fn pick(question: Question, dialog: rfd::FileDialog) -> Option<PathBuf> {
    match question {
        Question::Folder | Question::CopyTo | Question::DatasetTo => dialog.pick_folder(),
        Question::ExportAs(format) if format.is_folder() => dialog.pick_folder(),
        Question::ImportFrom(format) if format.is_folder() => dialog.pick_folder(),
        Question::ExportAs(_) => dialog.save_file(),
        Question::Project
        | Question::Video
        | Question::Queue
        | Question::CameraFrom
        | Question::CompareWith
        | Question::ImportFrom(_) => dialog.pick_file(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::sync::Arc;

    #[test]
    fn videos_as_cameras_name_them_are_offered() {
        let offered = video_extensions();
        for extension in ["mp4", "MP4", "MOV"] {
            assert!(offered.contains(&extension.to_owned()), "{extension}");
        }
    }

    #[test]
    fn a_dialog_that_fails_is_made_up_for_by_typing_however_late_the_window_looks() {
        let mut files = Files::new(Arc::new(|| {}));
        let task = Background::spawn("file dialog", files.wake.clone(), |_| ask_and_time(|| None))
            .unwrap();
        files.open = Some((Question::Project, task));
        std::thread::sleep(2 * NO_DIALOG);
        assert!(matches!(
            files.poll(),
            Some(Action::View(ViewAction::TypePath(Question::Project)))
        ));
        let cancelled = ask_and_time(|| {
            std::thread::sleep(NO_DIALOG);
            None
        });
        assert!(matches!(cancelled, Picked::Nothing));
    }
}
