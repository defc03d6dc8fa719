//! The trainer: trains a forest on the accepted references and proposes cameras for all other
//! frames.
//!
//! # Orders
//!
//! The owner sends the document after each edit. That is cheap: only the newest document waits, so
//! that several new references are one change. The owner also sends which of the trainer's answers
//! the document shows (by [`AnswerKey`](crate::app::AnswerKey)), and which were discarded: the same
//! forest is not queried for those again.
//!
//! # Steps
//!
//! The thread (`work/mod.rs`) repeats the first of these steps that is due:
//!
//! | step | when | file |
//! |---|---|---|
//! | recall a stored forest | once, before the first training | `backend.rs` |
//! | train | the training set is new and older than [`TrainerOptions::settle`] | `backend.rs` |
//! | show features | the user looks at the features of a frame | `backend.rs` |
//! | query the forest near the shown frame and once per shot | no answer yet | `answer_cache.rs` |
//! | measure accuracy | once for each forest | `backend.rs` |
//! | query the forest for all other frames | no answer yet | `answer_cache.rs` |
//! | propagate cameras between the key frames of a video | key frames have answers | `windows.rs` |
//! | query the forest between key frames | propagation gave no camera | `answer_cache.rs` |
//!
//! Added references let a running training finish; a changed or withdrawn one stops it
//! (`mailbox.rs`). After each training, proposals take precedence for as long as the training took,
//! at most 20 s, so that a user who accepts without a pause sees results.
//!
//! The work runs on threads of its own, one fewer than the machine has: the window keeps one. Work
//! that panics is reported and not repeated until its input changes.

mod answer_cache;
mod backend;
mod given_answers;
mod mailbox;
#[cfg(test)]
mod tests;
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

/// Maximum number of waiting reports; beyond it the trainer pauses. A report has about 64
/// proposals.
const MOST_REPORTS: usize = 16;

/// Settings of the trainer.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct TrainerOptions {
    /// Time for which the training set must be unchanged before training begins. 0.4 s by default.
    pub settle: Duration,
    /// Time for which proposals are gathered into one report. 0.5 s by default.
    pub gather: Duration,
    /// Number of threads. By default one fewer than the machine has, at least one.
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

/// The handle of the trainer of an open document. Dropping it ends the thread.
pub struct Trainer {
    worker: Worker<Orders, TrainerReport>,
}

impl Trainer {
    /// Starts the trainer of the document at `file`. Frames among `pictures` are not decoded again.
    /// It does nothing before it receives the document.
    ///
    /// # Errors
    /// The operating system gives no thread.
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

    /// Starts a trainer; `make` creates its backend on the trainer's thread.
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
        let worker = Worker::spawn(
            "trainer",
            mailbox,
            |message| TrainerReport::Broken { message },
            move |mailbox| {
                let mailbox = Arc::new(TrainerMailbox::new(Arc::clone(mailbox)));
                pool.install(|| Work::new(Arc::clone(&mailbox), make(mailbox), options).run());
            },
        )?;
        Ok(Self { worker })
    }

    /// Sends an order; never blocks.
    pub fn notify(&self, order: TrainerOrder) {
        let replaced = self
            .worker
            .mailbox()
            .update(|state| state.orders.take_in(order));
        // Dropping a large document may take a while; do it outside the lock.
        drop(replaced);
    }

    /// The reports that have arrived since the last call.
    pub fn poll(&self) -> Vec<TrainerReport> {
        self.worker.mailbox().take_reports()
    }
}
