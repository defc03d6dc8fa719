//! The review list: the suggestions that wait for the user, in the chosen order, and the frames
//! without an answer.
//!
//! Suggestions may arrive while the user works through the list. While the list is held (the
//! pointer is over it), no row moves: an accepted or withdrawn suggestion keeps its row, and new
//! ones are appended. When it is released, it is sorted again.
//!
//! If few frames changed since the last update, only their rows are computed.

mod held;
mod stretch;

pub(super) use stretch::{AcceptQuestion, Stretch};
pub use stretch::{LeftFrames, LeftReason};

pub use super::review_choice::{ReviewChoice, ReviewOrder};

use super::OpenProject;
use super::session::{Dialog, Session, SidePanel};
use std::cmp::Ordering;
use std::collections::BTreeSet;
use touchline_calibration::calibrate::{Disagreement, Disagreements};
use touchline_calibration::proposals::{ExpectedWrong, LabelAdvice};
use touchline_core::markings::LineVerdict;
use touchline_documents::document::{
    CameraId, Clip, Document, Frame, FrameChanges, FrameStatus, Frames, Shared,
};

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
    /// Whether the frame is no longer a suggestion: it was accepted, rejected, corrected or
    /// withdrawn while the list was held.
    pub gone: bool,
}

/// Whether a suggestion disagrees with its neighbours so much that the user must look at it. The
/// limit grows with the distance between the two neighbours, because between distant frames the
/// camera may go anywhere.
#[must_use]
pub fn disagrees(found: &Disagreement) -> bool {
    found.apart_px > DISAGREES_PX.max(found.neighbours_px)
}

impl ReviewRow {
    /// The row of a frame of the document.
    fn new(place: usize, frame: &Frame, disagreement: Option<Disagreement>) -> Self {
        Self {
            frame: place,
            confidence: confidence(frame),
            disagreement,
            paint: frame.paint_verdict(),
            shift_by_mending_px: frame.shift_by_mending_px(),
            gone: false,
        }
    }

    /// Whether the frame disagrees with its neighbours; see [`disagrees`].
    #[must_use]
    pub fn disagrees(&self) -> bool {
        self.disagreement.as_ref().is_some_and(disagrees)
    }

    /// Whether the frame's camera equals those of the frames before and after exactly, which is
    /// right only if the picture does not move.
    #[must_use]
    pub fn is_still(&self) -> bool {
        self.disagreement
            .as_ref()
            .is_some_and(Disagreement::is_still)
    }

    /// The distance from what the neighbours predict, px.
    #[must_use]
    pub fn apart_px(&self) -> Option<f64> {
        self.disagreement.map(|found| found.apart_px)
    }
}

/// Suggestions that are accepted together.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct BulkAccept {
    /// The suggestions, least certain first.
    pub rows: Vec<ReviewRow>,
    /// Number of suggestions that are certain enough but disagree with their neighbours, and are
    /// left out.
    pub left_out: usize,
    /// Number of suggestions that are certain enough but arrived or changed after the sheet was
    /// opened, and are left out.
    pub late: usize,
    /// The frame indices of suggestions that the user unticked.
    pub unticked: BTreeSet<usize>,
    /// The frames that are left where a stretch is accepted; none where suggestions are accepted by
    /// their confidence.
    pub of_stretch: Option<LeftFrames>,
}

impl BulkAccept {
    /// Number of least certain suggestions in the preview.
    const DOUBTFUL: usize = 6;
    /// Number of samples of the others in the preview.
    const SAMPLES: usize = 6;

    /// Leaves out the frames that differ between the sheet's opening (`opened`) and the present
    /// (`now`): the user agrees only to what the sheet showed.
    #[must_use]
    pub(super) fn without_late(mut self, opened: &Frames, now: &Frames) -> Self {
        let found = self.rows.len();
        self.rows
            .retain(|row| opened.get(row.frame) == now.get(row.frame));
        self.late = found - self.rows.len();
        self
    }

    /// The suggestions that will be accepted.
    pub fn taken(&self) -> impl Iterator<Item = &ReviewRow> {
        self.rows
            .iter()
            .filter(|row| !self.unticked.contains(&row.frame))
    }

    /// The suggestions shown before the user agrees: the least certain, then samples spread over
    /// the rest up to the most certain. If all have the same confidence, samples only.
    #[must_use]
    pub fn preview(&self) -> Vec<ReviewRow> {
        // Confidences are compared as displayed, in percent.
        let shown = |row: &ReviewRow| row.confidence.map(percent);
        let certain = self.rows.last().and_then(shown);
        let less_certain = self
            .rows
            .iter()
            .take(Self::DOUBTFUL)
            .take_while(|row| shown(row) != certain)
            .count();
        let (doubtful, others) = self.rows.split_at(less_certain);
        let samples = (Self::DOUBTFUL + Self::SAMPLES - doubtful.len()).min(others.len());
        let spread = (1..=samples).map(|sample| others[sample * others.len() / samples - 1]);
        doubtful.iter().copied().chain(spread).collect()
    }

    /// The distribution of the number of wrong suggestions among those to be accepted, from their
    /// confidences.
    #[must_use]
    pub fn expected_wrong(&self) -> ExpectedWrong {
        ExpectedWrong::among(self.taken().filter_map(|row| row.confidence))
    }
}

/// The content of the sheet *Accept all* while it is open; recomputed once per change.
#[derive(Clone, Debug, PartialEq)]
pub struct AcceptSheet {
    /// What will be accepted.
    pub bulk: BulkAccept,
    /// The distribution of the number of wrong ones among it.
    pub expected_wrong: ExpectedWrong,
}

impl From<BulkAccept> for AcceptSheet {
    fn from(bulk: BulkAccept) -> Self {
        let expected_wrong = bulk.expected_wrong();
        Self {
            bulk,
            expected_wrong,
        }
    }
}

/// The review list: derived, never stored.
#[derive(Clone, Debug, Default)]
pub struct Review {
    /// The rows of the list; in the chosen order unless the list is held.
    pub rows: Vec<ReviewRow>,
    /// The number of rows at the end that were added since the list is held.
    pub late: usize,
    /// Suggestions of shots that the list represents by another one.
    pub hidden: Vec<ReviewRow>,
    /// Whether the suggestions belong to several shots.
    pub several_shots: bool,
    /// Advice where to label next: how many frames lack a reliable answer, and the frame to label.
    pub advice: LabelAdvice,
    derived_from: Option<Source>,
    /// The document's frames at the last update.
    frames: Frames,
}

/// The inputs of the list.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
struct Source {
    /// A counter that grows with every change of a suggested frame.
    suggestions: u64,
    order: ReviewOrder,
    one_per_shot: bool,
    /// A counter that grows with every change of a disagreement. None while the disagreements are
    /// neither shown nor used, because then they are not computed.
    neighbours: Option<u64>,
    held: bool,
}

impl Source {
    /// Whether both describe the same rows in the same order, if no frame has changed.
    fn is_same_list(self, other: Self) -> bool {
        let Self {
            order,
            one_per_shot,
            neighbours,
            ..
        } = other;
        (self.order, self.one_per_shot, self.neighbours.is_some())
            == (order, one_per_shot, neighbours.is_some())
    }
}

/// The frames whose rows may have changed.
enum Concerned {
    All,
    /// A flag for each frame of the document.
    Some(Vec<bool>),
}

impl Concerned {
    /// The frames at `places`, of a document with `frames` frames.
    fn places(places: &BTreeSet<usize>, frames: usize) -> Self {
        let mut concerned = vec![false; frames];
        for place in places {
            concerned[*place] = true;
        }
        Self::Some(concerned)
    }

    fn has(&self, frame: usize) -> bool {
        match self {
            Self::All => true,
            Self::Some(concerned) => concerned.get(frame) == Some(&true),
        }
    }
}

impl Review {
    /// Updates the list if its inputs have changed: from the changed frames if they are few,
    /// otherwise completely.
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
            neighbours: with_neighbours
                .then(|| open.derived.disagreements(&open.document).edition()),
            held: choice.held && listed,
        };
        let before = self.derived_from.replace(source);
        if before != Some(source) {
            let frames = std::mem::replace(&mut self.frames, open.document.frames.clone());
            let disagreements = with_neighbours.then(|| open.derived.disagreements(&open.document));
            let before = before.filter(|before| before.is_same_list(source));
            // The present rows can be reused unless the list was just released, which requires
            // sorting all rows, or shows one row per shot, which depends on all frames of the shot.
            let stays =
                before.filter(|before| !source.one_per_shot && (source.held || !before.held));
            let few =
                stays.and_then(|before| changed(&open.document, &frames, before, disagreements));
            let rows = rows_of(
                &open.document.frames,
                few.as_ref(),
                disagreements,
                choice.order,
            );
            let concerned = few.map_or(Concerned::All, |few| {
                Concerned::places(&few, open.document.frames.len())
            });
            // While the list is held, rows keep their positions; otherwise the new rows are merged.
            if source.held && !self.rows.is_empty() && before.is_some() {
                self.keep_places(&concerned, rows, choice.one_per_shot);
            } else {
                self.put_in_order(&concerned, rows, choice.order);
                (self.rows, self.hidden) = one_of_each(
                    std::mem::take(&mut self.rows),
                    &self.frames,
                    choice.one_per_shot,
                );
                self.late = 0;
            }
            self.several_shots = self.is_of_several_shots(&concerned);
        }
        self.advice = open.derived.label_advice(
            &open.document,
            open.revision,
            &session.trainer.status.coverage,
        );
    }

    /// Replaces the rows of the concerned frames by `rows`, which are sorted, and keeps the list
    /// sorted.
    fn put_in_order(&mut self, concerned: &Concerned, rows: Vec<ReviewRow>, order: ReviewOrder) {
        let mut newer = rows.into_iter().peekable();
        let mut merged = Vec::with_capacity(self.rows.len() + newer.len());
        for row in std::mem::take(&mut self.rows)
            .into_iter()
            .filter(|row| !concerned.has(row.frame))
        {
            while let Some(before) = newer.next_if(|newer| in_order(order, newer, &row).is_lt()) {
                merged.push(before);
            }
            merged.push(row);
        }
        merged.extend(newer);
        self.rows = merged;
    }

    /// Whether the suggestions belong to more than one shot. If all belonged to one before, only
    /// the concerned frames are examined.
    fn is_of_several_shots(&self, concerned: &Concerned) -> bool {
        let first = self.waiting().next().map(|row| shot_of(&self.frames, row));
        let mut rows = self
            .waiting()
            .filter(|row| self.several_shots || concerned.has(row.frame));
        rows.any(|row| Some(shot_of(&self.frames, row)) != first)
    }

    /// The suggestions that wait, including hidden ones.
    fn waiting(&self) -> impl Iterator<Item = &ReviewRow> {
        self.rows.iter().chain(&self.hidden).filter(|row| !row.gone)
    }

    /// The number of suggestions that wait.
    #[must_use]
    pub fn count(&self) -> usize {
        self.waiting().count()
    }

    /// For the user's choice: the number of suggestions that would be accepted together, the number
    /// left out, and the lowest confidence among the former.
    #[must_use]
    pub fn bulk_size(&self, choice: &ReviewChoice) -> (usize, usize, Option<f64>) {
        let (mut taken, mut left_out, mut lowest) = (0, 0, None);
        for row in self.waiting() {
            let Some(confidence) = row
                .confidence
                .filter(|confidence| *confidence >= choice.threshold)
            else {
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

    /// The suggestions that would be accepted together with the user's choice.
    #[must_use]
    pub fn bulk(&self, choice: &ReviewChoice) -> BulkAccept {
        let certain = |row: &&ReviewRow| {
            row.confidence
                .is_some_and(|confidence| confidence >= choice.threshold)
        };
        let (disagreeing, mut rows): (Vec<ReviewRow>, Vec<ReviewRow>) = self
            .waiting()
            .filter(certain)
            .partition(|row| row.disagrees() && !choice.with_disagreeing);
        rows.sort_by(doubtful_first);
        BulkAccept {
            rows,
            left_out: disagreeing.len(),
            late: 0,
            unticked: BTreeSet::new(),
            of_stretch: None,
        }
    }

    /// The frame of the next suggestion after or before a frame in the list's order, cyclically.
    /// None if there is no other.
    #[must_use]
    pub fn next(&self, frame: usize, forward: bool) -> Option<usize> {
        let here = self.rows.iter().position(|row| row.frame == frame);
        let (before, after) = match here {
            Some(here) => (&self.rows[..here], &self.rows[here + 1..]),
            None => (&self.rows[..], &self.rows[..0]),
        };
        let waits = |row: &&ReviewRow| !row.gone;
        let next = if forward {
            after.iter().chain(before).find(waits)
        } else {
            after.iter().chain(before).rfind(waits)
        };
        next.map(|row| row.frame)
    }
}

/// Orders by confidence, least first; rows without a confidence come first.
fn doubtful_first(a: &ReviewRow, b: &ReviewRow) -> Ordering {
    let certain = |row: &ReviewRow| row.confidence.unwrap_or(f64::NEG_INFINITY);
    certain(a).total_cmp(&certain(b))
}

/// Orders by what the paint says: contradicted, undecided, supported; equal ones by how far mending
/// moved them, the farthest first.
fn off_paint_first(a: &ReviewRow, b: &ReviewRow) -> Ordering {
    let verdict = |row: &ReviewRow| row.paint.unwrap_or(LineVerdict::CannotSay);
    let moved = |row: &ReviewRow| row.shift_by_mending_px.unwrap_or(0.0);
    verdict(a)
        .cmp(&verdict(b))
        .then_with(|| moved(b).total_cmp(&moved(a)))
}

/// Compares two rows in the chosen order; equal ones by time.
fn in_order(order: ReviewOrder, a: &ReviewRow, b: &ReviewRow) -> Ordering {
    let apart = |row: &ReviewRow| row.apart_px().unwrap_or(f64::NEG_INFINITY);
    let by_choice = match order {
        ReviewOrder::Confidence => doubtful_first(a, b),
        ReviewOrder::Disagreement => apart(b).total_cmp(&apart(a)),
        ReviewOrder::Paint => off_paint_first(a, b),
        ReviewOrder::Time => Ordering::Equal,
    };
    by_choice.then(a.frame.cmp(&b.frame))
}

/// The indices of the frames whose rows may differ from a former state of the list. None if there
/// are too many to update one by one.
fn changed(
    document: &Document,
    frames: &Frames,
    before: Source,
    disagreements: Option<&Disagreements>,
) -> Option<BTreeSet<usize>> {
    let FrameChanges::At(changed) = document.frames.changes_since(frames) else {
        return None;
    };
    let mut places: BTreeSet<usize> = changed.into_iter().collect();
    if let Some((disagreements, edition)) = disagreements.zip(before.neighbours) {
        places.extend(disagreements.changed_since(edition)?);
    }
    Some(places)
}

/// The rows of the suggested frames, of all or only at `places`, in the chosen order.
fn rows_of(
    frames: &Frames,
    places: Option<&BTreeSet<usize>>,
    disagreements: Option<&Disagreements>,
    order: ReviewOrder,
) -> Vec<ReviewRow> {
    let row = |(place, frame): (usize, &Shared<Frame>)| {
        let disagreement = disagreements.and_then(|disagreements| disagreements.of_frame(place));
        let is_suggested = frame.status == FrameStatus::Suggested;
        is_suggested.then(|| ReviewRow::new(place, frame, disagreement))
    };
    let mut rows: Vec<ReviewRow> = match places {
        Some(places) => places
            .iter()
            .filter_map(|place| row((*place, frames.get(*place)?)))
            .collect(),
        None => frames.iter().enumerate().filter_map(row).collect(),
    };
    rows.sort_unstable_by(|a, b| in_order(order, a, b));
    rows
}

/// With `one_per_shot`: the first row of each shot, and the other rows. Otherwise all rows, and
/// none.
fn one_of_each(
    rows: Vec<ReviewRow>,
    frames: &Frames,
    one_per_shot: bool,
) -> (Vec<ReviewRow>, Vec<ReviewRow>) {
    if !one_per_shot {
        return (rows, Vec::new());
    }
    let mut shots = BTreeSet::new();
    rows.into_iter()
        .partition(|row| shots.insert(shot_of(frames, row)))
}

/// The shot of a row's frame: its camera and clip.
fn shot_of<'a>(frames: &'a Frames, row: &ReviewRow) -> Option<(&'a CameraId, &'a Option<Clip>)> {
    frames
        .get(row.frame)
        .map(|frame| (&frame.camera, &frame.clip))
}

/// The stated probability that a frame's suggestion is right.
fn confidence(frame: &Frame) -> Option<f64> {
    frame
        .solution
        .as_ref()
        .and_then(|solution| solution.confidence)
}

/// A probability as text. At most 99.9 %, because certainty is never claimed.
#[must_use]
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
    use touchline_core::camera::{BaseAngles, CameraBase, Ptz, PtzCamera};
    use touchline_core::geometry::{ImageSize, Vec3};
    use touchline_documents::document::{
        Camera, Document, FieldSpec, FramePtz, ImportedCamera, PaintEvidence, Solution,
        SolutionSource,
    };

    fn opened(confidences: &[Option<f64>]) -> OpenProject {
        let mut document = Document::new(FieldSpec::new("soccer"));
        for &confidence in confidences {
            let mut frame = Frame::from_image("x.jpg", "main".into(), ImageSize::new(64, 36));
            frame.ptz = Some(FramePtz::new(Ptz::from_degrees(0.0, -9.0, 900.0), None));
            let solution = Solution {
                source: Some(SolutionSource::Forest),
                confidence,
                ..Solution::default()
            };
            frame.solution = Some(solution);
            frame.status = FrameStatus::Suggested;
            document.frames.push(frame.into());
        }
        OpenProject::new(
            document,
            "/match/project.json".into(),
            "/match".into(),
            None,
        )
    }

    fn review_of(open: &mut OpenProject, choice: ReviewChoice) -> Review {
        let mut session = Session::default();
        (session.panel, session.review) = (SidePanel::Review, choice);
        let mut review = Review::default();
        review.refresh(Some(open), &session);
        review
    }

    fn review(confidences: &[Option<f64>], order: ReviewOrder) -> Review {
        review_of(
            &mut opened(confidences),
            ReviewChoice {
                order,
                ..ReviewChoice::default()
            },
        )
    }

    #[test]
    fn of_each_shot_the_most_doubtful_stands_for_the_others() {
        let mut open = opened(&[Some(0.7), Some(0.9), Some(0.8), Some(0.6)]);
        for (frame, shot) in open.document.frames.iter_mut().zip([1, 1, 2, 2]) {
            frame.clip = Some(Clip::Number(shot));
        }
        let choice = ReviewChoice {
            one_per_shot: true,
            threshold: 0.5,
            ..ReviewChoice::default()
        };
        let review = review_of(&mut open, choice);
        assert!(review.several_shots);
        assert_eq!((frames(&review), review.hidden.len()), (vec![3, 0], 2));
        assert_eq!(
            review.bulk(&choice).rows.len(),
            4,
            "what is accepted together is all of them"
        );
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
        assert_eq!(
            (review.next(2, true), review.next(1, false)),
            (Some(1), Some(2)),
            "round and round"
        );
        assert_eq!(
            (review.next(77, true), review.next(77, false)),
            (Some(1), Some(2))
        );
        assert_eq!(Review::default().next(0, true), None);
    }

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
            let camera = PtzCamera::new(
                CameraBase::new(
                    Vec3::new(0.0, -60.0, 15.0),
                    BaseAngles::default().base_from_world(),
                    ImageSize::new(64, 36).centre(),
                ),
                Ptz::from_degrees(0.0, -9.0, 900.0),
            );
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
        let off_paint: Vec<bool> = open
            .document
            .frames
            .iter()
            .map(|frame| frame.is_suggested_off_paint())
            .collect();
        assert_eq!(off_paint, [false, true, false, true, false]);
    }

    #[test]
    fn together_are_accepted_the_certain_ones_that_agree_with_their_neighbours() {
        let mut review = review(
            &[Some(0.97), Some(0.99), Some(0.5), None],
            ReviewOrder::Time,
        );
        review.rows[1].disagreement = Some(Disagreement {
            apart_px: DISAGREES_PX + 1.0,
            neighbours_px: 5.0,
        });
        review.rows[0].disagreement = Some(Disagreement {
            apart_px: 90.0,
            neighbours_px: 100.0,
        });
        let choice = ReviewChoice {
            threshold: 0.9,
            ..ReviewChoice::default()
        };
        let bulk = review.bulk(&choice);
        assert_eq!(
            (
                bulk.rows.iter().map(|row| row.frame).collect::<Vec<_>>(),
                bulk.left_out
            ),
            (vec![0], 1)
        );
        let bulk = review.bulk(&ReviewChoice {
            with_disagreeing: true,
            ..choice
        });
        assert_eq!(
            (
                bulk.rows.iter().map(|row| row.frame).collect::<Vec<_>>(),
                bulk.left_out
            ),
            (vec![0, 1], 0)
        );
        assert_eq!(review.bulk_size(&choice), (1, 1, Some(0.97)));
        let none = ReviewChoice {
            threshold: 1.0,
            ..choice
        };
        assert!(review.bulk(&none).rows.is_empty());
        assert_eq!(review.bulk_size(&none), (0, 0, None));
    }

    #[test]
    fn before_many_are_accepted_the_doubtful_and_samples_of_the_whole_range_are_shown() {
        let confidences: Vec<Option<f64>> = (0..100)
            .map(|index| Some(0.5 + 0.004 * f64::from(index)))
            .collect();
        let review = review(&confidences, ReviewOrder::Time);
        let choice = ReviewChoice {
            threshold: 0.6,
            ..ReviewChoice::default()
        };
        let mut bulk = review.bulk(&choice);
        assert_eq!(bulk.rows.len(), 75);
        let shown: Vec<usize> = bulk.preview().iter().map(|row| row.frame).collect();
        assert_eq!(shown, [25, 26, 27, 28, 29, 30, 41, 53, 64, 76, 87, 99]);
        let all = bulk.expected_wrong();
        assert!(
            (all.mean
                - bulk
                    .rows
                    .iter()
                    .map(|row| 1.0 - row.confidence.unwrap())
                    .sum::<f64>())
            .abs()
                < 1e-9
        );
        assert!(all.least > 0 && (all.least as f64) < all.mean && all.mean < all.most as f64);
        bulk.unticked.extend([25, 26]);
        assert_eq!(
            (bulk.taken().count(), bulk.preview().len()),
            (73, 12),
            "what is taken out stays in sight"
        );
        assert!((all.mean - bulk.expected_wrong().mean - 0.796).abs() < 1e-9);
        let few = review.bulk(&ReviewChoice {
            threshold: 0.885,
            ..choice
        });
        assert_eq!(few.preview(), few.rows);
    }

    #[test]
    fn where_all_are_as_certain_samples_over_all_of_them_are_shown() {
        let review = self::review(&[Some(0.99); 48], ReviewOrder::Time);
        let shown: Vec<usize> = review
            .bulk(&ReviewChoice::default())
            .preview()
            .iter()
            .map(|row| row.frame)
            .collect();
        assert_eq!(shown, [3, 7, 11, 15, 19, 23, 27, 31, 35, 39, 43, 47]);
    }

    #[test]
    fn a_list_that_follows_a_few_changes_is_the_list_made_anew() {
        let mut open = opened(&[Some(0.7), Some(0.9), None, Some(0.6), Some(0.8), Some(0.5)]);
        let size = ImageSize::new(64, 36);
        let mut camera = Camera::new("main".into(), size);
        let level = BaseAngles::default().base_from_world();
        camera.set_base(&CameraBase::new(
            Vec3::new(0.0, -60.0, 15.0),
            level,
            size.centre(),
        ));
        open.document.cameras.push(camera.into());
        for (index, frame) in open.document.frames.iter_mut().enumerate() {
            frame.clip = Some(Clip::Number(1));
            frame.ptz = Some(FramePtz::new(
                Ptz::from_degrees(index as f64, -9.0, 90.0),
                None,
            ));
        }
        for order in ReviewOrder::ALL {
            let mut session = Session::default();
            (session.panel, session.review) = (
                SidePanel::Review,
                ReviewChoice {
                    order,
                    ..ReviewChoice::default()
                },
            );
            let mut review = Review::default();
            review.refresh(Some(&mut open), &session);
            let mut step = |change: &dyn Fn(&mut Document), open: &mut OpenProject| {
                change(&mut open.document);
                open.revision += 1;
                review.refresh(Some(open), &session);
                let anew = review_of(open, session.review);
                assert!(
                    review.rows.iter().any(|row| row.disagreement.is_some()),
                    "neighbours are compared"
                );
                assert_eq!(
                    (&review.rows, review.several_shots),
                    (&anew.rows, anew.several_shots),
                    "{order:?}"
                );
            };
            step(
                &|document| document.frames[1].status = FrameStatus::Reference,
                &mut open,
            );
            let turned = |document: &mut Document| {
                document.frames[3].ptz =
                    Some(FramePtz::new(Ptz::from_degrees(9.0, -9.0, 90.0), None));
            };
            step(&turned, &mut open);
            step(
                &|document| document.frames[4].clip = Some(Clip::Number(2)),
                &mut open,
            );
            step(
                &|document| document.frames[4].clip = Some(Clip::Number(1)),
                &mut open,
            );
            step(
                &|document| document.frames[1].status = FrameStatus::Suggested,
                &mut open,
            );
            step(
                &|document| document.frames[3].ptz = document.frames[2].ptz.clone(),
                &mut open,
            );
        }
    }

    #[test]
    fn a_probability_is_never_a_certainty() {
        assert_eq!(
            [0.42, 0.97, 0.9951, 1.0].map(percent),
            ["42 %", "97 %", "99.5 %", "99.9 %"]
        );
    }
}
