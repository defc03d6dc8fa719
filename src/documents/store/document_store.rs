//! The interface of a place that stores one document.

use super::{Orphan, StoreError};
use crate::document::{Document, Edit, History};
use std::path::PathBuf;

/// A place that stores one document for one editor: a file with its journal
/// ([`Store`](super::Store)), or another implementation of the same contract.
pub trait DocumentStore: Send {
    /// Reads the stored document, including all appended edits.
    ///
    /// # Errors
    /// It cannot be read.
    fn load(&self) -> Result<Document, StoreError>;

    /// Stores edits durably before it returns.
    ///
    /// # Errors
    /// The place refuses them. Nothing has changed, so the edits may be appended again.
    fn append(&mut self, edits: &[Edit]) -> Result<(), StoreError>;

    /// What other programs changed in the document since it was last read or written through this
    /// store; none if they changed nothing.
    ///
    /// # Errors
    /// It cannot be read.
    fn since(&self) -> Result<Option<Outside>, StoreError>;

    /// Stores `own`, a document with all edits of this program, beside the version that another
    /// program wrote. Returns its path and the names of its edits; none if no other program changed
    /// the document, or if `own` contains no change against the common base.
    ///
    /// # Errors
    /// The place refuses it.
    fn keep_own(&mut self, own: &Document) -> Result<Option<Orphan>, StoreError>;

    /// Writes the whole document, with the steps that can be undone and redone in it. `document`
    /// must contain all appended edits. Returns the path of the other program's version if it was
    /// set aside.
    ///
    /// # Errors
    /// Another program changed the document and `others` is [`Others::Stay`], or the place refuses
    /// it.
    fn keep(
        &mut self,
        document: &Document,
        history: &History<Document>,
        others: Others,
    ) -> Result<Option<PathBuf>, StoreError>;

    /// Whether edits have been appended since the whole document was last written.
    fn is_behind(&self) -> bool;
}

/// What to do with a version that another program wrote since this store last read or wrote the
/// document.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Others {
    /// Leave it in place and do not write the document.
    Stay,
    /// Keep it under another name.
    SetAside,
}

/// A document that another program changed.
#[derive(Clone, Debug, PartialEq)]
pub struct Outside {
    /// The common base of both versions.
    pub base: Document,
    /// The other program's version.
    pub theirs: Document,
}
