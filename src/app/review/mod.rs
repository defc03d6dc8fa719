//! What waits to be looked at: the suggested frames in an order, and what has no answer.
//!
//! Suggestions come while a person looks through them. While the list is held, because the pointer is over it, no row moves:
//! one that is accepted or withdrawn stays in its place and new ones come last. Let go of, the list is in order again.

mod held;

pub use super::review_choice::{ReviewChoice, ReviewOrder};

use super::OpenProject;
use super::session::{Dialog, Session, SidePanel};
use crate::calibrate::Disagreement;
use crate::document::{Frame, FrameStatus};
use crate::proposals::{ExpectedWrong, LabelAdvice};
use std::collections::BTreeSet;

/// Suggestions that lie farther than this from their neighbours' way are to be looked at one by one, px at 1920 px width.
pub const DISAGREES_PX: f64 = 20.0;

/// A suggested frame.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ReviewRow {
    /// Its place in the document.
    pub frame: usize,
    /// The probability that it is right, if the program gave one.
    pub confidence: Option<f64>,
    /// How it lies to the frames before and after; none where there are none.
    pub disagreement: Option<Disagreement>,
    /// It is no longer a suggestion: accepted, rejected, corrected or withdrawn while the list was held.
    pub gone: bool,
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

    /// Whether its camera is exactly that of the frames before and after: only a picture that stands still bears that out.
    #[must_use]
    pub fn is_still(&self) -> bool {
        self.disagreement.as_ref().is_some_and(Disagreement::is_still)
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
    /// The places of those that a person has taken out.
    pub unticked: BTreeSet<usize>,
}

impl BulkAccept {
    /// As many of the most doubtful are shown before,
    const DOUBTFUL: usize = 6;
    /// and as many of the others, spread over the whole range of confidence.
    const SAMPLES: usize = 6;

    /// Those that are accepted.
    pub fn taken(&self) -> impl Iterator<Item = &ReviewRow> {
        self.rows.iter().filter(|row| !self.unticked.contains(&row.frame))
    }

    /// What a person looks at before: the most doubtful, then samples over the whole range of confidence up to the most certain.
    /// Where all are as certain as each other, samples alone.
    #[must_use]
    pub fn preview(&self) -> Vec<ReviewRow> {
        let shown = |row: &ReviewRow| row.confidence.map(percent);
        let certain = self.rows.last().and_then(shown);
        let less_certain = self.rows.iter().take(Self::DOUBTFUL).take_while(|row| shown(row) != certain).count();
        let (doubtful, others) = self.rows.split_at(less_certain);
        let samples = (Self::DOUBTFUL + Self::SAMPLES - doubtful.len()).min(others.len());
        let spread = (1..=samples).map(|sample| others[sample * others.len() / samples - 1]);
        doubtful.iter().copied().chain(spread).collect()
    }

    /// How many of those that are accepted are wrong, by their confidences.
    #[must_use]
    pub fn expected_wrong(&self) -> ExpectedWrong {
        ExpectedWrong::among(self.taken().filter_map(|row| row.confidence))
    }
}

/// What is accepted together while the sheet that asks for it is open, and what follows from it: derived once for each change.
#[derive(Clone, Debug, PartialEq)]
pub struct AcceptSheet {
    /// What is accepted.
    pub bulk: BulkAccept,
    /// How many of it are wrong.
    pub expected_wrong: ExpectedWrong,
}

impl From<BulkAccept> for AcceptSheet {
    fn from(bulk: BulkAccept) -> Self {
        let expected_wrong = bulk.expected_wrong();
        Self { bulk, expected_wrong }
    }
}

/// What waits to be looked at: derived, never stored.
#[derive(Clone, Debug, Default)]
pub struct Review {
    /// The frames of the list, in the chosen order as far as it is not held.
    pub rows: Vec<ReviewRow>,
    /// How many of the last rows were added since the list was held.
    pub late: usize,
    /// Suggested frames of shots that the list shows by another one.
    pub hidden: Vec<ReviewRow>,
    /// The suggested frames are of several shots.
    pub several_shots: bool,
    /// What has no answer to rely on, and the frame to label next.
    pub advice: LabelAdvice,
    derived_from: Option<Source>,
}

/// What the list is derived from.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
struct Source {
    /// Grows with every change of a suggested frame.
    suggestions: u64,
    order: ReviewOrder,
    one_per_shot: bool,
    /// Neighbours are compared only while somebody looks at the result; it grows with every change of that.
    neighbours: Option<u64>,
    held: bool,
}

impl Review {
    /// Derives it anew if something changed since the last time.
    pub(super) fn refresh(&mut self, open: Option<&mut OpenProject>, session: &Session) {
        let Some(open) = open else {
            *self = Self::default();
            return;
        };
        let choice = &session.review;
        let listed = session.panel == SidePanel::Review;
        let with_neighbours = listed || session.dialog == Some(Dialog::AcceptAll);
        let source = Source {
            suggestions: open.derived.counts(&open.document).suggestions_edition(),
            order: choice.order,
            one_per_shot: choice.one_per_shot,
            neighbours: with_neighbours.then(|| open.derived.disagreements(&open.document).edition()),
            held: choice.held && listed,
        };
        let before = self.derived_from.replace(source);
        if before != Some(source) {
            let now = Self::list(open, choice, with_neighbours);
            let is_same_list = |before: Source| {
                Source { suggestions: source.suggestions, neighbours: source.neighbours, held: source.held, ..before }
                    == source
            };
            if source.held && !self.rows.is_empty() && before.is_some_and(is_same_list) {
                self.keep_places(now, &open.document, choice.one_per_shot);
            } else {
                let Listed { rows, hidden, several_shots } = now;
                (self.rows, self.hidden, self.several_shots, self.late) = (rows, hidden, several_shots, 0);
            }
        }
        self.advice = open.derived.label_advice(&open.document, open.revision, &session.trainer.status.coverage);
    }

    /// The suggested frames in the chosen order.
    fn list(open: &mut OpenProject, choice: &ReviewChoice, with_neighbours: bool) -> Listed {
        let frames = &open.document.frames;
        let suggested = |(_, frame): &(usize, &Frame)| frame.status == FrameStatus::Suggested;
        let mut rows: Vec<ReviewRow> = frames
            .iter()
            .map(|frame| &**frame)
            .enumerate()
            .filter(suggested)
            .map(|(index, frame)| ReviewRow {
                frame: index,
                confidence: confidence(frame),
                disagreement: None,
                gone: false,
            })
            .collect();
        if with_neighbours && !rows.is_empty() {
            let found = open.derived.disagreements(&open.document);
            for row in &mut rows {
                row.disagreement = found.of_frame(row.frame);
            }
        }
        // A stable sort: equal ones stay in the order of time.
        let descending = |value: fn(&ReviewRow) -> Option<f64>| {
            move |a: &ReviewRow, b: &ReviewRow| {
                value(b).unwrap_or(f64::NEG_INFINITY).total_cmp(&value(a).unwrap_or(f64::NEG_INFINITY))
            }
        };
        match choice.order {
            ReviewOrder::Confidence => rows.sort_by(doubtful_first),
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
        Listed { rows, hidden, several_shots: shots.len() > 1 }
    }

    /// The suggestions that wait, whether the list shows them or not.
    fn waiting(&self) -> impl Iterator<Item = &ReviewRow> {
        self.rows.iter().chain(&self.hidden).filter(|row| !row.gone)
    }

    /// How many suggestions wait.
    #[must_use]
    pub fn count(&self) -> usize {
        self.waiting().count()
    }

    /// How many suggestions are accepted together by a choice, how many are left out, and the least certain one's
    /// probability.
    #[must_use]
    pub fn bulk_size(&self, choice: &ReviewChoice) -> (usize, usize, Option<f64>) {
        let (mut taken, mut left_out, mut lowest) = (0, 0, None);
        for row in self.waiting() {
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
        let (disagreeing, mut rows): (Vec<ReviewRow>, Vec<ReviewRow>) =
            self.waiting().filter(certain).partition(|row| row.disagrees() && !choice.with_disagreeing);
        rows.sort_by(doubtful_first);
        BulkAccept { rows, left_out: disagreeing.len(), unticked: BTreeSet::new() }
    }

    /// The suggestion after a frame, or before it, in the list's order, round and round; none where there is no other.
    #[must_use]
    pub fn next(&self, frame: usize, forward: bool) -> Option<usize> {
        let here = self.rows.iter().position(|row| row.frame == frame);
        let (before, after) = match here {
            Some(here) => (&self.rows[..here], &self.rows[here + 1..]),
            None => (&self.rows[..], &self.rows[..0]),
        };
        let waits = |row: &&ReviewRow| !row.gone;
        let next =
            if forward { after.iter().chain(before).find(waits) } else { after.iter().chain(before).rfind(waits) };
        next.map(|row| row.frame)
    }
}

/// The least certain first; what nobody is certain of before all others.
fn doubtful_first(a: &ReviewRow, b: &ReviewRow) -> std::cmp::Ordering {
    let certain = |row: &ReviewRow| row.confidence.unwrap_or(f64::NEG_INFINITY);
    certain(a).total_cmp(&certain(b))
}

/// The list in its order.
struct Listed {
    rows: Vec<ReviewRow>,
    hidden: Vec<ReviewRow>,
    several_shots: bool,
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
    use crate::camera::Ptz;
    use crate::document::{Clip, Document, FieldSpec, FramePtz, Solution, SolutionSource};
    use crate::geometry::ImageSize;

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
        OpenProject::new(document, "/match/project.json".into(), "/match".into(), None)
    }

    fn review_of(open: &mut OpenProject, choice: ReviewChoice) -> Review {
        let mut session = Session::default();
        (session.panel, session.review) = (SidePanel::Review, choice);
        let mut review = Review::default();
        review.refresh(Some(open), &session);
        review
    }

    fn review(confidences: &[Option<f64>], order: ReviewOrder) -> Review {
        review_of(&mut opened(confidences), ReviewChoice { order, ..ReviewChoice::default() })
    }

    #[test]
    fn of_each_shot_the_most_doubtful_stands_for_the_others() {
        let mut open = opened(&[Some(0.7), Some(0.9), Some(0.8), Some(0.6)]);
        for (frame, shot) in open.document.frames.iter_mut().zip([1, 1, 2, 2]) {
            frame.clip = Some(Clip::Number(shot));
        }
        let choice = ReviewChoice { one_per_shot: true, threshold: 0.5, ..ReviewChoice::default() };
        let review = review_of(&mut open, choice);
        assert!(review.several_shots);
        assert_eq!((frames(&review), review.hidden.len()), (vec![3, 0], 2));
        assert_eq!(review.bulk(&choice).rows.len(), 4, "what is accepted together is all of them");
    }

    fn frames(review: &Review) -> Vec<usize> {
        review.rows.iter().map(|row| row.frame).collect()
    }

    #[test]
    fn the_most_doubtful_come_first_and_those_without_a_number_before_all() {
        let confidences = [Some(0.7), None, Some(0.99), Some(0.7), Some(0.96)];
        let review = review(&confidences, ReviewOrder::Confidence);
        assert_eq!(frames(&review), [1, 0, 3, 4, 2]);
        assert_eq!(review.next(4, true), Some(2));
        assert_eq!(review.next(4, false), Some(3));
        assert_eq!((review.next(2, true), review.next(1, false)), (Some(1), Some(2)), "round and round");
        assert_eq!((review.next(77, true), review.next(77, false)), (Some(1), Some(2)));
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
    fn before_many_are_accepted_the_doubtful_and_samples_of_the_whole_range_are_shown() {
        let confidences: Vec<Option<f64>> = (0..100).map(|index| Some(0.5 + 0.004 * f64::from(index))).collect();
        let review = review(&confidences, ReviewOrder::Time);
        let choice = ReviewChoice { threshold: 0.6, ..ReviewChoice::default() };
        let mut bulk = review.bulk(&choice);
        assert_eq!(bulk.rows.len(), 75);
        let shown: Vec<usize> = bulk.preview().iter().map(|row| row.frame).collect();
        assert_eq!(shown, [25, 26, 27, 28, 29, 30, 41, 53, 64, 76, 87, 99]);
        let all = bulk.expected_wrong();
        assert!((all.mean - bulk.rows.iter().map(|row| 1.0 - row.confidence.unwrap()).sum::<f64>()).abs() < 1e-9);
        assert!(all.least > 0 && (all.least as f64) < all.mean && all.mean < all.most as f64);
        bulk.unticked.extend([25, 26]);
        assert_eq!((bulk.taken().count(), bulk.preview().len()), (73, 12), "what is taken out stays in sight");
        assert!((all.mean - bulk.expected_wrong().mean - 0.796).abs() < 1e-9);
        let few = review.bulk(&ReviewChoice { threshold: 0.885, ..choice });
        assert_eq!(few.preview(), few.rows);
    }

    #[test]
    fn where_all_are_as_certain_samples_over_all_of_them_are_shown() {
        let review = self::review(&[Some(0.99); 48], ReviewOrder::Time);
        let shown: Vec<usize> = review.bulk(&ReviewChoice::default()).preview().iter().map(|row| row.frame).collect();
        assert_eq!(shown, [3, 7, 11, 15, 19, 23, 27, 31, 35, 39, 43, 47]);
    }

    #[test]
    fn a_probability_is_never_a_certainty() {
        assert_eq!([0.42, 0.97, 0.9951, 1.0].map(percent), ["42 %", "97 %", "99.5 %", "99.9 %"]);
    }
}
