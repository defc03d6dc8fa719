//! [`App::update`], the only function that changes state: it takes an action and returns effects.
//!
//! # Order
//!
//! 1. The action itself: `actions.rs` and `commands.rs` dispatch it to the file of its subject,
//!    which lies here or in one of the rooms `clicking`, `documents`, `reviewing`.
//! 2. Results of operations that waited for the end of the user's change (`actions.rs`).
//! 3. The derived values, from those that others depend on to those that depend on them.
//! 4. What follows from the new state: the next step of the tour, operations that start without a
//!    command, orders to the trainer, templates that must be read.
//!
//! # Steps of undo
//!
//! A change of the document is a step of undo: [`App::begin`], the change, [`App::commit`]. While a
//! step is open, as during a drag, derived values follow the document but nothing is journalled;
//! `commit` makes one edit of it for the journal, and [`App::abort`] restores the document.
//! Suggestions of the program are edits for the journal, too, but no steps.

mod actions;
mod clicking;
mod commands;
mod documents;
mod playing;
mod reviewing;
mod tour;
mod trainer;

pub use commands::MAX_SCALE;

use super::action::Action;
use super::effect::{Effect, OrphanOrder};
use super::quality::Quality;
use super::review::Review;
use super::{App, Command, OpenProject, Settings};
use crate::app::panel_values::current::{Current, FreshSolve};
use crate::app::window_state::session::{Dialog, Mode, Saving};
use touchline_calibration::calibrate::{CalibrationError, record_outcome};
use touchline_core::solve::FrameSolution;
use touchline_documents::document::{Edit, EditKind, Frame, FrameStatus, Frames, Step};

impl App {
    /// An application without a document.
    pub fn new(settings: Settings) -> Self {
        Self {
            settings,
            ..Self::default()
        }
    }

    /// The same application with a clock: repeated clicks are stored with their time.
    #[must_use]
    pub fn with_clock(self, clock: fn() -> jiff::Timestamp) -> Self {
        Self {
            clock: Some(clock),
            ..self
        }
    }

    /// The open document.
    pub const fn open(&self) -> Option<&OpenProject> {
        self.open.as_ref()
    }

    /// The shown frame.
    pub fn frame(&self) -> Option<&Frame> {
        self.open.as_ref()?.frame(self.session.frame)
    }

    /// The values derived from the shown frame, such as its camera.
    pub const fn current(&self) -> &Current {
        &self.current
    }

    /// The suggestions that wait for review.
    pub const fn review(&self) -> &Review {
        &self.review
    }

    /// The values on the quality page; empty while it is closed.
    pub const fn quality(&self) -> &Quality {
        &self.quality
    }

    /// Carries out an action. Returns the effects in the order in which the shell must carry them
    /// out.
    pub fn update(&mut self, action: Action) -> Vec<Effect> {
        self.notify_tour(&action);
        // The action itself, then what waited for its end.
        self.apply(action);
        self.deliver_waiting_reports();
        // Derived values. Whatever follows reads them.
        self.refresh_derived();
        // What follows from the changed document: the tour's next step, background work, the
        // trainer, templates that are still to be read.
        self.advance_tour();
        self.start_after_change();
        self.notify_trainer();
        self.read_templates();
        std::mem::take(&mut self.effects)
    }

    /// Recomputes the derived values that are out of date. The order matters: later ones depend on
    /// earlier ones.
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
        let has_curves = self.settings.curves;
        self.quality
            .refresh(self.open.as_mut(), &self.session, has_curves);
        self.refresh_gold();
        self.refresh_queue();
    }

    /// Carries out an action itself, without what follows from it. A blind round refuses actions
    /// that would break it.
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
            Action::OpenAny(paths) => self.open_any(paths),
            Action::OpenMatch(at) => self.open_match(at),
            Action::Opened(opened) => self.show_document(*opened),
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

    /// Opens a step of undo on the shown frame. Returns false, with a message, if the document is
    /// read-only.
    pub(super) fn begin(&mut self, name: impl Into<String>) -> bool {
        self.begin_step(self.step_at(name, self.session.frame))
    }

    /// A step of undo that names the frame at `position`, so that undo can show it.
    pub(super) fn step_at(&self, name: impl Into<String>, position: usize) -> Step {
        let frame = self
            .open
            .as_ref()
            .and_then(|open| open.frame(position))
            .map(|frame| frame.id.clone());
        Step {
            frame,
            ..Step::on_document(name)
        }
    }

    /// Opens a step of undo and commits the one before. Returns false if the document is read-only
    /// (with a message) or none is open.
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

    /// Whether the document is read-only; shows a message if so.
    pub(in crate::app) fn refuses_changes(&mut self) -> bool {
        let Some(reason) = self.open.as_ref().and_then(|open| open.read_only.as_ref()) else {
            return false;
        };
        let text = format!("Read-only: this project is {reason}.");
        self.session.warn(text);
        true
    }

    /// Commits the open step: updates what depends on changed bases and writes the change to the
    /// journal.
    pub(super) fn commit(&mut self) {
        self.follow_base();
        self.close_step();
    }

    /// Commits the open step, if any, because the next action must not become a part of it. A drag
    /// or a series of edits ends with its step: what follows of it would belong to no step.
    pub(super) fn commit_open_step(&mut self) {
        if self.is_amid_step() {
            if let Mode::Dragging { .. } | Mode::Editing = self.session.mode {
                self.session.mode = Mode::Idle;
                self.session.points.grabbed = None;
            }
            self.commit_edits();
        }
    }

    /// [`Self::commit`] for a step after which the frames match their cameras already.
    pub(super) fn close_step(&mut self) {
        let Some(open) = &mut self.open else { return };
        let name = open
            .history
            .open_step()
            .map(|step| step.name.clone())
            .unwrap_or_default();
        let kind = open.history.open_kind();
        open.commit();
        // Even an empty step is journalled: a resumed step may have returned to its initial state.
        self.journal(&name, kind);
    }

    /// Aborts the open step of undo and ends the mode.
    fn abort(&mut self) {
        if let Some(open) = &mut self.open {
            open.abort();
        }
        self.session.mode = Mode::Idle;
        self.session.points.grabbed = None;
        self.clamp_selection();
    }

    /// Writes what changed since the last edit to the journal. `kind` says what undo and redo make
    /// of it.
    pub(in crate::app) fn journal(&mut self, name: &str, kind: EditKind) {
        let Some(open) = &mut self.open else { return };
        if let Some(edit) = open.take_edit(name, kind) {
            self.journal_edit(edit);
        }
    }

    /// Writes an edit to the journal that the open document contains already.
    pub(in crate::app) fn journal_edit(&mut self, edit: Edit) {
        let Some(open) = &self.open else { return };
        // The saver gets the document with each edit: it writes that, and can check that the edit
        // leads to it. A failure stays displayed until a write succeeds.
        self.effects.push(Effect::Journal {
            edit: Box::new(edit),
            to: Box::new(open.snapshot()),
        });
        if !matches!(self.session.disk.saving, Saving::Failed { .. }) {
            self.session.disk.saving = Saving::Pending;
        }
    }

    /// The shown frame, to be changed within an open step.
    pub(in crate::app) fn frame_mut(&mut self) -> Option<&mut Frame> {
        self.frame_mut_at(self.session.frame)
    }

    /// The frame at a position, to be changed within an open step.
    pub(in crate::app) fn frame_mut_at(&mut self, position: usize) -> Option<&mut Frame> {
        self.open
            .as_mut()?
            .document
            .frames
            .get_mut(position)
            .map(|frame| &mut **frame)
    }

    /// Solves the shown frame again after its clicks changed, within an open step.
    pub(in crate::app) fn clicks_changed(&mut self) {
        let index = self.session.frame;
        // A question whether to accept was about the camera before.
        self.session.retract(Command::AcceptAnyway);
        let Some(open) = &mut self.open else { return };
        let result = solve_in_place(open, index);
        // An accepted frame must be accepted again after a change of its clicks.
        if let Some(frame) = open.document.frames.get_mut(index)
            && !matches!(frame.status, FrameStatus::Rejected)
        {
            frame.status = frame.undecided_status();
        }
        // Kept, so that the derived values need not solve the frame a second time.
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

    /// After frames were added or removed: shows and selects the same frames as before, by their
    /// ids. If the shown frame was removed, its neighbour is shown. An estimate is forgotten if any
    /// frame was moved, because its tables name frames by their positions.
    pub(in crate::app) fn follow_frames(&mut self, before: &Frames) {
        let Some(open) = &self.open else { return };
        // Selected frames that are gone leave the selection.
        let now = &open.document.frames;
        let place_now = |place: usize| now.position_of(&before.get(place)?.id);
        let last = now.len().saturating_sub(1);
        let [ids, former_ids] = [now, before].map(|frames| frames.iter().map(|frame| &frame.id));
        let are_frames_moved = !ids.eq(former_ids);
        self.session.frame =
            place_now(self.session.frame).unwrap_or_else(|| self.session.frame.min(last));
        self.session.frames_selected = self
            .session
            .frames_selected
            .iter()
            .copied()
            .filter_map(place_now)
            .collect();
        if are_frames_moved {
            self.forget_estimate();
        }
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

/// Solves a frame from its clicks and writes the result into it; see [`record_outcome`]. None if
/// there is nothing to solve with.
fn solve_in_place(
    open: &mut OpenProject,
    index: usize,
) -> Option<Result<FrameSolution, CalibrationError>> {
    let solved = open.solve(index)?;
    record_outcome(open.document.frames.get_mut(index)?, solved.as_ref());
    Some(solved)
}
