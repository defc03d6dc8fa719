//! What a place that keeps a document does, whatever the place is.

use super::{Orphan, StoreError};
use crate::document::{Document, Edit, History};
use std::path::PathBuf;

/// A place that keeps one document for whoever edits it: a file with its journal today, a team's
/// database later.
pub trait DocumentStore: Send {
    /// The document as it is kept now, with every edit that was appended.
    ///
    /// # Errors
    /// It cannot be read.
    fn load(&self) -> Result<Document, StoreError>;

    /// Keeps edits; they are safe when this returns.
    ///
    /// # Errors
    /// The place refuses them. Everything is as it was; the edits may be appended again.
    fn append(&mut self, edits: &[Edit]) -> Result<(), StoreError>;

    /// What others made of the document since it was last read or written through this store; none
    /// where they changed nothing.
    ///
    /// # Errors
    /// It cannot be read.
    fn since(&self) -> Result<Option<Outside>, StoreError>;

    /// Keeps a document that holds every edit beside the version that others wrote since; where it
    /// is. None where others changed nothing, or where the document says nothing that their version
    /// does not start from.
    ///
    /// # Errors
    /// The place refuses it.
    fn keep_own(&mut self, own: &Document) -> Result<Option<Orphan>, StoreError>;

    /// Keeps the document as a whole, which holds every edit, and the steps that can be undone and
    /// redone in it; where the version of others went, if it was set aside.
    ///
    /// # Errors
    /// Others changed it and their version is to stay, or the place refuses it.
    fn keep(
        &mut self,
        document: &Document,
        history: &History<Document>,
        others: Others,
    ) -> Result<Option<PathBuf>, StoreError>;

    /// Whether edits are kept that the document as a whole lacks.
    fn is_behind(&self) -> bool;
}

/// What happens to a version that others wrote since the document was last read or written.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Others {
    /// It stays, and the document is not written.
    Stay,
    /// It is kept under another name.
    SetAside,
}

/// A document that others changed.
#[derive(Clone, Debug, PartialEq)]
pub struct Outside {
    /// The document that both versions started from.
    pub base: Document,
    /// The version of the others.
    pub theirs: Document,
}
