//! What follows from the document: derived when somebody asks for it, once for each version of the document at most.
//!
//! There is one memo with one key, the document's version. What is derived from all frames is brought up to date from the
//! frames that changed since it was asked for last, so that an edit in a document of 100,000 frames costs what one frame costs.
//! [`Current`](super::Current), the review list and the quality page follow from these values and from what a person chose.

mod advice;
mod field_models;
mod frame_counts;
mod gold;
mod memo;

pub use frame_counts::FrameCounts;
pub use gold::GoldWork;

use self::advice::Advice;
use self::field_models::FieldModels;
use self::gold::Gold;
use self::memo::{Follows, Memo};
use super::Versioned;
use crate::calibrate::{Disagreements, FrameLookup};
use crate::document::{Document, FieldSpec, Fields};
use crate::field::{FieldError, FieldModel};
use crate::proposals::{Coverage, LabelAdvice};
use std::path::Path;
use std::sync::Arc;

/// What follows from a document.
#[derive(Clone, Debug, Default)]
pub(super) struct Derived {
    lookup: Memo<FrameLookup>,
    counts: Memo<FrameCounts>,
    disagreements: Memo<Disagreements>,
    fields: Memo<FieldModels>,
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

    /// A field of the document with the click noise that it uses; `folder` is the document's.
    pub(super) fn field(
        &mut self,
        document: &Versioned<Document>,
        folder: &Path,
        spec: &FieldSpec,
    ) -> Result<Arc<FieldModel>, FieldError> {
        self.fields.at_mut(document).model(document.at(folder), spec)
    }

    /// The fields of all cameras; `folder` is the document's.
    pub(super) fn fields(&mut self, document: &Versioned<Document>, folder: &Path) -> Result<Arc<Fields>, FieldError> {
        self.fields.at_mut(document).all(document.at(folder))
    }

    /// Where to label next after a journalled edit; `coverage` has where references look. Where nothing lacks an answer no frame is
    /// looked at.
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

    /// What gold frames and their repeats say; `folder` is the document's.
    pub(super) fn gold(&mut self, document: &Versioned<Document>, folder: &Path) -> &GoldWork {
        let counts = self.counts.at(document);
        self.gold.update(document.at(folder), counts);
        &self.gold.work
    }

    /// What gold frames said when it was asked for last.
    pub(super) const fn last_gold(&self) -> &GoldWork {
        &self.gold.work
    }
}

/// Every field that a document names, its own last; the same one may be there more than once.
fn field_specs(document: &Document) -> Vec<FieldSpec> {
    let own = document.cameras.iter().filter_map(|camera| camera.field.as_ref());
    own.chain([&document.field]).cloned().collect()
}
