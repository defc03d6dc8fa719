//! Reports from the disk.

use std::path::PathBuf;
use touchline_core::field::{FieldError, Template};
use touchline_documents::document::Camera;
use touchline_documents::store::{Orphan, OrphanEdits, Outside};

/// The result of a request to the disk, or its progress.
#[derive(Debug, PartialEq)]
pub enum DiskReport {
    /// Progress of opening a document, as text.
    Progress(String),
    /// This window has the document open already.
    AlreadyOpen(PathBuf),
    /// One of the user's own field templates was read, or could not be.
    TemplateRead {
        /// The file of the document that names it.
        of: PathBuf,
        /// The template's path as the document writes it.
        name: String,
        /// The template, or the error.
        template: Result<Box<Template>, FieldError>,
    },
    /// A request failed; the error in one line.
    Failed(String),
    /// A camera base was read from another document.
    CameraLoaded(Box<Camera>),
    /// Every edit up to this revision is in the journal or the document.
    Saved {
        /// The revision.
        revision: u64,
        /// The local time, "12:03:41".
        at: String,
        /// The number of the last [`Effect::Save`](crate::app::Effect::Save) that this write
        /// answers, if the document itself was written and not only the journal.
        document: Option<u64>,
    },
    /// Writing failed: some edits exist only in memory.
    SaveFailed(String),
    /// Another program changed the document.
    ChangedOutside {
        /// The document's file.
        path: PathBuf,
        /// The window's version, which was set aside, if it has edits of its own.
        own: Option<Orphan>,
    },
    /// The version that another program wrote.
    Outside(Box<Outside>),
    /// Edits that were set aside were read.
    OrphanRead {
        /// Their file.
        orphan: PathBuf,
        /// The edits.
        edits: Box<OrphanEdits>,
    },
    /// Edits that were set aside were saved as a separate document.
    OrphanSaved {
        /// The new document's file.
        document: PathBuf,
    },
    /// Edits that were set aside are merged into the document, and their file was renamed.
    OrphanPutAway {
        /// Their former file.
        orphan: PathBuf,
        /// The new name.
        renamed: PathBuf,
    },
    /// A copy was written.
    Copied {
        /// The file of the document that was copied.
        of: PathBuf,
        /// The revision that was copied.
        revision: u64,
        /// The copy's folder.
        folder: PathBuf,
    },
}
