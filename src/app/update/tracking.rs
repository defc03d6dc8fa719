//! Carrying known cameras through the shown frame's clip: begun, stopped, and what came of it.

use super::App;
use crate::app::Command;
use crate::app::effect::Effect;
use crate::app::session::{Level, Mode};
use crate::app::tracking::{TrackAction, TrackFailure, TrackOrder, Tracking, describe_tracked};
use crate::calibrate::{TrackedClip, record_tracked};
use crate::document::{Camera, Step};

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
            return Some("Cameras are being carried.");
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
        let (Some(open), Some(field)) = (&self.open, self.current.field().cloned()) else { return };
        self.track_tickets += 1;
        let (document, folder) = ((*open.document).clone(), open.folder.clone());
        let order = TrackOrder { ticket: self.track_tickets, document, folder, frame: self.session.frame, field };
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
            TrackAction::Done { tracked: Ok(tracked), .. } => tracking.done = Some(tracked),
            TrackAction::Done { tracked: Err(failure), .. } => {
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
        let Some(Tracking { order, done: Some(tracked), .. }) = self.session.tracking.take() else { return };
        let Some(open) = &self.open else { return };
        let base_now = open.document.camera(&order.document.frames[order.frame].camera).and_then(Camera::base);
        if base_now.as_ref() != Some(&tracked.base) {
            self.session
                .notify(Level::Info, "The base has changed meanwhile; the cameras that were carried were left.");
            return;
        }
        // Frames are found again by their ids; those that people have changed since stay as they are.
        let here = |place: usize| {
            let then = order.document.frames.get(place)?;
            let now = open.document.frames.position_of(&then.id)?;
            open.document.frames[now].is_open().then_some(now)
        };
        let frames = tracked.frames.iter();
        let frames =
            frames.filter_map(|of| Some(crate::calibrate::TrackedFrame { place: here(of.place)?, ..of.clone() }));
        let taken = TrackedClip { frames: frames.collect(), references: Vec::new(), ..*tracked };
        let count = taken.frames.len();
        if count > 0 {
            if !self.begin_step(Step::on_document("Carry cameras through the shot")) {
                return;
            }
            if let Some(open) = &mut self.open {
                record_tracked(&mut open.document, &taken);
            }
            self.commit();
        }
        let level = if taken.stops.is_empty() { Level::Info } else { Level::Warning };
        let offers = [("Review", Command::ReviewPanel)];
        self.session.notify_with(level, describe_tracked(&taken, count), offers);
    }
}
