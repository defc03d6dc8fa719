//! Suggestions that come and go: the forest's proposals, which of them are outdated, and batches
//! that are discarded.

use super::App;
use crate::app::effect::Effect;
use crate::app::session::Level;
use crate::app::trainer::TrainerOrder;
use touchline_calibration::calibrate::follow_all_bases;
use touchline_calibration::proposals::{BatchId, CarriedProposal, Discarded, NoProposal, Proposal};
use touchline_core::geometry::counted;
use touchline_documents::document::Frame;

impl App {
    /// Takes proposals in: journalled, but not a step of undo. Those of an older forest than the
    /// last one are dropped.
    pub(super) fn take_proposals(&mut self, proposals: &[Proposal]) {
        let is_known = self.trainer_knows_document();
        let Some(open) = self.open.as_mut().filter(|open| open.read_only.is_none()) else {
            return;
        };
        let Some(edit) = open.take_proposals(proposals) else {
            return;
        };
        if is_known {
            let generation = open.forest_generation;
            self.tell_shown_answers(&edit, generation, false);
        }
        self.journal_edit(edit);
        let mistake = proposals
            .iter()
            .find_map(|proposal| match &proposal.outcome {
                Err(mistake @ NoProposal::Panicked { .. }) => Some(mistake.to_string()),
                _ => None,
            });
        if let Some(mistake) = mistake {
            self.session
                .notify(Level::Error, format!("No proposal: {mistake}."));
        }
    }

    /// Takes in cameras that were carried from what the forest proposed, in the same way.
    pub(super) fn take_carried(&mut self, carried: &[CarriedProposal]) {
        let is_known = self.trainer_knows_document();
        let Some(open) = self.open.as_mut().filter(|open| open.read_only.is_none()) else {
            return;
        };
        let Some(newest) = carried.iter().map(|carried| carried.generation).max() else {
            return;
        };
        let Some(edit) = open.take_carried(carried, newest) else {
            return;
        };
        if is_known {
            self.tell_shown_answers(&edit, newest, true);
        }
        self.journal_edit(edit);
    }

    /// Why the batch of the shown frame's suggestion cannot be discarded; none if it can.
    pub(super) fn why_not_discard_batch(&self) -> Option<&'static str> {
        if self.is_read_only() {
            return Some("The document is read-only.");
        }
        if !self.frame().is_some_and(Frame::shows_suggestion) {
            return Some("Nothing is suggested for this frame.");
        }
        self.shown_batch()
            .is_none()
            .then_some("Its batch of suggestions is gone.")
    }

    /// The batch of what is suggested for the shown frame.
    fn shown_batch(&self) -> Option<BatchId> {
        self.open.as_ref()?.project.batch_shown_in(self.frame()?)
    }

    /// Discards everything that was suggested together with what the shown frame shows.
    pub(super) fn discard_shown_batch(&mut self) {
        self.commit_open_step();
        if let Some(batch) = self.shown_batch() {
            self.discard_batch(batch);
        }
    }

    /// Discards a batch of suggestions in the frames that nobody has touched since, and says what
    /// that changed.
    pub(in crate::app) fn discard_batch(&mut self, batch: BatchId) {
        let newest_forest = self.newest_forest();
        let Some(open) = &mut self.open else { return };
        let discarded = open.discard_batch(batch, newest_forest);
        let text = describe_discarded(&discarded);
        if let Some(refused) = discarded.refused {
            self.effects
                .push(Effect::Trainer(TrainerOrder::Refused(refused)));
        }
        if let Some(edit) = discarded.edit {
            self.journal_edit(edit);
        }
        self.forget_carried_batch(batch);
        self.session.notify(Level::Info, text);
    }

    /// The newest forest that the window has heard of.
    fn newest_forest(&self) -> u64 {
        let proposed = self.open.as_ref().map_or(0, |open| open.forest_generation);
        let learnt = self
            .session
            .trainer
            .status
            .forest
            .map_or(0, |forest| forest.generation);
        proposed.max(learnt)
    }

    /// Within a step that moved a camera: what was proposed for the old place goes, and accepted
    /// lines stay on the picture where they were.
    pub(super) fn follow_base(&mut self) {
        let Some(open) = &mut self.open else { return };
        if !open.history.is_open() {
            return;
        }
        let before = open.project.view().clone();
        let withdrawn = follow_all_bases(&mut open.document, &before);
        self.tell_withdrawn(withdrawn);
    }

    /// Tells of proposals that were made for an old base.
    pub(in crate::app) fn tell_withdrawn(&mut self, withdrawn: usize) {
        if withdrawn > 0 {
            let (proposals, were) = if withdrawn == 1 {
                ("proposal", "was")
            } else {
                ("proposals", "were")
            };
            let text = format!(
                "{withdrawn} {proposals} for the old base {were} discarded; proposing again."
            );
            self.session.notify(Level::Info, text);
        }
    }
}

/// What discarding a batch of suggestions changed.
fn describe_discarded(
    Discarded {
        emptied,
        given_back,
        ..
    }: &Discarded,
) -> String {
    match (*emptied, *given_back) {
        (0, 0) => "No frame shows these suggestions any more.".to_owned(),
        (0, given_back) => format!(
            "{} again what was suggested before.",
            frames_that(given_back, "shows", "show")
        ),
        (emptied, 0) => format!("{} no suggestion now.", frames_that(emptied, "has", "have")),
        (emptied, given_back) => format!(
            "{} no suggestion now, {} again what was suggested before.",
            frames_that(emptied, "has", "have"),
            frames_that(given_back, "shows", "show")
        ),
    }
}

/// A count of frames with its verb: "1 frame has", "3 frames have".
fn frames_that(frames: usize, one: &str, many: &str) -> String {
    format!(
        "{} {}",
        counted(frames, "frame"),
        if frames == 1 { one } else { many }
    )
}
