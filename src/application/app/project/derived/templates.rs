//! The user's own field templates. They are read in the background, because a network drive may
//! take long to answer.

use std::collections::BTreeMap;
use std::path::Path;
use touchline_core::field::{FieldError, FieldModel, Template};
use touchline_documents::document::{Document, FieldSpec};

/// The state of a template.
#[derive(Clone, Debug)]
enum Reading {
    /// Needed, but not requested yet.
    Wanted,
    Requested,
    Done(Result<Box<Template>, FieldError>),
}

/// The templates that a document's fields name. The keys are their paths as the document writes
/// them.
#[derive(Clone, Debug, Default)]
pub(super) struct Templates(BTreeMap<String, Reading>);

impl Templates {
    /// A field with the click noise that its template states.
    pub(super) fn unweighted_field(&mut self, spec: &FieldSpec) -> Result<FieldModel, FieldError> {
        // Built-in templates are compiled in: the folder is of no importance.
        if !spec.is_file() {
            return spec.model(Path::new(""));
        }
        let reading = self
            .0
            .entry(spec.template.clone())
            .or_insert(Reading::Wanted);
        let Reading::Done(template) = reading else {
            return Err(FieldError::BeingRead {
                place: spec.template.clone(),
            });
        };
        spec.model_of_template(template.as_ref().map_err(FieldError::clone)?)
    }

    /// A field with the click noise that a document uses.
    pub(super) fn weighted_field(
        &mut self,
        document: &Document,
        spec: &FieldSpec,
    ) -> Result<FieldModel, FieldError> {
        let mut field = self.unweighted_field(spec)?;
        document.weight_clicks(&mut field);
        Ok(field)
    }

    /// The templates to be read; each is returned once.
    pub(super) fn take_wanted(&mut self) -> Vec<String> {
        let wanted = self
            .0
            .iter_mut()
            .filter(|(_, reading)| matches!(reading, Reading::Wanted));
        wanted
            .map(|(name, reading)| {
                *reading = Reading::Requested;
                name.clone()
            })
            .collect()
    }

    /// Requests the templates that could not be read once more.
    pub(super) fn want_failed_again(&mut self) {
        for reading in self
            .0
            .values_mut()
            .filter(|reading| matches!(reading, Reading::Done(Err(_))))
        {
            *reading = Reading::Wanted;
        }
    }

    /// Stores a template that was read, or the error.
    pub(super) fn put(&mut self, name: &str, template: Result<Box<Template>, FieldError>) {
        self.0.insert(name.to_owned(), Reading::Done(template));
    }
}
