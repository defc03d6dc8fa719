//! Corrections that spread through a clip: what a person corrects in one frame is tracked to the
//! others. An accepted correction is followed through a clip that was tracked before, and a drag
//! through the doubtful frames around it.

use super::tracking::Cause;
use crate::app::App;
use crate::app::operation::Running;
use std::sync::Arc;
use touchline_calibration::calibrate::is_doubtful;

impl App {
    /// After the shown frame was corrected and accepted: tracks its clip again, if it was tracked
    /// before.
    pub(in crate::app) fn carry_correction(&mut self) {
        let last = &self.operations.clip_tracking.last;
        let (Some(open), Some(frame), Some(last)) = (&self.open, self.frame(), last) else {
            return;
        };
        let shown = frame
            .picture_source(&open.folder)
            .is_some_and(|source| last.evidence.shows(&source));
        if shown && frame.is_solved_by_clicks() && self.why_not_track().is_none() {
            let evidence = Arc::clone(&last.evidence);
            self.track_clip_with(self.session.frame, evidence, Cause::Correction);
        }
    }

    /// After a drag that corrects the suggestion of the shown frame: tracks the doubtful frames
    /// around it again, if there are any beside it.
    pub(in crate::app) fn track_doubtful_neighbours(&mut self) {
        let (Some(open), Some(frame)) = (&self.open, self.frame()) else {
            return;
        };
        let shown = self.session.frame;
        // A correction spreads only into a stretch that is in doubt itself.
        let beside = [shown.checked_sub(1), shown.checked_add(1)];
        let is_beside_doubt = beside.into_iter().flatten().any(|place| {
            let other = open.frame(place);
            other.is_some_and(|other| other.camera == frame.camera && is_doubtful(other))
        });
        let solution = frame.solution.as_ref().filter(|_| frame.ptz.is_some());
        let is_corrected = solution.is_some_and(|solution| solution.proposed.is_some());
        if !is_corrected || !is_beside_doubt {
            return;
        }
        // A run that follows an earlier position of the point is obsolete.
        let slot = &mut self.operations.clip_tracking.slot;
        let running = slot.running().map(Running::operation);
        if running.is_some_and(|tracking| tracking.cause == Cause::Drag) {
            slot.cancel();
        }
        if self.why_not_track().is_none() {
            let last = self.operations.clip_tracking.last.as_ref();
            let evidence = last.map(|last| Arc::clone(&last.evidence));
            self.track_clip_with(shown, evidence.unwrap_or_default(), Cause::Drag);
        }
    }
}
