//! The painted lines: a frame snapped to them, cameras judged by them.

use super::App;
use crate::app::effect::Effect;
use crate::app::paint_orders::{SnapFailure, SnapOrder, SnappedFrame};
use crate::app::session::{Level, Mode, Snapping};
use touchline_calibration::calibrate::{record_found_by_paint, record_snapped};
use touchline_core::camera::PtzCamera;
use touchline_core::markings::LineVerdict;
use touchline_core::solve::{Judgement, Verdict};
use touchline_documents::document::{Frame, FrameStatus};

impl App {
    /// Why the shown frame cannot be snapped now; none if it can.
    pub(super) fn why_not_snap(&self) -> Option<&'static str> {
        self.why_no_paint_order().or_else(|| {
            self.current.camera.is_none().then_some("There is no camera to snap yet: click two points first.")
        })
    }

    /// Why the shown frame's camera cannot be searched by the painted lines now; none if it can.
    pub(super) fn why_not_search_lines(&self) -> Option<&'static str> {
        let frame = self.frame()?;
        let document = &self.open.as_ref()?.document;
        let base = document.camera_of(frame).and_then(|camera| camera.base_for(frame));
        self.why_no_paint_order()
            .or_else(|| self.current.camera.is_some().then_some("This frame has a camera: snap it."))
            .or_else(|| base.is_none().then_some("Its camera has no base yet."))
    }

    /// Why the painted lines of the shown frame cannot be looked for now.
    fn why_no_paint_order(&self) -> Option<&'static str> {
        let frame = self.frame()?;
        if self.open.as_ref().is_some_and(|open| open.read_only.is_some()) {
            return Some("The document is read-only.");
        }
        if frame.status == FrameStatus::Rejected {
            return Some("This frame is marked as not calibratable.");
        }
        self.session.snapping.is_some().then_some("The lines are being searched.")
    }

    /// Has the shown frame's camera pulled onto the painted lines, or found by them alone.
    pub(super) fn snap(&mut self, from_nothing: bool) {
        let Some(field) = self.current.field().cloned() else { return };
        self.commit_open_step();
        let Some(open) = &self.open else { return };
        let Some(frame) = open.document.frames.get(self.session.frame) else { return };
        self.session.snap_tickets += 1;
        let ticket = self.session.snap_tickets;
        self.session.snapping = Some(Snapping { ticket, frame: frame.clone(), from_nothing, progress: None });
        self.effects.push(Effect::Snap(Box::new(SnapOrder {
            ticket,
            document: (*open.document).clone(),
            folder: open.folder.clone(),
            frame: self.session.frame,
            field,
            from_nothing,
        })));
    }

    /// A search says how far it has come.
    pub(super) fn snap_progress(&mut self, ticket: u64, share: f64) {
        if let Some(snapping) = self.session.snapping.as_mut().filter(|snapping| snapping.ticket == ticket) {
            snapping.progress = Some(share);
        }
    }

    /// Stops the search of the painted lines; nothing has changed.
    pub(super) fn stop_search(&mut self) {
        if self.session.snapping.take_if(|snapping| snapping.from_nothing).is_some() {
            self.effects.push(Effect::CancelSnap);
            self.session.notify(Level::Info, "The search was stopped; nothing was changed.");
        }
    }

    /// Takes the report of a snap: one step of undo, or the reason why not.
    pub(super) fn snapped(&mut self, ticket: u64, result: Result<Box<SnappedFrame>, SnapFailure>) {
        let Some(asked) = self.session.snapping.take_if(|snapping| snapping.ticket == ticket) else { return };
        let found = match result {
            Ok(found) => found,
            Err(failure) => {
                let level = if matches!(failure, SnapFailure::Panicked { .. }) { Level::Error } else { Level::Warning };
                let what = if asked.from_nothing { "No camera found" } else { "Not snapped" };
                self.session.notify(level, format!("{what}: {failure}."));
                return;
            }
        };
        let position = self.open.as_ref().and_then(|open| {
            let position = open.document.frames.position_of(&asked.frame.id)?;
            open.document.frames[position].is_same(&asked.frame).then_some(position)
        });
        let Some(position) = position.filter(|_| self.session.mode == Mode::Idle) else {
            self.session.notify(Level::Info, "The frame changed in the meantime and was not snapped.");
            return;
        };
        let before = self.open.as_ref().and_then(|open| open.document.pointed(&asked.frame));
        let step = if asked.from_nothing { "Search the painted lines" } else { "Snap to the painted lines" };
        if !self.begin_step(self.step_at(step, position)) {
            return;
        }
        if let Some(frame) = self.open.as_mut().and_then(|open| open.document.frames.get_mut(position)) {
            let record = if asked.from_nothing { record_found_by_paint } else { record_snapped };
            record(frame, &found.base, &found.snapped);
            if asked.frame.shows_suggestion() && frame.status == FrameStatus::Suggested && !asked.from_nothing {
                // A suggestion is no step of undo, and what a person asked for is.
                frame.status = FrameStatus::Draft;
            }
        }
        self.commit();
        if let Some(before) = before {
            let text = describe_snap(&before, &found, &asked.frame);
            self.session.before_snap.insert(asked.frame.id.clone(), before);
            self.session.notify(Level::Info, text);
        } else if asked.from_nothing {
            let samples = found.snapped.samples;
            self.session.notify(
                Level::Info,
                format!("Found from {samples} points on painted lines. Check it before you accept."),
            );
        }
    }

    /// The shown frame's camera before it was snapped, where the frame is snapped and that is known.
    #[must_use]
    pub fn before_snap(&self) -> Option<&PtzCamera> {
        let frame = self.frame().filter(|frame| frame.is_snapped())?;
        self.session.before_snap.get(&frame.id)
    }

    /// Shows the camera before while the key is down; a frame that is not snapped is.
    pub(super) fn hold_snap(&mut self, down: bool) {
        if down && self.before_snap().is_none() {
            self.command(crate::app::Command::Snap);
        } else {
            self.session.held.before_snap = down;
        }
    }

    /// The verdict on the shown frame, the painted lines and its neighbours included: what these contradict is looked at first.
    #[must_use]
    pub fn judgement(&self) -> Option<Judgement> {
        let judgement = self.current.judgement.clone();
        if judgement.as_ref().is_some_and(|judgement| judgement.verdict != Verdict::Good) {
            return judgement;
        }
        let check = |reason| Judgement { verdict: Verdict::Check, reason };
        let says = self.paint_says(self.session.frame).filter(|says| says.verdict == LineVerdict::Contradicts);
        let of_paint = says.filter(|_| judgement.is_some()).map(|says| check(says.describe()));
        let is_reference = || self.frame().is_some_and(|frame| frame.status == FrameStatus::Reference);
        let of_neighbours = || {
            // A proposal tells of its neighbours itself.
            if judgement.is_none() && !is_reference() {
                return None;
            }
            let apart_px = self.current.off_neighbours?.apart_px;
            Some(check(format!("{apart_px:.0} px off the way between the frames before and after it")))
        };
        of_paint.or_else(of_neighbours).or(judgement)
    }
}

/// How far the picture's middle moved, and what it rests on.
fn describe_snap(before: &PtzCamera, found: &SnappedFrame, frame: &Frame) -> String {
    let snapped = &found.snapped;
    let after = PtzCamera::new(found.base, snapped.ptz);
    let centre = frame.image_size.centre();
    let moved = before.ray_from_image(centre).ok().and_then(|ray| after.image_from_ray(ray).ok());
    let moved = moved.map(|to| format!(", {:.1} px away", to.distance_px(centre))).unwrap_or_default();
    format!(
        "Snapped to {} points on painted lines (within {:.1} px){moved}. Hold S to see it before.",
        snapped.samples, snapped.rms_px
    )
}
