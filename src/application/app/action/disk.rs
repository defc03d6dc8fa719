//! What comes back from the disk.

use std::path::PathBuf;
use touchline_core::field::{FieldError, Template};
use touchline_documents::document::Camera;
use touchline_documents::store::{Orphan, OrphanEdits, Outside};

/// What was asked of the disk has come to an end there, or says how far it is.
#[derive(Debug, PartialEq)]
pub enum DiskReport {
    /// How far the opening has come, in words.
    Progress(String),
    /// This window has the document open already.
    AlreadyOpen(PathBuf),
    /// A field template of the user's own was read, or cannot be.
    TemplateRead {
        /// The file of the document that names it.
        of: PathBuf,
        /// Its path as the document writes it.
        name: String,
        /// What it says.
        template: Result<Box<Template>, FieldError>,
    },
    /// Something that was asked for could not be done: one line.
    Failed(String),
    /// A camera base was read from another document.
    CameraLoaded(Box<Camera>),
    /// Every edit up to this revision is in the journal or the document.
    Saved {
        /// The revision.
        revision: u64,
        /// The local time, "12:03:41".
        at: String,
        /// The document itself was written, not only the journal: the last
        /// [`Effect::Save`](crate::app::Effect::Save) before that.
        document: Option<u64>,
    },
    /// Edits are only in memory.
    SaveFailed(String),
    /// Another program changed the document.
    ChangedOutside {
        /// Its file.
        path: PathBuf,
        /// What this window holds, as it was kept beside, if it holds anything of its own.
        own: Option<Orphan>,
    },
    /// What another program made of the document.
    Outside(Box<Outside>),
    /// They were read.
    OrphanRead {
        /// Their file.
        orphan: PathBuf,
        /// What it holds.
        edits: Box<OrphanEdits>,
    },
    /// They were.
    OrphanSaved {
        /// The document.
        document: PathBuf,
    },
    /// Edits that were set aside are in the document now; their file has another name.
    OrphanPutAway {
        /// Their file.
        orphan: PathBuf,
        /// What it is called now.
        renamed: PathBuf,
    },
    /// A copy was written.
    Copied(PathBuf),
}
