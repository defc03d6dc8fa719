//! Tracked cameras as suggestions of the document: they are taken over in a batch of their own and
//! discarded as one; both are steps of undo. Cameras that were tracked with another base or field
//! are not taken over.

use super::tracking::{Cause, ClipTracking, TrackingOutcome, describe_followed, describe_tracked};
use super::{LastTracking, REFINED};
use crate::app::operation::AsItWas;
use crate::app::window_state::session::Level;
use crate::app::{App, Command};
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
            self.session.note(text);
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
