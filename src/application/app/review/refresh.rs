//! Updates the review list when its inputs have changed.
//!
//! If few frames changed since the last update, only their rows are computed and merged into the
//! list. Otherwise all rows are computed.

use super::row::in_order;
use super::{Review, ReviewOrder, ReviewRow};
use crate::app::OpenProject;
use crate::app::window_state::session::{Dialog, Session, SidePanel};
use std::collections::{BTreeMap, BTreeSet};
use touchline_calibration::calibrate::Disagreements;
use touchline_documents::document::{
    CameraId, Clip, Document, Frame, FrameChanges, FrameStatus, Frames,
};

/// The inputs of the list.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Source {
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
pub(super) enum AffectedRows {
    All,
    /// A flag for each frame of the document.
    Some(Vec<bool>),
}

impl AffectedRows {
    /// The frames at `places`, of a document with `frames` frames.
    fn places(places: &BTreeSet<usize>, frames: usize) -> Self {
        let mut concerned = vec![false; frames];
        for place in places {
            concerned[*place] = true;
        }
        Self::Some(concerned)
    }

    pub(super) fn has(&self, frame: usize) -> bool {
        match self {
            Self::All => true,
            Self::Some(concerned) => concerned.get(frame) == Some(&true),
        }
    }
}

impl Review {
    /// Updates the list if its inputs have changed: from the changed frames if they are few,
    /// otherwise completely.
    pub(in crate::app) fn refresh(&mut self, open: Option<&mut OpenProject>, session: &Session) {
        let Some(open) = open else {
            *self = Self::default();
            return;
        };
        let choice = &session.review;
        let listed = session.panel == SidePanel::Review;
        let with_neighbours =
            listed || matches!(session.dialog, Some(Dialog::AcceptAll | Dialog::Gallery));
        let source = Source {
            suggestions: open.derived.counts(&open.document).suggestions_edition(),
            order: choice.order,
            one_per_shot: choice.one_per_shot,
            neighbours: with_neighbours
                .then(|| open.derived.disagreements(&open.document).edition()),
            held: choice.held && listed,
        };
        let before = self.derived_from.replace(source);
        // `suggestions` in the source stands for all frames, so that an unchanged list costs the
        // same for any number of them.
        if before != Some(source) {
            let frames = std::mem::replace(&mut self.frames, open.document.frames.clone());
            let disagreements = with_neighbours.then(|| open.derived.disagreements(&open.document));
            let before = before.filter(|before| before.is_same_list(source));
            // The present rows can be reused unless the list was just released, which requires
            // sorting all rows, or shows one row per shot, which depends on all frames of the shot.
            let stays =
                before.filter(|before| !source.one_per_shot && (source.held || !before.held));
            let few = stays
                .and_then(|before| changed_frames(&open.document, &frames, before, disagreements));
            let rows = rows_of(
                &open.document.frames,
                few.as_ref(),
                disagreements,
                choice.order,
            );
            let concerned = few.map_or(AffectedRows::All, |few| {
                AffectedRows::places(&few, open.document.frames.len())
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
    fn put_in_order(&mut self, concerned: &AffectedRows, rows: Vec<ReviewRow>, order: ReviewOrder) {
        // Merge two sorted sequences: the rows that stay, and the new ones.
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
    fn is_of_several_shots(&self, concerned: &AffectedRows) -> bool {
        // If all belonged to one shot, rows that did not change still belong to the first one's.
        let first = self.waiting().next().map(|row| shot_of(&self.frames, row));
        let mut rows = self
            .waiting()
            .filter(|row| self.several_shots || concerned.has(row.frame));
        rows.any(|row| Some(shot_of(&self.frames, row)) != first)
    }
}

/// The indices of the frames whose rows may differ from a former state of the list. None if there
/// are too many to update one by one.
fn changed_frames(
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
        places.extend(disagreements.changes_since(edition)?);
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
    let mut rows: Vec<ReviewRow> = match places {
        Some(places) => places
            .iter()
            .filter_map(|place| suggested_row(*place, frames.get(*place)?, disagreements))
            .collect(),
        None => frames
            .iter()
            .enumerate()
            .filter_map(|(place, frame)| suggested_row(place, frame, disagreements))
            .collect(),
    };
    rows.sort_unstable_by(|a, b| in_order(order, a, b));
    rows
}

/// The row of a frame. `None` if it is not suggested.
fn suggested_row(
    place: usize,
    frame: &Frame,
    disagreements: Option<&Disagreements>,
) -> Option<ReviewRow> {
    if frame.status != FrameStatus::Suggested {
        return None;
    }
    let disagreement = disagreements.and_then(|disagreements| disagreements.for_frame(place));
    Some(ReviewRow::new(place, frame, disagreement))
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
pub(super) fn shot_of<'a>(
    frames: &'a Frames,
    row: &ReviewRow,
) -> Option<(&'a CameraId, &'a Option<Clip>)> {
    frames
        .get(row.frame)
        .map(|frame| (&frame.camera, &frame.clip))
}

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
    use super::*;
    use crate::app::OpenProject;
    use crate::app::review::tests::{frames, opened, review_of};
    use crate::app::review::{Review, ReviewChoice};
    use crate::app::window_state::session::{Session, SidePanel};
    use strum::IntoEnumIterator as _;
    use touchline_core::geometry::ImageSize;
    use touchline_core::testing::base_at;
    use touchline_documents::document::{Camera, Clip, FrameStatus, Solution, SolutionSource};
    use touchline_documents::testing::{new_frame, ptz_at, soccer_document};

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

    #[test]
    fn a_list_that_follows_a_few_changes_is_the_list_made_anew() {
        let mut open = opened(&[Some(0.7), Some(0.9), None, Some(0.6), Some(0.8), Some(0.5)]);
        let size = ImageSize::new(64, 36);
        let mut camera = Camera::new("main".into(), size);
        camera.set_base(&base_at([0.0, -60.0, 15.0], size));
        open.document.cameras.push(camera.into());
        for (index, frame) in open.document.frames.iter_mut().enumerate() {
            frame.image = Some(format!("{index}.jpg"));
            frame.clip = Some(Clip::Number(1));
            frame.ptz = ptz_at(index as f64, -9.0, 90.0);
        }
        for order in ReviewOrder::iter() {
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
                document.frames[3].ptz = ptz_at(9.0, -9.0, 90.0);
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

    /// Frames that belong to two shots alternately.
    fn alternating(frames: usize) -> OpenProject {
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

    #[test]
    fn while_it_is_held_no_row_moves_and_then_it_is_in_order() {
        let mut open = alternating(6);
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
        let mut open = alternating(6);
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
