//! The trainer: a forest is trained on the accepted references and proposes cameras for all other
//! frames.
//!
//! Its owner passes the document after what people did, which is cheap: only the newest one waits,
//! so that a burst of references is one change. Of its own answers the trainer hears by their keys
//! which ones the document shows, and which were discarded: the same forest is not asked for those
//! again.
//!
//! A thread then decides what has to be done: train, ask the forest for frames, measure its
//! accuracy. Added references let a running training finish; a changed or withdrawn one stops it.
//! After each training at least as much time is spent on proposals, so that somebody who accepts
//! without a pause sees them.
//!
//! The work runs on threads of its own, one fewer than the machine has: the window keeps one. What
//! causes a panic is reported and not tried again until something changes.

mod answer_cache;
mod backend;
mod error;
mod given_answers;
mod kept_forest;
mod mailbox;
#[cfg(test)]
mod tests;
mod watch;
mod windows;
mod work;

use self::backend::{Backend, ForestBackend};
use self::mailbox::{Orders, TrainerMailbox};
use self::work::Work;
use super::worker::{Mailbox, Worker};
use super::{SharedPictures, Wake};
use crate::app::{TrainerOrder, TrainerReport};
use std::io;
use std::path::PathBuf;
use std::sync::Arc;
use std::time::Duration;

/// How many reports may wait to be fetched before the trainer pauses; with each come up to some 64
/// proposals.
const MOST_REPORTS: usize = 16;

/// How the trainer behaves.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct TrainerOptions {
    /// How long references must have stayed as they are before training begins. Default: 0.4 s.
    pub settle: Duration,
    /// How long proposals are gathered before they are reported together. Default: 0.5 s.
    pub gather: Duration,
    /// Threads to work on; none takes one fewer than the machine has, but one at least.
    pub threads: Option<usize>,
}

impl Default for TrainerOptions {
    fn default() -> Self {
        Self {
            settle: Duration::from_millis(400),
            gather: Duration::from_millis(500),
            threads: None,
        }
    }
}

/// The trainer of an open document. Dropping it ends its thread.
pub struct Trainer {
    worker: Worker<Orders, TrainerReport>,
}

impl Trainer {
    /// Starts the trainer of a document at `file`; frames among `pictures` are not decoded again.
    /// It does nothing before it gets the document.
    ///
    /// # Errors
    /// The system gives no thread.
    pub fn start(
        file: PathBuf,
        options: TrainerOptions,
        pictures: SharedPictures,
        wake: Wake,
    ) -> io::Result<Self> {
        Self::start_with(options, wake, move |mailbox| {
            ForestBackend::new(&file, mailbox, pictures)
        })
    }

    /// Starts a trainer with the backend that `make` sets up on its thread.
    fn start_with<B: Backend>(
        options: TrainerOptions,
        wake: Wake,
        make: impl FnOnce(Arc<TrainerMailbox>) -> B + Send + 'static,
    ) -> io::Result<Self> {
        let cores = std::thread::available_parallelism().map_or(1, usize::from);
        let threads = options.threads.unwrap_or(cores - 1).max(1);
        let pool = rayon::ThreadPoolBuilder::new()
            .num_threads(threads)
            .thread_name(|at| format!("trainer {at}"));
        let pool = pool.build().map_err(io::Error::other)?;
        let mailbox = Mailbox::new(Orders::default(), MOST_REPORTS, wake);
        let broke_down = |message| TrainerReport::Broken { message };
        let worker = Worker::spawn("trainer", mailbox, broke_down, move |mailbox| {
            let mailbox = Arc::new(TrainerMailbox::new(Arc::clone(mailbox)));
            pool.install(|| Work::new(Arc::clone(&mailbox), make(mailbox), options).run());
        })?;
        Ok(Self { worker })
    }

    /// Sends the trainer an order; never waits.
    pub fn tell(&self, order: TrainerOrder) {
        let replaced = self
            .worker
            .mailbox()
            .update(|state| state.orders.take_in(order));
        // Letting go of a document may take a while.
        drop(replaced);
    }

    /// What it has to say since the last call.
    #[must_use]
    pub fn poll(&self) -> Vec<TrainerReport> {
        self.worker.mailbox().take_reports()
    }
}
