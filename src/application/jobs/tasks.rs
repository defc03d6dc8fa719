//! Short tasks of the runner: copying a document, reading a camera.

use super::JobError;
use std::path::Path;
use touchline_documents::document::{Camera, DocumentAt};
use touchline_documents::store;
use touchline_documents::store::{Location, Store};

/// Writes a document into another folder; fails if that has a project.
pub(super) fn save_copy(document: DocumentAt<'_>, folder: &Path) -> Result<(), JobError> {
    std::fs::create_dir_all(folder).map_err(JobError::io(folder))?;
    let location = Location::for_new_document(folder)?;
    Store::create(&location, &document.relocate(location.folder()))?;
    Ok(())
}

/// The first camera of a document that has a base.
pub(super) fn camera_with_base(path: &Path) -> Result<Camera, JobError> {
    let (_, document, _) = store::read(path)?;
    let camera = document
        .cameras
        .iter()
        .find(|camera| camera.base().is_some());
    camera
        .map(|camera| (**camera).clone())
        .ok_or_else(|| JobError::NoBase {
            path: path.to_path_buf(),
        })
}
