//! Reads foreign files as a document.

use super::authors_mat::read_authors_folder;
use super::error::ExchangeError;
use super::files::{Files, no_files};
use super::format::Format;
use super::import_cameras::import_cameras;
use super::import_clicks::import_clicks;
use super::imported::Imported;
use super::options::ImportOptions;
use super::registry::{camera_format, click_format};
use crate::document::{document_from_bytes, resolve_path};
use std::path::Path;

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
    let folder = if path.is_dir() {
        path
    } else {
        path.parent().unwrap_or(path)
    };
    let folder = resolve_path(folder);
    if let Some(camera_format) = camera_format(format) {
        return import_cameras(path, &folder, format, camera_format, options);
    }
    if let Some(click_format) = click_format(format) {
        return import_clicks(path, &folder, format, click_format, options);
    }
    if format == Format::AuthorsMat {
        let read = read_authors_folder(path, AUTHORS_FIELD_YD)?;
        return Ok(Imported {
            document: read.document,
            folder,
            format,
            notes: Vec::new(),
        });
    }
    let files = Files::read(path, &|_| false)?;
    let Some((name, bytes)) = files.sorted_entries().into_iter().next() else {
        return Err(no_files(path, "document; name the file itself"));
    };
    let read = document_from_bytes(bytes);
    let document = read.map_err(|source| ExchangeError::NoDocument {
        file: name.to_owned(),
        source,
    })?;
    Ok(Imported {
        document,
        folder,
        format,
        notes: Vec::new(),
    })
}
