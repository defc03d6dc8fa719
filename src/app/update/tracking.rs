//! Carrying known cameras through the shown frame's clip: begun, stopped, and what came of it.

use super::App;
use crate::app::Command;
use crate::app::effect::Effect;
use crate::app::session::{Level, Mode};
use crate::app::tracking::{
    CarriedShot, LastCarried, TrackAction, TrackFailure, TrackOrder, Tracking, describe_followed, describe_tracked,
};
use crate::calibrate::{ClipEvidence, TrackedClip, TrackedFrame, record_tracked};
use crate::document::{Camera, Frame, Step};
use std::sync::Arc;

impl App {
    /// Why cameras cannot be carried through the shown frame's clip now; none if they can.
    pub(super) fn why_not_track(&self) -> Option<&'static str> {
        let open = self.open.as_ref()?;
        if open.read_only.is_some() {
            return Some("The document is read-only.");
        }
        if cfg!(not(feature = "opencv")) {
            return Some("This program was built without OpenCV and cannot follow points.");
        }
        if self.session.tracking.is_some() {
            return Some("Cameras are being carried already.");
        }
        let frame = self.frame()?;
        if open.document.camera_of(frame).and_then(|camera| camera.base_for(frame)).is_none() {
            return Some("Its camera has no base yet.");
        }
        let mut others = open.document.frames.iter().filter(|other| other.camera == frame.camera);
        others.all(|other| other.ptz.is_none()).then_some("No frame has a camera to carry on: click one first.")
    }

    /// Has known cameras carried through the shown frame's clip.
    pub(super) fn track(&mut self) {
        self.commit_open_step();
        self.order_tracking(Arc::default());
    }

    /// Has the shot of the shown frame, which was just accepted, follow it if cameras were carried through it before.
    pub(super) fn carry_correction(&mut self) {
        let (Some(open), Some(frame), Some(carried)) = (&self.open, self.frame(), &self.session.carried) else {
            return;
        };
        let shown = frame.picture_source(&open.folder).is_some_and(|source| carried.evidence.shows(&source));
        if shown && frame.is_solved_by_clicks() && self.why_not_track().is_none() {
            self.order_tracking(Arc::clone(&carried.evidence));
        }
    }

    fn order_tracking(&mut self, evidence: Arc<ClipEvidence>) {
        let (Some(open), Some(field)) = (&self.open, self.current.field().cloned()) else { return };
        self.track_tickets += 1;
        let (document, folder) = ((*open.document).clone(), open.folder.clone());
        let (ticket, frame) = (self.track_tickets, self.session.frame);
        let order = TrackOrder { ticket, document, folder, frame, field, evidence };
        self.effects.push(Effect::Track(Box::new(order.clone())));
        self.session.tracking = Some(Tracking { order, progress: None, done: None });
    }

    /// Stops it; nothing has changed.
    pub(super) fn stop_tracking(&mut self) {
        if self.session.tracking.take().is_some() {
            self.effects.push(Effect::CancelTrack);
            self.session.notify(Level::Info, "Carrying cameras was stopped; nothing was changed.");
        }
    }

    /// Takes a report.
    pub(super) fn tracking(&mut self, action: TrackAction) {
        let (TrackAction::Progress { ticket, .. } | TrackAction::Done { ticket, .. }) = &action;
        let Some(tracking) = self.session.tracking.as_mut().filter(|tracking| tracking.order.ticket == *ticket) else {
            return;
        };
        match action {
            TrackAction::Progress { progress, .. } => tracking.progress = Some(progress),
            TrackAction::Done { carried: Ok(carried), .. } => tracking.done = Some(carried),
            TrackAction::Done { carried: Err(failure), .. } => {
                self.session.tracking = None;
                let level =
                    if matches!(failure, TrackFailure::Panicked { .. }) { Level::Error } else { Level::Warning };
                self.session.notify(level, format!("No cameras were carried: {failure}."));
            }
        }
    }

    /// Takes over what was carried, once nothing else is under way: a drag is not cut in two. They are suggestions and
    /// stand beside what people did, as the forest's do.
    pub(super) fn finish_tracking(&mut self) {
        let is_busy = self.session.mode != Mode::Idle
            || self.session.bulk.is_some()
            || self.open.as_ref().is_none_or(|open| open.history.is_open());
        if is_busy || self.session.tracking.as_ref().is_none_or(|tracking| tracking.done.is_none()) {
            return;
        }
        let Some(Tracking { order, done: Some(carried), .. }) = self.session.tracking.take() else { return };
        let CarriedShot { tracked, evidence } = *carried;
        let Some(open) = &self.open else { return };
        let base_now = open.document.camera(&order.document.frames[order.frame].camera).and_then(Camera::base);
        if base_now.as_ref() != Some(&tracked.base) {
            self.session.notify(Level::Info, "The base changed in the meantime; the carried cameras were discarded.");
            return;
        }
        // Frames are found again by their ids; those that people have changed since stay as they are.
        let here = |place: usize| {
            let then = order.document.frames.get(place)?;
            let now = open.document.frames.position_of(&then.id)?;
            open.document.frames[now].is_open().then_some(now)
        };
        let frames = tracked.frames.iter();
        let frames = frames.filter_map(|of| Some(TrackedFrame { place: here(of.place)?, ..of.clone() }));
        let taken = TrackedClip { frames: frames.collect(), references: Vec::new(), ..tracked };
        let count = taken.frames.len();
        let is_again = *order.evidence != ClipEvidence::default();
        // What a correction replaces was carried itself: what stood before that is what can be had back.
        let replaced = |of: &TrackedFrame| open.document.frames.get(of.place).map(|frame| Frame::clone(frame));
        let before = match self.session.carried.take().filter(|_| is_again) {
            Some(last) => last.before,
            None => taken.frames.iter().filter_map(replaced).collect(),
        };
        self.session.carried = Some(LastCarried { evidence, before });
        if count > 0 {
            if !self.begin_step(Step::on_document("Carry cameras through the shot")) {
                return;
            }
            if let Some(open) = &mut self.open {
                record_tracked(&mut open.document, &taken);
            }
            self.commit();
        }
        self.session.retract(Command::DiscardCarried);
        let offers = [("Review", Command::ReviewPanel), ("Discard", Command::DiscardCarried)];
        if is_again {
            self.session.notify_with(Level::Info, describe_followed(count), offers);
            return;
        }
        let level = if taken.stops.is_empty() { Level::Info } else { Level::Warning };
        self.session.notify_with(level, describe_tracked(&taken, count), offers);
    }

    /// Gives the frames that cameras were carried to what they showed before, where nobody has changed them since.
    pub(super) fn discard_carried(&mut self) {
        let Some(LastCarried { before, .. }) = self.session.carried.take() else { return };
        self.session.retract(Command::DiscardCarried);
        if !self.begin_step(Step::on_document("Discard the carried cameras")) {
            return;
        }
        let mut discarded = 0;
        for before in before {
            let Some(open) = &mut self.open else { break };
            let Some(frame) = open.document.frames.by_id_mut(&before.id) else { continue };
            if frame.is_open() && frame.is_carried() {
                open.journalled.forget(frame);
                (frame.status, frame.ptz, frame.solution) = (before.status, before.ptz, before.solution);
                discarded += 1;
            }
        }
        self.commit();
        let text = match discarded {
            1 => "1 frame was restored.".to_owned(),
            many => format!("{many} frames were restored."),
        };
        self.session.notify(Level::Info, text);
    }
}
