//! Changes after which many frames are solved again: few at once, many in the background, each one step of undo.

use super::App;
use crate::app::Command;
use crate::app::base::BaseWork;
use crate::app::bulk::{BulkFailure, BulkOrder, BulkWork, IN_BACKGROUND};
use crate::app::effect::Effect;
use crate::app::session::Level;
use std::ops::ControlFlow;
use std::sync::Arc;
use touchline_calibration::calibrate::{BulkChange, BulkError, BulkProgress, BulkSolve, BulkSolved};
use touchline_documents::document::Step;

impl App {
    /// Makes a change as one step of undo: at once, or in the background where it concerns many frames. False, and told, where it
    /// cannot be made now.
    pub(in crate::app) fn change_in_bulk(&mut self, step: Step, change: BulkChange) -> bool {
        if let Some(work) = &self.session.bulk {
            let text = format!("Not while another change is under way: {}", work.describe());
            self.session.notify_with(Level::Info, text, Some(("Stop", Command::StopSolving)));
            return false;
        }
        if self.refuses_changes() {
            return false;
        }
        self.commit_open_step();
        let Some(open) = &self.open else { return false };
        let work = BulkSolve { document: open.document.clone(), folder: open.folder.clone(), change };
        if work.frames() >= IN_BACKGROUND {
            self.begin_bulk(step, work);
            return true;
        }
        match work.run(&|_| ControlFlow::Continue(())) {
            Ok(solved) => self.join_bulk(step, &solved),
            Err(error) => {
                self.bulk_failed(&step, &error.into());
                false
            }
        }
    }

    fn begin_bulk(&mut self, step: Step, work: BulkSolve) {
        self.bulk_tickets += 1;
        let ticket = self.bulk_tickets;
        self.session.bulk = Some(BulkWork { ticket, step, progress: None, done: None });
        self.effects.push(Effect::SolveBulk(Box::new(BulkOrder { ticket, work })));
    }

    /// Stops the change that is being worked out; nothing has changed.
    pub(super) fn stop_bulk(&mut self) {
        if let Some(work) = self.session.bulk.take() {
            self.effects.push(Effect::CancelBulk);
            self.session.notify(Level::Info, format!("{}: stopped, nothing was changed.", work.step.name));
        }
    }

    pub(super) fn bulk_progress(&mut self, ticket: u64, progress: BulkProgress) {
        if let Some(work) = self.session.bulk.as_mut().filter(|work| work.ticket == ticket)
            && work.progress.is_none_or(|before| before.done < progress.done)
        {
            work.progress = Some(progress);
        }
    }

    pub(super) fn bulk_solved(&mut self, ticket: u64, solved: Result<Box<BulkSolved>, BulkFailure>) {
        let Some(mut work) = self.session.bulk.take_if(|work| work.ticket == ticket) else { return };
        match solved {
            Ok(solved) => {
                work.done = Some(solved);
                self.session.bulk = Some(work);
            }
            Err(failure) => self.bulk_failed(&work.step, &failure),
        }
    }

    /// Makes a change that has been worked out, once nothing else is under way: a drag is not cut in two.
    pub(super) fn finish_bulk(&mut self) {
        if self.open.as_ref().is_none_or(|open| open.history.is_open()) {
            return;
        }
        let Some(work) = self.session.bulk.take_if(|work| work.done.is_some()) else { return };
        if let Some(solved) = work.done {
            self.join_bulk(work.step, &solved);
        }
    }

    /// Joins a change with the document as it is now; where that has changed too much it is worked out again.
    fn join_bulk(&mut self, step: Step, solved: &BulkSolved) -> bool {
        let Some(open) = &self.open else { return false };
        let joined = match solved.join(&open.document) {
            Ok(Some(joined)) => joined,
            Ok(None) => {
                let change = solved.change_for(&open.document);
                let work = BulkSolve { document: open.document.clone(), folder: open.folder.clone(), change };
                self.begin_bulk(step, work);
                return true;
            }
            Err(error) => {
                self.bulk_failed(&step, &error.into());
                return false;
            }
        };
        if !self.begin_step(step) {
            return false;
        }
        if let Some(open) = &mut self.open {
            *open.document = joined.document;
        }
        self.close_step();
        self.tell_withdrawn(joined.withdrawn);
        self.bulk_made(solved.change());
        true
    }

    /// Tells of a change, and what follows from it in the window.
    fn bulk_made(&mut self, change: &BulkChange) {
        match change {
            BulkChange::Numbers(_) => {}
            BulkChange::Base(found) => {
                self.session.retract(Command::UseEstimatedBase);
                self.session.retract(Command::EstimateBase);
                self.session.base = BaseWork::Applied(Arc::clone(found));
                self.tell_assumed_size();
            }
            BulkChange::Unclicked(found) => self.tell_found_camera(found),
            BulkChange::Assign(given) => self.frames_assigned(given),
        }
    }

    fn bulk_failed(&mut self, step: &Step, failure: &BulkFailure) {
        let level = match failure {
            BulkFailure::Impossible(BulkError::Stopped) => return,
            BulkFailure::Impossible(_) => Level::Warning,
            BulkFailure::Panicked { .. } => Level::Error,
        };
        self.session.notify(level, format!("{}: nothing was changed: {failure}.", step.name));
    }
}
