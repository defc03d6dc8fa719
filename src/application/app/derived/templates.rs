//! Field templates of the user's own. They are read in the background: a network drive may not
//! answer.

use std::collections::BTreeMap;
use std::path::Path;
use touchline_core::field::{FieldError, FieldModel, Template};
use touchline_documents::document::{Document, FieldSpec};

/// What became of a template.
#[derive(Clone, Debug)]
enum Reading {
    /// Nobody was asked to read it yet.
    Wanted,
    Asked,
    Done(Result<Box<Template>, FieldError>),
}

/// The templates that a document's fields name, by their paths as the document writes them.
#[derive(Clone, Debug, Default)]
pub(super) struct Templates(BTreeMap<String, Reading>);

impl Templates {
    /// A field with the click noise that its template states.
    pub(super) fn stated(&mut self, spec: &FieldSpec) -> Result<FieldModel, FieldError> {
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
    pub(super) fn weighted(
        &mut self,
        document: &Document,
        spec: &FieldSpec,
    ) -> Result<FieldModel, FieldError> {
        let mut field = self.stated(spec)?;
        document.weight_clicks(&mut field);
        Ok(field)
    }

    /// Those that somebody has to be asked to read, each told once.
    pub(super) fn take_wanted(&mut self) -> Vec<String> {
        let wanted = self
            .0
            .iter_mut()
            .filter(|(_, reading)| matches!(reading, Reading::Wanted));
        wanted
            .map(|(name, reading)| {
                *reading = Reading::Asked;
                name.clone()
            })
            .collect()
    }

    /// Those that could not be read are to be read again.
    pub(super) fn want_failed_again(&mut self) {
        for reading in self
            .0
            .values_mut()
            .filter(|reading| matches!(reading, Reading::Done(Err(_))))
        {
            *reading = Reading::Wanted;
        }
    }

    /// One was read, or cannot be.
    pub(super) fn put(&mut self, name: &str, template: Result<Box<Template>, FieldError>) {
        self.0.insert(name.to_owned(), Reading::Done(template));
    }
}
