//! What waits to be looked at: the suggested frames in an order, and those without an answer.

use super::OpenProject;
use super::session::{Dialog, Panel, Session};
use crate::project::{Disagreement, Frame, FrameStatus, Unanswered, disagreements, unanswered};
use std::collections::BTreeSet;

/// Suggestions that lie farther than this from their neighbours' way are to be looked at one by one, px at 1920 px width.
pub const DISAGREES_PX: f64 = 20.0;

/// What the list of suggestions begins with.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum ReviewOrder {
    /// The most certain.
    #[default]
    Confidence,
    /// The one farthest from its neighbours' way.
    Disagreement,
    /// The first in the document.
    Time,
}

impl ReviewOrder {
    /// Every order, as the panel lists them.
    pub const ALL: [Self; 3] = [Self::Confidence, Self::Disagreement, Self::Time];

    /// What the panel calls it.
    #[must_use]
    pub const fn label(self) -> &'static str {
        match self {
            Self::Confidence => "Confidence",
            Self::Disagreement => "Disagreement",
            Self::Time => "Time",
        }
    }

    /// What it is good for.
    #[must_use]
    pub const fn about(self) -> &'static str {
        match self {
            Self::Confidence => "The most certain first: what lies above a line can be accepted at once.",
            Self::Disagreement => "Those first that lie farthest from the way between the frames before and after.",
            Self::Time => "In the order of the frames.",
        }
    }
}

/// What a person chose in the review panel.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ReviewChoice {
    /// The order of the list.
    pub order: ReviewOrder,
    /// Suggestions of at least this probability are accepted together.
    pub threshold: f64,
    /// Also those that disagree with their neighbours.
    pub with_disagreeing: bool,
    /// The list has one suggestion a shot.
    pub one_per_shot: bool,
}

impl Default for ReviewChoice {
    fn default() -> Self {
        Self { order: ReviewOrder::default(), threshold: 0.95, with_disagreeing: false, one_per_shot: false }
    }
}

/// A suggested frame.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ReviewRow {
    /// Its place in the document.
    pub frame: usize,
    /// The probability that it is right, if the program gave one.
    pub confidence: Option<f64>,
    /// How it lies to the frames before and after; none where there are none.
    pub disagreement: Option<Disagreement>,
}

/// Whether a frame is to be looked at by itself: it lies off its neighbours' way by more than they are apart, since between
/// frames that are seconds apart a camera goes anywhere.
#[must_use]
pub fn disagrees(found: &Disagreement) -> bool {
    found.apart_px > DISAGREES_PX.max(found.neighbours_px)
}

impl ReviewRow {
    /// Whether it is to be looked at by itself.
    #[must_use]
    pub fn disagrees(&self) -> bool {
        self.disagreement.as_ref().is_some_and(disagrees)
    }

    /// How far it is from its neighbours' way, px.
    #[must_use]
    pub fn apart_px(&self) -> Option<f64> {
        self.disagreement.map(|found| found.apart_px)
    }
}

/// What is accepted together.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct BulkAccept {
    /// The suggestions, the least certain first.
    pub rows: Vec<ReviewRow>,
    /// Certain enough, but left out because they disagree with their neighbours.
    pub left_out: usize,
}

/// What waits to be looked at: derived, never stored.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Review {
    /// The suggested frames of the list, in the chosen order.
    pub rows: Vec<ReviewRow>,
    /// Suggested frames of shots that the list shows by another one.
    pub hidden: Vec<ReviewRow>,
    /// The suggested frames are of several shots.
    pub several_shots: bool,
    /// Frames without an answer.
    pub unanswered: Unanswered,
    derived_from: Option<(u64, ReviewOrder, bool, bool)>,
}

impl Review {
    /// Derives it anew if something changed since the last time.
    pub(super) fn refresh(&mut self, open: Option<&OpenProject>, session: &Session) {
        let Some(open) = open else {
            *self = Self::default();
            return;
        };
        // Neighbours are compared only while somebody looks at the result.
        let shown = session.panel == Panel::Review || session.dialog == Some(Dialog::AcceptAll);
        let choice = &session.review;
        let from = (open.revision, choice.order, choice.one_per_shot, shown);
        if self.derived_from != Some(from) {
            *self = Self::derive(open, choice, shown);
            self.derived_from = Some(from);
        }
    }

    fn derive(open: &OpenProject, choice: &ReviewChoice, with_neighbours: bool) -> Self {
        let frames = &open.document.frames;
        let suggested = |(_, frame): &(usize, &Frame)| frame.status == FrameStatus::Suggested;
        let mut rows: Vec<ReviewRow> = frames
            .iter()
            .map(|frame| &**frame)
            .enumerate()
            .filter(suggested)
            .map(|(index, frame)| ReviewRow { frame: index, confidence: confidence(frame), disagreement: None })
            .collect();
        if with_neighbours && !rows.is_empty() {
            let found = disagreements(&open.document);
            for row in &mut rows {
                row.disagreement = found.get(row.frame).copied().flatten();
            }
        }
        // A stable sort: equal ones stay in the order of time.
        let descending = |value: fn(&ReviewRow) -> Option<f64>| {
            move |a: &ReviewRow, b: &ReviewRow| {
                value(b).unwrap_or(f64::NEG_INFINITY).total_cmp(&value(a).unwrap_or(f64::NEG_INFINITY))
            }
        };
        match choice.order {
            ReviewOrder::Confidence => rows.sort_by(descending(|row| row.confidence)),
            ReviewOrder::Disagreement => rows.sort_by(descending(ReviewRow::apart_px)),
            ReviewOrder::Time => {}
        }
        let mut shots = BTreeSet::new();
        let first_of_shot: Vec<bool> = rows
            .iter()
            .map(|row| {
                let frame = &frames[row.frame];
                shots.insert((&frame.camera, &frame.clip))
            })
            .collect();
        let mut first = first_of_shot.into_iter();
        let (rows, hidden) = rows.into_iter().partition(|_| first.next() == Some(true) || !choice.one_per_shot);
        Self {
            rows,
            hidden,
            several_shots: shots.len() > 1,
            unanswered: unanswered(&open.document),
            derived_from: None,
        }
    }

    /// How many suggestions are accepted together by a choice, how many are left out, and the least certain one's
    /// probability.
    #[must_use]
    pub fn bulk_size(&self, choice: &ReviewChoice) -> (usize, usize, Option<f64>) {
        let (mut taken, mut left_out, mut lowest) = (0, 0, None);
        for row in self.rows.iter().chain(&self.hidden) {
            let Some(confidence) = row.confidence.filter(|confidence| *confidence >= choice.threshold) else {
                continue;
            };
            if row.disagrees() && !choice.with_disagreeing {
                left_out += 1;
            } else {
                taken += 1;
                lowest = Some(lowest.map_or(confidence, |lowest: f64| lowest.min(confidence)));
            }
        }
        (taken, left_out, lowest)
    }

    /// What is accepted together by a choice.
    #[must_use]
    pub fn bulk(&self, choice: &ReviewChoice) -> BulkAccept {
        let certain = |row: &&ReviewRow| row.confidence.is_some_and(|confidence| confidence >= choice.threshold);
        let (disagreeing, mut rows): (Vec<ReviewRow>, Vec<ReviewRow>) = self
            .rows
            .iter()
            .chain(&self.hidden)
            .filter(certain)
            .partition(|row| row.disagrees() && !choice.with_disagreeing);
        rows.sort_by(|a, b| a.confidence.unwrap_or(0.0).total_cmp(&b.confidence.unwrap_or(0.0)));
        BulkAccept { rows, left_out: disagreeing.len() }
    }

    /// The suggestion after a frame, or before it, in the list's order, round and round; none where there is no other.
    #[must_use]
    pub fn next(&self, frame: usize, forward: bool) -> Option<usize> {
        let count = self.rows.len();
        let here = self.rows.iter().position(|row| row.frame == frame);
        let next = match (here, forward) {
            (Some(here), true) => (here + 1) % count,
            (Some(here), false) => (here + count - 1) % count,
            (None, true) => 0,
            (None, false) => count.checked_sub(1)?,
        };
        self.rows.get(next).map(|row| row.frame).filter(|next| *next != frame)
    }
}

/// The probability that a frame's suggestion is right.
fn confidence(frame: &Frame) -> Option<f64> {
    frame.solution.as_ref().and_then(|solution| solution.confidence)
}

/// A probability as a person reads it: certainty is never claimed.
#[must_use]
pub fn percent(probability: f64) -> String {
    let percent = 100.0 * probability;
    if percent >= 99.5 { format!("{:.1} %", percent.min(99.9)) } else { format!("{percent:.0} %") }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::app::Opened;
    use crate::camera::Ptz;
    use crate::geometry::ImageSize;
    use crate::project::{Clip, Document, FieldSpec, FramePtz, Solution, SolutionSource};

    fn opened(confidences: &[Option<f64>]) -> OpenProject {
        let mut document = Document::new(FieldSpec::new("soccer"));
        for &confidence in confidences {
            let mut frame = Frame::from_image("x.jpg", "main".into(), ImageSize::new(64, 36));
            frame.ptz = Some(FramePtz::new(Ptz::from_degrees(0.0, -9.0, 900.0), None));
            let solution = Solution { source: Some(SolutionSource::Forest), confidence, ..Solution::default() };
            frame.solution = Some(solution);
            frame.status = FrameStatus::Suggested;
            document.frames.push(frame.into());
        }
        OpenProject::new(Opened::new(document, "/match/project.json"))
    }

    fn review(confidences: &[Option<f64>], order: ReviewOrder) -> Review {
        let open = opened(confidences);
        Review::derive(&open, &ReviewChoice { order, ..ReviewChoice::default() }, true)
    }

    #[test]
    fn of_each_shot_the_most_certain_stands_for_the_others() {
        let mut open = opened(&[Some(0.7), Some(0.9), Some(0.8), Some(0.6)]);
        for (frame, shot) in open.document.frames.iter_mut().zip([1, 1, 2, 2]) {
            frame.clip = Some(Clip::Number(shot));
        }
        let choice = ReviewChoice { one_per_shot: true, threshold: 0.5, ..ReviewChoice::default() };
        let review = Review::derive(&open, &choice, false);
        assert!(review.several_shots);
        assert_eq!((frames(&review), review.hidden.len()), (vec![1, 2], 2));
        assert_eq!(review.bulk(&choice).rows.len(), 4, "what is accepted together is all of them");
    }

    fn frames(review: &Review) -> Vec<usize> {
        review.rows.iter().map(|row| row.frame).collect()
    }

    #[test]
    fn the_most_certain_come_first_and_those_without_a_number_last() {
        let confidences = [Some(0.7), None, Some(0.99), Some(0.7), Some(0.96)];
        let review = review(&confidences, ReviewOrder::Confidence);
        assert_eq!(frames(&review), [2, 4, 0, 3, 1]);
        assert_eq!(review.next(4, true), Some(0));
        assert_eq!(review.next(4, false), Some(2));
        assert_eq!((review.next(1, true), review.next(2, false)), (Some(2), Some(1)), "round and round");
        assert_eq!((review.next(77, true), review.next(77, false)), (Some(2), Some(1)));
        assert_eq!(Review::default().next(0, true), None);
    }

    #[test]
    fn together_are_accepted_the_certain_ones_that_agree_with_their_neighbours() {
        let mut review = review(&[Some(0.97), Some(0.99), Some(0.5), None], ReviewOrder::Time);
        review.rows[1].disagreement = Some(Disagreement { apart_px: DISAGREES_PX + 1.0, neighbours_px: 5.0 });
        review.rows[0].disagreement = Some(Disagreement { apart_px: 90.0, neighbours_px: 100.0 });
        let choice = ReviewChoice { threshold: 0.9, ..ReviewChoice::default() };
        let bulk = review.bulk(&choice);
        assert_eq!((bulk.rows.iter().map(|row| row.frame).collect::<Vec<_>>(), bulk.left_out), (vec![0], 1));
        let bulk = review.bulk(&ReviewChoice { with_disagreeing: true, ..choice });
        assert_eq!((bulk.rows.iter().map(|row| row.frame).collect::<Vec<_>>(), bulk.left_out), (vec![0, 1], 0));
        assert_eq!(review.bulk_size(&choice), (1, 1, Some(0.97)));
        let none = ReviewChoice { threshold: 1.0, ..choice };
        assert!(review.bulk(&none).rows.is_empty());
        assert_eq!(review.bulk_size(&none), (0, 0, None));
    }

    #[test]
    fn a_probability_is_never_a_certainty() {
        assert_eq!([0.42, 0.97, 0.9951, 1.0].map(percent), ["42 %", "97 %", "99.5 %", "99.9 %"]);
    }
}
