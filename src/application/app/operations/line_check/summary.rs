//! What a line check says in brief: the verdict on a frame's painted lines, as texts for panels. It
//! comes from a fresh check or from the evidence that a document stores.

use touchline_core::markings::LineVerdict;
use touchline_documents::document::PaintEvidence;
use touchline_vision::paint::LineCheck;

/// The line check of a camera, as the window shows it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LineCheckSummary {
    /// The verdict.
    pub verdict: LineVerdict,
    /// Number of samples on the lines with paint nearby.
    pub found: usize,
    /// Number of samples on the lines where nothing hides the ground.
    pub open: usize,
    /// Median distance of the paint from the lines, px; none if no paint was found.
    pub offset_px: Option<f64>,
}

impl LineCheckSummary {
    pub(super) fn from_check(check: &LineCheck) -> Self {
        let offset_px = Some(check.offset_px).filter(|offset| offset.is_finite());
        Self {
            verdict: check.verdict(),
            found: check.found,
            open: check.num_open(),
            offset_px,
        }
    }

    pub(super) fn from_evidence(evidence: &PaintEvidence) -> Self {
        let open = evidence.open();
        Self {
            verdict: evidence.verdict(),
            found: evidence.found,
            open,
            offset_px: evidence.offset_px,
        }
    }

    /// The verdict in three words.
    #[must_use]
    pub const fn in_brief(&self) -> &'static str {
        match self.verdict {
            LineVerdict::Supports => "on painted lines",
            LineVerdict::Contradicts => "off painted lines",
            LineVerdict::CannotSay => "painted lines unclear",
        }
    }

    /// One line: "on the painted lines (0.8 px at 212 of 230 open places)".
    #[must_use]
    pub fn describe(&self) -> String {
        let Self { found, open, .. } = self;
        match (self.verdict, self.offset_px) {
            (LineVerdict::Supports, Some(px)) => {
                format!("on the painted lines ({px:.1} px at {found} of {open} open places)")
            }
            (LineVerdict::Supports, None) => {
                format!("on the painted lines ({found} of {open} open places)")
            }
            (LineVerdict::Contradicts, _) => {
                format!("the painted lines are elsewhere (paint at {found} of {open} open places)")
            }
            (LineVerdict::CannotSay, _) => {
                format!("the painted lines do not decide (paint at {found} of {open} open places)")
            }
        }
    }
}
