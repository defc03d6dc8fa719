//! The thread that journals edits and writes documents.
//!
//! Every edit is flushed to disk before it is acknowledged; the document itself is written from time to time, on request
//! and at closing. When the disk refuses, edits stay in memory, the refusal is reported, and the saver tries again. An edit
//! that does not fit what the saver knows makes it ask for the whole document.

use super::{Wake, panic_message};
use crate::document::{Document, Edit, History, SplitDocument};
use crate::store::{DocumentStore, Others, Outside, StoreError};
use std::collections::VecDeque;
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::path::PathBuf;
use std::sync::mpsc::{Receiver, RecvTimeoutError, SyncSender, TrySendError, sync_channel};
use std::thread::JoinHandle;
use std::time::{Duration, Instant};

/// How many orders may be on their way to the saver; further ones wait with its owner. So many edits are written at once.
const CAPACITY: usize = 64;

/// How many reports may wait before the saver waits for its owner.
const REPORTS: usize = 256;

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
    /// Others changed the document; it is not written until somebody decides what becomes of their version. Edits are
    /// still journaled.
    ChangedOutside {
        /// The document's file.
        path: PathBuf,
    },
    /// What others made of the document, as it was asked for.
    Outside(Box<Outside>),
    /// An edit does not fit the document that the saver knows: it has to be given the whole document.
    NeedsWhole,
    /// The saver broke down; nothing is saved any more.
    Broken {
        /// What it said last.
        message: String,
    },
}

/// A document as it is, and what can be undone and redone in it.
struct Whole {
    document: Document,
    history: History<Document>,
}

enum Order {
    Edit(Edit, Revision),
    /// The document as it is with its history, in place of whatever the saver knows.
    Whole(Box<Whole>, Revision),
    Save(Others),
    /// Report what others made of the document.
    ReadOutside,
}

/// The handle of a saver; dropping it writes what is left.
pub struct Saver {
    /// None once the saver is being closed.
    orders: Option<SyncSender<Order>>,
    reports: Receiver<SaverReport>,
    /// A document that found the channel full; it goes before the edits that wait.
    waiting_whole: Option<(Box<Whole>, Revision)>,
    /// Edits that found the channel full, oldest first.
    waiting: VecDeque<(Edit, Revision)>,
    /// Requests that found the channel full.
    waiting_save: Option<Others>,
    waiting_read: bool,
    thread: Option<JoinHandle<()>>,
}

impl Saver {
    /// Starts a saver for a document as it was opened, and the steps that can be undone and redone in it.
    ///
    /// # Errors
    /// The system starts no thread.
    pub fn start(
        store: impl DocumentStore + 'static,
        document: Document,
        history: History<Document>,
        options: SaverOptions,
        wake: Wake,
    ) -> std::io::Result<Self> {
        let (orders, inbox) = sync_channel(CAPACITY);
        let (outbox, reports) = sync_channel(REPORTS);
        let run = move || {
            let (last_words, last_wake) = (outbox.clone(), wake.clone());
            let work = Work::new(Box::new(store), Whole { document, history }, options, outbox, wake);
            if let Err(panic) = catch_unwind(AssertUnwindSafe(|| work.run(&inbox))) {
                // Nobody may be listening any more; then nobody needs to know.
                let _ = last_words.send(SaverReport::Broken { message: panic_message(panic.as_ref()) });
                last_wake();
            }
        };
        let thread = std::thread::Builder::new().name("saver".to_owned()).spawn(run)?;
        Ok(Self {
            orders: Some(orders),
            reports,
            waiting_whole: None,
            waiting: VecDeque::new(),
            waiting_save: None,
            waiting_read: false,
            thread: Some(thread),
        })
    }

    /// Hands over an edit that led to a revision; never waits.
    pub fn edit(&mut self, edit: Edit, revision: Revision) {
        self.waiting.push_back((edit, revision));
        self.send_waiting();
    }

    /// Hands over the document as it is at a revision, with its history, in place of whatever the saver knows; never waits.
    pub fn whole(&mut self, document: Document, history: History<Document>, revision: Revision) {
        self.waiting_whole = Some((Box::new(Whole { document, history }), revision));
        // The document holds them.
        self.waiting.clear();
        self.send_waiting();
    }

    /// Asks for the document to be written now; never waits.
    pub fn save(&mut self) {
        self.waiting_save = Some(Others::Stay);
        self.send_waiting();
    }

    /// Asks for the document to be written although another program changed the file; that version is set aside.
    pub fn save_over(&mut self) {
        self.waiting_save = Some(Others::SetAside);
        self.send_waiting();
    }

    /// Asks for what others made of the document; never waits.
    pub fn read_outside(&mut self) {
        self.waiting_read = true;
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
        self.finish()
    }

    /// Sends what waits, in its order, as far as there is room. A saver that broke down has said so, and the document is
    /// still in the hands of its owner.
    fn send_waiting(&mut self) {
        let Some(orders) = &self.orders else { return };
        if let Some((document, revision)) = self.waiting_whole.take()
            && let Err(TrySendError::Full(Order::Whole(document, revision))) =
                orders.try_send(Order::Whole(document, revision))
        {
            self.waiting_whole = Some((document, revision));
            return;
        }
        while let Some((edit, revision)) = self.waiting.pop_front() {
            if let Err(TrySendError::Full(Order::Edit(edit, revision))) = orders.try_send(Order::Edit(edit, revision)) {
                self.waiting.push_front((edit, revision));
                return;
            }
        }
        let is_full = |sent| matches!(sent, Err(TrySendError::Full(_)));
        self.waiting_save = self.waiting_save.filter(|others| is_full(orders.try_send(Order::Save(*others))));
        self.waiting_read = self.waiting_read && is_full(orders.try_send(Order::ReadOutside));
    }

    fn finish(&mut self) -> Vec<SaverReport> {
        let mut last = Vec::new();
        while self.waiting_whole.is_some() || !self.waiting.is_empty() {
            self.send_waiting();
            // The saver may wait for room for its reports.
            last.extend(self.reports.recv_timeout(Duration::from_millis(5)));
        }
        // Without orders to come the thread writes what is left and ends.
        self.orders = None;
        last.extend(self.reports.iter());
        if let Some(thread) = self.thread.take() {
            // A panic was reported by the thread itself.
            let _ = thread.join();
        }
        last
    }
}

impl Drop for Saver {
    fn drop(&mut self) {
        self.finish();
    }
}

/// What the thread knows.
struct Work {
    store: Box<dyn DocumentStore>,
    /// The document as journal and file hold it.
    journaled: Document,
    journaled_revision: Revision,
    latest: SplitDocument,
    /// What can be undone and redone in `latest`.
    history: History<Document>,
    latest_revision: Revision,
    /// The edits that lead from `journaled` to `latest`.
    to_journal: Vec<Edit>,
    /// An edit did not fit: nothing is known of the document until it is given as a whole.
    needs_whole: bool,
    /// Since when the document's file lacks edits.
    behind_since: Option<Instant>,
    /// The journal was refused last time, and the user has been told.
    journal_refused: bool,
    options: SaverOptions,
    reports: SyncSender<SaverReport>,
    wake: Wake,
}

impl Work {
    fn new(
        store: Box<dyn DocumentStore>,
        Whole { document, history }: Whole,
        options: SaverOptions,
        reports: SyncSender<SaverReport>,
        wake: Wake,
    ) -> Self {
        Self {
            behind_since: store.is_behind().then(Instant::now),
            store,
            journaled: document.clone(),
            journaled_revision: 0,
            latest: SplitDocument::of(document),
            history,
            latest_revision: 0,
            to_journal: Vec::new(),
            needs_whole: false,
            journal_refused: false,
            options,
            reports,
            wake,
        }
    }

    fn run(mut self, orders: &Receiver<Order>) {
        loop {
            match orders.recv_timeout(self.patience()) {
                Ok(order) => self.obey(order, orders),
                Err(RecvTimeoutError::Disconnected) => break,
                Err(RecvTimeoutError::Timeout) => self.catch_up(),
            }
        }
        self.journal();
        if self.behind_since.is_some() {
            self.save(Others::Stay);
        }
    }

    fn obey(&mut self, order: Order, orders: &Receiver<Order>) {
        match order {
            Order::Edit(edit, revision) => {
                self.take(edit, revision);
                // Those that came meanwhile are flushed to disk with it.
                let mut next = None;
                for order in orders.try_iter().take(CAPACITY) {
                    match order {
                        Order::Edit(edit, revision) => self.take(edit, revision),
                        other => {
                            next = Some(other);
                            break;
                        }
                    }
                }
                self.journal();
                if let Some(next) = next {
                    self.obey(next, orders);
                }
            }
            Order::Whole(whole, revision) => self.take_whole(*whole, revision),
            Order::Save(others) => {
                self.journal();
                self.save(others);
            }
            Order::ReadOutside => self.read_outside(),
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
        if self.needs_whole {
            // The document that was asked for holds it.
            return;
        }
        if let Err(misfit) = self.history.follow(&mut self.latest, edit.clone()) {
            log::warn!("{}: {misfit}; the whole document is asked for", edit.name);
            self.needs_whole = true;
            self.report(SaverReport::NeedsWhole);
            return;
        }
        self.to_journal.push(edit);
        self.latest_revision = revision;
        self.behind_since.get_or_insert_with(Instant::now);
    }

    fn take_whole(&mut self, Whole { document, history }: Whole, revision: Revision) {
        self.needs_whole = false;
        let edit = Edit::between(&self.journaled, &document, "Everything since");
        self.to_journal = if edit.is_empty() { Vec::new() } else { vec![edit] };
        (self.latest, self.history) = (SplitDocument::of(document), history);
        self.latest_revision = revision;
        self.behind_since.get_or_insert_with(Instant::now);
        self.journal();
        self.save(Others::Stay);
    }

    fn catch_up(&mut self) {
        self.journal();
        if self.behind_since.is_some_and(|since| since.elapsed() >= self.options.save_every) {
            self.save(Others::Stay);
        }
    }

    /// Appends to the journal what it lacks: one edit, or several after a refusal.
    fn journal(&mut self) {
        let appended = if self.to_journal.is_empty() { Ok(()) } else { self.store.append(&self.to_journal) };
        match appended {
            Ok(()) => {
                self.journal_refused = false;
                self.to_journal.clear();
                self.journaled = self.latest.shown().clone();
                if self.journaled_revision < self.latest_revision {
                    self.journaled_revision = self.latest_revision;
                    self.report(SaverReport::Journaled { revision: self.journaled_revision, at: now() });
                }
            }
            // Writing the document makes a journal anew that was deleted.
            Err(StoreError::Gone { .. })
                if self.store.keep(self.latest.shown(), &self.history, Others::Stay).is_ok() =>
            {
                self.saved(None);
            }
            Err(error) => {
                if !self.journal_refused {
                    self.report(SaverReport::Failed { revision: self.journaled_revision, error });
                }
                self.journal_refused = true;
            }
        }
    }

    fn save(&mut self, others: Others) {
        if self.needs_whole {
            self.report(SaverReport::NeedsWhole);
            return;
        }
        match self.store.keep(self.latest.shown(), &self.history, others) {
            Ok(set_aside) => self.saved(set_aside),
            Err(error) => {
                // Tried again after the usual time, not at once.
                self.behind_since = self.behind_since.map(|_| Instant::now());
                self.report(match error {
                    StoreError::ChangedOutside { path } => SaverReport::ChangedOutside { path },
                    error => SaverReport::Failed { revision: self.journaled_revision, error },
                });
            }
        }
    }

    fn saved(&mut self, set_aside: Option<PathBuf>) {
        self.journal_refused = false;
        self.behind_since = None;
        self.to_journal.clear();
        self.journaled = self.latest.shown().clone();
        self.journaled_revision = self.latest_revision;
        self.report(SaverReport::Saved { revision: self.latest_revision, at: now(), set_aside });
    }

    fn read_outside(&mut self) {
        match self.store.since() {
            Ok(Some(outside)) => self.report(SaverReport::Outside(Box::new(outside))),
            // It was changed back.
            Ok(None) => self.save(Others::Stay),
            Err(error) => self.report(SaverReport::Failed { revision: self.journaled_revision, error }),
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
