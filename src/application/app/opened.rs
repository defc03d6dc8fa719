//! A document that has just been opened, and what becomes of a version that another program wrote.

use super::notice::Level;
use super::prepared::Prepared;
use std::path::{Path, PathBuf};
use touchline_documents::document::{Document, History};
use touchline_documents::store::Orphan;

/// What becomes of a version of the document that another program wrote.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum OutsideChoice {
    /// Its changes are joined with those made here.
    Merge,
    /// It is set aside, and the document as it is here written.
    Replace,
    /// It is opened; what was edited here is set aside.
    TakeTheirs,
}

/// A document that has just been opened.
#[derive(Clone, Debug, PartialEq)]
pub struct Opened {
    /// The document, made ready.
    pub(super) prepared: Prepared,
    /// The steps of earlier sessions that can be undone and redone.
    pub history: History<Document>,
    /// Its folder: what relative paths start from.
    pub folder: PathBuf,
    /// The file: `project.json`, or the dataset's.
    pub file: PathBuf,
    /// Why it can only be looked at, if so.
    pub read_only: Option<String>,
    /// Notices for the user: recovered edits, a video shorter than its header says.
    pub notices: Vec<(Level, String)>,
    /// Edits of another version of the document that were set aside.
    pub orphans: Vec<Orphan>,
    /// The project was just made: the sport is asked for.
    pub is_new: bool,
}

impl Opened {
    /// A writable document without notices; its folder is the file's. All frames are looked at: to
    /// be made where a document is opened in the background.
    #[must_use]
    pub fn new(document: Document, file: impl Into<PathBuf>) -> Self {
        let file = file.into();
        let folder = file.parent().map(Path::to_path_buf).unwrap_or_default();
        let (prepared, history) = (Prepared::of(document), History::default());
        Self {
            prepared,
            history,
            folder,
            file,
            read_only: None,
            notices: Vec::new(),
            orphans: Vec::new(),
            is_new: false,
        }
    }

    /// The document.
    #[must_use]
    pub const fn document(&self) -> &Document {
        self.prepared.document()
    }
}
