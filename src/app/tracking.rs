//! Carrying known cameras through a clip: the order, what is under way, and what came of it in words.

use crate::calibrate::{
    ClipEvidence, ClipFrames, ClipProgress, TrackClipError, TrackClipOptions, TrackedClip, clips, track_clip,
};
use crate::document::{Document, Frame};
use crate::field::FieldModel;
use crate::media::ReadFrames;
use std::ops::ControlFlow;
use std::path::PathBuf;
use std::sync::Arc;
use thiserror::Error;

/// Cameras are to be carried through a clip.
#[derive(Clone, Debug, PartialEq)]
pub struct TrackOrder {
    /// Which order: the reports say it again.
    pub ticket: u64,
    /// The document.
    pub document: Document,
    /// Where its relative paths start.
    pub folder: PathBuf,
    /// The place of a frame of the clip.
    pub frame: usize,
    /// The field that it shows.
    pub field: Arc<FieldModel>,
    /// What the pictures were found to say before; nothing the first time.
    pub evidence: Arc<ClipEvidence>,
}

/// What came of an order.
#[derive(Clone, Debug, PartialEq)]
pub struct CarriedShot {
    /// The cameras.
    pub tracked: TrackedClip,
    /// What the pictures say, for when a frame is corrected.
    pub evidence: Arc<ClipEvidence>,
}

/// What changes state while cameras are carried.
#[derive(Clone, Debug, PartialEq)]
pub enum TrackAction {
    /// How far it has come.
    Progress {
        /// Which order.
        ticket: u64,
        /// What it is at.
        progress: ClipProgress,
    },
    /// It has ended.
    Done {
        /// Which order.
        ticket: u64,
        /// The cameras, or why there are none.
        carried: Result<Box<CarriedShot>, TrackFailure>,
    },
}

/// Why no cameras were carried.
#[derive(Clone, Debug, PartialEq, Eq, Error)]
pub enum TrackFailure {
    /// Something is missing, or a picture cannot be read.
    #[error("{message}")]
    Impossible {
        /// What, in words.
        message: String,
    },
    /// An internal error of this program.
    #[error("internal error (please report it): {message}")]
    Panicked {
        /// The words of the panic.
        message: String,
    },
}

impl From<TrackClipError> for TrackFailure {
    fn from(error: TrackClipError) -> Self {
        Self::Impossible { message: error.to_string() }
    }
}

impl TrackOrder {
    /// The clip that the frame belongs to.
    fn clip(&self) -> Option<ClipFrames> {
        let of_frame = |clip: &ClipFrames| clip.frames.iter().any(|frame| frame.place == Some(self.frame));
        clips(self.document.at(&self.folder), None).into_iter().find(of_frame)
    }

    /// Carries the cameras; `watch` is told how far it has come and may end it.
    ///
    /// # Errors
    /// It was stopped, nothing is known of the clip, or a picture cannot be read.
    pub fn carry_out(
        &self,
        reader: &mut dyn ReadFrames,
        watch: &dyn Fn(ClipProgress) -> ControlFlow<()>,
    ) -> Result<Box<CarriedShot>, TrackFailure> {
        let missing = || TrackFailure::Impossible { message: "the frame has no picture".to_owned() };
        let clip = self.clip().ok_or_else(missing)?;
        let options = TrackClipOptions::default();
        let at = self.document.at(&self.folder);
        let mut evidence = (*self.evidence).clone();
        let watch = &mut |progress| watch(progress);
        let tracked = track_clip(at, &clip, &self.field, reader, &options, &mut evidence, watch)?;
        Ok(Box::new(CarriedShot { tracked, evidence: evidence.into() }))
    }
}

/// Cameras being carried.
#[derive(Debug)]
pub struct Tracking {
    /// What was ordered.
    pub(super) order: TrackOrder,
    /// How far it has come; none before it says so.
    pub(super) progress: Option<ClipProgress>,
    /// What came of it, while it waits for the end of what the person is doing.
    pub(super) done: Option<Box<CarriedShot>>,
}

/// The last cameras that were carried.
#[derive(Debug)]
pub struct LastCarried {
    /// What the pictures of their shot say.
    pub(super) evidence: Arc<ClipEvidence>,
    /// Their frames as they were before.
    pub(super) before: Vec<Frame>,
}

impl Tracking {
    /// What is being done, in one sentence.
    #[must_use]
    pub fn describe(&self) -> String {
        match self.progress {
            None => "Carrying cameras through the shot…".to_owned(),
            Some(ClipProgress::Following(done, of)) => format!("Following points: frame {done} of {of}…"),
            Some(ClipProgress::Painting(done, of)) => format!("Looking at painted lines: {done} of {of} frames…"),
            Some(ClipProgress::Adjusting) => "Adjusting all frames of the shot together…".to_owned(),
        }
    }
}

/// What was carried after a correction, in words.
pub(super) fn describe_followed(taken: usize) -> String {
    match taken {
        0 => "No other frame of the shot follows this correction.".to_owned(),
        1 => "1 other frame of the shot follows this correction.".to_owned(),
        many => format!("{many} other frames of the shot follow this correction."),
    }
}

/// What was carried, in words.
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
        format!(". It stopped at {}: only {} of {} points agree", stop.picture, stop.agreeing, stop.seen)
    } else if tracked.missed.is_empty() {
        String::new()
    } else {
        format!("; {} frames were not reached", tracked.missed.len())
    };
    format!("{got}{painted}{ended}.")
}
