//! Suggestions: takes in the forest's proposals, withdraws outdated ones, and discards batches.

use crate::app::App;
use crate::app::effect::Effect;
use crate::app::trainer::TrainerOrder;
use crate::app::window_state::session::{Dialog, Level};
use touchline_calibration::calibrate::follow_all_bases;
use touchline_calibration::proposals::{BatchId, Discarded, NoProposal, Proposal, TrackedProposal};
use touchline_core::geometry::pluralise;
use touchline_documents::document::{Frame, Step};

/// At most this many frames lose their suggestions without a question.
const UNASKED: usize = 50;
/// The name of the step of undo.
const DISCARD: &str = "Discard a batch of suggestions";

impl App {
    /// Takes in proposals as suggestions; they are journalled but are no step of undo. Proposals of
    /// outdated forests are dropped.
    pub(in crate::app::update) fn take_proposals(&mut self, proposals: &[Proposal]) {
        let is_known = self.trainer_knows_document();
        let Some(open) = self.open.as_mut().filter(|open| open.read_only.is_none()) else {
            return;
        };
        let Some(edit) = open.take_proposals(proposals) else {
            return;
        };
        // If the trainer knew the document before, it only needs to know which of its answers are
        // shown now.
        if is_known {
            let generation = open.forest_generation;
            self.notify_shown_answers(&edit, generation, false);
        }
        self.journal_edit(edit);
        // A panic is an error of the program; only one is reported.
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

    /// Takes in cameras that were tracked from the forest's proposals, in the same way.
    pub(in crate::app::update) fn take_tracked(&mut self, tracked: &[TrackedProposal]) {
        let is_known = self.trainer_knows_document();
        let Some(open) = self.open.as_mut().filter(|open| open.read_only.is_none()) else {
            return;
        };
        let Some(newest) = tracked.iter().map(|tracked| tracked.generation).max() else {
            return;
        };
        let Some(edit) = open.take_tracked(tracked, newest) else {
            return;
        };
        if is_known {
            self.notify_shown_answers(&edit, newest, true);
        }
        self.journal_edit(edit);
    }

    /// Why the batch of the shown frame's suggestion cannot be discarded. None if it can.
    pub(in crate::app::update) fn why_not_discard_batch(&self) -> Option<&'static str> {
        if self.is_read_only() {
            return Some("The document is read-only.");
        }
        if !self.frame().is_some_and(Frame::shows_suggestion) {
            return Some("Nothing is suggested for this frame.");
        }
        if self.frame().is_some_and(Frame::has_imported_camera) {
            return Some("This camera was imported: there is nothing that it replaced.");
        }
        self.shown_batch()
            .is_none()
            .then_some("Its batch of suggestions is gone.")
    }

    /// The batch of the shown frame's suggestion.
    fn shown_batch(&self) -> Option<BatchId> {
        self.open.as_ref()?.project.batch_shown_in(self.frame()?)
    }

    /// Discards the suggestions of the same batch as the shown frame's.
    pub(in crate::app::update) fn discard_shown_batch(&mut self) {
        self.commit_open_step();
        if let Some(batch) = self.shown_batch() {
            self.ask_discard_batch(batch);
        }
    }

    /// Discards a batch of suggestions, or asks first if it is large.
    pub(in crate::app) fn ask_discard_batch(&mut self, batch: BatchId) {
        let Some(open) = &self.open else { return };
        let frames = open.project.frames_showing(batch);
        if frames > UNASKED {
            self.session.dialog = Some(Dialog::DiscardBatch { batch, frames });
        } else {
            self.discard_batch(batch);
        }
    }

    /// Discards a batch of suggestions in the frames that users have not changed since, as one step
    /// of undo, and reports the result.
    pub(in crate::app::update) fn discard_batch(&mut self, batch: BatchId) {
        self.session.dialog = None;
        if self.refuses_changes() {
            return;
        }
        self.commit_open_step();
        let newest_forest = self.newest_forest();
        let Some(open) = &mut self.open else { return };
        let step = Step::on_document(DISCARD);
        let discarded = open.discard_batch(step, batch, newest_forest);
        let text = describe_discarded(&discarded);
        // The trainer must not propose the same again.
        if let Some(refused) = discarded.refused {
            self.effects
                .push(Effect::Trainer(TrainerOrder::Refused(refused)));
        }
        if let Some(edit) = discarded.edit {
            self.journal_edit(edit);
        }
        self.forget_tracked_batch(batch);
        self.session.note(text);
    }

    /// The generation of the newest forest that has proposed anything or was reported.
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

    /// Within an open step that may have moved a camera: withdraws the proposals for its former
    /// base, and refits pan, tilt and zoom of other cameras from pictures so that their lines stay
    /// in place.
    pub(in crate::app::update) fn follow_base(&mut self) {
        let Some(open) = &mut self.open else { return };
        if !open.history.is_open() {
            return;
        }
        // The view is the document as last journalled: that is, before this step.
        let before = open.project.view().clone();
        let withdrawn = follow_all_bases(&mut open.document, &before);
        self.report_withdrawn(withdrawn);
    }

    /// Reports proposals that were withdrawn because they belong to a former base.
    pub(in crate::app) fn report_withdrawn(&mut self, withdrawn: usize) {
        if withdrawn > 0 {
            let (proposals, were) = if withdrawn == 1 {
                ("proposal", "was")
            } else {
                ("proposals", "were")
            };
            let text = format!(
                "{withdrawn} {proposals} for the old base {were} discarded; proposing again."
            );
            self.session.note(text);
        }
    }
}

/// The result of discarding a batch, as text.
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

/// A number of frames with its verb, such as "1 frame has" or "3 frames have".
fn frames_that(frames: usize, one: &str, many: &str) -> String {
    format!(
        "{} {}",
        pluralise(frames, "frame"),
        if frames == 1 { one } else { many }
    )
}
