//! The fields that a document names; each is built once.

use super::field_specs;
use super::memo::Follows;
use super::templates::Templates;
use std::sync::Arc;
use touchline_core::field::{FieldError, FieldModel};
use touchline_documents::document::{ClickNoise, Document, FieldSpec, Fields};

/// The fields that were requested, with the document's click noise.
#[derive(Clone, Debug, Default)]
pub(super) struct FieldModels {
    click_noise: Option<ClickNoise>,
    models: Vec<(FieldSpec, Result<Arc<FieldModel>, FieldError>)>,
    /// The fields of all cameras, and the specifications from which they were built.
    all: Option<(Vec<FieldSpec>, Arc<Fields>)>,
}

impl Follows for FieldModels {
    fn update(&mut self, document: &Document) {
        // The models contain the σ of clicks, so that another click noise makes all of them
        // obsolete. Otherwise drop those that the document does not name any more: a number that is
        // dragged would leave one behind at each step.
        let (click_noise, specs) = (document.click_noise_in_use(), field_specs(document));
        if click_noise != self.click_noise {
            *self = Self {
                click_noise,
                ..Self::default()
            };
        }
        self.models.retain(|(spec, _)| specs.contains(spec));
        self.all.take_if(|(known, _)| *known != specs);
    }
}

impl FieldModels {
    /// One field, with its parameters. A field whose template is still being read is not kept.
    pub(super) fn model(
        &mut self,
        document: &Document,
        spec: &FieldSpec,
        templates: &mut Templates,
    ) -> Result<Arc<FieldModel>, FieldError> {
        if let Some((_, known)) = self.models.iter().find(|(known, _)| known == spec) {
            return known.clone();
        }
        let model = templates.weighted_field(document, spec).map(Arc::new);
        if !matches!(model, Err(FieldError::BeingRead { .. })) {
            self.models.push((spec.clone(), model.clone()));
        }
        model
    }

    /// The fields of all cameras.
    pub(super) fn all(
        &mut self,
        document: &Document,
        templates: &mut Templates,
    ) -> Result<Arc<Fields>, FieldError> {
        if let Some((_, known)) = &self.all {
            return Ok(Arc::clone(known));
        }
        let fields = Arc::new(Fields::with(document, |spec| {
            self.model(document, spec, templates)
        })?);
        self.all = Some((field_specs(document), Arc::clone(&fields)));
        Ok(fields)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use touchline_core::geometry::ImageSize;
    use touchline_documents::document::Camera;
    use touchline_documents::testing::soccer_document;

    #[test]
    fn a_field_is_built_once_until_the_document_names_another() {
        let mut document = soccer_document();
        let (mut models, mut templates) = (FieldModels::default(), Templates::default());
        let mut model = |document: &Document| {
            models.update(document);
            let model = models
                .model(document, &document.field, &mut templates)
                .unwrap();
            (model, models.all(document, &mut templates).unwrap())
        };
        let (first, all) = model(&document);
        document
            .cameras
            .push(Camera::new("main".into(), ImageSize::new(64, 36)).into());
        let (same, same_all) = model(&document);
        assert!(Arc::ptr_eq(&first, &same) && Arc::ptr_eq(&all, &same_all));
        assert!(
            Arc::ptr_eq(&same_all.per_camera(&document)[0], &first),
            "one model for both"
        );
        document.field.params.insert("length_m".to_owned(), 100.0);
        let (longer, longer_all) = model(&document);
        assert!(!Arc::ptr_eq(&first, &longer) && !Arc::ptr_eq(&all, &longer_all));
        document.field.params.insert("length_m".to_owned(), -1.0);
        models.update(&document);
        assert!(
            models
                .model(&document, &document.field, &mut templates)
                .is_err()
        );
        assert!(models.all(&document, &mut templates).is_err());
    }
}
