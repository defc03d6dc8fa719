//! What speaks for and against a suggestion, in words.

use crate::ui::Panel;
use touchline_application::app::LineCheckSummary;
use touchline_application::app::review::{ReviewRow, percent};
use touchline_application::app::session::status_label;

/// What a row of the review list says. A row that is no longer a suggestion says only what became
/// of it.
pub struct RowFacts {
    /// The confidence, or what became of the row.
    pub confidence: String,
    /// Why the camera is unlikely.
    pub unlikely: Option<String>,
    /// How far it is from what its neighbours predict.
    pub neighbours: Option<String>,
    /// How far mending moved it.
    pub mended: Option<String>,
    /// What the painted lines say.
    pub paint: Option<LineCheckSummary>,
    /// Whether something about it is out of the usual.
    pub is_odd: bool,
}

impl RowFacts {
    /// None if the frame is gone from the document.
    pub fn new(panel: &Panel<'_>, row: &ReviewRow) -> Option<Self> {
        let frame = panel.app.open()?.frame(row.frame)?;
        if row.gone {
            return Some(Self {
                confidence: status_label(frame.status).to_lowercase(),
                unlikely: None,
                neighbours: None,
                mended: None,
                paint: None,
                is_odd: false,
            });
        }
        // Exactly equal cameras of neighbours are suspicious, unless the picture stands still as
        // well.
        let neighbours = row.apart_px().map(|px| {
            if row.is_still() {
                "camera exactly still".to_owned()
            } else {
                format!("{px:.0} px from neighbours")
            }
        });
        let unlikely = frame.why_unlikely().map(str::to_owned);
        Some(Self {
            confidence: row
                .confidence
                .map_or_else(|| "not known".to_owned(), percent),
            is_odd: unlikely.is_some() || row.disagrees() || row.is_still(),
            unlikely,
            neighbours,
            mended: row.shift_by_mending_px.map(describe_mended),
            paint: panel.app.paint_says(row.frame),
        })
    }

    /// The reasons to look at it: what is unlikely, its neighbours where they are out of line, its
    /// paint, mending.
    pub fn reasons(&self) -> String {
        let neighbours = self.neighbours.clone().filter(|_| self.is_odd);
        let paint = self.paint.as_ref().map(|says| says.in_brief().to_owned());
        let reasons = [
            self.unlikely.clone(),
            neighbours,
            paint,
            self.mended.clone(),
        ];
        reasons.into_iter().flatten().collect::<Vec<_>>().join(", ")
    }

    /// All of it, as a screen reader says it.
    pub fn in_full(&self) -> String {
        let reasons = self.reasons();
        if reasons.is_empty() {
            return self.confidence.clone();
        }
        format!("{}, {reasons}", self.confidence)
    }
}

/// How far mending moved the camera that a frame came with.
fn describe_mended(moved_px: f64) -> String {
    if moved_px.is_finite() {
        format!("moved {moved_px:.0} px")
    } else {
        "came impossible".to_owned()
    }
}
