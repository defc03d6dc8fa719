//! The frames that need a label and their view directions, updated from the frames that changed.
//!
//! A frame needs a label if the forest found no answer for it, or is not sure of its answer. The
//! view direction of a frame without an answer is interpolated between the solved frames of its
//! shot.

use super::needing_frames::{HorizontalView, LabelCandidate, NeedingFrames};
use std::cmp::Reverse;
use std::collections::{BTreeMap, BTreeSet};
use touchline_documents::document::{
    CameraId, Clip, Document, Frame, FrameChanges, FrameStatus, Frames,
};
use touchline_vision::relocalize::CERTAIN;

/// A frame with a solved neighbour on one side only takes that neighbour's direction if it is at
/// most this many frames away.
const NEIGHBOUR_REACH: usize = 2;

/// The frames of a document that need a label.
#[derive(Clone, Debug, Default)]
pub struct LabelNeeds {
    /// The frames at the last update.
    frames: Frames,
    /// Frames without an answer.
    pub(super) unanswered: usize,
    /// Suggestions that the forest is not sure of: see [`CERTAIN`].
    pub(super) uncertain: usize,
    shots: BTreeMap<ShotKey, Shot>,
    /// The frames that need a label and have a known direction, by camera.
    needing: BTreeMap<CameraId, NeedingFrames>,
    edition: u64,
}

/// A camera and one of its shots. All frames of a camera that belong to no shot form one.
type ShotKey = (CameraId, Option<Clip>);

/// The frames of a shot, by index in the document.
#[derive(Clone, Debug, Default)]
struct Shot {
    /// Views of the solved frames.
    looks: BTreeMap<usize, HorizontalView>,
    /// Frames without an answer, if their picture can be read.
    unanswered: BTreeSet<usize>,
    /// Those of the unanswered frames that have no known direction.
    unknown: BTreeSet<usize>,
}

impl LabelNeeds {
    /// The frames of a document that need a label.
    pub fn from_document(document: &Document) -> Self {
        Self::anew(&document.frames, 0)
    }

    /// Updates the needs to a new state of the document.
    pub fn update(&mut self, document: &Document) {
        let FrameChanges::At(changed) = document.frames.changes_since(&self.frames) else {
            *self = Self::anew(&document.frames, self.edition + 1);
            return;
        };
        // Remove the old state of each changed frame and add the new one; then recompute all frames
        // that depend on it.
        let before = std::mem::replace(&mut self.frames, document.frames.clone());
        let (mut concerned, mut moved) = (BTreeSet::new(), Vec::new());
        for index in changed {
            let [gone, come] = [&before[index], &document.frames[index]];
            self.remove(index, gone);
            self.add(index, come);
            concerned.insert(index);
            if shot_of(gone) != shot_of(come)
                || HorizontalView::from_frame(gone) != HorizontalView::from_frame(come)
            {
                moved.push(index);
            }
        }
        // A solved frame determines the directions of the unsolved ones between its solved
        // neighbours, so these change with it. Each gap is visited once, however many of its
        // frames have changed.
        let mut gaps = BTreeSet::new();
        for index in moved {
            let frames = [&before[index], &document.frames[index]];
            gaps.extend(frames.map(|frame| self.gap_around(shot_of(frame), index)));
        }
        for (shot, from, to) in gaps {
            if let Some(shot) = self.shots.get(&shot) {
                concerned.extend(shot.unanswered.range(from..to));
            }
        }
        for index in concerned {
            self.settle(index);
        }
    }

    /// Increases whenever the next frame to label may change.
    pub const fn edition(&self) -> u64 {
        self.edition
    }

    /// The frames that need a label and have a known direction, camera by camera.
    pub(super) fn needing(&self) -> impl DoubleEndedIterator<Item = (&CameraId, &NeedingFrames)> {
        self.needing.iter()
    }

    /// The frames of unknown direction in the shot that has most of them. Of equal shots, the one
    /// that begins first.
    pub(in crate::proposals) fn unknown(&self) -> Option<&BTreeSet<usize>> {
        let unknown = self
            .shots
            .values()
            .map(|shot| &shot.unknown)
            .filter(|unknown| !unknown.is_empty());
        unknown.max_by_key(|shot| (shot.len(), Reverse(shot.first().copied())))
    }

    /// The camera of a frame.
    pub(in crate::proposals) fn camera_of(&self, index: usize) -> Option<&CameraId> {
        self.frames.get(index).map(|frame| &frame.camera)
    }

    /// Computes all needs from scratch.
    fn anew(frames: &Frames, edition: u64) -> Self {
        let mut needs = Self {
            frames: frames.clone(),
            edition,
            ..Self::default()
        };
        for (index, frame) in frames.iter().enumerate() {
            needs.add(index, frame);
        }
        for index in 0..frames.len() {
            needs.settle(index);
        }
        needs
    }

    /// Counts a frame and adds it to its shot.
    fn add(&mut self, index: usize, frame: &Frame) {
        self.unanswered += usize::from(frame.is_unanswered());
        self.uncertain += usize::from(is_uncertain(frame));
        // Both counts are part of the advice, so they are a change even if no direction is.
        self.edition += u64::from(frame.is_unanswered() || is_uncertain(frame));
        let shot = self.shots.entry(shot_of(frame)).or_default();
        shot.looks
            .extend(HorizontalView::from_frame(frame).map(|look| (index, look)));
        shot.unanswered
            .extend(can_be_labelled(frame).then_some(index));
    }

    /// Removes a frame's contribution, which `add` made.
    fn remove(&mut self, index: usize, frame: &Frame) {
        self.unanswered -= usize::from(frame.is_unanswered());
        self.uncertain -= usize::from(is_uncertain(frame));
        self.edition += u64::from(frame.is_unanswered() || is_uncertain(frame));
        if let Some(shot) = self.shots.get_mut(&shot_of(frame)) {
            shot.looks.remove(&index);
            shot.unanswered.remove(&index);
            shot.unknown.remove(&index);
        }
        if let Some(needing) = self.needing.get_mut(&frame.camera) {
            needing.put(index, None);
        }
    }

    /// The gap of a shot around a frame, from its solved neighbour before to the one after: the
    /// directions of the unanswered frames in it depend on this frame.
    fn gap_around(&self, shot: ShotKey, index: usize) -> (ShotKey, usize, usize) {
        let looks = self.shots.get(&shot).map(|shot| &shot.looks);
        let before = looks.and_then(|looks| looks.range(..index).next_back());
        let after = looks.and_then(|looks| looks.range(index + 1..).next());
        let from = before.map_or(0, |(before, _)| *before);
        let to = after.map_or(usize::MAX, |(after, _)| *after);
        (shot, from, to)
    }

    /// Recomputes whether a frame needs a label, and its direction.
    fn settle(&mut self, index: usize) {
        let frame = &*self.frames[index];
        let Some(shot) = self.shots.get_mut(&shot_of(frame)) else {
            return;
        };
        let is_unanswered = shot.unanswered.contains(&index);
        // Without an answer the direction is interpolated and the need is 1; with an uncertain
        // answer both follow from the answer.
        let found = if is_unanswered {
            shot.between(index).map(|look| (look, 1.0))
        } else {
            doubt(frame).and_then(|doubt| Some((HorizontalView::from_frame(frame)?, doubt)))
        };
        let is_unknown = is_unanswered && found.is_none();
        let mut is_news = if is_unknown {
            shot.unknown.insert(index)
        } else {
            shot.unknown.remove(&index)
        };
        // The edition changes only if the entry does.
        let needing = found.map(|(look, need)| LabelCandidate {
            frame: index,
            look,
            need,
        });
        is_news |= self
            .needing
            .entry(frame.camera.clone())
            .or_default()
            .put(index, needing);
        self.edition += u64::from(is_news);
    }
}

impl Shot {
    /// The interpolated view of a frame. Between two solved neighbours it is linear in the frame
    /// index, along the shorter way in pan. With one neighbour only, it is that neighbour's view if
    /// it is at most [`NEIGHBOUR_REACH`] frames away.
    fn between(&self, index: usize) -> Option<HorizontalView> {
        let before = self.looks.range(..index).next_back();
        let after = self.looks.range(index + 1..).next();
        match (before, after) {
            (Some((start, from)), Some((end, to))) => {
                let share = (index - start) as f64 / (end - start) as f64;
                Some(HorizontalView {
                    pan: (from.pan + to.pan.turn_from(from.pan) * share).wrap(),
                    half_view: from.half_view + (to.half_view - from.half_view) * share,
                })
            }
            (Some((place, look)), None) | (None, Some((place, look))) => {
                (place.abs_diff(index) <= NEIGHBOUR_REACH).then_some(*look)
            }
            (None, None) => None,
        }
    }
}

fn shot_of(frame: &Frame) -> ShotKey {
    (frame.camera.clone(), frame.clip.clone())
}

/// Whether a frame has no answer and its picture can be read.
fn can_be_labelled(frame: &Frame) -> bool {
    let mut warnings = frame
        .solution
        .iter()
        .flat_map(|solution| &solution.warnings);
    frame.is_unanswered() && warnings.all(|warning| warning.code != "picture")
}

/// Whether the forest is not sure of a frame's suggestion: see [`CERTAIN`].
pub fn is_uncertain(frame: &Frame) -> bool {
    doubt(frame).is_some()
}

/// The probability that a frame's suggestion is wrong; none if it is certain or states no
/// confidence.
fn doubt(frame: &Frame) -> Option<f64> {
    let confidence = frame
        .solution
        .as_ref()
        .filter(|_| frame.status == FrameStatus::Suggested)?
        .confidence?;
    (confidence < CERTAIN).then_some(1.0 - confidence.max(0.0))
}

#[cfg(test)]
mod tests {
    use super::super::needing_frames::Direction;
    use super::*;
    use touchline_core::geometry::ImageSize;
    use touchline_documents::document::{Solution, SolutionSource};
    use touchline_documents::testing::{new_frame, ptz_at, soccer_document, solved_by};

    /// Frames of two shots without an answer, and one solved frame in each.
    fn document() -> Document {
        let mut document = soccer_document();
        for index in 0..24 {
            let mut frame = new_frame(&format!("{index}.jpg"), ImageSize::new(1280, 720));
            frame.clip = Some(Clip::Number(index / 12));
            match index % 12 {
                4 => solve(&mut frame, index as f64),
                _ => ask_in_vain(&mut frame),
            }
            document.frames.push(frame.into());
        }
        document
    }

    fn solve(frame: &mut Frame, pan_deg: f64) {
        frame.status = FrameStatus::Reference;
        frame.ptz = ptz_at(pan_deg, -9.0, 3630.0);
        frame.solution = None;
    }

    fn ask_in_vain(frame: &mut Frame) {
        (frame.status, frame.ptz) = (FrameStatus::New, None);
        frame.solution = solved_by(SolutionSource::Forest);
    }

    /// All results, without the edition.
    type Said = ([usize; 2], Vec<(i64, Direction)>, Option<BTreeSet<usize>>);

    fn said(needs: &LabelNeeds) -> Said {
        let directions = needs
            .needing()
            .flat_map(|(_, needing)| needing.directions());
        let directions = directions
            .map(|(to, direction)| (to, direction.clone()))
            .collect();
        (
            [needs.unanswered, needs.uncertain],
            directions,
            needs.unknown().cloned(),
        )
    }

    #[test]
    fn brought_up_to_date_they_are_what_they_are_anew() {
        let mut document = document();
        let mut needs = LabelNeeds::from_document(&document);
        let changes: [fn(&mut Document); 11] = [
            |document| solve(&mut document.frames[9], 12.0),
            |document| solve(&mut document.frames[9], 13.0),
            |document| document.frames[4].status = FrameStatus::Rejected,
            |document| document.frames[4].clip = Some(Clip::Number(1)),
            |document| solve(&mut document.frames[4], 2.0),
            |document| ask_in_vain(&mut document.frames[16]),
            |document| (5..9).for_each(|index| solve(&mut document.frames[index], index as f64)),
            |document| (3..11).for_each(|index| ask_in_vain(&mut document.frames[index])),
            |document| document.frames[20].camera = "other".into(),
            |document| {
                solve(&mut document.frames[6], 3.0);
                document.frames[6].status = FrameStatus::Suggested;
                document.frames[6].solution = Some(Solution {
                    confidence: Some(0.4),
                    ..Solution::default()
                });
            },
            |document| {
                document.frames.remove(1);
            },
        ];
        for (number, change) in changes.into_iter().enumerate() {
            let before = (said(&needs), needs.edition());
            change(&mut document);
            needs.update(&document);
            assert_eq!(
                said(&needs),
                said(&LabelNeeds::from_document(&document)),
                "change {number}"
            );
            assert!(
                said(&needs) == before.0 || needs.edition() > before.1,
                "change {number} is noticed"
            );
        }
    }

    #[test]
    fn what_changes_no_need_is_no_news() {
        let mut document = document();
        let mut needs = LabelNeeds::from_document(&document);
        let before = needs.edition();
        document.frames[4].comment = Some("rain".to_owned());
        needs.update(&document);
        assert_eq!(needs.edition(), before);
        solve(&mut document.frames[4], 5.0);
        needs.update(&document);
        assert!(needs.edition() > before, "its neighbours look elsewhere");
    }
}
