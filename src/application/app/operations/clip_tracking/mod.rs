//! Tracks cameras through the clip of the shown frame: from frames with a known camera to all
//! others. The results are suggestions: like the forest's, they are kept apart from the users' work
//! and are no step of undo.
//!
//! When the user corrects and accepts one of the frames, the clip is tracked again; the points that
//! were followed the first time are reused.

mod availability;
mod measured_length;
mod words;

use crate::app::operation::{Context, Failure, Operation, Running, Slot};
use crate::app::operations::{UnderWay, has_same_base_and_field};
use crate::app::window_state::session::Level;
use crate::app::{App, Command};
use std::path::PathBuf;
use std::sync::Arc;
use thiserror::Error;
use touchline_calibration::calibrate::{
    ClipEvidence, ClipProgress, LengthOnLines, TrackClipError, TrackClipOptions, TrackedClip,
    TrackedFrame, clip_of_frame, is_doubtful, take_doubtful_stretch, track_clip,
};
use touchline_calibration::proposals::{BatchId, Finder, suggest_tracked_clip};
use touchline_core::field::{FieldError, FieldModel};
use touchline_documents::document::{Document, FrameId};
pub(super) use words::describe_progress;
use words::{describe_followed, describe_tracked};

// ---- The work ----

// ---- In the application ----

// ---- Words ----

/// Tracks cameras through a clip.
pub struct ClipTracking {
    document: Document,
    /// The folder to which its relative paths refer.
    folder: PathBuf,
    /// The index of one frame of the clip.
    frame: usize,
    /// The field that the clip shows.
    field: Arc<FieldModel>,
    /// Points and paint found in the pictures by an earlier run; empty the first time.
    evidence: Arc<ClipEvidence>,
    /// Why the clip is tracked.
    cause: Cause,
}

/// Why a clip is tracked.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Cause {
    /// The user started it, or the base was just refined on the clip.
    Command,
    /// The clip was tracked before, and the user corrected one of its frames.
    Correction,
    /// The user corrects a suggestion by dragging a point, a drawn line or a landmark: only the
    /// doubtful frames around it are tracked.
    Drag,
}

/// The tracked cameras.
pub struct TrackingOutcome {
    tracked: TrackedClip,
    /// Points and paint found in the pictures, for use after a correction.
    evidence: Arc<ClipEvidence>,
    /// Another length of the field, if the painted lines of the tracked frames require one.
    length: Result<Option<LengthOnLines>, FieldError>,
}

/// Why a clip could not be tracked.
#[derive(Debug, Error)]
pub enum ClipTrackingError {
    /// The frame has no picture.
    #[error("the frame has no picture")]
    NoPicture,
    /// No frame around the dragged one is in doubt.
    #[error("no frame beside it is in doubt")]
    NothingDoubtful,
    /// The clip cannot be tracked: no base, no known camera, or a picture that cannot be read.
    #[error(transparent)]
    Track(#[from] TrackClipError),
}

/// The running tracking, and the last result.
#[derive(Debug, Default)]
pub(in crate::app) struct ClipTrackingState {
    slot: Slot<ClipTracking>,
    last: Option<LastTracking>,
}

/// What is kept of the last result.
#[derive(Debug)]
struct LastTracking {
    /// Points tracked through the pictures of the clip, and the paint found in them.
    evidence: Arc<ClipEvidence>,
    /// The batch of its suggestions.
    batch: BatchId,
    /// The length of the field that its painted lines require, if the document states none.
    length: Option<LengthOnLines>,
}

impl Operation for ClipTracking {
    type Progress = ClipProgress;
    type Output = TrackingOutcome;
    type Error = ClipTrackingError;

    const NAME: &'static str = "track cameras";

    fn run(
        &self,
        context: &Context<'_, ClipProgress>,
    ) -> Result<TrackingOutcome, ClipTrackingError> {
        let mut reader = context.open_reader();
        let mut document = self.document.clone();
        let mut clip = clip_of_frame(document.at(&self.folder), self.frame)
            .ok_or(ClipTrackingError::NoPicture)?;
        if self.cause == Cause::Drag {
            clip = take_doubtful_stretch(&mut document, &clip, self.frame)
                .ok_or(ClipTrackingError::NothingDoubtful)?;
        }
        let (at, options) = (document.at(&self.folder), TrackClipOptions::default());
        let mut evidence = (*self.evidence).clone();
        let progress = context.progress();
        let tracked = track_clip(
            at,
            &clip,
            &self.field,
            &mut *reader,
            &options,
            &mut evidence,
            &progress,
        )?;
        // After a correction the length is not measured again.
        let length = if self.is_again() {
            Ok(None)
        } else {
            self.measure_length(&tracked, &mut *reader)
        };
        Ok(TrackingOutcome {
            tracked,
            evidence: evidence.into(),
            length,
        })
    }

    fn slot(app: &mut App) -> &mut Slot<Self> {
        &mut app.operations.clip_tracking.slot
    }

    fn must_wait(app: &App) -> bool {
        app.is_amid_change()
    }

    fn take_over(
        &self,
        app: &mut App,
        result: Result<TrackingOutcome, Failure<ClipTrackingError>>,
    ) {
        match result {
            Ok(outcome) => app.take_tracked_clip(self, outcome),
            Err(Failure::Failed(ClipTrackingError::NothingDoubtful)) => {}
            Err(failure) => app.session.notify(
                failure.level(),
                format!("No cameras were tracked: {failure}."),
            ),
        }
    }
}

impl ClipTracking {
    /// Whether the clip, or a part of it, follows a correction.
    fn is_again(&self) -> bool {
        matches!(self.cause, Cause::Correction | Cause::Drag)
    }

    /// The part of a tracked clip that still applies to the document `now`. Frames are found by
    /// their ids; frames that users have changed since are left out.
    fn still_open_in(&self, now: &Document, tracked: TrackedClip) -> TrackedClip {
        // `of.place` is a position in the document that was tracked.
        let frames = tracked.frames.iter().filter_map(|of| {
            let then = self.document.frames.get(of.place)?;
            let place = now.frames.position_of(&then.id)?;
            now.frames[place].is_open().then(|| TrackedFrame {
                place,
                ..of.clone()
            })
        });
        TrackedClip {
            frames: frames.collect(),
            references: Vec::new(),
            ..tracked
        }
    }
}

impl App {
    /// Carries out a command of the tracking.
    pub(in crate::app) fn clip_tracking_command(&mut self, command: Command) {
        match command {
            Command::Track => {
                self.commit_open_step();
                self.track_clip_with(self.session.frame, Arc::default(), Cause::Command);
            }
            Command::RefineBaseOnShot => self.refine_base_on_shot(),
            Command::StopTracking if self.stop_refining_base() => {}
            Command::StopTracking if self.operations.clip_tracking.slot.cancel() => {
                self.session
                    .notify(Level::Info, "Tracking was stopped; nothing was changed.");
            }
            Command::DiscardTracked => self.discard_tracked(),
            Command::TakeLength => self.take_measured_length(),
            _ => {}
        }
    }

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

    /// Tracks the clip of a frame with a base that was just refined on it; by now another clip may
    /// be shown. Reuses the points that were followed for the refinement.
    pub(super) fn track_with_refined_base(&mut self, frame: &FrameId, evidence: Arc<ClipEvidence>) {
        let open = self.open.as_ref();
        let place = open.and_then(|open| open.document.frames.position_of(frame));
        if let Some(place) = place.filter(|_| self.why_not_follow_points().is_none()) {
            self.track_clip_with(place, evidence, Cause::Command);
        }
    }

    /// Starts a tracking of the clip of a frame that reuses `evidence`.
    fn track_clip_with(&mut self, frame: usize, evidence: Arc<ClipEvidence>, cause: Cause) {
        let Some(open) = &mut self.open else { return };
        let Ok(field) = open.field_of(frame) else {
            return;
        };
        let (document, folder) = ((*open.document).clone(), open.folder.clone());
        self.start(ClipTracking {
            document,
            folder,
            frame,
            field,
            evidence,
            cause,
        });
    }

    /// Takes over tracked cameras as suggestions; this is no step of undo.
    fn take_tracked_clip(
        &mut self,
        tracking: &ClipTracking,
        TrackingOutcome {
            tracked,
            evidence,
            length,
        }: TrackingOutcome,
    ) {
        if self.refuses_changes() {
            return;
        }
        let Some(open) = &mut self.open else { return };
        // The result is valid only for the base and the field with which it was tracked.
        let camera = &tracking.document.frames[tracking.frame].camera;
        if !has_same_base_and_field(&open.document, &tracking.document, camera) {
            let text = "The base or the field changed in the meantime; the tracked cameras were \
                        discarded.";
            self.session.notify(Level::Info, text);
            return;
        }
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
        if let Some(edit) = open.suggest(batch, &suggest_tracked_clip(&open.document, &taken)) {
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
        self.tell_length(length);
    }

    /// Discards the tracked cameras: frames that users have not changed since show again what they
    /// showed before.
    fn discard_tracked(&mut self) {
        self.commit_open_step();
        if let Some(batch) = self
            .operations
            .clip_tracking
            .last
            .as_ref()
            .map(|last| last.batch)
        {
            self.discard_batch(batch);
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

impl ClipTrackingState {
    /// The running tracking with its progress, for the status row.
    pub(super) fn under_way(&self) -> Option<UnderWay> {
        let text = match self.slot.running()?.progress() {
            None => "Tracking cameras through the shot…".to_owned(),
            Some(progress) => describe_progress(progress),
        };
        Some(UnderWay {
            text,
            share: None,
            stop: Command::StopTracking,
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::app::{Action, EditAction};
    use touchline_core::camera::{BaseAngles, CameraBase};
    use touchline_core::geometry::{ImageSize, Vec3};
    use touchline_documents::document::{Camera, FieldSpec, Frame};

    /// An application after a clip was tracked, with a camera at (1, −62, 17) m.
    pub(super) fn app() -> App {
        let size = ImageSize::new(1920, 1080);
        let mut document = Document::new(FieldSpec::new("soccer"));
        let mut camera = Camera::new("main".into(), size);
        let rotation = BaseAngles::default().base_from_world();
        camera.set_base(&CameraBase::new(
            Vec3::new(1.0, -62.0, 17.0),
            rotation,
            size.centre(),
        ));
        document.cameras.push(camera.into());
        for name in ["a.jpg", "b.jpg"] {
            let frame = Frame::from_image(name, "main".into(), size);
            document.frames.push(frame.into());
        }
        let mut app = App::with_document(document);
        let finder = Finder::Command {
            name: Command::Track.name().to_owned(),
        };
        let batch = app.open.as_mut().unwrap().project.open_batch(finder);
        let last = LastTracking {
            evidence: Arc::default(),
            batch,
            length: None,
        };
        app.operations.clip_tracking.last = Some(last);
        app
    }

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
                kept: 0,
                stops: Vec::new(),
                sigma_px: 0.5,
                inflation: 1.0,
                painted: 0,
                jitter: None,
                raw_jitter: None,
            };
            let outcome = TrackingOutcome {
                tracked,
                evidence: Arc::default(),
                length: Ok(None),
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

    #[cfg(feature = "opencv")]
    #[test]
    fn after_a_refinement_its_own_clip_is_tracked_whichever_is_shown() {
        let mut app = app();
        let frame = app.open().unwrap().document.frames[1].id.clone();
        app.track_with_refined_base(&frame, Arc::default());
        let running = app.operations.clip_tracking.slot.running().unwrap();
        assert_eq!((app.session.frame, running.operation().frame), (0, 1));
    }
}
