//! Tracked cameras as suggestions of the document: they are taken over in a batch of their own and
//! discarded as one; both are steps of undo. Cameras that were tracked with another base or field
//! are not taken over.

use super::tracking::{Cause, ClipTracking, TrackingOutcome, describe_followed, describe_tracked};
use super::{LastTracking, REFINED};
use crate::app::operation::{AsItWas, Running};
use crate::app::window_state::session::Level;
use crate::app::{App, Command};
use std::sync::Arc;
use touchline_calibration::calibrate::is_doubtful;
use touchline_calibration::proposals::{BatchId, Finder, suggest_tracked_clip};
use touchline_documents::document::Step;

impl App {
    /// Takes over tracked cameras as suggestions; one step of undo.
    pub(super) fn take_tracked_clip(
        &mut self,
        tracking: &ClipTracking,
        TrackingOutcome { tracked, evidence }: TrackingOutcome,
    ) {
        if self.refuses_changes() {
            return;
        }
        let Some(open) = &mut self.open else { return };
        // The result is valid only for the base and the field with which it was tracked.
        let camera = &tracking.document.frames[tracking.frame].camera;
        let since = AsItWas {
            then: &tracking.document,
            now: &open.document,
        };
        if !since.has_base_and_field(camera) {
            let text = "The base or the field changed in the meantime; the tracked cameras were \
                        discarded.";
            self.session.notify(Level::Info, text);
            return;
        }
        let lengths = tracked.lengths.clone();
        let taken = tracking.still_open_in(&open.document, tracked);
        let count = taken.frames.len();
        let is_again = tracking.is_again();
        // After a correction the suggestions go into the same batch, so that discarding it restores
        // what the frames showed before the first run.
        let batch = match self
            .operations
            .clip_tracking
            .last
            .take()
            .filter(|_| is_again)
        {
            Some(last) => last.batch,
            None => open.project.open_batch(Finder::Command {
                name: Command::Track.name().to_owned(),
            }),
        };
        self.operations.clip_tracking.last = Some(LastTracking {
            evidence,
            batch,
            length: None,
        });
        let updates = suggest_tracked_clip(&open.document, &taken);
        // Tracking again after a correction is no command of the user.
        let edit = match tracking.cause {
            Cause::Correction | Cause::Drag => open.suggest(batch, &updates),
            Cause::Command => {
                open.suggest_as_step(Step::on_document(Command::Track.name()), batch, &updates)
            }
            Cause::Refined => {
                // One undo takes back the base and the cameras tracked with it.
                open.resume(&Step::on_document(REFINED));
                open.suggest_as_step(Step::on_document(REFINED), batch, &updates)
            }
        };
        if let Some(edit) = edit {
            self.journal_edit(edit);
        }
        self.session.retract(Command::DiscardTracked);
        // Report the result and suggest the next commands.
        let mut offers = vec![
            ("Review", Command::ReviewPanel),
            ("Discard", Command::DiscardTracked),
        ];
        if is_again {
            self.session
                .notify_with(Level::Info, describe_followed(count), offers);
            return;
        }
        // Frames that lie off their paint may all suffer from the same base.
        if taken
            .frames
            .iter()
            .any(|frame| frame.contradicted || frame.length_px.is_some())
        {
            offers.insert(1, ("Refine the base", Command::RefineBaseOnShot));
        }
        let level = if taken.stops.is_empty() {
            Level::Info
        } else {
            Level::Warning
        };
        self.session
            .notify_with(level, describe_tracked(&taken, count), offers);
        for found in lengths {
            self.report_length(found);
        }
    }

    /// Discards the tracked cameras: frames that users have not changed since show again what they
    /// showed before.
    pub(super) fn discard_tracked(&mut self) {
        self.commit_open_step();
        if let Some(batch) = self
            .operations
            .clip_tracking
            .last
            .as_ref()
            .map(|last| last.batch)
        {
            self.ask_discard_batch(batch);
        }
    }

    /// Forgets the last result if its batch has just been discarded.
    pub(in crate::app) fn forget_tracked_batch(&mut self, batch: BatchId) {
        let last = &mut self.operations.clip_tracking.last;
        if last.take_if(|last| last.batch == batch).is_some() {
            self.session.retract(Command::DiscardTracked);
        }
    }
}

// Corrections that spread through a clip: what a person corrects in one frame is tracked to the
// others. An accepted correction is followed through a clip that was tracked before, and a drag
// through the doubtful frames around it.

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

#[cfg(test)]
mod tests {
    use super::super::tests::app;
    use super::*;
    use crate::app::{Action, EditAction};
    use std::sync::Arc;
    use touchline_calibration::calibrate::TrackedClip;

    /// A tracking of the shown clip as it would start now.
    fn tracking(app: &App) -> ClipTracking {
        let open = app.open().unwrap();
        ClipTracking {
            document: open.document.clone(),
            folder: open.folder.clone(),
            frame: 0,
            field: Arc::clone(app.current().field().unwrap()),
            evidence: Arc::default(),
            cause: Cause::Command,
        }
    }

    #[test]
    fn cameras_that_were_tracked_with_another_field_are_discarded() {
        for is_changed in [false, true] {
            let mut app = app();
            let tracking = tracking(&app);
            let base = tracking.document.cameras[0].base().unwrap();
            if is_changed {
                let mut spec = app.shown_field_spec().unwrap().clone();
                spec.params.insert("length_m".to_owned(), 101.0);
                app.update(Action::Edit(EditAction::Field(spec)));
            }
            let tracked = TrackedClip {
                base,
                frames: Vec::new(),
                references: Vec::new(),
                missed: vec![1],
                unreadable: None,
                kept: 0,
                stops: Vec::new(),
                sigma_px: 0.5,
                inflation: 1.0,
                painted: 0,
                lengths: Vec::new(),
                jitter: None,
                raw_jitter: None,
            };
            let outcome = TrackingOutcome {
                tracked,
                evidence: Arc::default(),
            };
            app.take_tracked_clip(&tracking, outcome);
            let said = &app.session.messages.notices.last().unwrap().text;
            let is_taken = said.ends_with("; 1 frame was not reached.");
            let is_discarded = said.ends_with("; the tracked cameras were discarded.");
            assert_eq!(
                (is_taken, is_discarded),
                (!is_changed, is_changed),
                "{said}"
            );
        }
    }
}
