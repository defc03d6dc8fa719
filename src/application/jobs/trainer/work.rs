//! The loop of the trainer's thread: chooses the next step by priority, does it, and repeats.
//!
//! [`Work::next`] says which step comes next; the page of the module ([`super`]) lists them. A step
//! is short (four frames) or ends early when its [`Watch`] says so, so that new orders take effect
//! soon. A panic within a step becomes `trouble` in the status.

use super::TrainerOptions;
use super::answer_cache::{AnswerCache, Asking};
use super::backend::{Backend, Learnt, Measured};
use super::given_answers::GivenAnswers;
use super::mailbox::{Orders, TrainerMailbox};
use super::watch::{Until, Watch};
use super::windows::Windows;
use crate::app::{AnswerKey, Doing, ForestFacts, TrainerStatus};
use std::any::Any;
use std::collections::VecDeque;
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::sync::Arc;
use std::time::{Duration, Instant};
use touchline_calibration::proposals::{
    AskingOrder, Coverage, KeyWindow, NoProposal, Proposal, Quality, TrackedProposal,
    TrainingFrames, TrainingSet,
};
use touchline_core::progress::{Progress, Share};
use touchline_documents::document::{Document, FieldSpec, FrameId};
use touchline_vision::relocalize::{CameraForest, ForestModel};

/// Frames for which the forest is queried per step. Between steps the thread looks at its orders.
const BATCH: usize = 4;

/// Proposals are reported at the latest when this many are gathered.
const GATHER_MOST: usize = 64;

/// Maximum time that proposals take precedence over the next training.
const LONGEST_TURN: Duration = Duration::from_secs(20);

/// The state of the trainer's thread.
pub(super) struct Work<C> {
    mailbox: Arc<TrainerMailbox>,
    backend: C,
    options: TrainerOptions,
    orders: Orders,
    document: Document,
    training_frames: TrainingFrames,
    training_set: TrainingSet,
    /// When the training set changed last.
    changed: Instant,
    forest: Option<Forest>,
    generation: u64,
    /// Whether the disk has been searched for a stored forest.
    recalled: bool,
    /// The training set with which training failed; it is not tried again.
    failed: Option<TrainingSet>,
    /// Until then proposals take precedence over the next training.
    turn_until: Instant,
    answer_cache: AnswerCache,
    given_answers: GivenAnswers,
    windows: Windows,
    /// Frames between key frames to which cameras have been propagated since the last time that
    /// none was due. For the progress display.
    tracked: usize,
    queue: Queue,
    /// The frame for which features were shown last, and the generation of that forest.
    shown: Option<(FrameId, u64)>,
    /// The generation of the forest of which the accuracy was measured last.
    measured: u64,
    /// Proposals that have not been reported yet.
    gathered: Vec<Proposal>,
    gathered_since: Instant,
    status: TrainerStatus,
}

/// The forest in use.
struct Forest {
    model: Arc<ForestModel>,
    training_set: TrainingSet,
}

/// Frames for which the forest is to be queried, and the state for which the queue was made.
#[derive(Default)]
struct Queue {
    /// The surroundings of the shown frame, and one frame of each shot.
    first: VecDeque<usize>,
    /// All others except `between`.
    rest: VecDeque<usize>,
    /// Frames of videos between key frames. The forest is queried for them only if no camera was
    /// propagated to them.
    between: VecDeque<usize>,
    /// The edition of the document, the shown frame and the query.
    made_for: Option<(u64, Option<FrameId>, Asking)>,
}

/// A step of the trainer.
enum Step {
    Recall,
    Learn,
    ShowFeatures(usize),
    Propose(Vec<usize>),
    Carry(Box<KeyWindow>),
    Measure,
    /// Wait for an order, at most until a time.
    Wait(Doing, Option<Instant>),
}

impl<C: Backend> Work<C> {
    pub(super) fn new(mailbox: Arc<TrainerMailbox>, backend: C, options: TrainerOptions) -> Self {
        let now = Instant::now();
        Self {
            mailbox,
            backend,
            options,
            orders: Orders::default(),
            document: Document::new(FieldSpec::new("")),
            training_frames: TrainingFrames::default(),
            training_set: TrainingSet::default(),
            changed: now,
            forest: None,
            generation: 0,
            recalled: false,
            failed: None,
            turn_until: now,
            answer_cache: AnswerCache::default(),
            given_answers: GivenAnswers::default(),
            windows: Windows::default(),
            tracked: 0,
            queue: Queue::default(),
            shown: None,
            measured: 0,
            gathered: Vec::new(),
            gathered_since: now,
            status: TrainerStatus::default(),
        }
    }

    /// Works until the mailbox closes.
    pub(super) fn run(mut self) {
        while let Some(orders) = self.mailbox.take_orders() {
            self.take_in(orders);
            let step = self.next();
            if !matches!(step, Step::Propose(_))
                || self.gathered_since.elapsed() >= self.options.gather
            {
                self.hand_over();
            }
            match step {
                Step::Recall => self.recall(),
                Step::Learn => self.learn(),
                Step::ShowFeatures(frame) => self.show_features(frame),
                Step::Propose(frames) => self.propose(&frames),
                Step::Carry(window) => self.carry(&window),
                Step::Measure => self.measure(),
                Step::Wait(doing, until) => {
                    self.report(doing);
                    self.mailbox.wait(self.orders.number, until);
                }
            }
        }
    }

    /// Takes in the orders that have arrived since the last step.
    fn take_in(&mut self, mut orders: Orders) {
        for refused in orders.refused.drain(..) {
            self.answer_cache.refuse(refused);
        }
        // Apply the answers that older documents came to show first: if the newest document lacks
        // one of them, the answer was lost.
        self.note_shown(std::mem::take(&mut orders.shown_before));
        if self.orders.paused && !orders.paused {
            // Pausing and resuming is how the user retries.
            self.failed = None;
        }
        if orders.edition != self.orders.edition
            && let Some(document) = &orders.document
        {
            // Rebuild what depends on the document.
            self.windows.look_at(document, self.backend.folder());
            self.document = self.windows.with_answers(document.clone());
            self.given_answers.keep_fitting(&self.document);
            self.training_frames = TrainingFrames::of_solved(document);
            let training_set = TrainingSet::of(document, &self.training_frames.frames);
            if training_set != self.training_set {
                let before = std::mem::replace(&mut self.training_set, training_set);
                self.forget_changed(&before);
                self.changed = Instant::now();
            }
            self.answer_cache.look_at(&self.document);
            let TrainingFrames {
                frames,
                references,
                withheld,
            } = &self.training_frames;
            (
                self.status.references,
                self.status.training_frames,
                self.status.withheld,
            ) = (*references, frames.len(), *withheld);
            self.count();
        }
        self.note_shown(std::mem::take(&mut orders.shown));
        if !orders.features {
            self.shown = None;
        }
        self.orders = orders;
    }

    /// Records which answers the document has come to show, and copies those that this copy of it
    /// lacks.
    fn note_shown(&mut self, keys: Vec<AnswerKey>) {
        for key in keys {
            if key.is_tracked {
                self.windows.note_shown(&key.frame);
            } else {
                self.answer_cache.note_shown(&key);
            }
            self.given_answers.show(&key, &mut self.document);
        }
    }

    /// The first step that is due, in the order of the table on the module's page.
    fn next(&mut self) -> Step {
        if self.orders.paused {
            return Step::Wait(Doing::Paused, None);
        }
        if self.training_set.is_empty() {
            self.forget();
            return Step::Wait(Doing::Nothing, None);
        }
        let taught = self.forest.as_ref().map(|forest| &forest.training_set);
        let is_taught = taught == Some(&self.training_set);
        // A forest is usable only if none of its training samples has been changed or withdrawn.
        let serves = taught.is_some_and(|taught| self.training_set.contains(taught));
        let is_due = !is_taught && self.failed.as_ref() != Some(&self.training_set);
        // Train when the training set has been unchanged for a while. After the last training,
        // proposals of a usable forest come first.
        let mut due = None;
        if is_due {
            if !self.recalled {
                return Step::Recall;
            }
            let settled = self.changed + self.options.settle;
            let turn = if serves && self.has_to_ask() {
                self.turn_until
            } else {
                settled
            };
            if Instant::now() >= settled.max(turn) {
                return Step::Learn;
            }
            due = Some(settled.max(turn));
        }
        // Query the forest: the shown frame's features, frames near it, the accuracy, all other
        // frames.
        if serves {
            let is_shown = |id: &FrameId| matches!(&self.shown, Some((shown, by)) if shown == id && *by == self.generation);
            if self.orders.features
                && let Some(position) = self.current()
                && !is_shown(&self.document.frames[position].id)
            {
                return Step::ShowFeatures(position);
            }
            if let Some(frames) = self.take_from_queue(|queue| &mut queue.first) {
                return Step::Propose(frames);
            }
            if is_taught && self.measured != self.generation {
                return Step::Measure;
            }
            if let Some(frames) = self.take_from_queue(|queue| &mut queue.rest) {
                return Step::Propose(frames);
            }
            // Then propagate cameras between key frames, and query the forest for what that left
            // out.
            if let Some(window) = self.due_window() {
                return Step::Carry(Box::new(window));
            }
            self.tracked = 0;
            if let Some(frames) = self.take_from_queue(|queue| &mut queue.between) {
                return Step::Propose(frames);
            }
        }
        Step::Wait(
            if due.is_some() {
                Doing::Settling
            } else {
                Doing::Nothing
            },
            due,
        )
    }

    /// Drops what was found out about references that were changed or withdrawn.
    fn forget_changed(&mut self, before: &TrainingSet) {
        let is_unchanged = |id: &FrameId| {
            let position = self.document.frames.position_of(id);
            let sample = position.map(|position| TrainingSet::of(&self.document, &[position]));
            sample.is_some_and(|sample| {
                before.contains(&sample) && self.training_set.contains(&sample)
            })
        };
        let status = &mut self.status;
        status.suspects = status
            .suspects
            .iter()
            .filter(|suspect| is_unchanged(&suspect.frame))
            .cloned()
            .collect();
        status.failed = status
            .failed
            .iter()
            .filter(|failed| is_unchanged(&failed.frame))
            .cloned()
            .collect();
    }

    /// Drops the forest: no training sample is left.
    fn forget(&mut self) {
        if self.forest.take().is_some() {
            self.answer_cache.trust_from(self.generation + 1);
        }
        self.status = TrainerStatus {
            references: self.status.references,
            withheld: self.status.withheld,
            answered: self.status.answered,
            not_kept: self.status.not_kept.take(),
            ..TrainerStatus::default()
        };
    }

    /// Looks for a forest that an earlier run of the program stored.
    fn recall(&mut self) {
        self.recalled = true;
        match self.backend.recall(&self.training_set) {
            Ok(Some(model)) => {
                let facts = ForestFacts {
                    references: self.training_frames.frames.len(),
                    ..facts(&model)
                };
                // The forest already answered in an earlier run; what was discarded then stays
                // discarded.
                self.answer_cache
                    .keep_refusing(self.generation, self.generation + 1);
                self.take_forest(model, self.training_set.clone(), facts);
            }
            Ok(None) => {}
            // Not fatal: a new forest is trained instead.
            Err(error) => self.status.trouble = Some(error.to_string()),
        }
    }

    /// Trains a forest; ends early if a training sample is changed or withdrawn.
    fn learn(&mut self) {
        let begun = Instant::now();
        let (document, training_frames) =
            (self.document.clone(), self.training_frames.frames.clone());
        let training_set = self.training_set.clone();
        let watch = Watch::new(
            &self.mailbox,
            &self.status,
            self.orders.edition,
            Until::Unlearnt(training_set.clone()),
        );
        let backend = &mut self.backend;
        let learnt = catch_unwind(AssertUnwindSafe(|| {
            let progress = Progress::new(|doing| watch.tell(doing));
            backend.learn(&document, &training_frames, &training_set, &progress)
        }));
        match learnt {
            Ok(Ok(None)) => {}
            Ok(Ok(Some(Learnt {
                model,
                features,
                failed,
            }))) => {
                let took = begun.elapsed();
                let facts = ForestFacts {
                    references: training_frames.len() - failed.len(),
                    features,
                    took: Some(took),
                    ..facts(&model)
                };
                self.status.failed = failed.into();
                self.status.trouble = None;
                self.turn_until = Instant::now() + took.min(LONGEST_TURN);
                self.take_forest(model, training_set, facts);
            }
            Ok(Err(error)) => {
                self.status.trouble = Some(error.to_string());
                self.failed = Some(training_set);
            }
            Err(panic) => {
                self.status.trouble = Some(broke_down("learning", panic.as_ref()));
                self.failed = Some(training_set);
            }
        }
        self.status.not_kept = self.backend.not_kept();
    }

    /// Puts a forest into use under a new generation.
    fn take_forest(&mut self, model: ForestModel, training_set: TrainingSet, facts: ForestFacts) {
        self.generation += 1;
        // If it lacks samples of the one before, something was withdrawn: earlier answers are
        // unreliable.
        if self
            .forest
            .as_ref()
            .is_some_and(|before| !training_set.contains(&before.training_set))
        {
            self.answer_cache.trust_from(self.generation);
        }
        self.status.forest = Some(ForestFacts {
            generation: self.generation,
            ..facts
        });
        self.forest = Some(Forest {
            model: Arc::new(model),
            training_set,
        });
        self.survey();
    }

    /// Queries the forest for some frames and records the answers.
    fn propose(&mut self, frames: &[usize]) {
        let Some(model) = self.forest.as_ref().map(|forest| Arc::clone(&forest.model)) else {
            return;
        };
        // Progress counts every answer of this forest. Frames between key frames count once they
        // are next.
        let done = self.answer_cache.given_by(self.asking());
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
            Until::Done,
        );
        let (document, request) = (&self.document, self.asking());
        let Asking {
            generation,
            snapping,
        } = request;
        let backend = &mut self.backend;
        let proposed = catch_unwind(AssertUnwindSafe(|| {
            let asking = Progress::new(|more| {
                watch.tell(Doing::Proposing(Share {
                    done: done + more,
                    of,
                }))
            });
            backend.propose(document, frames, (&model, generation), snapping, &asking)
        }));
        let proposals = proposed.unwrap_or_else(|panic| {
            self.status.trouble = Some(broke_down("proposing", panic.as_ref()));
            let message = super::super::panic_message(panic.as_ref());
            let none = |index: &usize| {
                let reason = NoProposal::Panicked {
                    message: message.clone(),
                };
                Proposal::without_answer(document, *index, generation, reason)
            };
            frames.iter().map(none).collect()
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
    fn due_window(&self) -> Option<KeyWindow> {
        let (model, asking) = (&self.forest.as_ref()?.model, self.asking());
        let wanted = |index| {
            self.answer_cache
                .wants(&self.document, index, model, asking)
        };
        self.windows
            .due(&self.document, self.current().unwrap_or(0), wanted)
            .cloned()
    }

    /// Propagates cameras through a window and reports those that are new.
    fn carry(&mut self, window: &KeyWindow) {
        let Some(model) = self.forest.as_ref().map(|forest| Arc::clone(&forest.model)) else {
            return;
        };
        let asking = self.asking();
        let wanted = |index| {
            self.answer_cache
                .wants(&self.document, index, &model, asking)
        };
        let waiting = self.windows.waiting(&self.document, wanted);
        let watch = Watch::new(
            &self.mailbox,
            &self.status,
            self.orders.edition,
            Until::Done,
        );
        let (backend, document, generation) = (&mut self.backend, &self.document, self.generation);
        let before = self.tracked;
        let share = |done: usize| Share {
            done: before + done.min(window.between.len()),
            of: before + waiting,
        };
        let carrying = Progress::new(|done| watch.tell(Doing::Carrying(share(done))));
        let tracked = catch_unwind(AssertUnwindSafe(|| {
            backend.carry(document, window, generation, &carrying)
        }));
        let tracked = match tracked {
            // Ended early: the window stays due.
            Ok(None) => return,
            Ok(Some(tracked)) => tracked,
            Err(panic) => {
                self.status.trouble = Some(broke_down("carrying cameras", panic.as_ref()));
                Vec::new()
            }
        };
        self.tracked += window.between.len();
        let is_refused = |tracked: &TrackedProposal| {
            self.answer_cache
                .is_refused(&tracked.frame, self.generation)
        };
        let tracked = tracked
            .into_iter()
            .filter(|tracked| !is_refused(tracked))
            .collect();
        let news = self.windows.enter(window, &self.document, tracked);
        // Key frames keep the forest's answer in this copy of the document; propagation starts from
        // that.
        for tracked in &news {
            let is_key = |place: usize| window.keys.contains(&place);
            if let Some(place) = self
                .document
                .frames
                .position_of(&tracked.frame)
                .filter(|place| !is_key(*place))
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
    fn show_features(&mut self, frame: usize) {
        self.shown = Some((self.document.frames[frame].id.clone(), self.generation));
        let Some(model) = self.forest.as_ref().map(|forest| Arc::clone(&forest.model)) else {
            return;
        };
        let (backend, document) = (&mut self.backend, &self.document);
        match catch_unwind(AssertUnwindSafe(|| {
            backend.features(document, frame, &model)
        })) {
            Ok(Some(used)) => self.mailbox.show_features(used),
            // The picture cannot be read; the viewport already says so.
            Ok(None) => {}
            Err(panic) => {
                self.status.trouble = Some(broke_down("looking at features", panic.as_ref()));
            }
        }
    }

    /// Reports the gathered proposals.
    fn hand_over(&mut self) {
        if self.gathered.is_empty() {
            return;
        }
        self.count();
        self.mailbox.propose(std::mem::take(&mut self.gathered));
    }

    fn count(&mut self) {
        self.status.answered = self.answer_cache.answered(&self.document);
        self.status.unanswered = self.answer_cache.unanswered(&self.document);
    }

    /// Measures the accuracy of the forest by leaving references out.
    fn measure(&mut self) {
        let document = self.document.clone();
        let training_frames = &self.training_frames.frames;
        let watch = Watch::new(
            &self.mailbox,
            &self.status,
            self.orders.edition,
            Until::Changed(self.training_set.clone()),
        );
        let backend = &mut self.backend;
        let measured = catch_unwind(AssertUnwindSafe(|| {
            let progress = Progress::new(|doing| watch.tell(doing));
            backend.measure(&document, training_frames, &progress)
        }));
        // If this ended early, or the training set has changed, it is measured again.
        match measured {
            Ok(None) => return,
            Ok(Some(_)) if !watch.is_wanted() => return,
            Ok(Some(Measured { quality, suspects })) => {
                if let Some(quality) = &quality {
                    self.bound(quality);
                }
                self.status.quality = quality.map(Arc::new);
                self.status.suspects = suspects.into();
            }
            Err(panic) => {
                self.status.trouble = Some(broke_down("measuring quality", panic.as_ref()));
            }
        }
        self.measured = self.generation;
    }

    /// Lowers the forest's stated probabilities if references that were left out got wrong answers
    /// stated as certain. The result is a new generation, so that earlier answers are queried
    /// again.
    fn bound(&mut self, quality: &Quality) {
        let shown = quality.shown();
        let (Some(forest), Some(facts)) = (&self.forest, &self.status.forest) else {
            return;
        };
        if shown.right == shown.certain {
            return;
        }
        let mut model = (*forest.model).clone();
        quality.bound(&self.document, &mut model);
        let (training_set, facts) = (forest.training_set.clone(), *facts);
        self.answer_cache
            .keep_refusing(self.generation, self.generation + 1);
        self.take_forest(model, training_set, facts);
    }

    /// Maps what the references of each camera see.
    fn survey(&mut self) {
        let training_frames = &self.training_frames.frames;
        self.status.coverage =
            Coverage::of_cameras(self.document.at(self.backend.folder()), training_frames).into();
    }

    /// The next [`BATCH`] frames of a part of the queue for which an answer is missing.
    fn take_from_queue(
        &mut self,
        part: fn(&mut Queue) -> &mut VecDeque<usize>,
    ) -> Option<Vec<usize>> {
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
    fn has_to_ask(&mut self) -> bool {
        let Some(forest) = &self.forest else {
            return false;
        };
        let asking = self.asking();
        let made_for = Some((self.orders.edition, self.orders.frame.clone(), asking));
        if self.queue.made_for != made_for {
            let wanted = |index| {
                self.answer_cache
                    .wants(&self.document, index, &forest.model, asking)
            };
            let AskingOrder { first, rest } =
                AskingOrder::of(&self.document, self.current().unwrap_or(0), wanted);
            let (between, rest): (Vec<usize>, Vec<usize>) = rest
                .into_iter()
                .partition(|index| self.windows.holds_back(*index));
            let is_left = |index: &usize| !self.windows.has_given(&self.document.frames[*index].id);
            let between = between.into_iter().filter(is_left).collect();
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

    /// The query of the moment: which forest, with or without snapping.
    const fn asking(&self) -> Asking {
        Asking {
            generation: self.generation,
            snapping: self.orders.snapping,
        }
    }

    /// The index of the shown frame in the document; the first frame before any order named one.
    fn current(&self) -> Option<usize> {
        match &self.orders.frame {
            Some(id) => self.document.frames.position_of(id),
            None => (!self.document.frames.is_empty()).then_some(0),
        }
    }

    fn report(&mut self, doing: Doing) {
        self.status.doing = doing;
        self.mailbox.report(&self.status);
    }
}

/// The size of a forest.
fn facts(model: &ForestModel) -> ForestFacts {
    let count = |of: fn(&CameraForest) -> usize| model.cameras.iter().map(of).sum();
    ForestFacts {
        trees: count(|camera| camera.forest.trees()),
        leaves: count(|camera| camera.forest.leaves()),
        ..ForestFacts::default()
    }
}

fn broke_down(what: &str, panic: &(dyn Any + Send)) -> String {
    let message = super::super::panic_message(panic);
    format!(
        "Internal error while {what} (please report it): {message}. Pause and resume to try again."
    )
}
