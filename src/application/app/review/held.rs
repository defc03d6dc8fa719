//! Updates the review list while it is held, so that no row moves.

use super::refresh::{AffectedRows, shot_of};
use super::{Review, ReviewRow};
use std::collections::{BTreeMap, BTreeSet};

impl Review {
    /// Takes in new rows of the concerned frames. Rows keep their positions, those that are no
    /// longer suggestions are marked as gone, new ones are appended. With `one_per_shot` a shot
    /// that has a row gets no second one.
    pub(super) fn keep_places(
        &mut self,
        concerned: &AffectedRows,
        now: Vec<ReviewRow>,
        one_per_shot: bool,
    ) {
        let mut newer: BTreeMap<usize, ReviewRow> =
            now.iter().map(|row| (row.frame, *row)).collect();
        let mut shown = BTreeSet::new();
        for row in &mut self.rows {
            if concerned.has(row.frame) {
                *row = newer
                    .remove(&row.frame)
                    .unwrap_or(ReviewRow { gone: true, ..*row });
            }
            if one_per_shot && !row.gone {
                shown.insert(shot_of(&self.frames, row));
            }
        }
        // What is left in `newer` has no row yet.
        self.hidden.clear();
        for row in now.into_iter().filter(|row| newer.contains_key(&row.frame)) {
            if one_per_shot && !shown.insert(shot_of(&self.frames, &row)) {
                self.hidden.push(row);
            } else {
                self.rows.push(row);
                self.late += 1;
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use crate::app::OpenProject;
    use crate::app::review::{Review, ReviewChoice};
    use crate::app::window_state::session::{Session, SidePanel};
    use touchline_core::geometry::ImageSize;
    use touchline_documents::document::{Clip, FrameStatus, Solution, SolutionSource};
    use touchline_documents::testing::{new_frame, ptz_at, soccer_document};

    /// Frames that belong to two shots alternately.
    fn opened(frames: usize) -> OpenProject {
        let mut document = soccer_document();
        for index in 0..frames {
            let mut frame = new_frame("x.jpg", ImageSize::new(64, 36));
            frame.clip = Some(Clip::Number(index as i64 % 2));
            document.frames.push(frame.into());
        }
        OpenProject::with_document(document)
    }

    /// Makes a suggestion for a frame, or replaces it.
    fn propose(open: &mut OpenProject, index: usize, confidence: f64) {
        let frame = &mut open.document.frames[index];
        frame.ptz = ptz_at(0.0, -9.0, 900.0);
        let solution = Solution {
            source: Some(SolutionSource::Forest),
            confidence: Some(confidence),
            ..Solution::default()
        };
        frame.solution = Some(solution);
        frame.status = FrameStatus::Suggested;
        open.revision += 1;
    }

    fn session(held: bool, one_per_shot: bool) -> Session {
        let review = ReviewChoice {
            one_per_shot,
            held,
            ..ReviewChoice::default()
        };
        let mut session = Session::default();
        (session.panel, session.review) = (SidePanel::Review, review);
        session
    }

    fn frames(review: &Review) -> Vec<usize> {
        review.rows.iter().map(|row| row.frame).collect()
    }

    #[test]
    fn while_it_is_held_no_row_moves_and_then_it_is_in_order() {
        let mut open = opened(6);
        propose(&mut open, 0, 0.7);
        propose(&mut open, 1, 0.9);
        let mut review = Review::default();
        let (free, held) = (session(false, false), session(true, false));
        review.refresh(Some(&mut open), &free);
        assert_eq!(frames(&review), [0, 1]);
        review.refresh(Some(&mut open), &held);
        propose(&mut open, 2, 0.8);
        propose(&mut open, 3, 0.99);
        propose(&mut open, 0, 0.95);
        open.document.frames[1].status = FrameStatus::Reference;
        review.refresh(Some(&mut open), &held);
        assert_eq!((frames(&review), review.late), (vec![0, 1, 2, 3], 2));
        assert_eq!(review.rows[0].confidence, Some(0.95), "what it says is new");
        assert_eq!(
            review.rows.iter().map(|row| row.gone).collect::<Vec<_>>(),
            [false, true, false, false]
        );
        assert_eq!(
            (
                review.count(),
                review.bulk(&ReviewChoice::default()).rows.len()
            ),
            (3, 2)
        );
        assert_eq!(
            (
                review.next(1, true),
                review.next(2, true),
                review.next(0, false)
            ),
            (Some(2), Some(3), Some(3))
        );
        open.document.frames[1].status = FrameStatus::Suggested;
        open.revision += 1;
        review.refresh(Some(&mut open), &held);
        assert!(!review.rows[1].gone, "undone");
        review.refresh(Some(&mut open), &free);
        assert_eq!((frames(&review), review.late), (vec![2, 1, 0, 3], 0));
        let mut elsewhere = session(true, false);
        elsewhere.panel = SidePanel::Frame;
        review.refresh(Some(&mut open), &elsewhere);
        propose(&mut open, 4, 0.1);
        review.refresh(Some(&mut open), &elsewhere);
        assert_eq!(frames(&review)[0], 4, "the list is not visible");
    }

    #[test]
    fn a_shot_with_a_row_gets_no_other_and_one_whose_row_is_gone_does() {
        let mut open = opened(6);
        propose(&mut open, 0, 0.7);
        propose(&mut open, 1, 0.8);
        let mut review = Review::default();
        review.refresh(Some(&mut open), &session(false, true));
        review.refresh(Some(&mut open), &session(true, true));
        propose(&mut open, 2, 0.9);
        open.document.frames[1].status = FrameStatus::Reference;
        propose(&mut open, 3, 0.6);
        propose(&mut open, 5, 0.65);
        review.refresh(Some(&mut open), &session(true, true));
        assert_eq!(frames(&review), [0, 1, 3]);
        assert_eq!(
            (review.hidden.len(), review.late, review.count()),
            (2, 1, 4)
        );
    }
}
