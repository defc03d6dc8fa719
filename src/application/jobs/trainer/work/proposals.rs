//! The steps that use the forest: they find cameras for the frames that lack one.
//!
//! The trainer queries the forest for the frames in its queue, a few per step, and propagates
//! cameras between the key frames of videos. It shows how the forest uses the features of a frame.

use super::{Work, broke_down, catch_panic};
use crate::app::TrainerActivity;
use crate::jobs::panic_message;
use crate::jobs::trainer::answer_cache::ForestQuerySettings;
use crate::jobs::trainer::backend::Backend;
use crate::jobs::trainer::mailbox::{StopCondition, Watch};
use std::collections::VecDeque;
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::sync::Arc;
use std::time::Instant;
use touchline_calibration::proposals::{KeyWindow, NoProposal, Proposal, QueryOrder};
use touchline_core::progress::{Progress, Share};
use touchline_documents::document::FrameId;
use touchline_vision::relocalize::ForestModel;

/// Frames for which the forest is queried per step. Between steps the thread looks at its orders.
const BATCH: usize = 4;

/// Proposals are reported at the latest when this many are gathered.
const GATHER_MOST: usize = 64;

/// Frames for which the forest is to be queried, and the state for which the queue was made.
#[derive(Default)]
pub(super) struct Queue {
    /// The surroundings of the shown frame, and one frame of each shot.
    pub(super) first: VecDeque<usize>,
    /// All others except `between`.
    pub(super) rest: VecDeque<usize>,
    /// Frames of videos between key frames. The forest is queried for them only if no camera was
    /// propagated to them.
    pub(super) between: VecDeque<usize>,
    /// The edition of the document, the shown frame and the query.
    made_for: Option<(u64, Option<FrameId>, ForestQuerySettings)>,
}

impl<C: Backend> Work<C> {
    /// The next [`BATCH`] frames of a part of the queue for which an answer is missing.
    pub(super) fn take_from_queue(
        &mut self,
        part: fn(&mut Queue) -> &mut VecDeque<usize>,
    ) -> Option<Vec<usize>> {
        // Rebuild the queue if it is out of date. `wants` is checked again below, because answers
        // may have arrived since the queue was made.
        self.has_to_ask();
        let (model, asking) = (Arc::clone(&self.forest.as_ref()?.model), self.asking());
        let mut taken = Vec::new();
        while taken.len() < BATCH
            && let Some(index) = part(&mut self.queue).pop_front()
        {
            if self
                .answer_cache
                .wants(&self.document, index, &model, asking)
            {
                taken.push(index);
            }
        }
        (!taken.is_empty()).then_some(taken)
    }

    /// Rebuilds the queue if what it was made for has changed; returns whether it has a frame.
    pub(super) fn has_to_ask(&mut self) -> bool {
        let Some(forest) = &self.forest else {
            return false;
        };
        let asking = self.asking();
        let made_for = Some((
            self.orders.edition,
            self.orders.wishes.frame.clone(),
            asking,
        ));
        if self.queue.made_for != made_for {
            let QueryOrder { first, rest } =
                QueryOrder::new(&self.document, self.current().unwrap_or(0), |index| {
                    self.wants(index, &forest.model, asking)
                });
            let (between, rest): (Vec<usize>, Vec<usize>) = rest
                .into_iter()
                .partition(|index| self.windows.holds_back(*index));
            let between = between
                .into_iter()
                .filter(|index| !self.windows.has_given(&self.document.frames[*index].id))
                .collect();
            self.queue = Queue {
                first: first.into(),
                rest: rest.into(),
                between,
                made_for,
            };
        }
        !(self.queue.first.is_empty()
            && self.queue.rest.is_empty()
            && self.queue.between.is_empty())
    }

    /// Queries the forest for some frames and records the answers.
    pub(super) fn propose(&mut self, frames: &[usize]) {
        let Some(model) = self.forest.as_ref().map(|forest| Arc::clone(&forest.model)) else {
            return;
        };
        // Progress counts every answer of this forest. Frames between key frames count once they
        // are next.
        let done = self.answer_cache.count_answers(self.asking());
        let queue = &self.queue;
        let between = if queue.rest.is_empty() {
            queue.between.len()
        } else {
            0
        };
        let of = done + frames.len() + queue.first.len() + queue.rest.len() + between;
        let watch = Watch::new(
            &self.mailbox,
            &self.status,
            self.orders.edition,
            StopCondition::Done,
        );
        let (document, request) = (&self.document, self.asking());
        let ForestQuerySettings {
            generation,
            snapping,
        } = request;
        let backend = &mut self.backend;
        let proposed = catch_unwind(AssertUnwindSafe(|| {
            let progress = Progress::new(|more| {
                watch.notify(TrainerActivity::Proposing(Share::new(done + more, of)))
            });
            backend.propose(document, frames, (&model, generation), snapping, &progress)
        }));
        // After a panic each frame of the batch gets an answer that says so. Without one the batch
        // would be the next again, without end.
        let proposals = proposed.unwrap_or_else(|panic| {
            self.status.trouble = Some(broke_down("proposing", panic.as_ref()));
            let message = panic_message(panic.as_ref());
            let proposals = frames.iter().map(|index| {
                let reason = NoProposal::Panicked {
                    message: message.clone(),
                };
                Proposal::without_answer(document, *index, generation, reason)
            });
            proposals.collect()
        });
        // Ended early: the remaining frames return to the queue.
        if proposals.len() < frames.len() {
            self.queue.made_for = None;
        }
        if self.gathered.is_empty() {
            self.gathered_since = Instant::now();
        }
        for proposal in &proposals {
            self.answer_cache.enter(proposal, request);
            // Propagation starts from these cameras, before the application has sent a document
            // that shows them.
            if let Some(frame) = self
                .document
                .frames
                .by_id_mut(&proposal.frame)
                .filter(|frame| frame.is_open())
            {
                proposal.record(frame);
                self.given_answers.give(frame, request.generation);
            }
        }
        self.gathered.extend(proposals);
        if self.gathered.len() >= GATHER_MOST {
            self.hand_over();
        }
    }

    /// The nearest window through which cameras can be propagated.
    pub(super) fn due_window(&self) -> Option<KeyWindow> {
        let (model, asking) = (&self.forest.as_ref()?.model, self.asking());
        self.windows
            .due(&self.document, self.current().unwrap_or(0), |index| {
                self.wants(index, model, asking)
            })
            .cloned()
    }

    /// Whether an answer of the forest for a frame is missing.
    fn wants(&self, index: usize, model: &ForestModel, asking: ForestQuerySettings) -> bool {
        self.answer_cache
            .wants(&self.document, index, model, asking)
    }

    /// Propagates cameras through a window and reports those that are new.
    pub(super) fn carry(&mut self, window: &KeyWindow) {
        let Some(model) = self.forest.as_ref().map(|forest| Arc::clone(&forest.model)) else {
            return;
        };
        let asking = self.asking();
        let waiting = self
            .windows
            .waiting(&self.document, |index| self.wants(index, &model, asking));
        let watch = Watch::new(
            &self.mailbox,
            &self.status,
            self.orders.edition,
            StopCondition::Done,
        );
        let (backend, document, generation) = (&mut self.backend, &self.document, self.generation);
        let before = self.tracked;
        let progress = Progress::new(|done: usize| {
            watch.notify(TrainerActivity::Carrying(Share::new(
                before + done.min(window.between.len()),
                before + waiting,
            )))
        });
        let tracked = catch_panic("tracking cameras", || {
            backend.carry(document, window, generation, &progress)
        });
        let tracked = match tracked {
            // Ended early: the window stays due.
            Ok(None) => return,
            Ok(Some(tracked)) => tracked,
            // Entered below as a propagation without a result, so that it is not repeated.
            Err(trouble) => {
                self.status.trouble = Some(trouble);
                Vec::new()
            }
        };
        self.tracked += window.between.len();
        // The user may have discarded cameras of this generation while the window was tracked.
        let tracked = tracked
            .into_iter()
            .filter(|tracked| {
                !self
                    .answer_cache
                    .is_refused(&tracked.frame, self.generation)
            })
            .collect();
        let news = self.windows.enter(window, &self.document, tracked);
        // Key frames keep the forest's answer in this copy of the document; propagation starts from
        // that.
        for tracked in &news {
            if let Some(place) = self
                .document
                .frames
                .position_of(&tracked.frame)
                .filter(|place| !window.keys.contains(place))
            {
                tracked.record(&mut self.document.frames[place]);
                self.given_answers
                    .give(&self.document.frames[place], self.generation);
            }
        }
        if !news.is_empty() {
            self.mailbox.carry(news);
        }
    }

    /// Reports how the forest uses the features of the shown frame.
    pub(super) fn show_features(&mut self, frame: usize) {
        self.shown = Some((self.document.frames[frame].id.clone(), self.generation));
        let Some(model) = self.forest.as_ref().map(|forest| Arc::clone(&forest.model)) else {
            return;
        };
        let (backend, document) = (&mut self.backend, &self.document);
        match catch_panic("looking at features", || {
            backend.features(document, frame, &model)
        }) {
            Ok(Some(used)) => self.mailbox.show_features(used),
            // The picture cannot be read; the viewport already says so.
            Ok(None) => {}
            Err(trouble) => self.status.trouble = Some(trouble),
        }
    }
}
