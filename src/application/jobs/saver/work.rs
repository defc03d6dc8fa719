//! What the thread of the saver does.

use super::{Orders, Revision, SaverOptions, SaverReport};
use crate::app::Snapshot;
use crate::jobs::worker::{Mailbox, Waited};
use std::path::PathBuf;
use std::time::Instant;
use touchline_documents::document::Edit;
use touchline_documents::store::{DocumentStore, Others, StoreError};

/// What the thread knows.
pub(super) struct Work<'a> {
    store: Box<dyn DocumentStore>,
    /// The document as it was given last.
    latest: Snapshot,
    /// The last edit that journal or file holds.
    journaled_revision: Revision,
    /// The edits that lead from there to the latest document.
    to_journal: Vec<Edit>,
    /// The last request to write the document.
    save_request: u64,
    /// Since when the document's file lacks edits.
    behind_since: Option<Instant>,
    /// The journal was refused last time, and the user has been told.
    journal_refused: bool,
    options: SaverOptions,
    mailbox: &'a Mailbox<Orders, SaverReport>,
}

impl<'a> Work<'a> {
    pub(super) fn new(
        store: Box<dyn DocumentStore>,
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
            options,
            mailbox,
        }
    }

    /// Works until it is closed, and then writes what is left.
    pub(super) fn run(mut self) {
        loop {
            match self.mailbox.wait_for(self.due(), Orders::take) {
                Waited::Order(orders) => self.obey(orders),
                Waited::TimeIsUp => self.catch_up(),
                Waited::Closing => break,
            }
        }
        self.journal();
        // Another program may have replaced what was read or written here, and nobody else would
        // keep what stood there.
        if self.behind_since.is_some() || !matches!(self.store.since(), Ok(None)) {
            self.save(Others::Stay);
        }
    }

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
        }
        if let Some(others) = save {
            self.save_request = self.save_request.max(save_request);
            self.journal();
            self.save(others);
        }
        if read_outside {
            self.read_outside();
        }
    }

    /// When there is something to do of its own accord.
    fn due(&self) -> Option<Instant> {
        if self.journal_refused {
            return Instant::now().checked_add(self.options.retry_after);
        }
        self.behind_since?.checked_add(self.options.save_every)
    }

    fn take(&mut self, edit: Edit, to: Snapshot) {
        let fitting = match edit.clone().apply(&mut self.latest.document) {
            Ok(()) => edit,
            // In the journal it would cut off what follows it; what leads to the document is known
            // all the same.
            Err(misfit) => {
                log::warn!("{}: {misfit}", edit.name);
                Edit::between(&self.latest.document, &to.document, &edit.name)
            }
        };
        self.to_journal.push(fitting);
        self.latest = to;
        self.behind_since.get_or_insert_with(Instant::now);
    }

    fn catch_up(&mut self) {
        self.journal();
        if self
            .behind_since
            .is_some_and(|since| since.elapsed() >= self.options.save_every)
        {
            self.save(Others::Stay);
        }
    }

    /// Appends to the journal what it lacks: one edit, or several after a refusal.
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
                if self.journaled_revision < self.latest.revision {
                    self.journaled_revision = self.latest.revision;
                    self.report(SaverReport::Journaled {
                        revision: self.journaled_revision,
                        at: now(),
                    });
                }
            }
            // Writing the document makes a journal anew that was deleted.
            Err(StoreError::Gone { .. }) if self.keep(Others::Stay).is_ok() => self.saved(None),
            Err(error) => {
                if !self.journal_refused {
                    self.report(SaverReport::Failed {
                        revision: self.journaled_revision,
                        error,
                    });
                }
                self.journal_refused = true;
            }
        }
    }

    fn keep(&mut self, others: Others) -> Result<Option<PathBuf>, StoreError> {
        self.store
            .keep(&self.latest.document, &self.latest.history, others)
    }

    fn save(&mut self, others: Others) {
        match self.keep(others) {
            Ok(set_aside) => self.saved(set_aside),
            Err(error) => {
                // Tried again after the usual time, not at once.
                self.behind_since = self.behind_since.map(|_| Instant::now());
                match error {
                    StoreError::ChangedOutside { path } => self.keep_own(path),
                    error => self.report(SaverReport::Failed {
                        revision: self.journaled_revision,
                        error,
                    }),
                }
            }
        }
    }

    /// Keeps what the window holds beside the version that another program wrote, before anybody
    /// decides between the two.
    fn keep_own(&mut self, path: PathBuf) {
        let own = self
            .store
            .keep_own(&self.latest.document)
            .unwrap_or_else(|error| {
                self.report(SaverReport::Failed {
                    revision: self.journaled_revision,
                    error,
                });
                None
            });
        self.report(SaverReport::ChangedOutside { path, own });
    }

    fn saved(&mut self, set_aside: Option<PathBuf>) {
        self.journal_refused = false;
        self.behind_since = None;
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
            // It was changed back.
            Ok(None) => self.save(Others::Stay),
            Err(error) => self.report(SaverReport::Failed {
                revision: self.journaled_revision,
                error,
            }),
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
