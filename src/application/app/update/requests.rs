//! Starts operations and receives their reports.

use super::App;
use crate::app::effect::Effect;
use crate::app::operation::{Job, Operation, Report};
use crate::app::window_state::session::Mode;

impl App {
    /// Starts an operation. Cancels a running one of the same kind.
    pub(in crate::app) fn start<O: Operation>(&mut self, operation: O) {
        let (running, job) = Job::new(self.last_request.advance(), operation);
        O::slot(self).replace(running);
        self.effects.push(Effect::Start(job));
    }

    /// Applies a report, or keeps it for later if its operation must wait.
    pub(super) fn receive(&mut self, report: Report) {
        let waits = report.apply(self);
        self.waiting_reports.extend(waits);
    }

    /// Tries the kept reports again; those that still must wait are kept again.
    pub(in crate::app) fn deliver_waiting_reports(&mut self) {
        for report in std::mem::take(&mut self.waiting_reports) {
            self.receive(report);
        }
    }

    /// Whether a step of undo is open (as during a drag), or no document is.
    pub(in crate::app) fn is_amid_step(&self) -> bool {
        self.open.as_ref().is_none_or(|open| open.history.is_open())
    }

    /// Whether the user is in the middle of a change, or a change of many frames is being computed.
    /// Results that change the document wait for its end.
    pub(in crate::app) fn is_amid_change(&self) -> bool {
        self.session.mode != Mode::Idle
            || self.operations.bulk_solve.is_running()
            || self.is_amid_step()
    }
}

#[cfg(test)]
mod tests {
    use super::super::App;
    use crate::app::operation::probe::Probe;
    use crate::app::operation::{Breakdown, Failure, Job, Report, RequestId};
    use crate::app::{Action, Effect, Opened, Settings, ViewAction};
    use touchline_documents::testing::soccer_document;

    fn opened() -> Action {
        Action::Opened(Box::new(Opened::new(
            soccer_document(),
            "/match/project.json",
        )))
    }

    fn app() -> App {
        let mut app = App::new(Settings::default());
        app.update(opened());
        app
    }

    /// Starts a probe as a command would.
    fn start(app: &mut App) -> Job {
        let Effect::Start(job) = app.start_probe(Probe::from_steps([])) else {
            panic!("nothing was started")
        };
        job
    }

    fn end(id: RequestId, output: u32) -> Action {
        Action::Report(Report::from_result::<Probe>(id, Ok(output)))
    }

    #[test]
    fn a_request_is_followed_to_its_end_and_taken_over_once() {
        let mut app = app();
        let job = start(&mut app);
        app.update(Action::Report(Report::from_progress::<Probe>(job.id(), 40)));
        assert_eq!(
            app.operations.probe.slot.running().unwrap().progress(),
            Some(&40)
        );
        app.update(end(job.id(), 7));
        assert!(!app.operations.probe.slot.is_running());
        app.update(end(job.id(), 8));
        assert_eq!(
            app.operations.probe.taken,
            [Ok(7)],
            "the second report is of nothing"
        );
    }

    #[test]
    fn a_newer_request_of_the_kind_cancels_the_one_before() {
        let mut app = app();
        let (first, second) = (start(&mut app), start(&mut app));
        assert!(first.is_cancelled() && !second.is_cancelled() && first.id() < second.id());
        app.update(Action::Report(Report::from_progress::<Probe>(
            first.id(),
            40,
        )));
        app.update(end(first.id(), 1));
        assert!(app.operations.probe.taken.is_empty());
        assert_eq!(
            app.operations.probe.slot.running().unwrap().progress(),
            None,
            "of another request"
        );
        app.update(end(second.id(), 2));
        assert_eq!(app.operations.probe.taken, [Ok(2)]);
    }

    #[test]
    fn another_document_cancels_whatever_runs_and_numbers_go_on() {
        let mut app = app();
        let before = start(&mut app);
        app.update(opened());
        assert!(before.is_cancelled());
        let after = start(&mut app);
        assert!(before.id() < after.id());
        app.update(end(before.id(), 1));
        assert!(
            app.operations.probe.taken.is_empty(),
            "a late report of the document before"
        );
        drop(app);
        assert!(after.is_cancelled(), "its result is no longer needed");
    }

    #[test]
    fn a_result_waits_while_it_must_and_can_still_be_cancelled() {
        let mut app = app();
        let job = start(&mut app);
        app.operations.probe.must_wait = true;
        app.update(end(job.id(), 1));
        assert!(app.operations.probe.taken.is_empty() && app.operations.probe.slot.is_running());
        app.update(Action::View(ViewAction::SelectNoFrames));
        assert!(app.operations.probe.taken.is_empty());
        app.operations.probe.must_wait = false;
        app.update(Action::View(ViewAction::SelectNoFrames));
        assert_eq!(app.operations.probe.taken, [Ok(1)]);

        let job = start(&mut app);
        app.operations.probe.must_wait = true;
        app.update(end(job.id(), 2));
        assert!(app.operations.probe.slot.cancel());
        app.operations.probe.must_wait = false;
        app.update(Action::View(ViewAction::SelectNoFrames));
        assert_eq!(
            (app.operations.probe.taken.len(), app.waiting_reports.len()),
            (1, 0)
        );
    }

    #[test]
    fn a_failure_of_the_program_is_louder_than_one_of_the_work() {
        use crate::app::window_state::session::Level;
        let panicked: Failure<&str> = Failure::Broken(Breakdown::Panicked("a bug".to_owned()));
        assert_eq!(
            panicked.to_string(),
            "internal error (please report it): a bug"
        );
        assert_eq!(
            (panicked.level(), Failure::Failed("no paint").level()),
            (Level::Error, Level::Warning)
        );
        assert_eq!(Failure::Failed("no paint").to_string(), "no paint");
    }
}
