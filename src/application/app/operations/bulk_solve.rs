//! Changes that require many frames to be solved again, such as a new base. Each is one step of
//! undo. A change of few frames is made at once, one of many in the background.
//!
//! The user may edit the document while the background works. The result is therefore joined with
//! the document as it is at the end; if they no longer fit together, the work starts again.

use crate::app::operation::{Context, Failure, Operation, Slot};
use crate::app::operations::UnderWay;
use crate::app::window_state::session::Level;
use crate::app::{App, Command};
use std::sync::atomic::{AtomicUsize, Ordering};
use touchline_calibration::calibrate::{BulkChange, BulkError, BulkSolve, BulkSolved};
use touchline_core::geometry::thousands;
use touchline_core::progress::{Progress, Share};
use touchline_documents::document::Step;

/// From this number of frames on, a change is made in the background. A frame takes 0.1 ms.
const IN_BACKGROUND: usize = 200;

/// Computes a change.
#[derive(Debug)]
pub struct BulkSolving {
    work: BulkSolve,
    /// The resulting step of undo.
    step: Step,
    /// What to do in the application afterwards.
    then: AfterBulk,
}

/// What to do in the application after a change was made; given by the function that started the
/// change.
pub type AfterBulk = fn(&mut App, &BulkChange);

// ---- The work ----

impl Operation for BulkSolving {
    type Progress = Share;
    type Output = Box<BulkSolved>;
    type Error = BulkError;

    const NAME: &'static str = "solving";

    fn run(&self, context: &Context<'_, Share>) -> Result<Box<BulkSolved>, BulkError> {
        let furthest = AtomicUsize::new(0);
        let watched = Progress::new(|progress: Share| {
            // Several threads solve frames, so their counts may arrive out of order. Only increases
            // are reported.
            let is_further = furthest.fetch_max(progress.done, Ordering::Relaxed) < progress.done;
            if is_further {
                context.report(progress)
            } else {
                context.check()
            }
        });
        self.work.clone().run(&watched).map(Box::new)
    }

    fn slot(app: &mut App) -> &mut Slot<Self> {
        &mut app.operations.bulk_solve
    }

    fn must_wait(app: &App) -> bool {
        app.is_amid_step()
    }

    fn take_over(&self, app: &mut App, result: Result<Box<BulkSolved>, Failure<BulkError>>) {
        match result {
            Ok(solved) => {
                app.join_bulk(self.step.clone(), &solved, self.then);
            }
            Err(failure) => app.report_bulk_failed(&self.step, &failure),
        }
    }
}

// ---- In the application ----

impl App {
    /// Makes a change as one step of undo: at once, or in the background if it affects many frames.
    /// Calls `then` after the change was made. Returns false, with a message, if the change cannot
    /// be made now.
    pub(in crate::app) fn change_in_bulk(
        &mut self,
        step: Step,
        change: BulkChange,
        then: AfterBulk,
    ) -> bool {
        if let Some(running) = self.operations.bulk_solve.running() {
            let text = format!(
                "Not while another change is under way: {}",
                running.operation().step.name
            );
            self.session
                .notify_with(Level::Info, text, Some(("Stop", Command::StopSolving)));
            return false;
        }
        if self.refuses_changes() {
            return false;
        }
        self.commit_open_step();
        let Some(open) = &self.open else { return false };
        let work = BulkSolve {
            document: open.document.clone(),
            folder: open.folder.clone(),
            change,
        };
        // Many frames are solved in the background, few at once.
        if work.frames() >= IN_BACKGROUND {
            self.start(BulkSolving { work, step, then });
            return true;
        }
        match work.run(&Progress::default()) {
            Ok(solved) => self.join_bulk(step, &solved, then),
            Err(error) => {
                self.report_bulk_failed(&step, &Failure::Failed(error));
                false
            }
        }
    }

    /// Why there is nothing to stop. None if a change is being computed.
    pub(in crate::app) fn why_not_stop_bulk(&self) -> Option<&'static str> {
        (!self.operations.bulk_solve.is_running()).then_some("No frames are being solved again.")
    }

    /// Stops the change that is being computed. The document stays as it is.
    pub(in crate::app) fn stop_bulk(&mut self) {
        let slot = &mut self.operations.bulk_solve;
        let Some(name) = slot
            .running()
            .map(|running| running.operation().step.name.clone())
        else {
            return;
        };
        slot.cancel();
        self.session
            .note(format!("{name}: stopped, nothing was changed."));
    }

    /// Joins a computed change with the document as it is now, as one step of undo. If the document
    /// has changed too much for that, computes the change again in the background. Returns false if
    /// neither is possible.
    fn join_bulk(&mut self, step: Step, solved: &BulkSolved, then: AfterBulk) -> bool {
        let Some(open) = &self.open else { return false };
        let joined = match solved.join(&open.document) {
            Ok(Some(joined)) => joined,
            // The user changed something that the result depends on: compute it for the present
            // document.
            Ok(None) => {
                let change = solved.change_for(&open.document);
                let work = BulkSolve {
                    document: open.document.clone(),
                    folder: open.folder.clone(),
                    change,
                };
                self.start(BulkSolving { work, step, then });
                return true;
            }
            Err(error) => {
                self.report_bulk_failed(&step, &Failure::Failed(error));
                return false;
            }
        };
        if !self.begin_step(step) {
            return false;
        }
        if let Some(open) = &mut self.open {
            *open.document = joined.document;
        }
        // The frames fit the new base already, which `commit` would adjust them to.
        self.close_step();
        self.report_withdrawn(joined.withdrawn);
        then(self, solved.change());
        true
    }

    fn report_bulk_failed(&mut self, step: &Step, failure: &Failure<BulkError>) {
        if *failure != Failure::Failed(BulkError::Stopped) {
            self.session.notify(
                failure.level(),
                format!("{}: nothing was changed: {failure}.", step.name),
            );
        }
    }
}

// ---- Words ----

impl Slot<BulkSolving> {
    /// The running change with its progress, for the status row.
    pub(super) fn under_way(&self) -> Option<UnderWay> {
        let running = self.running()?;
        let progress = running.progress();
        let step = progress.map_or_else(String::new, |progress| {
            format!(
                "{} of {} frames solved again",
                thousands(progress.done),
                thousands(progress.of)
            )
        });
        let job = running.operation().step.name.clone();
        let share = progress.map(|progress| progress.fraction());
        Some(UnderWay::new(job, step, Command::StopSolving).with_share(share))
    }
}
