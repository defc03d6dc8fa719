//! Journals whose document was replaced by another program: their edits are found again and joined with what is there.

use super::atomic::{folder_of, set_aside, write_new_beside};
use super::disk::hash_of;
use super::journal::{JournalContent, Pending};
use super::{Location, StoreError};
use crate::document::{Document, Edit, Merged, document_from_bytes, document_to_string, graft, merge};
use crate::files::read_regular;
use std::fs;
use std::path::{Path, PathBuf};

/// A journal that was set aside because its edits start from another document than the one beside it.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Orphan {
    /// The journal.
    pub path: PathBuf,
    /// The names of its edits, oldest first.
    pub edits: Vec<String>,
}

/// The edits of an orphan, and the document they start from, where one of the versions beside the document is it.
#[derive(Clone, Debug, PartialEq)]
pub struct OrphanEdits {
    /// The document that the edits start from.
    pub base: Option<Document>,
    /// The edits, oldest first.
    pub edits: Vec<Edit>,
}

/// The journals set aside beside a document that hold edits.
#[must_use]
pub fn orphans(location: &Location) -> Vec<Orphan> {
    let prefix = file_name(&location.journal()) + ".orphan-";
    let mut paths = siblings(location);
    paths.retain(|path| file_name(path).starts_with(&prefix));
    let orphan = |path: PathBuf| {
        let edits: Vec<String> = JournalContent::parse(&read_regular(&path).ok()?).edit_names().collect();
        (!edits.is_empty()).then_some(Orphan { path, edits })
    };
    paths.into_iter().filter_map(orphan).collect()
}

/// Reads an orphan, and looks for the document that it starts from among the versions beside the document.
///
/// # Errors
/// It cannot be read.
pub fn read_orphan(location: &Location, orphan: &Path) -> Result<OrphanEdits, StoreError> {
    let bytes = read_regular(orphan).map_err(|source| StoreError::from_io("read", orphan, source))?;
    let own = [location.journal(), location.history(), location.lock(), orphan.to_path_buf()];
    for version in siblings(location) {
        let is_version = file_name(&version).starts_with(&file_name(location.file())) && !own.contains(&version);
        let Some(version) = is_version.then(|| read_regular(&version).ok()).flatten() else { continue };
        let content = JournalContent::parse(&bytes);
        let hash = hash_of(&version);
        if content.knows(&hash)
            && let Ok(base) = document_from_bytes(&version)
            && let Pending::Edits(pending) = content.pending(&hash)
        {
            return Ok(OrphanEdits { base: Some(base), edits: pending.edits });
        }
    }
    Ok(OrphanEdits { base: None, edits: JournalContent::parse(&bytes).into_edits() })
}

impl OrphanEdits {
    /// Joins the edits with a document. Where it is not known what they start from, the frames they hold take the place of
    /// those in the document.
    #[must_use]
    pub fn merged_into(&self, document: &Document) -> Merged {
        match self.document() {
            Some((base, ours)) => merge(base, &ours, document),
            None => Merged { document: graft(&self.edits, document), conflicts: Vec::new() },
        }
    }

    /// The document that the edits start from, and the one they lead to as far as they fit.
    fn document(&self) -> Option<(&Document, Document)> {
        let base = self.base.as_ref()?;
        let mut ours = base.clone();
        for edit in &self.edits {
            if let Err(misfit) = edit.clone().apply(&mut ours) {
                log::warn!("{}: {misfit}", edit.name);
                break;
            }
        }
        Some((base, ours))
    }
}

/// Writes what an orphan's edits lead to as a document of its own beside the document; where.
///
/// # Errors
/// The orphan or the document cannot be read, or nothing can be written there.
pub fn save_orphan(location: &Location, orphan: &Path) -> Result<PathBuf, StoreError> {
    let edits = read_orphan(location, orphan)?;
    let document = match edits.document() {
        Some((_, ours)) => ours,
        None => graft(&edits.edits, &super::read(location.file())?.1),
    };
    let file = location.file();
    let text =
        document_to_string(&document).map_err(|source| StoreError::Write { path: file.to_path_buf(), source })?;
    write_new_beside(file, "recovered", text.as_bytes()).map_err(|source| StoreError::from_io("write", file, source))
}

/// Puts an orphan away whose edits are in the document; the file stays, under another name.
///
/// # Errors
/// It cannot be renamed.
pub fn put_orphan_away(location: &Location, orphan: &Path) -> Result<PathBuf, StoreError> {
    let renamed = set_aside(&location.journal(), orphan, "merged");
    renamed.map_err(|source| StoreError::from_io("rename", orphan, source))
}

fn file_name(path: &Path) -> String {
    path.file_name().unwrap_or_default().to_string_lossy().into_owned()
}

/// The files beside a document, by name.
fn siblings(location: &Location) -> Vec<PathBuf> {
    let entries = fs::read_dir(folder_of(location.file())).into_iter().flatten().flatten();
    let mut paths: Vec<PathBuf> = entries.map(|entry| entry.path()).collect();
    paths.sort();
    paths
}
