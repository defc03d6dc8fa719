//! The fields of a document, because its cameras may be at different venues.

use super::{Document, DocumentAt, FieldSpec, Frame};
use std::sync::Arc;
use touchline_core::field::{FieldError, FieldModel};

/// The fields of a document's cameras, each built once.
#[derive(Clone, Debug)]
pub struct Fields {
    /// The document's own comes last.
    models: Vec<(FieldSpec, Arc<FieldModel>)>,
}

impl Fields {
    /// Every field of a document, with the click noise that it uses.
    ///
    /// # Errors
    /// One of them is not valid.
    pub fn from_document(document: DocumentAt<'_>) -> Result<Self, FieldError> {
        Self::with(document.document, |spec| {
            document.model_of(spec).map(Arc::new)
        })
    }

    /// Every field of a document, with the click noise of the templates.
    ///
    /// # Errors
    /// One of them is not valid.
    pub fn as_stated(document: DocumentAt<'_>) -> Result<Self, FieldError> {
        Self::with(document.document, |spec| {
            spec.model(document.folder).map(Arc::new)
        })
    }

    /// Every field of a document, built by a function of the caller.
    ///
    /// # Errors
    /// One of them is not valid.
    pub fn with(
        document: &Document,
        mut model: impl FnMut(&FieldSpec) -> Result<Arc<FieldModel>, FieldError>,
    ) -> Result<Self, FieldError> {
        // A list, because a document has few fields. A camera's field that equals the document's is
        // left to the last entry.
        let mut models: Vec<(FieldSpec, Arc<FieldModel>)> = Vec::new();
        let own = document
            .cameras
            .iter()
            .filter_map(|camera| camera.field.as_ref());
        for spec in own
            .filter(|spec| **spec != document.field)
            .chain([&document.field])
        {
            if !models.iter().any(|(known, _)| known == spec) {
                models.push((spec.clone(), model(spec)?));
            }
        }
        Ok(Self { models })
    }

    /// The field that a frame shows.
    pub fn for_frame(&self, document: &Document, frame: &Frame) -> &Arc<FieldModel> {
        self.for_spec(document.field_of(frame))
    }

    /// The field of each camera, in the document's order.
    pub fn per_camera(&self, document: &Document) -> Vec<Arc<FieldModel>> {
        document
            .cameras
            .iter()
            .map(|camera| camera.field.as_ref().unwrap_or(&document.field))
            .map(|spec| Arc::clone(self.for_spec(spec)))
            .collect()
    }

    fn for_spec(&self, spec: &FieldSpec) -> &Arc<FieldModel> {
        // A field that the document got after `with` is not among them. The last one, the
        // document's own, stands for it; `with` always adds that one.
        let at = self
            .models
            .iter()
            .position(|(known, _)| known == spec)
            .unwrap_or(self.models.len() - 1);
        &self.models[at].1
    }
}
