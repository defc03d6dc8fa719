//! How the runner opens, replaces and closes a document.
//!
//! A writable document has a saver and a trainer. The runner starts both when the document replaces
//! the one before, and ends both when the document is closed.

use super::Runner;
use super::task::{Kind, Outcome};
use crate::app::session::Level;
use crate::app::{Action, DiskReport, Opening, OrphanOrder, Snapshot, ViewAction};
use crate::jobs::drawn_match::fresh_demo;
use crate::jobs::opening::{Ready, open_anything};
use crate::jobs::queue_opening::{open_match, open_path, open_paths};
use crate::jobs::{JobError, Saver, SaverOptions, SaverReport, Trainer, TrainerOptions};
use std::path::{Path, PathBuf};
use touchline_core::progress::Progress;
use touchline_documents::store::{Orphan, put_orphan_away, read_orphan, save_orphan};

impl Runner {
    /// Starts opening a document; discards an earlier one that is still being opened.
    pub(super) fn open(&mut self, opening: Opening) {
        self.give_up(|kind| kind == Kind::Opening);
        self.ready = None;
        if matches!(opening, Opening::Again(_)) {
            // Close the document first, or opening it would find it locked. If writing fails, the
            // edits are in the journal, from which opening recovers them.
            let last = self.close();
            self.reports.extend(last);
        }
        let held = self.held.clone();
        self.begin("open", Kind::Opening, move |watch| {
            let progress =
                Progress::new(|text| watch.notify(Action::Disk(DiskReport::Progress(text))));
            let held = held.as_ref();
            let ready = match opening {
                Opening::Path(path) | Opening::Again(path) => open_path(&path, held, &progress),
                Opening::Paths(paths) => open_paths(&paths, held, &progress),
                Opening::Match(queued) => open_match(&queued, held, &progress),
                Opening::Demo => open_anything(&fresh_demo(&progress)?, held, &progress),
            };
            ready.map(|ready| Outcome::Opened(Box::new(ready)))
        });
    }

    /// Replaces the open document by one that has been opened.
    ///
    /// By now the application has taken in all reports about the document before, and its edits are
    /// with that document's saver. Later reports about it are discarded.
    pub(super) fn let_in(&mut self, ready: Ready) -> Vec<Action> {
        self.give_up(|kind| kind == Kind::Beside);
        // Write the document before first. Of its last reports only failures matter.
        let mut actions = self.close();
        actions.push(match self.start_saver(ready) {
            Ok(opened) => opened,
            Err(error) => Action::Disk(DiskReport::Failed(error.to_string())),
        });
        actions
    }

    /// Starts the saver and the trainer of a document; neither if it is read-only.
    fn start_saver(&mut self, ready: Ready) -> Result<Action, JobError> {
        if let Some(store) = ready.store {
            let opened = Snapshot {
                document: ready.opened.document().clone(),
                history: ready.opened.history.clone(),
                revision: 0,
            };
            let held = store.location().clone();
            let saver = Saver::start(store, opened, SaverOptions::default(), self.wake.clone());
            self.saver = Some(saver.map_err(|source| JobError::NoThread {
                what: "saving".to_owned(),
                source,
            })?);
            self.held = Some(held);
            self.start_trainer(ready.opened.file.clone());
        }
        Ok(Action::Opened(Box::new(ready.opened)))
    }

    /// Starts the trainer of a writable document. If that fails, everything but the forest works.
    fn start_trainer(&mut self, file: PathBuf) {
        if cfg!(not(feature = "opencv")) {
            return;
        }
        match Trainer::start(
            file,
            TrainerOptions::default(),
            self.pictures.clone(),
            self.wake.clone(),
        ) {
            Ok(trainer) => self.trainer = Some(trainer),
            Err(error) => {
                let text = format!("The system could not start a thread for the trainer: {error}");
                self.reports
                    .push(Action::View(ViewAction::Notify(Level::Warning, text)));
            }
        }
    }

    /// Ends the trainer, writes the open document and waits for the disk. Returns failures, and
    /// where the user's version of a conflicting document is.
    pub fn close(&mut self) -> Vec<Action> {
        self.trainer = None;
        self.held = None;
        let reports = self.saver.take().map(Saver::close).unwrap_or_default();
        reports
            .into_iter()
            .flat_map(actions_of)
            .filter_map(failure_at_close)
            .collect()
    }

    /// Starts reading, saving or renaming edits that were set aside beside the open document.
    pub(super) fn begin_with_orphan(&mut self, orphan: PathBuf, order: OrphanOrder) {
        let Some(location) = self.held.clone() else {
            return;
        };
        self.begin("edits set aside", Kind::Beside, move |_| {
            Ok(Outcome::Action(match order {
                OrphanOrder::Read => {
                    let edits = Box::new(read_orphan(&location, &orphan)?);
                    Action::Disk(DiskReport::OrphanRead { orphan, edits })
                }
                OrphanOrder::Save => Action::Disk(DiskReport::OrphanSaved {
                    document: save_orphan(&location, &orphan)?,
                }),
                OrphanOrder::PutAway => {
                    let renamed = put_orphan_away(&location, &orphan)?;
                    Action::Disk(DiskReport::OrphanPutAway { orphan, renamed })
                }
            }))
        });
    }
}

/// What the user still has to see of an action when the document is closed: failures, and where
/// the versions of a conflicting document are.
fn failure_at_close(action: Action) -> Option<Action> {
    match action {
        Action::Disk(DiskReport::SaveFailed(_)) | Action::View(_) => Some(action),
        // The document is closed, so that the user cannot choose between the versions any more.
        Action::Disk(DiskReport::ChangedOutside {
            path,
            own: Some(own),
        }) => Some(Action::View(ViewAction::Notify(
            Level::Warning,
            describe_kept_version(&path, &own),
        ))),
        _ => None,
    }
}

/// Translates a report of the saver for the application.
pub(super) fn actions_of(report: SaverReport) -> Vec<Action> {
    match report {
        SaverReport::Journaled { revision, at } => {
            vec![Action::Disk(DiskReport::Saved {
                revision,
                at: clock(at),
                document: None,
            })]
        }
        SaverReport::Saved {
            revision,
            at,
            request,
            set_aside,
        } => {
            let said = set_aside.map(|path| {
                let text = format!(
                    "Another program changed the document; its version is kept as {}.",
                    path.display()
                );
                Action::View(ViewAction::Notify(Level::Warning, text))
            });
            said.into_iter()
                .chain([Action::Disk(DiskReport::Saved {
                    revision,
                    at: clock(at),
                    document: Some(request),
                })])
                .collect()
        }
        SaverReport::Failed(error) => {
            vec![Action::Disk(DiskReport::SaveFailed(error.to_string()))]
        }
        SaverReport::ChangedOutside { path, own } => {
            vec![Action::Disk(DiskReport::ChangedOutside { path, own })]
        }
        SaverReport::Outside(outside) => vec![Action::Disk(DiskReport::Outside(outside))],
        SaverReport::Broken { message } => {
            vec![Action::Disk(DiskReport::SaveFailed(format!(
                "saving failed: {message}"
            )))]
        }
    }
}

/// The message for a document that is closed after another program has changed it.
fn describe_kept_version(path: &Path, own: &Orphan) -> String {
    let (path, own) = (path.display(), own.path.display());
    format!("Another program changed {path}; your version is kept as {own}.")
}

/// The time of day as the window shows it: "12:03:41".
fn clock(at: jiff::civil::Time) -> String {
    format!("{:02}:{:02}:{:02}", at.hour(), at.minute(), at.second())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::app::Effect;
    use crate::jobs::runner::tests::Bench;
    use std::sync::mpsc::channel;
    use touchline_documents::store::Location;
    use touchline_documents::testing::{WithFrames, soccer_document};

    /// A folder with a document of `frames` frames.
    fn project(frames: usize) -> tempfile::TempDir {
        let folder = tempfile::tempdir().unwrap();
        let names = (0..frames).map(|index| index.to_string());
        let document = soccer_document().with_pictures(names, SIZE);
        let location = Location::for_new_document(&folder.path().join("project.json")).unwrap();
        touchline_documents::store::write_document(&location, &document, false).unwrap();
        folder
    }

    const SIZE: touchline_core::geometry::ImageSize =
        touchline_core::geometry::ImageSize::new(64, 48);

    #[test]
    fn what_was_reported_before_a_document_opened_still_concerns_the_one_before() {
        let mut bench = Bench::new();
        let folder = project(1);
        bench
            .runner
            .carry_out(Effect::Open(Opening::Path(folder.path().to_path_buf())));
        bench.runner.begin("word", Kind::Other, |_| {
            Ok(Outcome::Action(Action::View(ViewAction::Notify(
                Level::Info,
                "a word".to_owned(),
            ))))
        });
        let mut batches = Vec::new();
        while bench.runner.is_busy() {
            bench.woken.recv().unwrap();
            batches.push(bench.runner.poll());
        }
        let opened = |batch: &Vec<Action>| {
            batch
                .iter()
                .any(|action| matches!(action, Action::Opened(_)))
        };
        let last = batches.iter().position(opened).unwrap();
        assert_eq!(batches[last].len(), 1, "nothing is reported along with it");
        assert!(
            batches[..last]
                .iter()
                .chain(&batches[last + 1..])
                .flatten()
                .count()
                > 0,
            "the word is not lost"
        );
    }

    #[test]
    fn where_another_programs_version_is_kept_is_said_also_at_the_close() {
        let reports = [None, Some(PathBuf::from("project.json.outside-1"))].map(|set_aside| {
            actions_of(SaverReport::Saved {
                revision: 1,
                at: jiff::civil::Time::midnight(),
                request: 1,
                set_aside,
            })
        });
        let said = reports.map(|actions| actions.into_iter().filter_map(failure_at_close).count());
        assert_eq!(said, [0, 1]);
    }

    #[test]
    fn only_the_document_that_is_requested_last_opens() {
        let mut bench = Bench::new();
        let (first, last) = (project(1), project(2));
        bench
            .runner
            .carry_out(Effect::Open(Opening::Path(first.path().to_path_buf())));
        bench
            .runner
            .carry_out(Effect::Open(Opening::Path(last.path().to_path_buf())));
        bench.wait();
        assert_eq!(bench.app.open().unwrap().document.frames.len(), 2);
        assert!(
            !first.path().join("project.json.lock").exists(),
            "the other one is let go of"
        );
    }

    #[test]
    fn what_was_read_for_another_document_is_passed_over() {
        let mut bench = Bench::new();
        let folder = project(1);
        let (go_on, wait) = channel();
        bench.runner.begin("read", Kind::Beside, move |_| {
            let _: Result<(), _> = wait.recv();
            Ok(Outcome::Action(Action::View(ViewAction::Notify(
                Level::Info,
                "of another document".to_owned(),
            ))))
        });
        bench
            .runner
            .carry_out(Effect::Open(Opening::Path(folder.path().to_path_buf())));
        while bench
            .app
            .open()
            .is_none_or(|open| open.document.frames.is_empty())
        {
            bench.woken.recv().unwrap();
            for action in bench.runner.poll() {
                bench.app.update(action);
            }
        }
        go_on.send(()).unwrap();
        bench.wait();
        assert!(
            bench
                .app
                .session
                .messages
                .notices
                .iter()
                .all(|notice| notice.text != "of another document")
        );
    }
}
