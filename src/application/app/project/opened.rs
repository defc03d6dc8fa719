//! A document that was just read, and the choices about another program's version.

use super::prepared::Prepared;
use super::review_queue::ReviewQueue;
use crate::app::commands::notice::Level;
use std::path::{Path, PathBuf};
use touchline_documents::document::{Document, History};
use touchline_documents::store::Orphan;

/// The user's choice about a version of the document that another program wrote.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum OutsideChoice {
    /// Merge both versions.
    Merge,
    /// Write the window's version; the other one is set aside.
    Replace,
    /// Open the other version; the window's edits are set aside.
    TakeTheirs,
}

/// A document that was just read.
#[derive(Clone, Debug, PartialEq)]
pub struct Opened {
    /// The document with its derived values.
    pub(in crate::app) prepared: Prepared,
    /// Undo and redo of earlier sessions.
    pub history: History<Document>,
    /// The folder to which relative paths refer.
    pub folder: PathBuf,
    /// The file: `project.json`, or the dataset's.
    pub file: PathBuf,
    /// Why the document is read-only, if it is.
    pub read_only: Option<String>,
    /// Messages, such as recovered edits or a video shorter than its header says.
    pub notices: Vec<(Level, String)>,
    /// Edits that belong to another version of the document and were set aside.
    pub orphans: Vec<Orphan>,
    /// The review queue of a season that leads to this document, if it was opened by one.
    pub queue: Option<ReviewQueue>,
    /// Whether the project was just created; then the dialog for the sport opens.
    pub is_new: bool,
}

impl Opened {
    /// A writable document without messages, in the folder of its file. Takes a pass over all
    /// frames, so call it on the thread that reads the document.
    pub fn new(document: Document, file: impl Into<PathBuf>) -> Self {
        let file = file.into();
        let folder = file.parent().map(Path::to_path_buf).unwrap_or_default();
        let (prepared, history) = (Prepared::from_document(document), History::default());
        Self {
            prepared,
            history,
            folder,
            file,
            read_only: None,
            notices: Vec::new(),
            orphans: Vec::new(),
            queue: None,
            is_new: false,
        }
    }

    /// The document.
    pub const fn document(&self) -> &Document {
        self.prepared.document()
    }
}

#[cfg(any(test, feature = "testing"))]
impl crate::app::App {
    /// The application of a test with a document open.
    pub fn with_document(document: Document) -> Self {
        let mut app = Self::new(crate::app::Settings::default());
        let opened = Opened::new(document, "/match/project.json");
        app.update(crate::app::Action::Opened(Box::new(opened)));
        app
    }
}
