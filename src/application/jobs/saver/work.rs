//! The loop of the saver's thread.

use super::{Orders, Revision, SaverOptions, SaverReport};
use crate::app::Snapshot;
use crate::jobs::worker::{Mailbox, WaitOutcome};
use std::path::PathBuf;
use std::time::Instant;
use touchline_documents::document::Edit;
use touchline_documents::store::{Others, Store, StoreError};

/// The state of the saver's thread.
pub(super) struct Work<'a> {
    store: Store,
    /// The newest document.
    latest: Snapshot,
    /// The last edit on disk, in the journal or the document.
    journaled_revision: Revision,
    /// The edits from there to the newest document.
    to_journal: Vec<Edit>,
    /// The last request to write the document.
    save_request: u64,
    /// Since when the document's file lacks edits; `None` if it has all.
    behind_since: Option<Instant>,
    /// Whether the last append to the journal failed; the failure is reported once.
    journal_refused: bool,
    /// The document's file, if another program has changed it and the user had nothing of their own
    /// to keep beside it then.
    without_own: Option<PathBuf>,
    options: SaverOptions,
    mailbox: &'a Mailbox<Orders, SaverReport>,
}

impl<'a> Work<'a> {
    pub(super) fn new(
        store: Store,
        opened: Snapshot,
        options: SaverOptions,
        mailbox: &'a Mailbox<Orders, SaverReport>,
    ) -> Self {
        Self {
            behind_since: store.is_behind().then(Instant::now),
            store,
            journaled_revision: opened.revision,
            latest: opened,
            to_journal: Vec::new(),
            save_request: 0,
            journal_refused: false,
            without_own: None,
            options,
            mailbox,
        }
    }

    /// Works until the mailbox closes, then writes what is left.
    pub(super) fn run(mut self) {
        loop {
            match self.mailbox.wait_for(self.due(), Orders::take) {
                WaitOutcome::Order(orders) => self.obey(orders),
                WaitOutcome::TimeIsUp => self.catch_up(),
                WaitOutcome::Closing => break,
            }
        }
        self.journal();
        // Also write if another program has replaced the file: its version is then kept beside the
        // user's.
        if self.behind_since.is_some() || !matches!(self.store.since(), Ok(None)) {
            self.save(Others::Stay);
        }
    }

    /// Carries out orders: edits first, then writing, then reading.
    fn obey(
        &mut self,
        Orders {
            edits,
            save,
            save_request,
            read_outside,
        }: Orders,
    ) {
        if !edits.is_empty() {
            for (edit, to) in edits {
                self.take(edit, to);
            }
            self.journal();
            // The version that the journal starts from is on disk no more: the first edit after
            // another program's change keeps it.
            if let Some(path) = self.without_own.take() {
                self.keep_own(path);
            }
        }
        if let Some(others) = save {
            // `write` and `save_over` have the number 0, which must not replace a later one.
            self.save_request = self.save_request.max(save_request);
            // Journal before writing: if the document is refused, the edits are on disk anyway.
            self.journal();
            self.save(others);
        }
        if read_outside {
            self.read_outside();
        }
    }

    /// The time of the next attempt or write if no order arrives.
    fn due(&self) -> Option<Instant> {
        // A refusal comes first: until the journal accepts the edits, they are in memory only.
        if self.journal_refused {
            return Instant::now().checked_add(self.options.retry_after);
        }
        self.behind_since?.checked_add(self.options.save_every)
    }

    /// Takes in an edit and the document that it led to.
    fn take(&mut self, edit: Edit, to: Snapshot) {
        // Apply the edit to the document before it, as a reader of the journal will. A misfit
        // leaves that document unchanged.
        let fitting = match edit.clone().apply(&mut self.latest.document) {
            Ok(()) => edit,
            // An edit that does not apply would make the rest of the journal unreadable. Journal
            // the difference of the documents instead.
            Err(misfit) => {
                log::warn!("{}: {misfit}", edit.name);
                Edit::between(&self.latest.document, &to.document, &edit.name)
            }
        };
        self.to_journal.push(fitting);
        self.latest = to;
        self.behind_since.get_or_insert_with(Instant::now);
    }

    /// Tries the journal again, and writes the document if it is time.
    fn catch_up(&mut self) {
        self.journal();
        if self
            .behind_since
            .is_some_and(|since| since.elapsed() >= self.options.save_every)
        {
            self.save(Others::Stay);
        }
    }

    /// Appends the pending edits to the journal: one, or several after a refusal.
    fn journal(&mut self) {
        let appended = if self.to_journal.is_empty() {
            Ok(())
        } else {
            self.store.append(&self.to_journal)
        };
        match appended {
            Ok(()) => {
                self.journal_refused = false;
                self.to_journal.clear();
                // Without a new edit there is nothing to acknowledge.
                if self.journaled_revision < self.latest.revision {
                    self.journaled_revision = self.latest.revision;
                    self.report(SaverReport::Journaled {
                        revision: self.journaled_revision,
                        at: now(),
                    });
                }
            }
            // The journal was deleted. Writing the document also creates a new one.
            Err(StoreError::Gone { .. }) if self.keep(Others::Stay).is_ok() => {
                self.report_saved(None);
            }
            // The edits stay in `to_journal` for the next attempt. Further refusals, every two
            // seconds, would only repeat the message.
            Err(error) => {
                if !self.journal_refused {
                    self.report(SaverReport::Failed(error));
                }
                self.journal_refused = true;
            }
        }
    }

    /// Writes the newest document and its history.
    fn keep(&mut self, others: Others) -> Result<Option<PathBuf>, StoreError> {
        self.store
            .keep(&self.latest.document, &self.latest.history, others)
    }

    /// Writes the document and reports the outcome. If another program has changed it, the user's
    /// version is written beside it.
    fn save(&mut self, others: Others) {
        match self.keep(others) {
            Ok(set_aside) => self.report_saved(set_aside),
            Err(error) => {
                // Try again after the usual interval, not at once.
                self.behind_since = self.behind_since.map(|_| Instant::now());
                match error {
                    StoreError::ChangedOutside { path } => self.keep_own(path),
                    error => self.report(SaverReport::Failed(error)),
                }
            }
        }
    }

    /// Writes the user's version beside the one of another program, before the user decides between
    /// them.
    fn keep_own(&mut self, path: PathBuf) {
        let own = self
            .store
            .keep_own(&self.latest.document)
            .unwrap_or_else(|error| {
                self.report(SaverReport::Failed(error));
                None
            });
        self.without_own = own.is_none().then(|| path.clone());
        self.report(SaverReport::ChangedOutside { path, own });
    }

    /// Records and reports that the document was written.
    fn report_saved(&mut self, set_aside: Option<PathBuf>) {
        // The document contains all edits, also those that the journal refused.
        self.journal_refused = false;
        self.behind_since = None;
        self.without_own = None;
        self.to_journal.clear();
        self.journaled_revision = self.latest.revision;
        let (revision, request) = (self.journaled_revision, self.save_request);
        self.report(SaverReport::Saved {
            revision,
            at: now(),
            request,
            set_aside,
        });
    }

    fn read_outside(&mut self) {
        match self.store.since() {
            Ok(Some(outside)) => self.report(SaverReport::Outside(Box::new(outside))),
            // The file has been restored to what the saver wrote.
            Ok(None) => self.save(Others::Stay),
            Err(error) => self.report(SaverReport::Failed(error)),
        }
    }

    fn report(&self, report: SaverReport) {
        self.mailbox.report(report);
    }
}

/// The local time, to the second.
fn now() -> jiff::civil::Time {
    let time = jiff::Zoned::now().time();
    time.with().subsec_nanosecond(0).build().unwrap_or(time)
}
