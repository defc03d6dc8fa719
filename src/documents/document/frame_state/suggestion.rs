//! The program's suggestion for a frame without a decision of the user. In a file it is stored in
//! the frame; a program that edits the document keeps it separately, so that undo and redo do not
//! affect it.

use crate::document::{Document, Frame, FramePtz, FrameStatus, Shared, Solution};
use serde::{Deserialize, Serialize};
use touchline_core::camera::CameraBase;

/// A camera that the program suggests for a frame, or the reason why it found none.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Suggestion {
    /// The revision of the frame that it was made for.
    #[serde(skip)]
    pub revision: u64,
    /// The base of the frame's camera that it was made for; none where that camera had none.
    #[serde(skip)]
    pub base: Option<CameraBase>,
    /// Pan, tilt and focal length; none where no camera was found.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub ptz: Option<FramePtz>,
    /// How it was found, or why none was found.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub solution: Option<Solution>,
}

impl Suggestion {
    /// The suggestion that a frame shows, given its camera's base; none where the user decided or
    /// there is no suggestion.
    pub fn in_frame(frame: &Frame, base: Option<&CameraBase>) -> Option<Self> {
        let Frame {
            revision,
            ptz,
            solution,
            ..
        } = frame;
        frame.shows_suggestion().then(|| Self {
            revision: *revision,
            base: base.copied(),
            ptz: ptz.clone(),
            solution: solution.clone(),
        })
    }

    /// Stores it in its frame as in a file: with a camera the frame is `suggested`, without one it
    /// is `new`.
    pub fn show_in(&self, frame: &mut Frame) {
        frame.status = if self.ptz.is_some() {
            FrameStatus::Suggested
        } else {
            FrameStatus::New
        };
        frame.ptz.clone_from(&self.ptz);
        frame.solution.clone_from(&self.solution);
    }

    /// Whether the program looked for a camera and found none.
    pub const fn is_unanswered(&self) -> bool {
        self.ptz.is_none()
    }
}

impl Frame {
    /// Whether the user has neither clicked in it nor given it a camera, accepted or rejected it.
    /// Suggestions must have been removed before.
    pub fn is_untouched(&self) -> bool {
        self.status == FrameStatus::New && self.clicks.is_empty() && self.ptz.is_none()
    }

    /// Whether another document, with its version of this frame or without the frame, lacks work of
    /// the user: clicks, decision, comment, masks, repeated clicks, or the choice of its uses.
    pub fn gives_way_in(&self, other: &Document) -> bool {
        let mine = self.without_suggestion();
        let Some(theirs) = other
            .frames
            .by_id(&self.id)
            .map(|frame| frame.without_suggestion())
        else {
            return !mine.is_untouched()
                || mine.comment.is_some()
                || !mine.masks.is_empty()
                || !mine.repeats.is_empty()
                || mine.has_chosen_uses();
        };
        // Each kind of work counts by itself, and only where there is some on this side: what only
        // the other document has is no loss.
        let has_same_labels = (&mine.clicks, mine.status, mine.reason)
            == (&theirs.clicks, theirs.status, theirs.reason);
        (!mine.is_untouched() && !has_same_labels)
            || (mine.comment.is_some() && mine.comment != theirs.comment)
            || (!mine.masks.is_empty() && mine.masks != theirs.masks)
            || (!mine.repeats.is_empty() && mine.repeats != theirs.repeats)
            || (mine.has_chosen_uses() && mine.uses() != theirs.uses())
    }

    /// Whether the user chose what it is used for.
    pub(super) fn has_chosen_uses(&self) -> bool {
        self.uses() != (true, None, false)
    }

    /// What it is used for: its camera's base, training, blind clicks.
    pub(super) const fn uses(&self) -> (bool, Option<bool>, bool) {
        (self.use_for_base, self.use_for_training, self.gold)
    }

    /// Whether its camera, or the reason why it has none, comes from the program alone: no clicks
    /// and no decision of the user.
    pub fn shows_suggestion(&self) -> bool {
        self.clicks.is_empty()
            && match self.status {
                FrameStatus::Suggested => self.ptz.is_some(),
                FrameStatus::New => self.ptz.is_none() && self.solution.is_some(),
                FrameStatus::Draft | FrameStatus::Reference | FrameStatus::Rejected => false,
            }
    }

    /// The frame without the program's suggestion.
    #[must_use]
    pub fn without_suggestion(&self) -> Self {
        let mut frame = self.clone();
        if frame.shows_suggestion() {
            (frame.status, frame.ptz, frame.solution) = (FrameStatus::New, None, None);
        }
        frame
    }
}

impl Document {
    /// The document without suggestions in any frame.
    #[must_use]
    pub fn without_suggestions(&self) -> Self {
        let mut edited = self.clone();
        for (position, frame) in self.frames.iter().enumerate() {
            if frame.shows_suggestion() {
                edited.frames[position] = frame.without_suggestion().into();
            }
        }
        edited
    }

    /// [`Self::without_suggestions`] of a document that was edited since `before`. `edited_before`
    /// is `before` without suggestions: its frames are shared where the user changed nothing, and
    /// unchanged frames are not compared.
    #[must_use]
    pub fn without_suggestions_since(&self, before: &Self, edited_before: &Self) -> Self {
        // Usually frames changed in place, and only these are visited. Where frames were added,
        // removed or moved, all are visited, and the known handle of each is found by its id.
        let frames = if let Some(changed) = self.frames.changes_in_place(&before.frames) {
            let mut frames = edited_before.frames.clone();
            for position in changed {
                frames[position] =
                    share_without_suggestion(&self.frames[position], Some(&frames[position]));
            }
            frames
        } else {
            self.frames
                .iter()
                .map(|frame| {
                    let known = edited_before.frames.by_id(&frame.id);
                    share_without_suggestion(frame, known)
                })
                .collect()
        };
        Self {
            frames,
            ..self.clone()
        }
    }
}

/// The frame without a suggestion; the known handle if its contents are equal. Frames that share a
/// handle are later compared without a look at their contents ([`Shared`]).
fn share_without_suggestion(frame: &Shared<Frame>, known: Option<&Shared<Frame>>) -> Shared<Frame> {
    if !frame.shows_suggestion() {
        return frame.clone();
    }
    let without = frame.without_suggestion();
    known
        .filter(|known| ***known == without)
        .cloned()
        .unwrap_or_else(|| without.into())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::document::{Click, SolutionSource};
    use crate::testing::{new_frame, ptz_at, soccer_document};
    use touchline_core::camera::Ptz;
    use touchline_core::geometry::{ImagePoint, ImageSize};
    use touchline_core::testing::pixel_box;

    fn frame(status: FrameStatus, ptz: bool, source: Option<SolutionSource>) -> Frame {
        let mut frame = new_frame("a.jpg", ImageSize::new(64, 36));
        frame.status = status;
        frame.ptz = ptz.then(|| FramePtz::new(Ptz::from_degrees(1.0, -9.0, 900.0), None));
        frame.solution = source.map(|source| Solution {
            source: Some(source),
            ..Solution::default()
        });
        frame
    }

    #[test]
    fn a_suggestion_is_taken_out_of_its_frame_and_put_back() {
        for frame in [
            frame(FrameStatus::Suggested, true, Some(SolutionSource::Forest)),
            frame(FrameStatus::Suggested, true, Some(SolutionSource::Tracking)),
            frame(FrameStatus::Suggested, true, None),
            frame(FrameStatus::New, false, Some(SolutionSource::Forest)),
        ] {
            let suggestion = Suggestion::in_frame(&frame, None).unwrap();
            let mut without = frame.without_suggestion();
            assert!(
                without.is_untouched() && without.solution.is_none() && !without.shows_suggestion()
            );
            suggestion.show_in(&mut without);
            assert_eq!(without, frame);
        }
    }

    fn suggest(frame: &mut Frame, pan_deg: f64) {
        frame.ptz = ptz_at(pan_deg, -9.0, 900.0);
        frame.status = FrameStatus::Suggested;
    }

    #[test]
    fn the_document_without_suggestions_changes_with_the_edits_of_people_alone() {
        let mut document = soccer_document();
        let frame = |name: &str| new_frame(name, ImageSize::new(64, 36)).into();
        document.frames.extend(["a", "b", "c"].map(frame));
        let untouched = document.clone();
        suggest(&mut document.frames[1], 1.0);
        let (before, edited_before) = (document.clone(), document.without_suggestions());
        assert_eq!(edited_before, untouched);

        suggest(&mut document.frames[1], 2.0);
        suggest(&mut document.frames[2], 3.0);
        let edited = document.without_suggestions_since(&before, &edited_before);
        assert_eq!(edited, untouched);
        let handles = edited.frames.iter().zip(&edited_before.frames);
        assert!(handles.take(2).all(|(now, before)| now.is_same(before)));

        let (before, edited_before) = (document.clone(), edited);
        document.frames[1].status = FrameStatus::Reference;
        document.frames.remove(0);
        let edited = document.without_suggestions_since(&before, &edited_before);
        assert_eq!(edited.frames[0], document.frames[0]);
        assert_eq!(edited, document.without_suggestions());
    }

    #[test]
    fn a_document_without_the_frame_lacks_its_masks_and_its_uses() {
        let without = soccer_document();
        let untouched = frame(FrameStatus::New, false, None);
        assert!(!untouched.gives_way_in(&without), "there is no work in it");
        let mut masked = untouched.clone();
        masked.masks.push(pixel_box(0.0, 0.0, 9.0, 9.0));
        let left_out = Frame {
            use_for_base: false,
            ..untouched.clone()
        };
        let mut with = without.clone();
        with.frames.push(untouched.into());
        for worked_on in [masked, left_out] {
            assert!(worked_on.gives_way_in(&without) && worked_on.gives_way_in(&with));
        }
    }

    #[test]
    fn what_a_person_did_stays_in_the_frame() {
        let mut clicked = frame(FrameStatus::Suggested, true, Some(SolutionSource::Forest));
        clicked
            .clicks
            .push(Click::without_name(ImagePoint::new(1.0, 1.0)));
        for frame in [
            clicked,
            frame(FrameStatus::New, false, None),
            frame(FrameStatus::New, true, Some(SolutionSource::Import)),
            frame(FrameStatus::Draft, true, Some(SolutionSource::Manual)),
            frame(FrameStatus::Reference, true, Some(SolutionSource::Forest)),
            frame(FrameStatus::Rejected, true, Some(SolutionSource::Forest)),
        ] {
            assert_eq!(Suggestion::in_frame(&frame, None), None);
            assert_eq!(frame.without_suggestion(), frame);
        }
    }
}
