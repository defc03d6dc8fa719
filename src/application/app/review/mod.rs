//! The review list: the suggestions that wait for the user, in the chosen order, and the frames
//! without an answer.
//!
//! Suggestions may arrive while the user works through the list. While the list is held (the
//! pointer is over it), no row moves: an accepted or withdrawn suggestion keeps its row, and new
//! ones are appended. When it is released, it is sorted again.
//!
//! | file | content |
//! |---|---|
//! | `row.rs` | a row, and the orders of rows |
//! | `refresh.rs` | how the list follows the document |
//! | `stretch.rs` | a stretch of frames that is accepted together |
//!
//! Here are the list itself and what is accepted from it together.

mod refresh;
mod row;
mod stretch;

pub use crate::app::window_state::choices::{ReviewChoice, ReviewOrder};
pub use row::{DISAGREES_PX, ReviewRow, disagrees, percent};
pub(super) use stretch::{AcceptQuestion, Stretch};
pub use stretch::{LeftFrames, LeftReason};

use self::refresh::Source;
use self::row::doubtful_first;
use std::collections::BTreeSet;
use touchline_calibration::proposals::{ExpectedWrong, LabelAdvice};
use touchline_documents::document::Frames;

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
    pub fn ticked_rows(&self) -> impl Iterator<Item = &ReviewRow> {
        self.rows
            .iter()
            .filter(|row| !self.unticked.contains(&row.frame))
    }

    /// The suggestions shown before the user agrees: the least certain, then samples spread over
    /// the rest up to the most certain. If all have the same confidence, samples only.
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
        // The last of `samples` equal parts of the others ends at the most certain row.
        let samples = (Self::DOUBTFUL + Self::SAMPLES - doubtful.len()).min(others.len());
        let spread = (1..=samples).map(|sample| others[sample * others.len() / samples - 1]);
        doubtful.iter().copied().chain(spread).collect()
    }

    /// The distribution of the number of wrong suggestions among those to be accepted, from their
    /// confidences.
    pub fn expected_wrong(&self) -> ExpectedWrong {
        ExpectedWrong::among(self.ticked_rows().filter_map(|row| row.confidence))
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

impl Review {
    /// The suggestions that wait, including hidden ones.
    fn waiting(&self) -> impl Iterator<Item = &ReviewRow> {
        self.rows.iter().chain(&self.hidden).filter(|row| !row.gone)
    }

    /// The number of suggestions that wait.
    pub fn count(&self) -> usize {
        self.waiting().count()
    }

    /// For the user's choice: the number of suggestions that would be accepted together, the number
    /// left out, and the lowest confidence among the former.
    pub fn bulk_size(&self, choice: &ReviewChoice) -> (usize, usize, Option<f64>) {
        // Called for each drawing of the panel, hence without the vectors of `bulk`.
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
    pub fn bulk(&self, choice: &ReviewChoice) -> BulkAccept {
        let (disagreeing, mut rows): (Vec<ReviewRow>, Vec<ReviewRow>) = self
            .waiting()
            .filter(|row| {
                row.confidence
                    .is_some_and(|confidence| confidence >= choice.threshold)
            })
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
    pub fn next(&self, frame: usize, forward: bool) -> Option<usize> {
        // Behind the shown frame first, then from the beginning up to it. A frame that is not in
        // the list stands before its first row.
        let here = self.rows.iter().position(|row| row.frame == frame);
        let (before, after) = match here {
            Some(here) => (&self.rows[..here], &self.rows[here + 1..]),
            None => (&self.rows[..], &self.rows[..0]),
        };
        let mut waiting = after.iter().chain(before).filter(|row| !row.gone);
        let next = if forward {
            waiting.next()
        } else {
            waiting.next_back()
        };
        next.map(|row| row.frame)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::app::OpenProject;
    use crate::app::window_state::session::{Session, SidePanel};
    use touchline_calibration::calibrate::Disagreement;
    use touchline_core::geometry::ImageSize;
    use touchline_documents::document::{FrameStatus, SolutionSource};
    use touchline_documents::testing::{answered_by, new_frame, ptz_at, soccer_document};

    pub(super) fn opened(confidences: &[Option<f64>]) -> OpenProject {
        let mut document = soccer_document();
        for &confidence in confidences {
            let mut frame = new_frame("x.jpg", ImageSize::new(64, 36));
            frame.ptz = ptz_at(0.0, -9.0, 900.0);
            frame.solution = answered_by(SolutionSource::Forest, confidence);
            frame.status = FrameStatus::Suggested;
            document.frames.push(frame.into());
        }
        OpenProject::with_document(document)
    }

    pub(super) fn review_of(open: &mut OpenProject, choice: ReviewChoice) -> Review {
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

    pub(super) fn frames(review: &Review) -> Vec<usize> {
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
            (bulk.ticked_rows().count(), bulk.preview().len()),
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
}
