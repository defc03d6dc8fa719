//! The tracking of cameras through one clip, as work: its input, why it is done, and its outcome.
//! What becomes of the outcome in the document is in `suggestions.rs`.

use crate::app::App;
use crate::app::operation::{AsItWas, Context, Failure, Operation, Slot};
use crate::app::operations::OperationStep;
use std::path::PathBuf;
use std::sync::Arc;
use thiserror::Error;
use touchline_calibration::calibrate::{
    ClipEvidence, ClipProgress, TrackClipError, TrackClipOptions, TrackedClip, TrackedFrame,
    clip_of_frame, take_doubtful_stretch, track_clip,
};
use touchline_core::field::FieldModel;
use touchline_core::geometry::pluralise;
use touchline_core::progress::Share;
use touchline_documents::document::Document;

/// Tracks cameras through a clip.
pub struct ClipTracking {
    pub(super) document: Document,
    /// The folder to which its relative paths refer.
    pub(super) folder: PathBuf,
    /// The index of one frame of the clip.
    pub(super) frame: usize,
    /// The field that the clip shows.
    pub(super) field: Arc<FieldModel>,
    /// Points and paint found in the pictures by an earlier run; empty the first time.
    pub(super) evidence: Arc<ClipEvidence>,
    /// Why the clip is tracked.
    pub(super) cause: Cause,
}

/// Why a clip is tracked.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Cause {
    /// The user started it.
    Command,
    /// The base was just refined on the clip.
    Refined,
    /// The clip was tracked before, and the user corrected one of its frames.
    Correction,
    /// The user corrects a suggestion by dragging a point, a drawn line or a landmark: only the
    /// doubtful frames around it are tracked.
    Drag,
}

/// The tracked cameras.
#[derive(Clone)]
pub struct TrackingOutcome {
    pub(super) tracked: TrackedClip,
    /// Points and paint found in the pictures, for use after a correction.
    pub(super) evidence: Arc<ClipEvidence>,
}

impl From<TrackedClip> for TrackingOutcome {
    /// Cameras of which no points are kept.
    fn from(tracked: TrackedClip) -> Self {
        Self {
            tracked,
            evidence: Arc::default(),
        }
    }
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

impl Operation for ClipTracking {
    type Progress = OperationStep;
    type Output = TrackingOutcome;
    type Error = ClipTrackingError;

    const NAME: &'static str = "track cameras";

    fn run(
        &self,
        context: &Context<'_, OperationStep>,
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
        let steps = context.progress();
        let progress = steps.part(|event: ClipProgress| step_of(&event));
        let tracked = track_clip(
            at,
            &clip,
            &self.field,
            &mut *reader,
            &options,
            &mut evidence,
            &progress,
        )?;
        Ok(TrackingOutcome {
            tracked,
            evidence: evidence.into(),
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
    pub(super) fn is_again(&self) -> bool {
        matches!(self.cause, Cause::Correction | Cause::Drag)
    }

    /// The part of a tracked clip that still applies to the document `now`. Frames are found by
    /// their ids; frames that users have changed since are left out.
    pub(super) fn still_open_in(&self, now: &Document, tracked: TrackedClip) -> TrackedClip {
        let since = AsItWas {
            then: &self.document,
            now,
        };
        // The shot may have been divided since: what lies behind the cut is of another camera.
        let here = self.document.frames.get(self.frame);
        let shot = here.and_then(|here| Some(now.frames.by_id(&here.id)?.clip.clone()));
        // `of.place` is a position in the document that was tracked.
        let frames = tracked.frames.iter().filter_map(|of| {
            let then = self.document.frames.get(of.place)?;
            let place = since.position_if_untouched(&then.id)?;
            let frame = &now.frames[place];
            let is_in_shot = shot.as_ref().is_none_or(|shot| *shot == frame.clip);
            (frame.is_open() && is_in_shot).then(|| TrackedFrame {
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

/// What the tracking of a clip does at present.
pub(in crate::app::operations) fn step_of(progress: &ClipProgress) -> OperationStep {
    let (step, done) = match *progress {
        ClipProgress::Following(done, of) => (
            format!("Following points: frame {done} of {of}"),
            Some(Share::new(done, of)),
        ),
        ClipProgress::Painting(done, of) => (
            format!("Looking at painted lines: {done} of {of} frames"),
            Some(Share::new(done, of)),
        ),
        ClipProgress::Adjusting => ("Adjusting all frames of the shot together".to_owned(), None),
    };
    OperationStep::new(step, done.map(Share::fraction))
}

/// The result of tracking again after a correction, as text.
pub(super) fn describe_followed(taken: usize) -> String {
    match taken {
        0 => "No other frame of the shot follows this correction.".to_owned(),
        1 => "1 other frame of the shot follows this correction.".to_owned(),
        many => format!("{many} other frames of the shot follow this correction."),
    }
}

/// The result of tracking, as text.
pub(super) fn describe_tracked(tracked: &TrackedClip, taken: usize) -> String {
    let got = match taken {
        1 => "1 frame got its camera".to_owned(),
        many => format!("{many} frames got their cameras"),
    };
    let painted = match tracked.painted {
        0 => String::new(),
        many => format!("; {many} also checked against their painted lines"),
    };
    let ended = if let Some(stop) = tracked.stops.first() {
        format!(
            ". It stopped at {}: only {} of {} points agree",
            stop.picture, stop.agreeing, stop.seen
        )
    } else if tracked.missed.is_empty() {
        String::new()
    } else {
        let count = tracked.missed.len();
        let were = if count == 1 { "was" } else { "were" };
        format!("; {} {were} not reached", pluralise(count, "frame"))
    };
    format!("{got}{painted}{ended}.")
}
