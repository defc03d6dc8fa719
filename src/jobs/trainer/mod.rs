//! The trainer: accepted references teach a forest, the forest proposes cameras for all other frames.
//!
//! Its owner tells it the document as it is now, which costs nothing: only the newest waits, so that bursts of references
//! are one change. A thread of its own then finds out what has to be done: train, ask the forest for frames, measure what
//! it is worth. References that are added let a running training end; one that was changed or withdrawn stops it. After
//! each training at least as much time belongs to proposals, so that somebody who accepts without a pause sees them.
//!
//! The work runs on threads of its own, one fewer than the machine has: the window keeps one. What it panics at is reported
//! and left alone until something changes.

mod book;
mod craft;
mod desk;
mod kept_forest;
#[cfg(test)]
mod tests;
mod watch;
mod work;

use self::craft::Workshop;
use self::desk::Desk;
use self::work::Work;
use super::{SharedPictures, Wake};
use crate::app::{TrainerOrder, TrainerStatus};
use crate::proposals::{Proposal, UsedFeatures};
use std::io;
use std::path::PathBuf;
use std::sync::Arc;
use std::thread::JoinHandle;
use std::time::Duration;

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
        Self { settle: Duration::from_millis(400), gather: Duration::from_millis(500), threads: None }
    }
}

/// What the trainer says.
#[derive(Clone, Debug, PartialEq)]
pub enum TrainerReport {
    /// What it is doing and has found out, when that changed.
    Status(Box<TrainerStatus>),
    /// What the forest proposes.
    Proposals(Vec<Proposal>),
    /// What the forest made of the shown frame's features.
    Features(Box<UsedFeatures>),
}

/// The trainer of an open document. Dropping it ends its thread.
pub struct Trainer {
    desk: Arc<Desk>,
    thread: Option<JoinHandle<()>>,
}

impl Trainer {
    /// Starts the trainer of a document that lies at `file`; frames among `pictures` are not decoded again. It does nothing
    /// before it is told the document.
    ///
    /// # Errors
    /// The system gives no thread.
    pub fn start(file: PathBuf, options: TrainerOptions, pictures: SharedPictures, wake: Wake) -> io::Result<Self> {
        Self::start_with(options, wake, move |desk| Workshop::new(&file, desk, pictures))
    }

    /// Starts a trainer with the workshop that `make` sets up on its thread.
    fn start_with<C: craft::Craft>(
        options: TrainerOptions,
        wake: Wake,
        make: impl FnOnce(Arc<Desk>) -> C + Send + 'static,
    ) -> io::Result<Self> {
        let cores = std::thread::available_parallelism().map_or(1, usize::from);
        let threads = options.threads.unwrap_or(cores - 1).max(1);
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).thread_name(|at| format!("trainer {at}"));
        let pool = pool.build().map_err(io::Error::other)?;
        let desk = Arc::new(Desk::new(wake));
        let of_thread = Arc::clone(&desk);
        let thread = std::thread::Builder::new().name("trainer".to_owned()).spawn(move || {
            pool.install(|| Work::new(Arc::clone(&of_thread), make(of_thread), options).run());
        })?;
        Ok(Self { desk, thread: Some(thread) })
    }

    /// Tells the trainer something; never waits.
    pub fn tell(&self, order: TrainerOrder) {
        self.desk.take_order(order);
    }

    /// What it has to say since the last call.
    #[must_use]
    pub fn poll(&self) -> Vec<TrainerReport> {
        self.desk.fetch_reports()
    }
}

impl Drop for Trainer {
    fn drop(&mut self) {
        self.desk.stop();
        if let Some(thread) = self.thread.take() {
            // Panics of the work have been reported.
            let _ = thread.join();
        }
    }
}
