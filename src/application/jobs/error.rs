//! Errors of background work that the user started.

use std::io;
use std::path::PathBuf;
use thiserror::Error;
use touchline_calibration::pipelines::VenueError;
use touchline_core::field::FieldError;
use touchline_documents::document::WriteError;
use touchline_documents::store::StoreError;
use touchline_season::queue::QueueError;
use touchline_vision::media::MediaError;

/// Why a job failed.
#[derive(Debug, Error)]
pub enum JobError {
    /// The operating system gives no thread.
    #[error("the system could not start a thread for {what}: {source}")]
    NoThread {
        /// The purpose of the thread: "saving".
        what: String,
        /// The system's error.
        source: io::Error,
    },
    /// Nothing exists at the path.
    #[error("{}: there is no such file or folder", path.display())]
    Missing { path: PathBuf },
    /// The system refused access to a file or folder.
    #[error("{}: {source}", path.display())]
    Io {
        /// The file or folder.
        path: PathBuf,
        /// The system's error.
        source: io::Error,
    },
    /// A picture or video cannot be read.
    #[error(transparent)]
    Media(#[from] MediaError),
    /// A document cannot be read or written.
    #[error(transparent)]
    Store(#[from] StoreError),
    /// A document cannot be serialised.
    #[error(transparent)]
    Document(#[from] WriteError),
    /// A document's field is not valid.
    #[error(transparent)]
    Field(#[from] FieldError),
    /// A field template would replace another file.
    #[error("{}: it exists already; give the template another \"name\"", path.display())]
    TemplateExists { path: PathBuf },
    /// This window already has the document open.
    #[error("{} is open already", file.display())]
    AlreadyOpen {
        /// The document's file.
        file: PathBuf,
    },
    /// A queue cannot be read.
    #[error(transparent)]
    Queue(#[from] QueueError),
    /// A queue has neither a match nor a frame.
    #[error("{}: no match and no frame is left to look at", path.display())]
    EmptyQueue {
        /// The queue.
        path: PathBuf,
    },
    /// A folder or video has no readable frame.
    #[error("{}: there is no frame that can be read{}", path.display(), in_brackets(reason.as_deref()))]
    NoFrames {
        /// The folder or video.
        path: PathBuf,
        /// Why the last of them cannot be read.
        reason: Option<String>,
    },
    /// The name of a folder on the way to a frame is not UTF-8. A document has no other text than
    /// Unicode, so that it would name another file.
    #[error("{path}: a folder's name in it is not UTF-8; rename the folder")]
    Unwritable {
        /// The path as the document would have it.
        path: String,
    },
    /// A project can be created neither beside the frames nor in the user's data folder.
    #[error("{}: there is no folder to keep a project in", path.display())]
    NoPlace {
        /// The folder or video.
        path: PathBuf,
    },
    /// A venue file cannot be read.
    #[error(transparent)]
    Venue(#[from] VenueError),
    /// No camera of the document has a base.
    #[error("{}: no camera has a position and a base rotation", path.display())]
    NoBase {
        /// The document.
        path: PathBuf,
    },
    /// The system's file manager cannot be started.
    #[error("{opener} cannot show the folder: {source}; it is {}", folder.display())]
    NoFileManager {
        /// The program that was to show it.
        opener: &'static str,
        folder: PathBuf,
        /// The system's error.
        source: io::Error,
    },
    /// The system has no folder for a user's data.
    #[error("this system has no folder for a user's data")]
    NoUserFolder,
    /// A picture of the demo match cannot be encoded.
    #[error("the demo match cannot be drawn: {0}")]
    Drawing(#[from] image::ImageError),
}

impl JobError {
    /// Converts the system's error at a path.
    pub(super) fn io(path: impl Into<PathBuf>) -> impl FnOnce(io::Error) -> Self {
        let path = path.into();
        move |source| Self::Io { path, source }
    }
}

fn in_brackets(reason: Option<&str>) -> String {
    reason
        .map(|reason| format!(" ({reason})"))
        .unwrap_or_default()
}
