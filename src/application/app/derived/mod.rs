//! What follows from the document: derived when somebody asks for it, once for each version of the
//! document at most.
//!
//! There is one memo with one key, the document's version. What is derived from all frames is
//! brought up to date from the frames that changed since it was asked for last, so that an edit in
//! a document of 100,000 frames costs what one frame costs.
//! [`Current`](super::Current), the review list and the quality page follow from these values and from what a person chose.

mod advice;
mod field_models;
mod frame_counts;
mod gold;
mod memo;
mod templates;

pub use frame_counts::FrameCounts;
pub use gold::GoldWork;

use self::advice::Advice;
use self::field_models::FieldModels;
use self::gold::Gold;
use self::memo::{Follows, Memo};
use self::templates::Templates;
use super::Versioned;
use std::sync::Arc;
use touchline_calibration::calibrate::{Disagreements, FrameLookup};
use touchline_calibration::proposals::{Coverage, LabelAdvice};
use touchline_core::field::{FieldError, FieldModel, Template};
use touchline_documents::document::{Document, FieldSpec, Fields, Frame};

/// What follows from a document.
#[derive(Clone, Debug, Default)]
pub(super) struct Derived {
    lookup: Memo<FrameLookup>,
    counts: Memo<FrameCounts>,
    disagreements: Memo<Disagreements>,
    fields: Memo<FieldModels>,
    templates: Templates,
    gold: Gold,
    advice: Advice,
}

impl Follows for FrameLookup {
    fn update(&mut self, document: &Document) {
        Self::update(self, document);
    }
}

impl Follows for Disagreements {
    fn update(&mut self, document: &Document) {
        Self::update(self, document);
    }
}

impl Derived {
    /// What calibrating looks up.
    pub(super) fn lookup(&mut self, document: &Versioned<Document>) -> &FrameLookup {
        self.lookup.at(document)
    }

    /// How many frames there are of each kind.
    pub(super) fn counts(&mut self, document: &Versioned<Document>) -> &FrameCounts {
        self.counts.at(document)
    }

    /// The counts of the version that they were asked for last.
    pub(super) const fn last_counts(&self) -> &FrameCounts {
        self.counts.last()
    }

    /// How solved frames lie to their neighbours.
    pub(super) fn disagreements(&mut self, document: &Versioned<Document>) -> &Disagreements {
        self.disagreements.at(document)
    }

    /// A field of the document with the click noise that it uses.
    pub(super) fn field(
        &mut self,
        document: &Versioned<Document>,
        spec: &FieldSpec,
    ) -> Result<Arc<FieldModel>, FieldError> {
        self.fields
            .at_mut(document)
            .model(document, spec, &mut self.templates)
    }

    /// The fields of all cameras.
    pub(super) fn fields(
        &mut self,
        document: &Versioned<Document>,
    ) -> Result<Arc<Fields>, FieldError> {
        self.fields
            .at_mut(document)
            .all(document, &mut self.templates)
    }

    /// The field of a frame in a document as it might become.
    pub(super) fn field_in(
        &mut self,
        document: &Document,
        frame: &Frame,
    ) -> Result<FieldModel, FieldError> {
        self.templates.weighted(document, document.field_of(frame))
    }

    /// The templates that have to be read before a field can be built, each told once.
    pub(super) fn take_wanted_templates(&mut self) -> Vec<String> {
        self.templates.take_wanted()
    }

    /// A template was read, or cannot be; what follows from it follows with the document's next
    /// version.
    pub(super) fn template_read(
        &mut self,
        name: &str,
        template: Result<Box<Template>, FieldError>,
    ) {
        self.templates.put(name, template);
    }

    /// Templates that could not be read are to be read again: their files may have been mended.
    pub(super) fn want_failed_templates_again(&mut self) {
        self.templates.want_failed_again();
        self.fields = Memo::default();
        self.gold.forget();
    }

    /// Where to label next after a journalled edit; `coverage` has where references look. Where
    /// nothing lacks an answer no frame is looked at.
    pub(super) fn label_advice(
        &mut self,
        document: &Versioned<Document>,
        revision: u64,
        coverage: &Arc<[Coverage]>,
    ) -> LabelAdvice {
        let counts = self.counts.at(document);
        if (counts.unanswered, counts.uncertain) == (0, 0) {
            return LabelAdvice::default();
        }
        self.advice.at(document, revision, coverage)
    }

    /// What gold frames and their repeats say.
    pub(super) fn gold(&mut self, document: &Versioned<Document>) -> &GoldWork {
        let counts = self.counts.at(document);
        self.gold.update(document, counts, &mut self.templates);
        &self.gold.work
    }

    /// What gold frames said when it was asked for last.
    pub(super) const fn last_gold(&self) -> &GoldWork {
        &self.gold.work
    }
}

/// Every field that a document names, its own last; the same one may be there more than once.
fn field_specs(document: &Document) -> Vec<FieldSpec> {
    let own = document
        .cameras
        .iter()
        .filter_map(|camera| camera.field.as_ref());
    own.chain([&document.field]).cloned().collect()
}
