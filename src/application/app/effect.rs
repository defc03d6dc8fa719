//! Effects, which the outside carries out.

use super::TrainerOrder;
use super::operation::Job;
use super::session::Question;
use std::path::PathBuf;
use touchline_documents::document::{Document, Edit, History};

/// What the outside has to do; the shell passes it to `jobs` or to the window system.
#[derive(Clone, Debug, PartialEq)]
pub enum Effect {
    /// Read a document and report `Action::Opened`.
    Open(Opening),
    /// Read a field template of the user's own and report `DiskReport::TemplateRead`.
    ReadTemplate {
        /// The document's file.
        of: PathBuf,
        /// The folder that its relative paths start from.
        folder: PathBuf,
        /// Its path as the document writes it.
        name: String,
    },
    /// Append an edit to the journal.
    Journal {
        /// What changed.
        edit: Box<Edit>,
        /// The document with it.
        to: Box<Snapshot>,
    },
    /// Write the document now: the journal alone does not tell what can be undone and redone in it.
    WriteDocument,
    /// Write the document: the saver has every edit already.
    Save {
        /// Counts these, so that the answer is known from an earlier write.
        request: u64,
    },
    /// Write the document although another program changed the file; that version is set aside.
    SaveOver,
    /// Report what another program made of the document: `DiskReport::Outside`.
    ReadOutside,
    /// Do something with edits that were set aside.
    Orphan {
        /// Their file.
        file: PathBuf,
        /// What.
        order: OrphanOrder,
    },
    /// Write a copy of the project into a folder.
    SaveCopy {
        /// The document.
        document: Box<Document>,
        /// The folder that its relative paths start from.
        from: PathBuf,
        /// Where.
        folder: PathBuf,
    },
    /// Give up what is being opened.
    CancelOpening,
    /// Run an operation and pass on what it reports as `Action::Report`.
    Start(Job),
    /// Tell the background trainer something.
    Trainer(TrainerOrder),
    /// Read the first camera with a base from a document and report `DiskReport::CameraLoaded`.
    LoadCamera(PathBuf),
    /// Ask for a path.
    Ask(Question),
    /// Write the settings.
    SaveSettings,
    /// Everything is on disk: close the window.
    Close,
}

/// A document at one moment, as it is to be written. What it holds is shared with the document that
/// is open.
#[derive(Clone, Debug, PartialEq)]
pub struct Snapshot {
    /// The document.
    pub document: Document,
    /// What can be undone and redone in it.
    pub history: History<Document>,
    /// Counts the edits of a session: this is the document after the edit of this number.
    pub revision: u64,
}

/// What is opened.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Opening {
    /// A document, folder or video.
    Path(PathBuf),
    /// A fresh copy of the demo match.
    Demo,
    /// The open document as it is on disk: this one is let go of first.
    Again(PathBuf),
}

/// What is done with edits that were set aside.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum OrphanOrder {
    /// Read them and report them.
    Read,
    /// Write them as a document of their own.
    Save,
    /// Give their file another name: they are in the document.
    PutAway,
}
