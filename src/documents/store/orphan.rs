//! Orphans: edits that were set aside beside a document because another program replaced it. They
//! are journals (`.journal.orphan-N`) or own versions (`.mine-N`), and can be merged into the
//! document or saved as a document.

use super::atomic::{file_name, folder_of, set_aside, write_new_as};
use super::journal::{JournalContent, Pending, hash_of};
use super::own_version::{base_of, is_own_version, list_own_version, read_own_version};
use super::{Location, Orphan, OrphanEdits, StoreError};
use crate::document::{document_from_bytes, document_to_string, graft};
use std::fs;
use std::path::{Path, PathBuf};
use touchline_core::files::read_regular;

/// Lists the orphans beside a document.
pub fn orphans(location: &Location) -> Vec<Orphan> {
    siblings(location)
        .into_iter()
        .filter_map(|path| list_orphan(location, path))
        .collect()
}

/// Lists one file; none if it is not an orphan.
fn list_orphan(location: &Location, path: PathBuf) -> Option<Orphan> {
    if is_own_version(location, &path) {
        list_own_version(path)
    } else if is_journal(location, &path) {
        list_journal(path)
    } else {
        None
    }
}

/// Whether a file beside a document is a journal that was set aside.
fn is_journal(location: &Location, path: &Path) -> bool {
    file_name(path).starts_with(&(file_name(&location.journal()) + ".orphan-"))
}

/// Lists a journal; none if it contains no edit.
fn list_journal(path: PathBuf) -> Option<Orphan> {
    let edits: Vec<String> = JournalContent::parse(&read_regular(&path).ok()?)
        .edit_names()
        .collect();
    (!edits.is_empty()).then_some(Orphan { path, edits })
}

/// Reads an orphan. The document from which its edits start is looked for among the versions beside
/// the document.
///
/// # Errors
/// It cannot be read.
pub fn read_orphan(location: &Location, orphan: &Path) -> Result<OrphanEdits, StoreError> {
    if is_own_version(location, orphan) {
        return read_own_version(orphan);
    }
    let bytes =
        read_regular(orphan).map_err(|source| StoreError::from_io("read", orphan, source))?;
    // A base is any version of the document: the file, its backup, or a copy that was set aside.
    // Its hash decides. What cannot be read is no base.
    let own = [
        location.journal(),
        location.history(),
        location.lock(),
        orphan.to_path_buf(),
    ];
    for version in siblings(location) {
        let is_version =
            file_name(&version).starts_with(&file_name(location.file())) && !own.contains(&version);
        let Some(version) = is_version.then(|| read_regular(&version).ok()).flatten() else {
            continue;
        };
        // Parsed anew for each version, because `pending` consumes it.
        let content = JournalContent::parse(&bytes);
        let hash = hash_of(&version);
        if content.knows(&hash)
            && let Ok(base) = document_from_bytes(&version)
            && let Pending::Edits(pending) = content.pending(&hash)
        {
            return Ok(OrphanEdits {
                base: Some(base),
                edits: pending.edits,
            });
        }
    }
    Ok(OrphanEdits {
        base: None,
        edits: JournalContent::parse(&bytes).into_edits(),
    })
}

/// Writes the document to which an orphan's edits lead, as a new file beside the document. Returns
/// its path.
///
/// # Errors
/// The orphan or the document cannot be read, or the new file cannot be written.
pub fn save_orphan(location: &Location, orphan: &Path) -> Result<PathBuf, StoreError> {
    let edits = read_orphan(location, orphan)?;
    // Without a base, the edits are put into the present document, as a merge would do.
    let document = match edits.result() {
        Some(ours) => ours,
        None => graft(&edits.edits, &super::read(location.file())?.1).document,
    };
    let file = location.file();
    let text =
        document_to_string(&document).map_err(|source| StoreError::from_write(file, source))?;
    write_new_as(file, "recovered", ".json", text.as_bytes())
        .map_err(|source| StoreError::from_io("write", file, source))
}

/// Renames an orphan after its edits were merged into the document, so that it is no longer listed.
/// Returns the new path.
///
/// # Errors
/// It cannot be renamed.
pub fn put_orphan_away(location: &Location, orphan: &Path) -> Result<PathBuf, StoreError> {
    let io = |source| StoreError::from_io("rename", orphan, source);
    if !is_own_version(location, orphan) {
        return set_aside(&location.journal(), orphan, "merged").map_err(io);
    }
    let renamed = set_aside(location.file(), orphan, "merged").map_err(io)?;
    // The base is needed for merging only, which is done.
    if let Err(error) = fs::remove_file(base_of(orphan)) {
        log::warn!("{}: {error}", base_of(orphan).display());
    }
    Ok(renamed)
}

/// The paths in the document's folder, sorted by name.
fn siblings(location: &Location) -> Vec<PathBuf> {
    let entries = fs::read_dir(folder_of(location.file()))
        .into_iter()
        .flatten()
        .flatten();
    let mut paths: Vec<PathBuf> = entries.map(|entry| entry.path()).collect();
    paths.sort();
    paths
}
