//! Values derived from the document: computed on request, at most once for each version of the
//! document.
//!
//! Most values have a [`Memo`], whose key is the document's version. Values that depend on all
//! frames are updated from the frames that changed since the last request, so that an edit in a
//! document of 100,000 frames costs what one frame costs. [`Current`](crate::app::Current), the
//! review list and the quality page depend on these values and on the user's choices.

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
use crate::app::Versioned;
use std::sync::Arc;
use touchline_calibration::calibrate::{Disagreements, FrameLookup};
use touchline_calibration::proposals::{Coverage, LabelAdvice};
use touchline_core::field::{FieldError, FieldModel, Template};
use touchline_documents::document::{Document, FieldSpec, Fields, Frame};

/// The values derived from a document.
#[derive(Clone, Debug, Default)]
pub(in crate::app) struct Derived {
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
    /// Index of the frames for the calibration.
    pub(in crate::app) fn lookup(&mut self, document: &Versioned<Document>) -> &FrameLookup {
        self.lookup.at(document)
    }

    /// The counts of frames by kind.
    pub(in crate::app) fn counts(&mut self, document: &Versioned<Document>) -> &FrameCounts {
        self.counts.at(document)
    }

    /// The counts at their last request.
    pub(super) const fn last_counts(&self) -> &FrameCounts {
        self.counts.last()
    }

    /// The disagreements of solved frames with their neighbours.
    pub(in crate::app) fn disagreements(
        &mut self,
        document: &Versioned<Document>,
    ) -> &Disagreements {
        self.disagreements.at(document)
    }

    /// A field of the document, with the click noise that the document uses.
    pub(in crate::app) fn field(
        &mut self,
        document: &Versioned<Document>,
        spec: &FieldSpec,
    ) -> Result<Arc<FieldModel>, FieldError> {
        self.fields
            .at_mut(document)
            .model(document, spec, &mut self.templates)
    }

    /// The fields of all cameras.
    pub(in crate::app) fn fields(
        &mut self,
        document: &Versioned<Document>,
    ) -> Result<Arc<Fields>, FieldError> {
        self.fields
            .at_mut(document)
            .all(document, &mut self.templates)
    }

    /// The field of a frame in a document that differs from the open one.
    pub(in crate::app) fn field_in(
        &mut self,
        document: &Document,
        frame: &Frame,
    ) -> Result<FieldModel, FieldError> {
        self.templates
            .weighted_field(document, document.field_of(frame))
    }

    /// The templates that must be read before a field can be built. Each is returned once.
    pub(in crate::app) fn take_wanted_templates(&mut self) -> Vec<String> {
        self.templates.take_wanted()
    }

    /// Stores a template that was read, or the error. Fields that use it are built with the
    /// document's next version.
    pub(in crate::app) fn template_read(
        &mut self,
        name: &str,
        template: Result<Box<Template>, FieldError>,
    ) {
        self.templates.put(name, template);
    }

    /// Requests the templates that could not be read once more, because their files may have been
    /// corrected.
    pub(in crate::app) fn want_failed_templates_again(&mut self) {
        // Forget the fields, too: their errors are stored with them.
        self.templates.want_failed_again();
        self.fields = Memo::default();
        self.gold.forget();
    }

    /// Advice where to label next, for the document after its journalled edit `revision`.
    /// `coverage` says where references look. If no frame lacks an answer, nothing is computed.
    pub(in crate::app) fn label_advice(
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

    /// The values about gold frames and their repeats.
    pub(in crate::app) fn gold(&mut self, document: &Versioned<Document>) -> &GoldWork {
        let counts = self.counts.at(document);
        self.gold.update(document, counts, &mut self.templates);
        &self.gold.work
    }

    /// The values about gold frames at their last request.
    pub(in crate::app) const fn last_gold(&self) -> &GoldWork {
        &self.gold.work
    }
}

/// All fields that a document names: the cameras' own, then the document's. May contain duplicates.
fn field_specs(document: &Document) -> Vec<FieldSpec> {
    document.fields().cloned().collect()
}
