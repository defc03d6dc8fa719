//! The user's own field templates, which are copied into a dataset.

use crate::document::{Document, DocumentAt, FieldSpec};
use crate::exchange::error::ExchangeError;
use crate::exchange::files::{Files, without_ending};
use std::path::Path;

/// Their folder in a dataset.
const FOLDER: &str = "fields";

/// Files by their path in the dataset.
pub type Templates = Vec<(String, Vec<u8>)>;

/// The document with its own templates in `fields/`, and their files.
///
/// # Errors
/// One of them cannot be read.
pub fn with_templates(at: DocumentAt<'_>) -> Result<(Document, Templates), ExchangeError> {
    let mut document = at.document.clone();
    let mut files = Templates::new();
    for field in document.fields_mut().filter(|field| field.is_file()) {
        take_along(field, at.folder, &mut files)?;
    }
    Ok((document, files))
}

fn take_along(
    field: &mut FieldSpec,
    folder: &Path,
    files: &mut Templates,
) -> Result<(), ExchangeError> {
    let read = Files::read(&folder.join(&field.template), &|_| false)?;
    let Some((name, bytes)) = read.sorted_entries().into_iter().next() else {
        return Ok(());
    };
    let stem = without_ending(name);
    let numbered = (1..).map(|number| match number {
        1 => format!("{FOLDER}/{stem}.json"),
        number => format!("{FOLDER}/{stem}-{number}.json"),
    });
    // A template of the same name from another folder gets a number.
    for place in numbered {
        match files.iter().find(|(known, _)| *known == place) {
            // Another template of this name: the next number. The same one is copied once.
            Some((_, known)) if known != bytes => {}
            known => {
                if known.is_none() {
                    files.push((place.clone(), bytes.to_vec()));
                }
                field.template = place;
                return Ok(());
            }
        }
    }
    Ok(())
}
