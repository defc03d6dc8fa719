//! Counts of frames by kind, updated from the frames that change.

use super::Follows;
use crate::app::window_state::choices::{Filter, is_to_do};
use std::collections::{BTreeMap, BTreeSet};
use touchline_calibration::proposals::is_uncertain;
use touchline_documents::document::{CameraId, Document, Frame, FrameChanges, FrameStatus, Frames};

/// The number of frames of each kind, and the indices of the frames that were clicked again.
#[derive(Clone, Debug, Default)]
pub struct FrameCounts {
    frames: Frames,
    by_status: BTreeMap<FrameStatus, usize>,
    by_camera: BTreeMap<CameraId, usize>,
    /// Frames that are neither accepted nor rejected.
    pub to_do: usize,
    /// Frames for which the forest gave no answer.
    pub unanswered: usize,
    /// Suggestions of which the forest is uncertain.
    pub uncertain: usize,
    /// Suggestions that the paint of their pictures does not support.
    pub off_paint: usize,
    /// Suggestions that were tracked from other frames.
    pub tracked: usize,
    /// Frames with a camera of another program that is neither mended nor reviewed.
    pub imported: usize,
    /// Frames on which the forest is trained.
    pub used_for_training: usize,
    /// Gold frames.
    pub gold: usize,
    /// Gold frames that are references.
    pub gold_references: usize,
    /// Frames that qualify as gold frames but are none.
    pub could_be_gold: usize,
    with_repeats: BTreeSet<usize>,
    repeats_edition: u64,
    suggestions_edition: u64,
}

impl FrameCounts {
    /// The number of frames with a status.
    pub fn count_with_status(&self, status: FrameStatus) -> usize {
        self.by_status.get(&status).copied().unwrap_or_default()
    }

    /// The number of frames of a camera.
    pub fn count_of_camera(&self, camera: &CameraId) -> usize {
        self.by_camera.get(camera).copied().unwrap_or_default()
    }

    /// The number of cameras that have frames.
    pub fn cameras_with_frames(&self) -> usize {
        self.by_camera.values().filter(|count| **count > 0).count()
    }

    /// The number of frames that a filter shows.
    pub fn count_matching(&self, filter: Filter) -> usize {
        match filter {
            Filter::All => self.frames.len(),
            Filter::ToDo => self.to_do,
            Filter::Unanswered => self.unanswered,
            Filter::OffPaint => self.off_paint,
            Filter::Status(status) => self.count_with_status(status),
        }
    }

    /// The frames to do, by reason, such as "12 to review, 3 drafts, 8 without an answer, 2 new".
    /// None if there are none.
    pub fn describe_to_do(&self) -> Option<String> {
        let drafts = self.count_with_status(FrameStatus::Draft);
        // Frames without an answer are new, too, and counted under their own reason.
        let new = self
            .count_with_status(FrameStatus::New)
            .saturating_sub(self.unanswered);
        let reasons = [
            (self.count_with_status(FrameStatus::Suggested), "to review"),
            (drafts, if drafts == 1 { "draft" } else { "drafts" }),
            (self.unanswered, "without an answer"),
            (new, "new"),
        ];
        let said = reasons
            .iter()
            .filter(|(count, _)| *count > 0)
            .map(|(count, what)| format!("{count} {what}"));
        let said: Vec<String> = said.collect();
        (!said.is_empty()).then(|| said.join(", "))
    }

    /// The indices of the frames that were clicked again, ascending.
    pub fn with_repeats(&self) -> impl Iterator<Item = usize> + '_ {
        self.with_repeats.iter().copied()
    }

    /// A counter that grows whenever a frame that was clicked again changes.
    pub const fn repeats_edition(&self) -> u64 {
        self.repeats_edition
    }

    /// A counter that grows whenever a suggested frame changes, appears or disappears.
    pub const fn suggestions_edition(&self) -> u64 {
        self.suggestions_edition
    }

    /// Counts all frames.
    fn from_frames(frames: &Frames, editions: (u64, u64)) -> Self {
        let (repeats_edition, suggestions_edition) = editions;
        let mut counts = Self {
            frames: frames.clone(),
            repeats_edition,
            suggestions_edition,
            ..Self::default()
        };
        for (index, frame) in frames.iter().enumerate() {
            counts.add(index, frame);
        }
        counts
    }

    fn add(&mut self, index: usize, frame: &Frame) {
        if !frame.repeats.is_empty() {
            self.with_repeats.insert(index);
        }
        self.count(frame, |count| *count += 1);
    }

    fn remove(&mut self, index: usize, frame: &Frame) {
        self.with_repeats.remove(&index);
        self.count(frame, |count| *count -= 1);
    }

    /// Applies `change` to every count that includes the frame.
    fn count(&mut self, frame: &Frame, change: fn(&mut usize)) {
        change(self.by_status.entry(frame.status).or_default());
        change(self.by_camera.entry(frame.camera.clone()).or_default());
        let is_reference = frame.status == FrameStatus::Reference;
        let kinds = [
            (is_to_do(frame), &mut self.to_do),
            (frame.is_unanswered(), &mut self.unanswered),
            (is_uncertain(frame), &mut self.uncertain),
            (frame.is_suggested_off_paint(), &mut self.off_paint),
            (
                frame.status == FrameStatus::Suggested && frame.is_tracked(),
                &mut self.tracked,
            ),
            (frame.has_imported_camera(), &mut self.imported),
            (frame.is_used_for_training(), &mut self.used_for_training),
            (frame.gold, &mut self.gold),
            (frame.gold && is_reference, &mut self.gold_references),
            (
                !frame.gold && frame.why_not_gold().is_none(),
                &mut self.could_be_gold,
            ),
        ];
        kinds
            .into_iter()
            .filter(|(is_one, _)| *is_one)
            .for_each(|(_, count)| change(count));
    }
}

impl Follows for FrameCounts {
    fn update(&mut self, document: &Document) {
        let FrameChanges::At(changed) = document.frames.changes_since(&self.frames) else {
            *self = Self::from_frames(
                &document.frames,
                (self.repeats_edition + 1, self.suggestions_edition + 1),
            );
            return;
        };
        let before = std::mem::replace(&mut self.frames, document.frames.clone());
        // Take each changed frame out of the counts as it was and add it as it is. The editions
        // grow if the old or the new state is of their kind.
        for index in changed {
            let both = [&before[index], &document.frames[index]];
            self.remove(index, both[0]);
            self.add(index, both[1]);
            let concerns =
                |is_one: fn(&Frame) -> bool| u64::from(both.iter().any(|frame| is_one(frame)));
            self.repeats_edition += concerns(|frame| !frame.repeats.is_empty());
            self.suggestions_edition += concerns(|frame| frame.status == FrameStatus::Suggested);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use touchline_core::geometry::ImagePoint;
    use touchline_documents::document::{Click, Repeat, Solution, SolutionSource};
    use touchline_documents::testing::{SMALL, WithFrames, soccer_document};

    fn document(frames: usize) -> Document {
        let names = (0..frames).map(|index| index.to_string());
        soccer_document().with_pictures(names, SMALL)
    }

    /// All values except the editions.
    fn said(counts: &FrameCounts) -> (Vec<usize>, Vec<usize>, [usize; 7], Vec<usize>) {
        let filters = Filter::ALL
            .map(|filter| counts.count_matching(filter))
            .to_vec();
        let cameras = ["main", "other"]
            .map(|camera| counts.count_of_camera(&camera.into()))
            .to_vec();
        let rest = [
            counts.uncertain,
            counts.tracked,
            counts.imported,
            counts.used_for_training,
            counts.gold,
            counts.gold_references,
            counts.could_be_gold,
        ];
        (filters, cameras, rest, counts.with_repeats().collect())
    }

    #[test]
    fn counts_that_are_kept_are_those_that_would_be_counted_anew() {
        let mut document = document(200);
        let mut kept = FrameCounts::default();
        let click = || Click::landmark("centre_mark".into(), ImagePoint::new(9.0, 9.0));
        let changes: [&dyn Fn(&mut Document); 7] = [
            &|_| (),
            &|document| document.frames[3].status = FrameStatus::Reference,
            &|document| document.frames[3].clicks.push(click()),
            &|document| document.frames[3].gold = true,
            &|document| {
                document.frames[3].repeats.push(Repeat::new(
                    "centre_mark".into(),
                    ImagePoint::new(9.0, 9.0),
                    1,
                ));
            },
            &|document| {
                document.frames[5].status = FrameStatus::Suggested;
                document.frames[6].camera = "other".into();
            },
            &|document| drop(document.frames.remove(3)),
        ];
        for change in changes {
            change(&mut document);
            kept.update(&document);
            assert_eq!(
                said(&kept),
                said(&FrameCounts::from_frames(&document.frames, (0, 0)))
            );
        }
        assert_eq!(
            (
                kept.count_with_status(FrameStatus::Suggested),
                kept.count_of_camera(&"other".into())
            ),
            (1, 1)
        );
    }

    #[test]
    fn what_is_to_do_is_what_is_neither_accepted_nor_rejected_and_its_reasons_add_up() {
        let mut document = document(8);
        let in_vain = || Solution {
            source: Some(SolutionSource::Forest),
            ..Solution::default()
        };
        document.frames[0].status = FrameStatus::Reference;
        document.frames[1].status = FrameStatus::Rejected;
        document.frames[2].status = FrameStatus::Draft;
        document.frames[3].status = FrameStatus::Suggested;
        document.frames[4].status = FrameStatus::Suggested;
        document.frames[5].solution = Some(in_vain());
        let counts = FrameCounts::from_frames(&document.frames, (0, 0));
        assert_eq!((counts.to_do, counts.count_matching(Filter::ToDo)), (6, 6));
        assert_eq!(
            counts.describe_to_do().unwrap(),
            "2 to review, 1 draft, 1 without an answer, 2 new"
        );
        assert_eq!(
            document
                .frames
                .iter()
                .filter(|frame| Filter::ToDo.shows(frame))
                .count(),
            counts.to_do
        );
        assert_eq!(FrameCounts::default().describe_to_do(), None);
    }

    #[test]
    fn an_edition_grows_with_what_it_is_of() {
        let mut document = document(10);
        let mut counts = FrameCounts::default();
        let mut editions = |document: &Document| {
            counts.update(document);
            [counts.repeats_edition(), counts.suggestions_edition()]
        };
        let first = editions(&document);
        document.frames[2].comment = Some("rain".to_owned());
        assert_eq!(editions(&document), first);
        document.frames[2].status = FrameStatus::Suggested;
        let suggested = editions(&document);
        assert!(suggested[0] == first[0] && suggested[1] > first[1]);
        document.frames[2].status = FrameStatus::Reference;
        let accepted = editions(&document);
        assert!(accepted[1] > suggested[1], "it is gone from the list");
        document.frames[2].repeats.push(Repeat::new(
            "centre_mark".into(),
            ImagePoint::new(9.0, 9.0),
            1,
        ));
        let repeated = editions(&document);
        assert!(repeated[0] > accepted[0] && repeated[1] == accepted[1]);
    }
}
