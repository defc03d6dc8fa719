//! The forest of a document on disk, so that opening it again does not start from nothing.

use serde_json::Value;
use std::io;
use thiserror::Error;
use touchline_calibration::proposals::{TrainingSet, WorkFolder};
use touchline_core::files::read_regular;
use touchline_documents::document::{ReadError, document_from_bytes, document_to_string};
use touchline_documents::store::write_atomically;
use touchline_vision::features::FeatureOptions;
use touchline_vision::relocalize::{ForestFileError, ForestModel};

/// The key in a forest's own document that says what it was taught.
const TAUGHT: &str = "taught";

/// Why the forest beside a document is of no use.
#[derive(Debug, Error)]
pub(super) enum KeptForestError {
    /// It cannot be read.
    #[error("the forest cannot be read: {0}")]
    Io(#[from] io::Error),
    /// It is no whole forest.
    #[error(transparent)]
    Forest(#[from] ForestFileError),
    /// The document in it is none.
    #[error("the forest's document: {0}")]
    Document(#[from] ReadError),
}

/// Writes a forest beside its document, with what it was taught.
///
/// # Errors
/// The folder cannot be made or written to. Nothing depends on it: the forest is made again.
pub(super) fn keep_forest(
    place: &WorkFolder,
    model: &mut ForestModel,
    training_set: &TrainingSet,
) -> io::Result<()> {
    let mut document = document_from_bytes(model.document.as_bytes()).map_err(io::Error::other)?;
    document
        .extra
        .insert(TAUGHT.to_owned(), Value::String(training_set.fingerprint()));
    model.document = document_to_string(&document).map_err(io::Error::other)?;
    place.refuse_links()?;
    std::fs::create_dir_all(place.path())?;
    write_atomically(&place.forest(), &model.to_bytes())
}

/// The forest beside a document, if it was taught exactly this with these features.
///
/// # Errors
/// There is one, but it is damaged or cannot be read.
pub(super) fn kept_forest(
    place: &WorkFolder,
    training_set: &TrainingSet,
    features: &FeatureOptions,
) -> Result<Option<ForestModel>, KeptForestError> {
    let bytes = match read_regular(&place.forest()) {
        Ok(bytes) => bytes,
        Err(error) if error.kind() == io::ErrorKind::NotFound => return Ok(None),
        Err(error) => return Err(error.into()),
    };
    let model = ForestModel::from_bytes(&bytes)?;
    let document = document_from_bytes(model.document.as_bytes())?;
    let taught = document.extra.get(TAUGHT).and_then(Value::as_str);
    let fits = taught == Some(&training_set.fingerprint()) && model.features == *features;
    Ok(fits.then_some(model))
}
