//! A row of the review list: a suggested frame with what the user judges it by, and the orders of
//! rows.

use super::ReviewOrder;
use std::cmp::Ordering;
use touchline_calibration::calibrate::Disagreement;
use touchline_core::markings::LineVerdict;
use touchline_documents::document::Frame;

/// Suggestions that are farther than this from what their neighbours predict are reviewed one by
/// one, px at 1920 px width.
pub const DISAGREES_PX: f64 = 20.0;

/// A suggested frame.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ReviewRow {
    /// The index of the frame in the document.
    pub frame: usize,
    /// The probability that the suggestion is right, if the program states one.
    pub confidence: Option<f64>,
    /// The disagreement with the frames before and after; none without both.
    pub disagreement: Option<Disagreement>,
    /// What the painted lines said about it, where that is recorded.
    pub paint: Option<LineVerdict>,
    /// How far mending moved the camera that it came with, px; infinitely far if that camera was
    /// impossible.
    pub shift_by_mending_px: Option<f64>,
    /// Where the camera looks, °; none without one.
    pub pan_deg: Option<f64>,
    /// Whether the frame is no longer a suggestion: it was accepted, rejected, corrected or
    /// withdrawn while the list was held.
    pub gone: bool,
}

/// Whether a suggestion disagrees with its neighbours so much that the user must look at it. The
/// limit grows with the distance between the two neighbours, because between distant frames the
/// camera may go anywhere.
pub fn disagrees(found: &Disagreement) -> bool {
    found.apart_px > DISAGREES_PX.max(found.neighbours_px)
}

impl ReviewRow {
    /// The row of a frame of the document.
    pub(super) fn new(place: usize, frame: &Frame, disagreement: Option<Disagreement>) -> Self {
        Self {
            frame: place,
            confidence: frame.confidence(),
            disagreement,
            paint: frame.paint_verdict(),
            shift_by_mending_px: frame.shift_by_mending_px(),
            pan_deg: frame.ptz.as_ref().map(|ptz| ptz.pan_deg),
            gone: false,
        }
    }

    /// Whether the frame disagrees with its neighbours; see [`disagrees`].
    pub fn disagrees(&self) -> bool {
        self.disagreement.as_ref().is_some_and(disagrees)
    }

    /// Whether the frame's camera equals those of the frames before and after exactly, which is
    /// right only if the picture does not move.
    pub fn is_still(&self) -> bool {
        self.disagreement
            .as_ref()
            .is_some_and(Disagreement::is_still)
    }

    /// The distance from what the neighbours predict, px.
    pub fn apart_px(&self) -> Option<f64> {
        self.disagreement.map(|found| found.apart_px)
    }
}

/// Orders by confidence, least first; rows without a confidence come first.
pub(super) fn doubtful_first(a: &ReviewRow, b: &ReviewRow) -> Ordering {
    let certain = |row: &ReviewRow| row.confidence.unwrap_or(f64::NEG_INFINITY);
    certain(a).total_cmp(&certain(b))
}

/// Orders by what the paint says: contradicted, undecided, supported; equal ones by how far mending
/// moved them, the farthest first.
fn off_paint_first(a: &ReviewRow, b: &ReviewRow) -> Ordering {
    let verdict = |row: &ReviewRow| row.paint.unwrap_or(LineVerdict::CannotSay);
    verdict(a)
        .cmp(&verdict(b))
        .then_with(|| moved_px(b).total_cmp(&moved_px(a)))
}

/// How far mending moved a frame's camera, px; 0 for a frame that was not imported.
fn moved_px(row: &ReviewRow) -> f64 {
    row.shift_by_mending_px.unwrap_or(0.0)
}

/// Where a row's camera looks, °; rows without one stand at the left.
fn pan_deg(row: &ReviewRow) -> f64 {
    row.pan_deg.unwrap_or(f64::NEG_INFINITY)
}

/// Compares two rows in the chosen order; equal ones by time.
pub(super) fn in_order(order: ReviewOrder, a: &ReviewRow, b: &ReviewRow) -> Ordering {
    let apart = |row: &ReviewRow| row.apart_px().unwrap_or(f64::NEG_INFINITY);
    let by_choice = match order {
        ReviewOrder::Confidence => doubtful_first(a, b),
        ReviewOrder::Disagreement => apart(b).total_cmp(&apart(a)),
        ReviewOrder::Paint => off_paint_first(a, b),
        ReviewOrder::Moved => moved_px(b).total_cmp(&moved_px(a)),
        ReviewOrder::Pan => pan_deg(a).total_cmp(&pan_deg(b)),
        ReviewOrder::Time => Ordering::Equal,
    };
    by_choice.then(a.frame.cmp(&b.frame))
}

/// A probability as text. At most 99.9 %, because certainty is never claimed.
pub fn percent(probability: f64) -> String {
    let percent = 100.0 * probability;
    if percent >= 99.5 {
        format!("{:.1} %", percent.min(99.9))
    } else {
        format!("{percent:.0} %")
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::app::review::ReviewChoice;
    use crate::app::review::tests::{frames, opened, review_of};
    use touchline_core::geometry::ImageSize;
    use touchline_core::testing::{TestBase, base_at};
    use touchline_documents::document::{ImportedCamera, PaintEvidence};

    #[test]
    fn what_the_paint_contradicts_comes_first_and_then_what_was_moved_farthest() {
        let mut open = opened(&[Some(0.9); 5]);
        let verdicts = [
            (0.99, 3.0),
            (0.5, 0.0),
            (0.99, 60.0),
            (0.01, 2.0),
            (0.99, f64::INFINITY),
        ];
        for (frame, (score, moved_px)) in open.document.frames.iter_mut().zip(verdicts) {
            let camera = base_at([0.0, -60.0, 15.0], ImageSize::new(64, 36)).aim(0.0, -9.0, 900.0);
            let fault = moved_px
                .is_infinite()
                .then(|| "under the ground".to_owned());
            let solution = frame.solution.as_mut().unwrap();
            solution.imported = ImportedCamera::new(&camera, Some(moved_px), fault);
            solution.line_check = Some(PaintEvidence {
                score,
                predicted: 100,
                found: 90,
                bare: 10,
                ..PaintEvidence::default()
            });
        }
        let choice = ReviewChoice {
            order: ReviewOrder::Paint,
            ..ReviewChoice::default()
        };
        let review = review_of(&mut open, choice);
        assert_eq!(frames(&review), [3, 1, 4, 2, 0]);
        let by_distance = ReviewChoice {
            order: ReviewOrder::Moved,
            ..choice
        };
        let review = review_of(&mut open, by_distance);
        assert_eq!(frames(&review), [4, 2, 0, 3, 1]);
        let off_paint: Vec<bool> = open
            .document
            .frames
            .iter()
            .map(|frame| frame.is_suggested_off_paint())
            .collect();
        assert_eq!(off_paint, [false, true, false, true, false]);
    }

    #[test]
    fn a_probability_is_never_a_certainty() {
        assert_eq!(
            [0.42, 0.97, 0.9951, 1.0].map(percent),
            ["42 %", "97 %", "99.5 %", "99.9 %"]
        );
    }
}
