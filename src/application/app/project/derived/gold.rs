//! Values about gold frames and their repeats.

use super::templates::Templates;
use super::{FrameCounts, field_specs};
use std::sync::Arc;
use touchline_calibration::calibrate::{OwnNoise, can_choose_gold};
use touchline_core::field::FieldError;
use touchline_documents::document::{Document, FieldSpec, Fields};

/// Values about gold frames and their repeats: derived, never stored.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct GoldWork {
    /// Number of gold frames that are references.
    pub frames: usize,
    /// Whether the program could choose more references as gold frames.
    pub can_choose: bool,
    /// The annotator's click noise, measured from the repeats.
    pub own: OwnNoise,
}

/// The values, and the inputs of the click noise.
#[derive(Clone, Debug, Default)]
pub(super) struct Gold {
    pub(super) work: GoldWork,
    /// The edition of the repeats, and the fields on which they were clicked.
    measured: Option<(u64, Vec<FieldSpec>)>,
}

impl Gold {
    /// Makes the next update measure the click noise again, because fields may have changed.
    pub(super) fn forget(&mut self) {
        self.measured = None;
    }

    /// Updates the values for a document with the given counts. The click noise is measured again
    /// only if repeats or fields have changed.
    pub(super) fn update(
        &mut self,
        document: &Document,
        counts: &FrameCounts,
        templates: &mut Templates,
    ) {
        self.work.frames = counts.gold_references;
        self.work.can_choose = can_choose_gold(counts.gold, counts.could_be_gold);
        let of = (counts.repeats_edition(), field_specs(document));
        if self.measured.as_ref() != Some(&of) {
            let fields = Fields::with(document, |spec| {
                templates.unweighted_field(spec).map(Arc::new)
            });
            // While a template is being read, the next update tries again.
            self.measured = (!matches!(fields, Err(FieldError::BeingRead { .. }))).then_some(of);
            // The error of an invalid field is shown elsewhere.
            let own = fields.map(|fields| {
                OwnNoise::estimate_from_frames(document, &fields, counts.with_repeats())
            });
            self.work.own = own.unwrap_or_default();
        }
    }
}
