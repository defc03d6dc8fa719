//! The system's file dialogs, on a thread of their own so that the window never waits.

use crate::app::{Action, Question};
use crate::jobs::{Background, BackgroundReport, Wake};
use std::path::{Path, PathBuf};
use std::time::{Duration, Instant};

/// Image, video and document files as the dialogs filter them.
const VIDEOS: &[&str] = &["mp4", "mov", "mkv", "avi", "m4v", "webm", "ts", "mts", "mxf", "mpg", "mpeg"];

/// A dialog that is cancelled faster than this was never shown: a missing dialog reports "cancelled" within milliseconds.
const NO_DIALOG: Duration = Duration::from_millis(150);

/// At most one file dialog.
pub struct Files {
    wake: Wake,
    open: Option<(Question, Instant, Background<(), Option<PathBuf>>)>,
}

impl Files {
    /// No dialog is open.
    pub const fn new(wake: Wake) -> Self {
        Self { wake, open: None }
    }

    /// Opens a dialog, near a folder if one is given; one that is open already stays.
    pub fn ask(&mut self, question: Question, near: Option<&Path>) {
        if self.open.is_some() {
            return;
        }
        let dialog = dialog(question, near);
        let task = Background::spawn("file dialog", self.wake.clone(), move |_| pick(question, dialog));
        self.open = task.ok().map(|task| (question, Instant::now(), task));
    }

    /// What was chosen, once it has been; nothing if cancelled. Where no dialog could open, the path is typed instead.
    pub fn poll(&mut self) -> Option<Action> {
        let (question, since, task) = self.open.as_mut()?;
        let (question, waited, report) = (*question, since.elapsed(), task.poll()?);
        self.open = None;
        match report {
            BackgroundReport::Done(Some(path)) => Some(Action::Answer(question, path)),
            BackgroundReport::Done(None) => (waited < NO_DIALOG).then_some(Action::TypePath(question)),
            BackgroundReport::Panicked(_) => Some(Action::TypePath(question)),
            BackgroundReport::Progress(()) => None,
        }
    }
}

fn dialog(question: Question, near: Option<&Path>) -> rfd::FileDialog {
    let dialog = rfd::FileDialog::new().set_title(match question {
        Question::Project => "Open a project or dataset",
        Question::Folder => "Open a folder of frames",
        Question::Video => "Open a video",
        Question::CopyTo => "Save a copy into a folder",
        Question::ExportAs(_) => "Export",
        Question::DatasetTo => "A folder for the dataset",
        Question::ImportFrom(_) => "Import labels",
        Question::CompareWith => "Compare with another annotator's document",
        Question::CameraFrom => "Load the camera from a project or dataset",
    });
    let dialog = match near {
        Some(near) => dialog.set_directory(near),
        None => dialog,
    };
    match question {
        Question::Project | Question::CameraFrom | Question::CompareWith => {
            dialog.add_filter("Projects and datasets", &["json"])
        }
        Question::Video => dialog.add_filter("Videos", VIDEOS),
        Question::ExportAs(format) if !format.is_folder() => dialog.set_file_name(format.usual_name()),
        Question::Folder | Question::CopyTo | Question::ExportAs(_) | Question::DatasetTo | Question::ImportFrom(_) => {
            dialog
        }
    }
}

fn pick(question: Question, dialog: rfd::FileDialog) -> Option<PathBuf> {
    match question {
        Question::Folder | Question::CopyTo | Question::DatasetTo => dialog.pick_folder(),
        Question::ExportAs(format) if format.is_folder() => dialog.pick_folder(),
        Question::ImportFrom(format) if format.is_folder() => dialog.pick_folder(),
        Question::ExportAs(_) => dialog.save_file(),
        Question::Project
        | Question::Video
        | Question::CameraFrom
        | Question::CompareWith
        | Question::ImportFrom(_) => dialog.pick_file(),
    }
}
