//! The thread that journals edits and writes documents.
//!
//! Every edit is flushed to disk before it is acknowledged; the document itself is written from time to time, on request
//! and at closing. When the disk refuses, edits stay in memory, the refusal is reported, and the saver tries again.

use super::Wake;
use crate::document::{Document, Edit};
use crate::store::{Store, StoreError};
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::path::PathBuf;
use std::sync::mpsc::{Receiver, RecvTimeoutError, Sender, SyncSender, TrySendError, channel, sync_channel};
use std::thread::JoinHandle;
use std::time::{Duration, Instant};

/// How many edits may wait for a slow disk one by one; further ones are joined into one.
const CAPACITY: usize = 64;

/// Counts the edits of a session: the document after the edit of this number.
pub type Revision = u64;

/// How a saver behaves.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct SaverOptions {
    /// How long edits may be in the journal alone before the document is written. Default: a minute.
    pub save_every: Duration,
    /// How long to wait before trying again what the disk refused. Default: two seconds.
    pub retry_after: Duration,
}

impl Default for SaverOptions {
    fn default() -> Self {
        Self { save_every: Duration::from_mins(1), retry_after: Duration::from_secs(2) }
    }
}

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
        /// Where the version of another program went, if it was replaced.
        set_aside: Option<PathBuf>,
    },
    /// The disk refused the journal or the document. Edits after this one are only in memory; it is tried again.
    Failed {
        /// The last edit that is on disk, in the journal or the document.
        revision: Revision,
        /// What to tell the user.
        error: StoreError,
    },
    /// The saver broke down; nothing is saved any more.
    Broken {
        /// What it said last.
        message: String,
    },
}

enum Order {
    Edit(Edit, Revision),
    Save(Save),
    Close,
}

/// What happens to a version that another program wrote meanwhile.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Save {
    /// It stays, and the document is not written.
    Careful,
    /// It is set aside.
    Over,
}

/// The handle of a saver; dropping it writes what is left.
pub struct Saver {
    orders: SyncSender<Order>,
    reports: Receiver<SaverReport>,
    /// Edits that found the channel full, joined.
    waiting: Option<(Edit, Revision)>,
    /// A request that found the channel full.
    waiting_save: Option<Save>,
    thread: Option<JoinHandle<()>>,
}

impl Saver {
    /// Starts a saver for a document as it was opened.
    ///
    /// # Errors
    /// The system starts no thread.
    pub fn start(store: Store, document: Document, options: SaverOptions, wake: Wake) -> std::io::Result<Self> {
        let (orders, inbox) = sync_channel(CAPACITY);
        let (outbox, reports) = channel();
        let run = move || {
            let (last_words, last_wake) = (outbox.clone(), wake.clone());
            let work = Work::new(store, document, options, outbox, wake);
            if let Err(panic) = catch_unwind(AssertUnwindSafe(|| work.run(&inbox))) {
                let text = panic.downcast_ref::<&str>().copied();
                let text = text.or_else(|| panic.downcast_ref::<String>().map(String::as_str));
                // Nobody may be listening any more; then nobody needs to know.
                let _ = last_words.send(SaverReport::Broken { message: text.unwrap_or("no reason").to_owned() });
                last_wake();
            }
        };
        let thread = std::thread::Builder::new().name("saver".to_owned()).spawn(run)?;
        Ok(Self { orders, reports, waiting: None, waiting_save: None, thread: Some(thread) })
    }

    /// Hands over an edit that led to a revision; never waits.
    pub fn edit(&mut self, edit: Edit, revision: Revision) {
        match &mut self.waiting {
            Some((joined, last)) => {
                joined.join(edit);
                *last = revision;
            }
            None => self.waiting = Some((edit, revision)),
        }
        self.send_waiting();
    }

    /// Asks for the document to be written now; never waits.
    pub fn save(&mut self) {
        self.waiting_save = Some(Save::Careful);
        self.send_waiting();
    }

    /// Asks for the document to be written although another program changed the file; that version is set aside.
    pub fn save_over(&mut self) {
        self.waiting_save = Some(Save::Over);
        self.send_waiting();
    }

    /// What has been reported since the last call.
    pub fn reports(&mut self) -> Vec<SaverReport> {
        self.send_waiting();
        self.reports.try_iter().collect()
    }

    /// Writes what is left, ends the thread and returns its last reports. Waits for the disk.
    #[must_use]
    pub fn close(mut self) -> Vec<SaverReport> {
        self.finish();
        self.reports.try_iter().collect()
    }

    /// Sends what waits, in its order, as far as there is room.
    fn send_waiting(&mut self) {
        if let Some((edit, revision)) = self.waiting.take() {
            use TrySendError::{Disconnected, Full};
            let sent = self.orders.try_send(Order::Edit(edit, revision));
            if let Err(Full(Order::Edit(edit, revision)) | Disconnected(Order::Edit(edit, revision))) = sent {
                self.waiting = Some((edit, revision));
                return;
            }
        }
        if let Some(save) = self.waiting_save
            && self.orders.try_send(Order::Save(save)).is_ok()
        {
            self.waiting_save = None;
        }
    }

    fn finish(&mut self) {
        if let Some((edit, revision)) = self.waiting.take() {
            // A saver that broke down has said so; the document is still in the hands of the caller.
            let _ = self.orders.send(Order::Edit(edit, revision));
        }
        let _ = self.orders.send(Order::Close);
        if let Some(thread) = self.thread.take() {
            // A panic was reported by the thread itself.
            let _ = thread.join();
        }
    }
}

impl Drop for Saver {
    fn drop(&mut self) {
        self.finish();
    }
}

/// What the thread knows.
struct Work {
    store: Store,
    /// The document as journal and file hold it.
    journaled: Document,
    journaled_revision: Revision,
    latest: Document,
    latest_revision: Revision,
    /// What the last edit is called.
    name: String,
    /// Since when the document's file lacks edits.
    behind_since: Option<Instant>,
    /// The journal was refused last time, and the user has been told.
    journal_refused: bool,
    options: SaverOptions,
    reports: Sender<SaverReport>,
    wake: Wake,
}

impl Work {
    fn new(store: Store, document: Document, options: SaverOptions, reports: Sender<SaverReport>, wake: Wake) -> Self {
        Self {
            behind_since: store.is_behind().then(Instant::now),
            store,
            journaled: document.clone(),
            journaled_revision: 0,
            latest: document,
            latest_revision: 0,
            name: String::new(),
            journal_refused: false,
            options,
            reports,
            wake,
        }
    }

    fn run(mut self, orders: &Receiver<Order>) {
        loop {
            match orders.recv_timeout(self.patience()) {
                Ok(Order::Edit(edit, revision)) => self.take(edit, revision),
                Ok(Order::Save(save)) => {
                    self.journal();
                    self.save(save);
                }
                Ok(Order::Close) | Err(RecvTimeoutError::Disconnected) => break,
                Err(RecvTimeoutError::Timeout) => self.catch_up(),
            }
        }
        self.journal();
        if self.behind_since.is_some() {
            self.save(Save::Careful);
        }
    }

    /// How long there is nothing to do of its own accord.
    fn patience(&self) -> Duration {
        if self.journal_refused {
            return self.options.retry_after;
        }
        self.behind_since.map_or(Duration::MAX, |since| self.options.save_every.saturating_sub(since.elapsed()))
    }

    fn take(&mut self, edit: Edit, revision: Revision) {
        self.name.clone_from(&edit.name);
        if let Err(misfit) = edit.apply(&mut self.latest) {
            self.report(SaverReport::Broken { message: format!("an edit does not fit the document: {misfit}") });
            return;
        }
        self.latest_revision = revision;
        self.behind_since.get_or_insert_with(Instant::now);
        self.journal();
    }

    fn catch_up(&mut self) {
        self.journal();
        if self.behind_since.is_some_and(|since| since.elapsed() >= self.options.save_every) {
            self.save(Save::Careful);
        }
    }

    /// Appends to the journal what it lacks: one edit, or several as one after a refusal.
    fn journal(&mut self) {
        let edit = Edit::between(&self.journaled, &self.latest, &self.name);
        let appended = if edit.is_empty() { Ok(()) } else { self.store.journal(edit) };
        match appended {
            Ok(()) => {
                self.journal_refused = false;
                self.journaled = self.latest.clone();
                if self.journaled_revision < self.latest_revision {
                    self.journaled_revision = self.latest_revision;
                    self.report(SaverReport::Journaled { revision: self.journaled_revision, at: now() });
                }
            }
            Err(error) => {
                if !self.journal_refused {
                    self.report(SaverReport::Failed { revision: self.journaled_revision, error });
                }
                self.journal_refused = true;
            }
        }
    }

    fn save(&mut self, save: Save) {
        let saved = match save {
            Save::Careful => self.store.save(&self.latest).map(|()| None),
            Save::Over => self.store.save_over(&self.latest),
        };
        match saved {
            Ok(set_aside) => {
                self.journal_refused = false;
                self.behind_since = None;
                self.journaled = self.latest.clone();
                self.journaled_revision = self.latest_revision;
                self.report(SaverReport::Saved { revision: self.latest_revision, at: now(), set_aside });
            }
            Err(error) => {
                // Tried again after the usual time, not at once.
                self.behind_since = self.behind_since.map(|_| Instant::now());
                self.report(SaverReport::Failed { revision: self.journaled_revision, error });
            }
        }
    }

    fn report(&self, report: SaverReport) {
        // Nobody listens while the program closes.
        let _ = self.reports.send(report);
        (self.wake)();
    }
}

/// The local time, to the second.
fn now() -> jiff::civil::Time {
    let time = jiff::Zoned::now().time();
    time.with().subsec_nanosecond(0).build().unwrap_or(time)
}
