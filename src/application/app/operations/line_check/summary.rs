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
    pub const fn in_brief(&self) -> &'static str {
        match self.verdict {
            LineVerdict::Supports => "on painted lines",
            LineVerdict::Contradicts => "off painted lines",
            LineVerdict::CannotSay => "painted lines unclear",
        }
    }

    /// The share of the open places at which paint was found, as text: "97 %".
    fn share_found(&self) -> String {
        format!(
            "{:.0} %",
            100.0 * self.found as f64 / self.open.max(1) as f64
        )
    }

    /// One line: "on the painted lines: 0.7 px off, 97 % of the visible paint found".
    pub fn describe(&self) -> String {
        let found = self.share_found();
        match (self.verdict, self.offset_px) {
            (LineVerdict::Supports, Some(px)) => {
                format!("on the painted lines: {px:.1} px off, {found} of the visible paint found")
            }
            (LineVerdict::Supports, None) => {
                format!("on the painted lines: {found} of the visible paint found")
            }
            (LineVerdict::Contradicts, _) => {
                format!("the paint contradicts this camera ({found} found where it expects paint)")
            }
            (LineVerdict::CannotSay, Some(px)) => format!(
                "the paint neither supports nor contradicts this camera ({found} found, {px:.0} px \
                 off)"
            ),
            (LineVerdict::CannotSay, None) => {
                format!("the paint neither supports nor contradicts this camera ({found} found)")
            }
        }
    }
}
