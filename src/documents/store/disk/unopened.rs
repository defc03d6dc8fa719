//! Documents that this program does not have open: written whole, and refused if another program
//! has them open.

use super::Store;
use crate::document::{Document, document_to_string};
use crate::store::atomic::{
    is_pipe_or_device, keep_backup, write_atomically, write_new, write_output,
};
use crate::store::lock::lock_or_fail;
use crate::store::{Location, StoreError};
use std::io;
use std::path::Path;

/// Writes a document that this program does not have open: a command's result, a dataset, a new
/// project.
///
/// If a project there has been edited, its last version is kept as the backup, and a journal with
/// edits is set aside.
///
/// # Errors
/// There is a file and `replace` is false, another program has the document open, or it cannot be
/// written.
pub fn write_document(
    location: &Location,
    document: &Document,
    replace: bool,
) -> Result<(), StoreError> {
    let path = location.file();
    if path.exists() && !replace {
        return Err(StoreError::Exists {
            path: path.to_path_buf(),
        });
    }
    // A journal or a lock means that the file is, or was, open in the program: take the lock.
    // Otherwise no lock is left behind beside a result that is never opened for writing.
    if location.journal().exists() || location.lock().exists() {
        return Store::replace(location, document).map(drop);
    }
    let text =
        document_to_string(document).map_err(|source| StoreError::from_write(path, source))?;
    if is_pipe_or_device(path) {
        return write_output(path, text.as_bytes())
            .map_err(|source| StoreError::from_io("write", path, source));
    }
    // The file is checked again as it gets its name: another program may create it meanwhile.
    if !replace && !path.is_symlink() {
        return write_new(path, text.as_bytes()).map_err(|source| match source.kind() {
            io::ErrorKind::AlreadyExists => StoreError::Exists {
                path: path.to_path_buf(),
            },
            _ => StoreError::from_io("write", path, source),
        });
    }
    let backup = location.backup();
    keep_backup(path, &backup).map_err(|source| StoreError::from_io("write", &backup, source))?;
    write_atomically(path, text.as_bytes())
        .map_err(|source| StoreError::from_io("write", path, source))
}

/// Returns an error if another program has the document open. Commands call it before long work,
/// the result of which replaces the document.
///
/// # Errors
/// The document is open in another program, or cannot be written.
pub fn refuse_open(path: &Path) -> Result<(), StoreError> {
    // What does not exist is open nowhere. A lock file alone proves nothing, because a killed
    // process leaves one: only an attempt to lock it shows whether another process has it.
    let Ok(location) = Location::find(path) else {
        return Ok(());
    };
    if !location.lock().exists() {
        return Ok(());
    }
    lock_or_fail(&location).map(drop)
}
