//! What gold frames and their repeats say.

use super::templates::Templates;
use super::{FrameCounts, field_specs};
use std::sync::Arc;
use touchline_calibration::calibrate::{OwnNoise, can_choose_gold};
use touchline_core::field::FieldError;
use touchline_documents::document::{Document, FieldSpec, Fields};

/// What gold frames and their repeats say: derived, never stored.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct GoldWork {
    /// Gold references.
    pub frames: usize,
    /// The program could make more references gold.
    pub can_choose: bool,
    /// What the repeats say of the annotator's click noise.
    pub own: OwnNoise,
}

/// The same, and what the click noise was derived from.
#[derive(Clone, Debug, Default)]
pub(super) struct Gold {
    pub(super) work: GoldWork,
    /// The edition of the repeats, and the fields that they were clicked on.
    measured: Option<(u64, Vec<FieldSpec>)>,
}

impl Gold {
    /// The fields may be others than they were.
    pub(super) fn forget(&mut self) {
        self.measured = None;
    }

    /// Brings it up to date with a document, whose counts these are. The repeats are looked at only
    /// where they have changed.
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
            let fields = Fields::with(document, |spec| templates.stated(spec).map(Arc::new));
            self.measured = (!matches!(fields, Err(FieldError::BeingRead { .. }))).then_some(of);
            // A field that is not valid is told of elsewhere.
            let own = |fields| OwnNoise::of_frames(document, &fields, counts.with_repeats());
            self.work.own = fields.map(own).unwrap_or_default();
        }
    }
}
