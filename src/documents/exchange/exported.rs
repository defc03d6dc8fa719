//! What an export made.

use super::error::ExchangeError;
use super::files::Files;
use super::format::Format;
use super::loss::Loss;
use crate::document::{Document, document_to_string, resolved};
use std::path::{Path, PathBuf};
use touchline_core::files::folder_of;

/// An export that has proved itself and waits to be written.
#[derive(Clone, Debug, PartialEq)]
pub struct Exported {
    /// The format.
    pub format: Format,
    /// Its files.
    pub files: Files,
    /// How many frames they hold.
    pub frames: usize,
    /// Frames that were asked for and cannot be held, by name, and why.
    pub left_out: Vec<(String, String)>,
    /// What the format does not hold of the others.
    pub loss: Option<Loss>,
    /// What a user should know.
    pub notes: Vec<String>,
    /// How far a landmark or click moved when the files were read again, at most, px.
    pub worst_px: f64,
    /// It is divided into takes, which have files of their own.
    pub in_takes: bool,
    /// The dataset and where its relative paths start; none for foreign formats.
    pub(super) dataset: Option<(Document, PathBuf)>,
}

impl Exported {
    /// Whether its files go into a folder.
    #[must_use]
    pub const fn is_folder(&self) -> bool {
        self.in_takes || self.format.is_folder()
    }

    /// The dataset and the folder that its relative paths start from; none for foreign formats.
    #[must_use]
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
        // Where it lands its paths point at the same files.
        let moved = document_to_string(
            &dataset
                .clone()
                .relocated(folder, &resolved(folder_of(path))),
        )?;
        Files::one("dataset.json", moved.into_bytes()).write(path, false, force)
    }
}
