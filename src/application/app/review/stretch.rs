//! A stretch of frames that is to be accepted together: the frames on the paint, and the others by
//! the reason why they are left.
//!
//! It is counted once, when the sheet opens: what is found out about the frames afterwards does not
//! change the list that a person is looking at.

use super::{BulkAccept, ReviewChoice, ReviewRow, doubtful_first};
use crate::app::OpenProject;
use crate::app::project::selection::runs_of;
use std::collections::{BTreeMap, BTreeSet};
use touchline_calibration::calibrate::Disagreement;
use touchline_core::geometry::thousands;
use touchline_documents::document::Frames;

/// How many runs of frame numbers a reason names.
const NAMED_RUNS: usize = 4;

/// Why a frame of a stretch is not accepted with the others, in the order in which the sheet names
/// the reasons.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum LeftReason {
    /// It has no camera, or its camera has no base.
    NoCamera,
    /// No camera of a match stands or looks like this.
    Impossible,
    /// The painted lines lie elsewhere in the picture.
    OffPaint,
    /// Its points contradict each other or the camera.
    PointsDisagree,
    /// One of its points has no name.
    UnnamedPoint,
    /// The program takes its own proposal for more likely wrong than right.
    Unlikely,
    /// Too little paint is in view to decide.
    PaintUndecided,
    /// The background check has not come to it yet.
    NotChecked,
    /// A person marked it as not calibratable.
    Rejected,
}

impl LeftReason {
    /// What follows the number of the frames: "2 without a camera".
    pub const fn describe(self) -> &'static str {
        match self {
            Self::NoCamera => "without a camera",
            Self::Impossible => "with an impossible camera",
            Self::OffPaint => "contradicted by the painted lines",
            Self::PointsDisagree => "contradicted by points",
            Self::UnnamedPoint => "with a point that has no name",
            Self::Unlikely => "more likely wrong than right",
            Self::PaintUndecided => "where the painted lines do not decide",
            Self::NotChecked => "not checked against the painted lines yet",
            Self::Rejected => "marked as not calibratable",
        }
    }
}

/// What becomes of the frames of a stretch that are not accepted with the others.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct LeftFrames {
    /// How many are accepted already.
    pub accepted: usize,
    /// The places of the others by their reason, ascending.
    pub by_reason: BTreeMap<LeftReason, Vec<usize>>,
}

impl LeftFrames {
    /// How many are left for a reason.
    pub fn count(&self) -> usize {
        self.by_reason.values().map(Vec::len).sum()
    }

    /// One sentence: "196 on the paint, 4 left: 3 without a camera (frames 3, 9–10), 1 contradicted
    /// by the painted lines (frame 17)." `on_paint` is the number of those that are accepted.
    pub fn describe(&self, on_paint: usize, open: &OpenProject) -> String {
        let reasons: Vec<String> = self
            .by_reason
            .iter()
            .map(|(reason, places)| describe_reason(*reason, places, open))
            .collect();
        let left = match self.count() {
            0 => "none left".to_owned(),
            count => format!("{} left: {}", thousands(count), reasons.join(", ")),
        };
        let accepted = match self.accepted {
            0 => String::new(),
            1 => " 1 is accepted already.".to_owned(),
            count => format!(" {} are accepted already.", thousands(count)),
        };
        format!("{} on the paint, {left}.{accepted}", thousands(on_paint))
    }
}

/// "3 without a camera (frames 3, 9–10)": the first runs of frame numbers are named.
fn describe_reason(reason: LeftReason, places: &[usize], open: &OpenProject) -> String {
    let word = if places.len() == 1 { "frame" } else { "frames" };
    let runs = runs_of(places.iter().copied());
    let mut named: Vec<String> = runs
        .iter()
        .take(NAMED_RUNS)
        .map(|run| describe_run(*run, open))
        .collect();
    if runs.len() > NAMED_RUNS {
        named.push("…".to_owned());
    }
    let count = thousands(places.len());
    format!(
        "{count} {} ({word} {})",
        reason.describe(),
        named.join(", ")
    )
}

/// "17", or "17–30".
fn describe_run([first, last]: [usize; 2], open: &OpenProject) -> String {
    let first_number = open.frame_number(first);
    if first == last {
        return first_number.to_string();
    }
    format!("{first_number}–{}", open.frame_number(last))
}

/// What the open sheet asks about, as it was when it opened.
#[derive(Clone, Debug)]
pub(in crate::app) enum AcceptQuestion {
    /// The suggestions of the document, by their confidence.
    Suggestions(Frames),
    /// A stretch of frames, by their paint.
    Stretch(Stretch),
}

/// A stretch of frames as it was counted.
#[derive(Clone, Debug)]
pub(in crate::app) struct Stretch {
    /// The frames of the document then.
    frames: Frames,
    /// Those on the paint.
    rows: Vec<ReviewRow>,
    /// The others.
    left: LeftFrames,
}

impl Stretch {
    /// An empty stretch of a document with these frames.
    pub(in crate::app) fn new(frames: Frames) -> Self {
        Self {
            frames,
            rows: Vec::new(),
            left: LeftFrames::default(),
        }
    }

    /// Adds a frame that is accepted with the others.
    pub(in crate::app) fn take(&mut self, place: usize, disagreement: Option<Disagreement>) {
        let Some(frame) = self.frames.get(place) else {
            return;
        };
        self.rows.push(ReviewRow::new(place, frame, disagreement));
    }

    /// Adds a frame that is left.
    pub(in crate::app) fn leave(&mut self, place: usize, reason: LeftReason) {
        self.left.by_reason.entry(reason).or_default().push(place);
    }

    /// Adds a frame that is accepted already.
    pub(in crate::app) const fn pass_over_accepted(&mut self) {
        self.left.accepted += 1;
    }

    /// What is accepted by a choice, given the frames as they are now. The threshold of the choice
    /// is about confidences; here the paint has decided.
    pub(in crate::app) fn bulk(&self, choice: &ReviewChoice, now: &Frames) -> BulkAccept {
        let (disagreeing, mut rows): (Vec<ReviewRow>, Vec<ReviewRow>) = self
            .rows
            .iter()
            .partition(|row| row.disagrees() && !choice.with_disagreeing);
        rows.sort_by(doubtful_first);
        let bulk = BulkAccept {
            rows,
            left_out: disagreeing.len(),
            late: 0,
            unticked: BTreeSet::new(),
            of_stretch: Some(self.left.clone()),
        };
        bulk.without_late(&self.frames, now)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use touchline_core::geometry::ImageSize;
    use touchline_documents::testing::{new_frame, soccer_document};

    #[test]
    fn what_is_left_is_named_by_number_and_reason() {
        let mut document = soccer_document();
        for index in 0..40 {
            let name = format!("{index}.jpg");
            let frame = new_frame(&name, ImageSize::new(64, 36));
            document.frames.push(frame.into());
        }
        let mut stretch = Stretch::new(document.frames.clone());
        let open = OpenProject::new(document, "/match/p.json".into(), "/match".into(), None);
        assert_eq!(
            stretch.left.describe(3, &open),
            "3 on the paint, none left."
        );
        for place in [3, 9, 10, 11, 20, 30, 32] {
            stretch.leave(place, LeftReason::NoCamera);
        }
        stretch.leave(17, LeftReason::OffPaint);
        stretch.pass_over_accepted();
        assert_eq!(
            stretch.left.describe(1_960, &open),
            "1,960 on the paint, 8 left: 7 without a camera (frames 3, 9–11, 20, 30, …), \
             1 contradicted by the painted lines (frame 17). 1 is accepted already."
        );
    }
}
