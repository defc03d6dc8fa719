//! Reads foreign files as a document.

use super::import_cameras::import_cameras;
use super::import_clicks::import_clicks;
use super::imported::Imported;
use crate::document::{Document, document_from_bytes, resolve_path};
use crate::exchange::authors_mat::read_authors_folder;
use crate::exchange::error::ExchangeError;
use crate::exchange::files::{Files, no_files};
use crate::exchange::format::Format;
use crate::exchange::options::ImportOptions;
use crate::exchange::registry::{Codec, codec};
use std::path::{Path, PathBuf};

/// The size of the authors' field where there is no model of it, yards.
const AUTHORS_FIELD_YD: [f64; 2] = [118.0, 70.0];

/// Reads a file or folder of a foreign format as a document.
///
/// # Errors
/// It cannot be read, is damaged, or an option is needed.
pub fn import(
    path: &Path,
    format: Format,
    options: &ImportOptions,
) -> Result<Imported, ExchangeError> {
    if !format.imports() {
        return Err(ExchangeError::OneWay {
            format,
            what: "imported",
            instead: "exported",
        });
    }
    let folder = folder_of(path);
    let document = match codec(format) {
        Codec::Cameras(codec) => return import_cameras(path, &folder, format, codec, options),
        Codec::Clicks(codec) => return import_clicks(path, &folder, format, codec, options),
        // The authors' files have clips, masks and a field that no other format has and become a
        // document directly.
        Codec::Documents(_) if format == Format::AuthorsMat => {
            read_authors_folder(path, AUTHORS_FIELD_YD)?.document
        }
        Codec::Documents(_) => read_document(path)?,
    };
    Ok(Imported {
        document,
        folder,
        format,
        notes: Vec::new(),
        failures: Vec::new(),
    })
}

/// The folder that relative paths of an imported document start from: where the foreign files lie,
/// because their pictures usually lie there, too.
pub(in crate::exchange) fn folder_of(path: &Path) -> PathBuf {
    let folder = if path.is_dir() {
        path
    } else {
        path.parent().unwrap_or(path)
    };
    resolve_path(folder)
}

/// Reads a document of this program. A folder gives none: which file of it is meant must be said.
fn read_document(path: &Path) -> Result<Document, ExchangeError> {
    let files = Files::read(path, &|_| false)?;
    let Some((name, bytes)) = files.sorted_entries().into_iter().next() else {
        return Err(no_files(path, "document; name the file itself"));
    };
    document_from_bytes(bytes).map_err(|source| ExchangeError::NoDocument {
        file: name.to_owned(),
        source,
    })
}
