//! A document together with its folder.

use super::{Document, FieldSpec};
use std::ops::Deref;
use std::path::Path;
use touchline_core::field::{FieldError, FieldModel};

/// A document and the folder that its relative paths start from. Needed for its pictures and for a
/// field template file.
#[derive(Clone, Copy, Debug)]
pub struct DocumentAt<'a> {
    /// The document.
    pub document: &'a Document,
    /// Its folder, absolute unless the document names no file of its own.
    pub folder: &'a Path,
}

impl Document {
    /// The document in its folder.
    pub const fn at<'a>(&'a self, folder: &'a Path) -> DocumentAt<'a> {
        DocumentAt {
            document: self,
            folder,
        }
    }
}

impl DocumentAt<'_> {
    /// A field of the document with the click noise that it uses.
    ///
    /// # Errors
    /// There is no such template, or it does not accept a parameter or its value.
    pub fn model_of(self, spec: &FieldSpec) -> Result<FieldModel, FieldError> {
        let mut field = spec.model(self.folder)?;
        self.document.weight_clicks(&mut field);
        Ok(field)
    }

    /// The document rewritten for another folder: see [`Document::relocate`].
    pub fn relocate(self, to_folder: &Path) -> Document {
        self.document.clone().relocate(self.folder, to_folder)
    }
}

impl Deref for DocumentAt<'_> {
    type Target = Document;
    fn deref(&self) -> &Document {
        self.document
    }
}
