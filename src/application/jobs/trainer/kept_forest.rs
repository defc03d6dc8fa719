//! The forest stored beside a document, so that reopening the document does not train it again.

use serde_json::Value;
use std::io;
use thiserror::Error;
use touchline_calibration::proposals::{TrainingSet, WorkFolder};
use touchline_core::files::read_regular;
use touchline_documents::document::{ReadError, document_from_bytes, document_to_string};
use touchline_documents::store::write_atomically;
use touchline_vision::features::FeatureOptions;
use touchline_vision::relocalize::{ForestFileError, ForestModel};

/// Key of the fingerprint of the training set, in the forest's own document.
const TAUGHT: &str = "taught";

/// Why the stored forest cannot be used.
#[derive(Debug, Error)]
pub(super) enum KeptForestError {
    /// The file cannot be read.
    #[error("the forest cannot be read: {0}")]
    Io(#[from] io::Error),
    /// The file is not a complete forest.
    #[error(transparent)]
    Forest(#[from] ForestFileError),
    /// The document within the file cannot be read.
    #[error("the forest's document: {0}")]
    Document(#[from] ReadError),
}

/// Writes a forest beside its document, with the fingerprint of its training set.
///
/// # Errors
/// The folder cannot be created or written to. That is harmless: the forest can be trained again.
pub(super) fn keep_forest(
    place: &WorkFolder,
    model: &mut ForestModel,
    training_set: &TrainingSet,
) -> io::Result<()> {
    // The fingerprint is part of the document inside the forest's file, so that one atomic write
    // stores both. With a file of its own it could describe another forest.
    let mut document = document_from_bytes(model.document.as_bytes()).map_err(io::Error::other)?;
    document
        .extra
        .insert(TAUGHT.to_owned(), Value::String(training_set.fingerprint()));
    model.document = document_to_string(&document).map_err(io::Error::other)?;
    place.refuse_links()?;
    std::fs::create_dir_all(place.path())?;
    write_atomically(&place.forest(), &model.to_bytes())
}

/// The stored forest, if it was trained on exactly this training set and with these feature
/// options.
///
/// # Errors
/// The file exists, but is damaged or cannot be read.
pub(super) fn load_forest(
    place: &WorkFolder,
    training_set: &TrainingSet,
    features: &FeatureOptions,
) -> Result<Option<ForestModel>, KeptForestError> {
    let bytes = match read_regular(&place.forest()) {
        Ok(bytes) => bytes,
        // Nothing was stored yet, which is no failure.
        Err(error) if error.kind() == io::ErrorKind::NotFound => return Ok(None),
        Err(error) => return Err(error.into()),
    };
    let model = ForestModel::from_bytes(&bytes)?;
    let document = document_from_bytes(model.document.as_bytes())?;
    // A forest of other references or other features is none for this document. It is no error: the
    // trainer trains a new one and overwrites it.
    let taught = document.extra.get(TAUGHT).and_then(Value::as_str);
    let fits = taught == Some(&training_set.fingerprint()) && model.features == *features;
    Ok(fits.then_some(model))
}
