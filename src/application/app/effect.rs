//! Effects: what the application asks the shell to do.

use super::TrainerOrder;
use super::operation::Job;
use crate::app::window_state::session::{Opening, Question};
use std::path::PathBuf;
use touchline_documents::document::{Document, Edit, History};
use touchline_season::queue::QueuedMatch;

/// Something that the shell must do, through `jobs` or the window system.
#[derive(Clone, Debug, PartialEq)]
pub enum Effect {
    /// Read a document and report `Action::Opened`.
    Open(Opening),
    /// Read or write one of the user's own field templates.
    Template {
        /// The document's file.
        of: PathBuf,
        /// The folder to which its relative paths refer.
        folder: PathBuf,
        /// The template's path as the document writes it.
        name: String,
        order: TemplateOrder,
    },
    /// Append an edit to the journal.
    Journal {
        edit: Box<Edit>,
        /// The document after the edit.
        to: Box<Snapshot>,
    },
    /// Write the document now, because the journal alone does not record its history of undo.
    WriteDocument,
    /// Write the document. The saver has received every edit already.
    Save {
        /// The number of the request, so that its answer is not confused with an earlier one.
        request: u64,
    },
    /// Do something with the version of the document that another program wrote.
    Outside(OutsideOrder),
    /// Do something with a file of edits that were set aside.
    Orphan {
        file: PathBuf,
        /// What to do with it.
        order: OrphanOrder,
    },
    /// Write a copy of the project into a folder and report `DiskReport::Copied`.
    SaveCopy {
        /// The document's file.
        of: PathBuf,
        /// The document to copy.
        document: Box<Document>,
        revision: u64,
        /// The folder to which its relative paths refer.
        from: PathBuf,
        /// The destination.
        folder: PathBuf,
    },
    /// Stop reading the document that is being opened.
    CancelOpening,
    /// Run an operation and pass its reports on as `Action::Report`.
    Start(Job),
    /// Send an order to the background trainer.
    Trainer(TrainerOrder),
    /// Read something of other documents.
    ReadBeside(Beside),
    /// Ask the user for a path.
    Ask(Question),
    /// Show a folder in the system's file manager.
    ShowFolder(PathBuf),
    /// Write the settings.
    SaveSettings,
    /// Close the window; everything is on disk.
    Close,
}

/// What is read of other documents than the open one.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Beside {
    /// The first camera with a base; `DiskReport::CameraLoaded` is reported.
    Camera(PathBuf),
    /// How far matches of a queue have come; `DiskReport::MatchSeen` is reported for each. Earlier
    /// ones that were not looked at yet are left out.
    Matches(Vec<QueuedMatch>),
}

/// A document at one moment, to be written. It shares its parts with the open document.
#[derive(Clone, Debug, PartialEq)]
pub struct Snapshot {
    pub document: Document,
    /// Its history of undo and redo.
    pub history: History<Document>,
    /// The number of edits of the session up to this state.
    pub revision: u64,
}

/// What is done with a field template.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum TemplateOrder {
    /// Read it, and report `DiskReport::TemplateRead`.
    Read,
    /// Read its text for the field editor, and report `DiskReport::TemplateText`.
    ReadText,
    /// Write it, and report `DiskReport::TemplateWritten`.
    Write {
        text: String,
        /// Whether a file of this name is an earlier version of it.
        replaces: bool,
    },
}

/// What to do with the version of a document that another program wrote.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum OutsideOrder {
    /// Read it, and report `DiskReport::Outside`.
    Read,
    /// Set it aside, and write the document in its place.
    SaveOver,
}

/// What to do with edits that were set aside.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum OrphanOrder {
    /// Read and report them.
    Read,
    /// Write them as a separate document.
    Save,
    /// Rename their file, because the document contains them now.
    PutAway,
}
