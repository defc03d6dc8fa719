//! What an export made.

use super::error::ExchangeError;
use super::files::Files;
use super::format::Format;
use super::loss::Loss;
use std::path::Path;

/// An export that has proved itself and waits to be written.
#[derive(Clone, Debug)]
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
}

impl Exported {
    /// Writes the files: one to `path`, or all into a new folder there.
    ///
    /// # Errors
    /// Something is there already and `force` was not given, or it cannot be written; nothing was changed then.
    pub fn write(&self, path: &Path, force: bool) -> Result<(), ExchangeError> {
        self.files.write(path, self.format.is_folder(), force)
    }
}
