//! The only place that changes state: an action in, effects out.

mod actions;
mod base;
mod cameras;
mod clicks;
mod commands;
mod document;
mod doubt;
mod frames;
mod gold;
mod guide;
mod leaving;
mod masks;
mod naming;
mod numbers;
mod outside;
mod playing;
mod proposals;
mod quality;
mod requests;
mod review;
mod settings;
mod shots;
mod sport;
mod tour;
mod trainer;
mod verdict;

pub use commands::MAX_SCALE;

use super::action::Action;
use super::current::{Current, FreshSolve};
use super::effect::{Effect, OrphanOrder};
use super::quality::Quality;
use super::review::Review;
use super::session::{Dialog, Level, Mode, Saving};
use super::{App, OpenProject, Settings};
use touchline_calibration::calibrate::{CalibrationError, record_outcome};
use touchline_core::solve::FrameSolution;
use touchline_documents::document::{Edit, EditKind, Frame, FrameStatus, Frames, Step};

impl App {
    /// An application with nothing open.
    #[must_use]
    pub fn new(settings: Settings) -> Self {
        Self {
            settings,
            ..Self::default()
        }
    }

    /// The same application, which writes down when people click again.
    #[must_use]
    pub fn with_clock(self, clock: fn() -> jiff::Timestamp) -> Self {
        Self {
            clock: Some(clock),
            ..self
        }
    }

    /// The document that is open.
    #[must_use]
    pub const fn open(&self) -> Option<&OpenProject> {
        self.open.as_ref()
    }

    /// The frame that is shown.
    #[must_use]
    pub fn frame(&self) -> Option<&Frame> {
        self.open.as_ref()?.frame(self.session.frame)
    }

    /// The shown frame, solved.
    #[must_use]
    pub const fn current(&self) -> &Current {
        &self.current
    }

    /// What waits to be looked at.
    #[must_use]
    pub const fn review(&self) -> &Review {
        &self.review
    }

    /// What the quality page shows; nothing while it is closed.
    #[must_use]
    pub const fn quality(&self) -> &Quality {
        &self.quality
    }

    /// Changes state; what the outside then has to do is returned in order.
    pub fn update(&mut self, action: Action) -> Vec<Effect> {
        let (readiness, revision) = (self.current.readiness, self.revision());
        self.tell_tour(&action);
        self.apply(action);
        self.take_over_what_waited();
        self.refresh_derived();
        if self.revision() != revision {
            self.tell_when_enough(readiness);
        }
        self.advance_tour();
        self.start_unasked();
        self.tell_trainer();
        self.read_templates();
        std::mem::take(&mut self.effects)
    }

    fn revision(&self) -> Option<u64> {
        self.open.as_ref().map(|open| open.revision)
    }

    /// Works out again what follows from the document and the session and has changed, in the order
    /// in which one rests on another.
    fn refresh_derived(&mut self) {
        let proposed = self.operations.proposed_base();
        self.current.refresh(
            self.open.as_mut(),
            &self.session,
            self.fresh.take(),
            proposed,
        );
        self.refresh_review();
        self.refresh_accept_sheet();
        self.quality.refresh(self.open.as_mut(), &self.session);
        self.refresh_gold();
    }

    fn apply(&mut self, action: Action) {
        if self.breaks_round(&action) {
            return;
        }
        match action {
            Action::Pointer(action) => self.point(action),
            Action::View(action) => self.show(action),
            Action::Navigate(action) => self.navigate(action),
            Action::Edit(action) => self.edit(action),
            Action::Settings(action) => self.set_setting(action),
            Action::Trainer(report) => self.take_from_trainer(report),
            Action::Disk(report) => self.take_from_disk(report),
            Action::PictureAwaited(awaited) => self.session.video.picture_awaited = awaited,
            Action::Command(command) => self.command(command),
            Action::Hold(command, down) => self.hold(command, down),
            Action::Report(report) => self.receive(report),
            Action::Transfer(action) => self.transfer(action),
            Action::Compare(with) => self.compare(with),
            Action::Answer(question, path) => self.answer(question, path),
            Action::Open(path) => self.open_path(path),
            Action::Opened(opened) => self.opened(*opened),
            Action::AskOutside => self.session.dialog = Some(Dialog::ChangedOutside),
            Action::ResolveOutside(choice) => self.resolve_outside(choice),
            Action::MergeOrphan(orphan) => self.effects.push(Effect::Orphan {
                file: orphan,
                order: OrphanOrder::Read,
            }),
            Action::SaveOrphan(orphan) => self.effects.push(Effect::Orphan {
                file: orphan,
                order: OrphanOrder::Save,
            }),
            Action::LeaveUnsaved => self.leave_unsaved(),
            Action::CloseRequested => self.close_requested(),
        }
    }

    /// Opens a step of undo on the shown frame; false (and said so) if nothing can be changed.
    pub(super) fn begin(&mut self, name: impl Into<String>) -> bool {
        self.begin_step(self.step_at(name, self.session.frame))
    }

    /// A step of undo on the frame at a position.
    pub(super) fn step_at(&self, name: impl Into<String>, position: usize) -> Step {
        let frame = self
            .open
            .as_ref()
            .and_then(|open| open.frame(position))
            .map(|frame| frame.id.clone());
        Step {
            name: name.into(),
            frame,
        }
    }

    pub(super) fn begin_step(&mut self, step: Step) -> bool {
        if self.refuses_changes() {
            return false;
        }
        self.commit_open_step();
        let Some(open) = &mut self.open else {
            return false;
        };
        open.begin(step);
        true
    }

    /// Whether nothing can be changed; says so.
    pub(in crate::app) fn refuses_changes(&mut self) -> bool {
        let Some(reason) = self.open.as_ref().and_then(|open| open.read_only.as_ref()) else {
            return false;
        };
        let text = format!("Nothing can be changed here: {reason}");
        self.session.notify(Level::Warning, text);
        true
    }

    /// Closes the step of undo; what changed goes into the journal.
    pub(super) fn commit(&mut self) {
        self.follow_base();
        self.close_step();
    }

    /// Commits the step that is open, if one is: what was begun does not go on across what comes
    /// next.
    pub(super) fn commit_open_step(&mut self) {
        if self
            .open
            .as_ref()
            .is_some_and(|open| open.history.is_open())
        {
            self.commit();
        }
    }

    /// [`Self::commit`] for a step in which the frames follow their cameras already.
    pub(super) fn close_step(&mut self) {
        let Some(open) = &mut self.open else { return };
        let name = open
            .history
            .open_step()
            .map(|step| step.name.clone())
            .unwrap_or_default();
        let kind = open.history.open_kind();
        open.commit();
        // Even where it is no step: one that was gone on with may have come back to where it began.
        self.journal(&name, kind);
    }

    /// Gives the open step of undo up, and whatever was begun.
    fn abort(&mut self) {
        if let Some(open) = &mut self.open {
            open.abort();
        }
        self.session.mode = Mode::Idle;
        self.clamp_selection();
    }

    /// Passes what changed since the last time to the journal, with its meaning for undo and redo.
    pub(in crate::app) fn journal(&mut self, name: &str, kind: EditKind) {
        let Some(open) = &mut self.open else { return };
        if let Some(edit) = open.take_edit(name, kind) {
            self.journal_edit(edit);
        }
    }

    /// Passes an edit to the journal that the open document has taken in.
    pub(in crate::app) fn journal_edit(&mut self, edit: Edit) {
        let Some(open) = &self.open else { return };
        self.effects.push(Effect::Journal {
            edit: Box::new(edit),
            to: Box::new(open.snapshot()),
        });
        if !matches!(self.session.disk.saving, Saving::Failed { .. }) {
            self.session.disk.saving = Saving::Pending;
        }
    }

    /// The shown frame, to change it within a step.
    pub(in crate::app) fn frame_mut(&mut self) -> Option<&mut Frame> {
        let index = self.session.frame;
        self.open
            .as_mut()?
            .document
            .frames
            .get_mut(index)
            .map(|frame| &mut **frame)
    }

    /// Solves the shown frame anew after its clicks changed, within a step.
    pub(in crate::app) fn clicks_changed(&mut self) {
        let index = self.session.frame;
        let Some(open) = &mut self.open else { return };
        let result = solve_in_place(open, index);
        if let Some(frame) = open.document.frames.get_mut(index)
            && !matches!(frame.status, FrameStatus::Rejected)
        {
            frame.status = frame.undecided();
        }
        self.fresh = result.map(|result| FreshSolve {
            frame: index,
            version: open.document.version(),
            result,
        });
    }

    fn refresh_review(&mut self) {
        // The list must not change during a drag.
        if self
            .open
            .as_ref()
            .is_none_or(|open| !open.history.is_open())
        {
            self.review.refresh(self.open.as_mut(), &self.session);
        }
    }

    /// Shows and selects the same frames as before, after frames came or went. Where the shown one
    /// went, its neighbour is shown.
    fn follow_frames(&mut self, before: &Frames) {
        let Some(open) = &self.open else { return };
        let now = &open.document.frames;
        let place_now = |place: usize| now.position_of(&before.get(place)?.id);
        let last = now.len().saturating_sub(1);
        self.session.frame =
            place_now(self.session.frame).unwrap_or_else(|| self.session.frame.min(last));
        self.session.frames_selected = self
            .session
            .frames_selected
            .iter()
            .copied()
            .filter_map(place_now)
            .collect();
    }

    fn clamp_selection(&mut self) {
        let clicks = self.frame().map_or(0, |frame| frame.clicks.len());
        self.session.points.selected = self
            .session
            .points
            .selected
            .filter(|selected| *selected < clicks);
    }
}

/// Writes what a frame's clicks say into the frame: see [`record_outcome`]. None where there is
/// nothing to solve with.
fn solve_in_place(
    open: &mut OpenProject,
    index: usize,
) -> Option<Result<FrameSolution, CalibrationError>> {
    let solved = open.solve(index)?;
    record_outcome(open.document.frames.get_mut(index)?, solved.as_ref());
    Some(solved)
}
