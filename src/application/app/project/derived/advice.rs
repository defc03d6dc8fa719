//! Advice where to label next.

use super::memo::{Follows, Memo};
use crate::app::Versioned;
use std::sync::Arc;
use touchline_calibration::proposals::{Coverage, LabelAdvice, LabelNeeds};
use touchline_documents::document::Document;

/// The advice, and the inputs from which it was computed.
#[derive(Clone, Debug, Default)]
pub(super) struct Advice {
    needs: Memo<LabelNeeds>,
    given: LabelAdvice,
    given_for: Option<GivenFor>,
}

#[derive(Clone, Debug)]
struct GivenFor {
    /// The number of journalled edits.
    revision: u64,
    /// The edition of the needs; it grows with every change of them.
    edition: u64,
    /// The coverage by references.
    coverage: Arc<[Coverage]>,
}

impl Follows for LabelNeeds {
    fn update(&mut self, document: &Document) {
        Self::update(self, document);
    }
}

impl Advice {
    /// The advice for a document after its journalled edit `revision`. It does not change during a
    /// drag, which is journalled as one edit at its end.
    pub(super) fn at(
        &mut self,
        document: &Versioned<Document>,
        revision: u64,
        coverage: &Arc<[Coverage]>,
    ) -> LabelAdvice {
        let known = self
            .given_for
            .as_ref()
            .filter(|known| Arc::ptr_eq(&known.coverage, coverage));
        // Two levels: without a new edit nothing is examined, and after an edit that leaves the
        // needs as they are the advice stays.
        if known.is_some_and(|known| known.revision == revision) {
            return self.given;
        }
        let known_edition = known.map(|known| known.edition);
        let needs = self.needs.at(document);
        let edition = needs.edition();
        if known_edition != Some(edition) {
            self.given = LabelAdvice::from_needs(needs, coverage);
        }
        self.given_for = Some(GivenFor {
            revision,
            edition,
            coverage: Arc::clone(coverage),
        });
        self.given
    }
}
