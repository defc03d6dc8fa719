//! The thread that journals edits and writes documents.
//!
//! Every edit is flushed to disk before it is acknowledged; the document itself is written from
//! time to time, on request and at closing. When the disk refuses, edits stay in memory, the
//! refusal is reported, and the saver tries again.
//!
//! With every edit comes the document that it led to, with what can be undone and redone in it: the
//! saver writes what it is given.

mod work;

use self::work::Work;
use super::Wake;
use super::worker::{Mailbox, Worker};
use crate::app::Snapshot;
use std::path::PathBuf;
use std::time::Duration;
use touchline_documents::document::Edit;
use touchline_documents::store::{DocumentStore, Orphan, Others, Outside, StoreError};

/// How many reports may wait before the saver waits for its owner.
const MOST_REPORTS: usize = 256;

/// Counts the edits of a session: the document after the edit of this number.
pub type Revision = u64;

/// How a saver behaves.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct SaverOptions {
    /// How long edits may be in the journal alone before the document is written. Default: a
    /// minute.
    pub save_every: Duration,
    /// How long to wait before trying again what the disk refused. Default: two seconds.
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

/// How long a saver that is closed waits for the disk. Every edit was journalled as it was made, so
/// that seldom anything is left.
const PATIENCE: Duration = Duration::from_secs(20);

/// What a saver says.
#[derive(Debug)]
pub enum SaverReport {
    /// Every edit up to this one is on disk, in the journal.
    Journaled {
        /// The last of them.
        revision: Revision,
        /// When, local time.
        at: jiff::civil::Time,
    },
    /// The document was written and holds every edit up to this one.
    Saved {
        /// The last of them.
        revision: Revision,
        /// When, local time.
        at: jiff::civil::Time,
        /// The last request of [`Saver::save`] that had been taken by then; 0 before the first.
        request: u64,
        /// Where the version of another program went, if it was replaced.
        set_aside: Option<PathBuf>,
    },
    /// The disk refused the journal or the document. Edits after this one are only in memory; it is
    /// tried again.
    Failed {
        /// The last edit that is on disk, in the journal or the document.
        revision: Revision,
        /// What to tell the user.
        error: StoreError,
    },
    /// Others changed the document; it is not written until somebody decides what becomes of their
    /// version. Edits are still journaled.
    ChangedOutside {
        /// The document's file.
        path: PathBuf,
        /// What the window holds, as it was kept beside; none where it holds nothing of its own, or
        /// where that was refused, which is reported, too.
        own: Option<Orphan>,
    },
    /// What others made of the document, as it was asked for.
    Outside(Box<Outside>),
    /// The saver broke down; nothing is saved any more.
    Broken {
        /// What it said last.
        message: String,
    },
}

/// What the saver is to do, in this order.
#[derive(Default)]
struct Orders {
    /// Journal these, oldest first, each with the document that it led to. An edit can neither be
    /// dropped nor wait elsewhere, so that their number has no bound.
    edits: Vec<(Edit, Snapshot)>,
    /// Write the document.
    save: Option<Others>,
    /// The last request to write it.
    save_request: u64,
    /// Report what others made of the document.
    read_outside: bool,
}

impl Orders {
    /// All of them, if there are any.
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

/// The handle of a saver; dropping it writes what is left.
pub struct Saver {
    worker: Worker<Orders, SaverReport>,
}

impl Saver {
    /// Starts a saver for a document as it was opened.
    ///
    /// # Errors
    /// The system starts no thread.
    pub fn start(
        store: impl DocumentStore + 'static,
        opened: Snapshot,
        options: SaverOptions,
        wake: Wake,
    ) -> std::io::Result<Self> {
        let mailbox = Mailbox::new(Orders::default(), MOST_REPORTS, wake);
        let broke_down = |message| SaverReport::Broken { message };
        let worker = Worker::spawn("saver", mailbox, broke_down, move |mailbox| {
            Work::new(Box::new(store), opened, options, mailbox).run();
        })?;
        Ok(Self { worker })
    }

    /// Hands over an edit and the document that it led to; never waits.
    pub fn edit(&self, edit: Edit, to: Snapshot) {
        self.order(|orders| orders.edits.push((edit, to)));
    }

    /// Asks for the document to be written now, without being told when that is done; never waits.
    pub fn write(&self) {
        self.order(|orders| {
            orders.save.get_or_insert(Others::Stay);
        });
    }

    /// Asks for the document to be written now; never waits. The report of a write names the last
    /// request before it, so that an earlier write is not mistaken for the answer: another program
    /// may have replaced the file in between.
    pub fn save(&self, request: u64) {
        self.order(|orders| {
            orders.save.get_or_insert(Others::Stay);
            orders.save_request = request;
        });
    }

    /// Asks for the document to be written although another program changed the file; that version
    /// is set aside.
    pub fn save_over(&self) {
        self.order(|orders| orders.save = Some(Others::SetAside));
    }

    /// Asks for what others made of the document; never waits.
    pub fn read_outside(&self) {
        self.order(|orders| orders.read_outside = true);
    }

    /// What has been reported since the last call.
    #[must_use]
    pub fn reports(&self) -> Vec<SaverReport> {
        self.worker.mailbox().take_reports()
    }

    /// Writes what is left, ends the thread and returns its last reports. Waits for the disk; one
    /// that does not answer is told of.
    #[must_use]
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
