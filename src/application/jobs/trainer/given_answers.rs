//! Answers of the trainer that the application has not yet confirmed to show.
//!
//! A document that was sent while the trainer answered lacks those answers. When the application
//! confirms that it shows one ([`AnswerKey`]), the trainer copies the answer into its own document
//! from here, because cameras are propagated from it.

use crate::app::AnswerKey;
use std::collections::BTreeMap;
use touchline_documents::document::{Document, Frame, FrameId, Shared};

/// The last answer for each frame.
#[derive(Debug, Default)]
pub(super) struct GivenAnswers(BTreeMap<FrameId, GivenAnswer>);

#[derive(Debug)]
struct GivenAnswer {
    /// The forest that gave the answer.
    generation: u64,
    /// The frame with the answer recorded in it.
    answered: Shared<Frame>,
}

impl GivenAnswers {
    /// Stores an answer for a frame, from a forest of this generation or propagated from its
    /// answers.
    pub(super) fn give(&mut self, answered: &Shared<Frame>, generation: u64) {
        let given = GivenAnswer {
            generation,
            answered: answered.clone(),
        };
        self.0.insert(answered.id.clone(), given);
    }

    /// Drops the answers for frames that the document lacks or that have changed since.
    pub(super) fn keep_fitting(&mut self, document: &Document) {
        self.0.retain(|id, given| {
            document
                .frames
                .by_id(id)
                .is_some_and(|frame| given.fits(frame))
        });
    }

    /// Records in `document` the answer that the application shows, if it is the stored one.
    pub(super) fn show(&mut self, key: &AnswerKey, document: &mut Document) {
        let is_meant = self.0.get(&key.frame).is_some_and(|given| {
            given.generation == key.generation && given.answered.is_tracked() == key.is_tracked
        });
        if !is_meant {
            return;
        }
        let (given, position) = (
            self.0.remove(&key.frame),
            document.frames.position_of(&key.frame),
        );
        if let Some((given, position)) = given.zip(position)
            && given.fits(&document.frames[position])
        {
            document.frames[position] = given.answered;
        }
    }
}

impl GivenAnswer {
    /// Whether a frame is still in the state for which the answer was given, and undecided.
    fn fits(&self, frame: &Frame) -> bool {
        frame.is_open() && frame.revision == self.answered.revision
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use touchline_calibration::proposals::{Answer, TrackedProposal};
    use touchline_documents::document::FrameStatus;
    use touchline_documents::testing::{SMALL, WithFrames, soccer_document};

    fn document() -> Document {
        soccer_document().with_pictures(["a.jpg", "b.jpg"], SMALL)
    }

    fn key(document: &Document, position: usize, generation: u64, is_tracked: bool) -> AnswerKey {
        let frame = &document.frames[position];
        AnswerKey {
            frame: frame.id.clone(),
            revision: frame.revision,
            generation,
            is_tracked,
        }
    }

    #[test]
    fn a_document_that_was_on_its_way_shows_the_answers_that_it_is_known_to_show() {
        let (on_its_way, mut answered, mut given) =
            (document(), document(), GivenAnswers::default());
        answered.frames[0].ptz = Some(Answer::at_pan(1.0, 0.9).ptz);
        answered.frames[0].status = FrameStatus::Suggested;
        TrackedProposal::at_pan(&document(), 1, 2.0, 3).record(&mut answered.frames[1]);
        for frame in &answered.frames {
            given.give(frame, 3);
        }
        let mut now = on_its_way.clone();
        given.keep_fitting(&now);
        given.show(&key(&now, 0, 2, false), &mut now);
        given.show(&key(&now, 1, 3, false), &mut now);
        assert_eq!(now, on_its_way, "other answers");
        given.show(&key(&now, 0, 3, false), &mut now);
        given.show(&key(&now, 1, 3, true), &mut now);
        assert_eq!(now, answered);
    }

    #[test]
    fn an_answer_for_a_frame_that_was_edited_since_is_not_shown() {
        let (mut now, mut given) = (document(), GivenAnswers::default());
        given.give(&now.frames[0], 1);
        now.frames[0].revision += 1;
        let edited = now.clone();
        given.show(&key(&now, 0, 1, false), &mut now);
        assert_eq!(now, edited);
    }
}
