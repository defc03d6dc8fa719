//! A document that was just read, and the choices about another program's version.

use super::derived::Derived;
use super::review_queue::ReviewQueue;
use crate::app::Versioned;
use crate::app::commands::notice::Level;
use std::path::{Path, PathBuf};
use touchline_calibration::proposals::Project;
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
    /// The queue of matches that leads to this document, if it was opened by one.
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

/// A document split into the users' work and the suggestions, with the values that the window
/// derives from all frames. With 100,000 frames their computation takes a good part of a second.
#[derive(Clone, Debug)]
pub(in crate::app) struct Prepared {
    pub(in crate::app) project: Project,
    /// Values derived from version 0 of the document.
    pub(in crate::app) derived: Derived,
}

impl Prepared {
    pub(in crate::app) fn from_document(document: Document) -> Self {
        // The window's first update then finds both for version 0, with which it begins as well.
        let mut derived = Derived::default();
        let document = Versioned::new(document);
        derived.counts(&document);
        derived.lookup(&document);
        Self {
            project: Project::from_document(document.clone()),
            derived,
        }
    }

    /// The document with the suggestions, as a reader sees it.
    pub(in crate::app) const fn document(&self) -> &Document {
        self.project.view()
    }
}

/// Both fields follow from the document, so comparing the documents is enough.
impl PartialEq for Prepared {
    fn eq(&self, other: &Self) -> bool {
        self.document() == other.document()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::app::OpenProject;
    use touchline_core::geometry::ImageSize;
    use touchline_documents::document::FrameStatus;
    use touchline_documents::testing::{new_frame, ptz_at, soccer_document};

    #[test]
    fn what_was_prepared_holds_for_the_open_document() {
        let mut document = soccer_document();
        for name in ["a.jpg", "b.jpg"] {
            let mut frame = new_frame(name, ImageSize::new(64, 36));
            (frame.status, frame.ptz) = (FrameStatus::Suggested, ptz_at(1.0, -9.0, 900.0));
            document.frames.push(frame.into());
        }
        let prepared = Prepared::from_document(document.clone());
        let mut open = OpenProject::from_prepared(
            prepared,
            "/match/project.json".into(),
            "/match".into(),
            None,
        );
        assert_eq!(*open.document, document);
        assert_eq!(
            open.counts().count_with_status(FrameStatus::Suggested),
            2,
            "counted before anybody asks"
        );
        let editions =
            |open: &mut OpenProject| open.derived.counts(&open.document).suggestions_edition();
        let before = editions(&mut open);
        open.document.frames[0].status = FrameStatus::Reference;
        assert!(
            editions(&mut open) > before,
            "and counted again once the document has changed"
        );
    }
}
