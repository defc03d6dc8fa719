//! Journaling of edits, and versions of other programs.

use super::Store;
use super::contents::read_document;
use crate::document::{Document, Edit, History, common_base};
use crate::store::own_version::OwnVersion;
use crate::store::{Orphan, StoreError};
use std::path::PathBuf;

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

impl Store {
    /// Stores edits durably before it returns.
    ///
    /// # Errors
    /// The place refuses them. Nothing has changed, so the edits may be appended again.
    pub fn append(&mut self, edits: &[Edit]) -> Result<(), StoreError> {
        // The edits of the deleted journal are only in memory: after them, these would not fit any
        // document on the disk.
        if self.needs_whole {
            return Err(StoreError::Gone {
                path: self.location.journal(),
            });
        }
        self.journal
            .append(edits)
            .map_err(|source| self.journal_error(source))?;
        self.behind = true;
        if let Some(own) = &mut self.own {
            own.is_whole = false;
        }
        Ok(())
    }

    /// What other programs changed in the document since it was last read or written through this
    /// store; none if they changed nothing.
    ///
    /// # Errors
    /// It cannot be read.
    pub fn since(&self) -> Result<Option<Outside>, StoreError> {
        if !self.has_changed_on_disk()? {
            return Ok(None);
        }
        let (theirs, _) = read_document(&self.location)?;
        // Before its first write a new document has no state in common with a file that others
        // made.
        let base = match (&self.opened, &self.written) {
            (Some(opened), Some((written, _))) => common_base(opened, written, &theirs),
            _ => theirs.clone(),
        };
        Ok(Some(Outside { base, theirs }))
    }

    /// Stores `own`, a document with all edits of this program, beside the version that another
    /// program wrote. Returns its path and the names of its edits; none if no other program changed
    /// the document, or if `own` contains no change against the common base.
    ///
    /// # Errors
    /// The place refuses it.
    pub fn keep_own(&mut self, own: &Document) -> Result<Option<Orphan>, StoreError> {
        let base = match self.since() {
            Ok(None) => return Ok(None),
            Ok(Some(Outside { mut base, theirs })) => {
                // A revision counts edits, so it cannot tell a later state from a fork of an
                // earlier one with as many edits. The base leaves out frames in which theirs lacks
                // work of the user; the merge then keeps ours.
                base.frames = base
                    .frames
                    .iter()
                    .filter(|frame| !frame.gives_way_in(&theirs))
                    .cloned()
                    .collect();
                base
            }
            // Their file is not a document, so there is nothing to merge with: the base is the
            // document as it was opened.
            Err(error) => self.opened.clone().ok_or(error)?,
        };
        // The earlier one stays known until another replaces it, also where this write fails:
        // otherwise its file would stay, listed as edits that are not in the document.
        let version = OwnVersion::write(self.own.as_ref(), &self.location, &base, own)?;
        let Some(version) = version else {
            return Ok(None);
        };
        // Edits from here on start from the own version. If this journal is set aside, too, its
        // edits find their base there.
        self.journal
            .announce(version.hash())
            .map_err(|source| self.journal_error(source))?;
        let orphan = version.as_orphan();
        self.own = Some(version);
        Ok(Some(orphan))
    }

    /// Writes the whole document, with the steps that can be undone and redone in it. `document`
    /// must contain all appended edits. Returns the path of the other program's version if it was
    /// set aside.
    ///
    /// # Errors
    /// Another program changed the document and `others` is [`Others::Stay`], or the place refuses
    /// it.
    pub fn keep(
        &mut self,
        document: &Document,
        history: &History<Document>,
        others: Others,
    ) -> Result<Option<PathBuf>, StoreError> {
        match others {
            Others::Stay => self.save(document, history).map(|()| None),
            Others::SetAside => self.save_over(document, history),
        }
    }

    /// Whether edits have been appended since the whole document was last written.
    pub const fn is_behind(&self) -> bool {
        self.behind
    }
}
