//! Moves between frames, and accepts, rejects or comments them.

use crate::app::panel_values::progress::just_accepted;
use crate::app::window_state::choices::Scope;
use crate::app::window_state::session::Mode;
use crate::app::{App, Command};
use touchline_documents::document::{Frame, FrameStatus, RejectReason};

impl App {
    /// Shows a frame; an index beyond the last means the last. Commits the open step and ends the
    /// mode.
    pub(in crate::app) fn go_to(&mut self, frame: usize) {
        let count = self
            .open
            .as_ref()
            .map_or(0, |open| open.document.frames.len());
        let frame = frame.min(count.saturating_sub(1));
        if frame == self.session.frame {
            return;
        }
        self.commit_open_step();
        // What is played from here on begins here.
        if self.session.video.playing {
            self.session.video.played = None;
        }
        self.session.frame = frame;
        self.session.points.selected = None;
        self.session.points.hover = None;
        self.session.forget_placed();
        self.session.mode = Mode::Idle;
        self.session.retract(Command::AcceptAnyway);
        self.session.doubted = None;
    }

    /// Shows the frame `by` frames later, or earlier if negative.
    pub(in crate::app::update) fn step_frame(&mut self, by: isize) {
        self.go_to(self.session.frame.saturating_add_signed(by));
    }

    /// Shows the next frame in a direction for which `wanted` is true. Continues from the other
    /// end; shows the message `none` if there is no such frame.
    pub(in crate::app::update) fn go_to_next(
        &mut self,
        forward: bool,
        wanted: impl Fn(&Frame) -> bool,
        none: &str,
    ) {
        let Some(open) = &self.open else { return };
        let (here, end) = (self.session.frame, open.document.frames.len());
        // The shown frame itself does not count: then the message says that there is no other.
        let next = open.find(here, forward, &wanted).or_else(|| {
            // From the other end of the document back to the shown frame.
            if forward {
                (0..here).find(|index| open.frame(*index).is_some_and(&wanted))
            } else {
                open.find(end, false, &wanted).filter(|frame| *frame > here)
            }
        });
        match next {
            Some(frame) => self.go_to(frame),
            None => self.session.note(none),
        }
    }

    /// Why the shown frame cannot be accepted, and a remedy. None if it can.
    pub fn unacceptable(&self) -> Option<String> {
        let frame = self.frame()?;
        if self.session.video.picture_awaited {
            return Some(
                "The picture of this frame is still loading. Accept it once you have seen it."
                    .to_owned(),
            );
        }
        if self.decides_about_base() {
            return Some("An estimated base is shown. Use it or discard it first.".to_owned());
        }
        if let Some(unnamed) = frame.unnamed_click() {
            return Some(format!(
                "Point {} has no name. Name it (C) or delete it (Del), then accept.",
                unnamed + 1
            ));
        }
        if frame.ptz.is_some() || self.current.click_solution().is_some() {
            return None;
        }
        Some(match &self.current.solution {
            Some(Err(error)) => format!("Nothing to accept: {error}."),
            _ => "Nothing to accept yet. Click two points first, or reject the frame with X."
                .to_owned(),
        })
    }

    /// Accepts the shown frame as a reference; one step of undo. Goes to the next frame to do
    /// unless `stay`. Asks first if the frame looks wrong.
    pub(in crate::app::update) fn accept(&mut self, stay: bool) {
        if let Some(reason) = self.unacceptable() {
            self.session.note(reason);
            self.session.points.selected = self
                .frame()
                .and_then(Frame::unnamed_click)
                .or(self.session.points.selected);
            return;
        }
        if self.asks_about_doubt(stay) {
            return;
        }
        self.session.retract(Command::AcceptAnyway);
        self.session.doubted = None;
        // The next row must be found now, because the accepted frame will leave the list.
        let listed = self.next_in_list(true);
        // Write the solution, the status and the line check into the frame.
        if self.begin("Accept") {
            let solved = self.current.click_solution().cloned();
            if let Some(frame) = self.frame_mut() {
                // A frame with a camera keeps it: it may be aligned to paint, or set by hand.
                if let (None, Some(solved)) = (&frame.ptz, &solved) {
                    frame.record(solved);
                }
                frame.status = FrameStatus::Reference;
                frame.reason = None;
            }
            self.record_paint_of(self.session.frame);
            self.accept_before_check(self.session.frame);
            self.commit();
            // What follows from the acceptance: a clip that was tracked before follows the
            // correction, and the message says how much is left.
            self.carry_correction();
            self.refresh_review();
            let used_for_training = self.frame().is_some_and(Frame::is_used_for_training);
            if let Some(open) = &mut self.open {
                let counts = open.derived.counts(&open.document);
                let text = just_accepted(counts, used_for_training);
                self.session.note(text);
            }
            match listed.filter(|_| !stay) {
                Some(frame) => self.go_to(frame),
                None if !stay => self.go_to_next_that_needs_me(true),
                None => {}
            }
        }
    }

    /// Asks for the reason of a rejection. On a rejected frame, removes the mark instead.
    pub(in crate::app::update) fn ask_reject(&mut self, whole_shot: bool) {
        let Some(frame) = self.frame() else { return };
        if frame.status == FrameStatus::Rejected && !whole_shot {
            if self.begin("Remove the mark") {
                if let Some(frame) = self.frame_mut() {
                    frame.status = frame.undecided_status();
                    frame.reason = None;
                }
                self.commit();
            }
            return;
        }
        if whole_shot && frame.clip.is_none() {
            self.session
                .note("This frame is not in a shot. X marks it alone.");
            return;
        }
        self.session.mode = Mode::Rejecting { whole_shot };
    }

    /// Rejects the shown frame or its shot for a reason; one step of undo. Then goes to the next
    /// frame to do.
    pub(in crate::app::update) fn reject_as(&mut self, reason: RejectReason) {
        let whole_shot = matches!(self.session.mode, Mode::Rejecting { whole_shot: true });
        self.session.mode = Mode::Idle;
        // The next row must be found before the frame leaves the list.
        let listed = self.next_in_list(true).filter(|_| !whole_shot);
        let Some(open) = &self.open else { return };
        let (scope, step) = if whole_shot {
            (Scope::Shot, "Mark shot as not calibratable")
        } else {
            (Scope::Frame, "Mark as not calibratable")
        };
        let frames = scope.frames(open, &self.session);
        let step = self.step_at(step, self.session.frame);
        if !self.reject_frames(step, frames, reason) {
            return;
        }
        match listed {
            Some(frame) => self.go_to(frame),
            None => self.go_to_next_that_needs_me(true),
        }
    }

    /// Sets the comment of the shown frame; an empty one removes it.
    pub(in crate::app::update) fn set_comment(&mut self, comment: &str) {
        self.session.dialog = None;
        if self.begin("Comment") {
            if let Some(frame) = self.frame_mut() {
                frame.comment =
                    Some(comment.trim().to_owned()).filter(|comment| !comment.is_empty());
            }
            self.commit();
        }
    }
}
