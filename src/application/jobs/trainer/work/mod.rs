//! The loop of the trainer's thread: chooses the next step by priority, does it, and repeats.
//!
//! [`Work::next`] says which step comes next; the page of the module ([`super`]) lists them. A step
//! is short (four frames) or ends early when its [`Watch`](super::mailbox::Watch) says so, so that
//! new orders take effect soon. A panic within a step becomes `trouble` in the status.
//!
//! | file | steps |
//! |---|---|
//! | `forest.rs` | train or recall the forest, measure it, drop it |
//! | `proposals.rs` | query the forest, propagate cameras, show features |

mod forest;
mod proposals;

use self::forest::Forest;
use self::proposals::Queue;
use super::TrainerOptions;
use super::answer_cache::{AnswerCache, ForestQuerySettings};
use super::backend::Backend;
use super::given_answers::GivenAnswers;
use super::mailbox::{Orders, TrainerMailbox};
use super::windows::Windows;
use crate::app::{AnswerKey, TrainerActivity, TrainerStatus};
use std::any::Any;
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::sync::Arc;
use std::time::Instant;
use touchline_calibration::proposals::{KeyWindow, Proposal, TrainingFrames, TrainingSet};
use touchline_documents::document::{Document, FieldSpec, FrameId};

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

/// A step of the trainer.
enum Step {
    Recall,
    Learn,
    ShowFeatures(usize),
    Propose(Vec<usize>),
    Carry(Box<KeyWindow>),
    Measure,
    /// Wait for an order, at most until a time.
    Wait(TrainerActivity, Option<Instant>),
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
            // Gather proposals while the trainer only proposes. Hand them over before any other
            // step, which may take long or wait.
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
        if self.orders.wishes.paused && !orders.wishes.paused {
            // Pausing and resuming is how the user retries.
            self.failed = None;
        }
        if orders.edition != self.orders.edition
            && let Some(document) = &orders.document
        {
            // Rebuild what depends on the document. `windows` comes first: the copy of the document
            // gets the forest's answers from it, and the caches look at that copy.
            self.windows.look_at(document, self.backend.folder());
            self.document = self.windows.with_answers(document.clone());
            self.given_answers.keep_fitting(&self.document);
            self.training_frames = TrainingFrames::from_solved_frames(document);
            let training_set = TrainingSet::from_frames(document, &self.training_frames.frames);
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
        // When the user looks at features again, they are reported again.
        if !orders.wishes.features {
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
        if self.orders.wishes.paused {
            return Step::Wait(TrainerActivity::Paused, None);
        }
        if self.training_set.is_empty() {
            self.forget();
            return Step::Wait(TrainerActivity::Nothing, None);
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
            if self.orders.wishes.features
                && let Some(position) = self.current()
                && !self.shows_features_of(&self.document.frames[position].id)
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
            // No window is due: a later one begins a new count of progress.
            self.tracked = 0;
            if let Some(frames) = self.take_from_queue(|queue| &mut queue.between) {
                return Step::Propose(frames);
            }
        }
        Step::Wait(
            if due.is_some() {
                TrainerActivity::Settling
            } else {
                TrainerActivity::Nothing
            },
            due,
        )
    }

    /// Whether the window shows the features of a frame as the present forest uses them.
    fn shows_features_of(&self, id: &FrameId) -> bool {
        self.shown
            .as_ref()
            .is_some_and(|(shown, generation)| shown == id && *generation == self.generation)
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
        self.status.answered = self.answer_cache.count_answered(&self.document);
        self.status.unanswered = self.answer_cache.count_unanswered(&self.document);
    }

    /// The query of the moment: which forest, with or without snapping.
    const fn asking(&self) -> ForestQuerySettings {
        ForestQuerySettings {
            generation: self.generation,
            snapping: self.orders.wishes.snapping,
        }
    }

    /// The index of the shown frame in the document; the first frame before any order named one.
    fn current(&self) -> Option<usize> {
        match &self.orders.wishes.frame {
            Some(id) => self.document.frames.position_of(id),
            None => (!self.document.frames.is_empty()).then_some(0),
        }
    }

    fn report(&mut self, doing: TrainerActivity) {
        self.status.doing = doing;
        self.mailbox.report(&self.status);
    }
}

/// Does a part of a step. A panic becomes a message for the user, which says `what` was done.
fn catch_panic<T>(what: &str, work: impl FnOnce() -> T) -> Result<T, String> {
    catch_unwind(AssertUnwindSafe(work)).map_err(|panic| broke_down(what, panic.as_ref()))
}

fn broke_down(what: &str, panic: &(dyn Any + Send)) -> String {
    let message = super::super::panic_message(panic);
    format!(
        "Internal error while {what} (please report it): {message}. Pause and resume to try again."
    )
}
