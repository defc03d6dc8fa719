//! The saver: a thread that journals edits and writes documents.
//!
//! Every edit is flushed to the journal before it is acknowledged. The document itself is written
//! at intervals, on request and on closing. When the disk refuses, edits stay in memory, the saver
//! reports the refusal and tries again.
//!
//! Each edit comes with the document that it led to and its history of undo and redo. The saver
//! writes that; it keeps no history of its own.

mod work;

use self::work::Work;
use super::Wake;
use super::worker::{Mailbox, Worker};
use crate::app::Snapshot;
use std::path::PathBuf;
use std::time::Duration;
use touchline_documents::document::Edit;
use touchline_documents::store::{Orphan, Others, Outside, Store, StoreError};

/// Maximum number of waiting reports; beyond it the saver pauses.
const MOST_REPORTS: usize = 256;

/// The number of an edit in this run of the program, and of the document after it.
pub type Revision = u64;

/// Settings of the saver.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct SaverOptions {
    /// Maximum time for which edits are in the journal only. One minute by default.
    pub save_every: Duration,
    /// Time before another attempt after the disk has refused. Two seconds by default.
    pub retry_after: Duration,
}

impl Default for SaverOptions {
    fn default() -> Self {
        Self {
            save_every: Duration::from_mins(1),
            retry_after: Duration::from_secs(2),
        }
    }
}

/// Maximum time that closing waits for the disk. Edits are journaled at once, so that little is
/// left then.
const PATIENCE: Duration = Duration::from_secs(20);

/// What the saver reports.
#[derive(Debug)]
pub enum SaverReport {
    /// All edits up to `revision` are on disk, in the journal.
    Journaled {
        /// The last of them.
        revision: Revision,
        /// Local time.
        at: jiff::civil::Time,
    },
    /// The document was written with all edits up to `revision`.
    Saved {
        /// The last of them.
        revision: Revision,
        /// Local time.
        at: jiff::civil::Time,
        /// The last request of [`Saver::save`] before the write; 0 before the first.
        request: u64,
        /// Where the version of another program was moved, if there was one.
        set_aside: Option<PathBuf>,
    },
    /// The disk refused the journal or the document. The edits since the last report are only in
    /// memory; the saver tries again.
    Failed(StoreError),
    /// Another program changed the document. It is not written until the user decides between the
    /// versions. Edits are still journaled.
    ChangedOutside {
        /// The document's file.
        path: PathBuf,
        /// The file with the user's own version. `None` if it has no own changes, or if it could
        /// not be written, which [`SaverReport::Failed`] reports.
        own: Option<Orphan>,
    },
    /// The version of other programs, as requested.
    Outside(Box<Outside>),
    /// The saver panicked, or the disk does not answer. Nothing is saved any more.
    Broken {
        /// The panic's message, or how long the disk has not answered.
        message: String,
    },
}

/// What the saver is to do, in this order.
#[derive(Default)]
struct Orders {
    /// Edits to journal, oldest first, each with the document that it led to. Their number is not
    /// limited: none may be dropped.
    edits: Vec<(Edit, Snapshot)>,
    /// Write the document, and what to do with the version of another program.
    save: Option<Others>,
    /// The last request of [`Saver::save`].
    save_request: u64,
    /// Report the version of other programs.
    read_outside: bool,
}

impl Orders {
    /// Takes all orders; `None` if there are none.
    fn take(&mut self) -> Option<Self> {
        let Self {
            edits,
            save,
            save_request: _,
            read_outside,
        } = &self;
        let is_any = !edits.is_empty() || save.is_some() || *read_outside;
        is_any.then(|| std::mem::take(self))
    }
}

/// The handle of the saver. Dropping it writes what is left.
pub struct Saver {
    worker: Worker<Orders, SaverReport>,
}

impl Saver {
    /// Starts the saver of a document that has just been opened.
    ///
    /// # Errors
    /// The operating system gives no thread.
    pub fn start(
        store: Store,
        opened: Snapshot,
        options: SaverOptions,
        wake: Wake,
    ) -> std::io::Result<Self> {
        let mailbox = Mailbox::new(Orders::default(), MOST_REPORTS, wake);
        let worker = Worker::spawn(
            "saver",
            mailbox,
            |message| SaverReport::Broken { message },
            move |mailbox| {
                Work::new(store, opened, options, mailbox).run();
            },
        )?;
        Ok(Self { worker })
    }

    /// Orders an edit to be journaled; `to` is the document that it led to. Never blocks.
    pub fn edit(&self, edit: Edit, to: Snapshot) {
        self.order(|orders| orders.edits.push((edit, to)));
    }

    /// Orders the document to be written now, without a request number. Never blocks.
    pub fn write(&self) {
        self.order(|orders| {
            orders.save.get_or_insert(Others::Stay);
        });
    }

    /// Orders the document to be written now. Never blocks.
    ///
    /// [`SaverReport::Saved`] names the last request before the write, so that an earlier write is
    /// not mistaken for the answer: another program may have replaced the file in between.
    pub fn save(&self, request: u64) {
        self.order(|orders| {
            // An order of `save_over` that still waits stays in force.
            orders.save.get_or_insert(Others::Stay);
            orders.save_request = request;
        });
    }

    /// Orders the document to be written although another program changed the file; that version is
    /// renamed. Never blocks.
    pub fn save_over(&self) {
        self.order(|orders| orders.save = Some(Others::SetAside));
    }

    /// Orders a report about the version of other programs. Never blocks.
    pub fn read_outside(&self) {
        self.order(|orders| orders.read_outside = true);
    }

    /// The reports that have arrived since the last call.
    pub fn reports(&self) -> Vec<SaverReport> {
        self.worker.mailbox().take_reports()
    }

    /// Writes what is left, ends the thread and returns its last reports. Blocks until the disk has
    /// answered, at most 20 s; reports a disk that has not answered by then.
    pub fn close(mut self) -> Vec<SaverReport> {
        let (mut reports, has_ended) = self.worker.close(PATIENCE);
        if !has_ended {
            let message = format!(
                "the disk has not answered for {} s; the journal beside the document holds what was saved before",
                PATIENCE.as_secs()
            );
            reports.push(SaverReport::Broken { message });
        }
        reports
    }

    fn order<T>(&self, order: impl FnOnce(&mut Orders) -> T) -> T {
        self.worker
            .mailbox()
            .update(|state| order(&mut state.orders))
    }
}
