//! The result of an export.

use super::loss::Loss;
use crate::document::{Document, document_to_string, resolve_path};
use crate::exchange::error::ExchangeError;
use crate::exchange::files::Files;
use crate::exchange::format::Format;
use std::path::{Path, PathBuf};
use touchline_core::files::folder_of;

/// A verified export, ready to be written.
#[derive(Clone, Debug, PartialEq)]
pub struct Exported {
    /// The format.
    pub format: Format,
    /// Its files.
    pub files: Files,
    /// The number of frames in them.
    pub frames: usize,
    /// Chosen frames that the format cannot store, by name, with the reason.
    pub left_out: Vec<(String, String)>,
    /// What the format loses of the others.
    pub loss: Option<Loss>,
    /// Notes for the user.
    pub notes: Vec<String>,
    /// The largest change of a landmark or click when the files were read back, px.
    pub worst_px: f64,
    /// Whether it is divided into takes, each with its own files.
    pub in_takes: bool,
    /// The dataset and where its relative paths start; none for foreign formats.
    pub(in crate::exchange) dataset: Option<(Document, PathBuf)>,
}

impl Exported {
    /// Whether it is written as a folder.
    pub fn is_folder(&self) -> bool {
        self.in_takes || self.format.is_folder()
    }

    /// The dataset and the folder that its relative paths start from; none for foreign formats.
    pub fn dataset(&self) -> Option<(&Document, &Path)> {
        self.dataset
            .as_ref()
            .map(|(dataset, folder)| (dataset, folder.as_path()))
    }

    /// Writes the files: one to `path`, or all into a new folder there.
    ///
    /// # Errors
    /// Something is there already and `force` was not given, other files would be lost, or it
    /// cannot be written; nothing was changed then.
    pub fn write(&self, path: &Path, force: bool) -> Result<(), ExchangeError> {
        let Some((dataset, folder)) = &self.dataset else {
            return self.files.write(path, self.is_folder(), force);
        };
        // Rewrite its paths so that they refer to the same files from the new folder.
        let moved = document_to_string(
            &dataset
                .clone()
                .relocate(folder, &resolve_path(folder_of(path))),
        )?;
        Files::one("dataset.json", moved.into_bytes()).write(path, false, force)
    }
}
