//! The forest of a document on disk, so that opening it again does not start from nothing.

use super::{Curriculum, WorkFolder};
use crate::document::{document_from_bytes, document_to_string};
use crate::features::FeatureOptions;
use crate::relocalize::ForestModel;
use crate::store::write_atomically;
use serde_json::Value;
use std::io;

/// The key in a forest's own document that says what it was taught.
const TAUGHT: &str = "taught";

/// Writes a forest beside its document, with what it was taught.
///
/// # Errors
/// The folder cannot be made or written to. Nothing depends on it: the forest is made again.
pub fn keep_forest(place: &WorkFolder, model: &mut ForestModel, curriculum: &Curriculum) -> io::Result<()> {
    let mut document = document_from_bytes(model.document.as_bytes()).map_err(io::Error::other)?;
    document.extra.insert(TAUGHT.to_owned(), Value::String(curriculum.fingerprint()));
    model.document = document_to_string(&document).map_err(io::Error::other)?;
    std::fs::create_dir_all(place.path())?;
    write_atomically(&place.forest(), &model.to_bytes())
}

/// The forest beside a document, if it was taught exactly this with these features.
///
/// # Errors
/// One line: there is one, but it is damaged or cannot be read.
pub fn kept_forest(
    place: &WorkFolder,
    curriculum: &Curriculum,
    features: &FeatureOptions,
) -> Result<Option<ForestModel>, String> {
    let bytes = match std::fs::read(place.forest()) {
        Ok(bytes) => bytes,
        Err(error) if error.kind() == io::ErrorKind::NotFound => return Ok(None),
        Err(error) => return Err(error.to_string()),
    };
    let model = ForestModel::from_bytes(&bytes).map_err(|error| error.to_string())?;
    let document = document_from_bytes(model.document.as_bytes()).map_err(|error| error.to_string())?;
    let taught = document.extra.get(TAUGHT).and_then(Value::as_str);
    let fits = taught == Some(&curriculum.fingerprint()) && model.features == *features;
    Ok(fits.then_some(model))
}
