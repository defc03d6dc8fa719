//! Estimating a camera's base: what the frames give so far, the estimation under way, the result.

use super::OpenProject;
use std::sync::Arc;
use thiserror::Error;
use touchline_calibration::calibrate::{
    BaseEstimationError, BaseOnPaintError, CalibrationError, EstimatedBase, calibrate,
};
use touchline_core::camera::{CameraBase, PtzCamera};
use touchline_core::field::FieldModel;
use touchline_core::solve::base::BaseProgress;
use touchline_core::solve::{FrameSolution, Judgement, judge};

/// Why the estimation of a base ended without one.
#[derive(Clone, Debug, PartialEq, Error)]
pub enum EstimateFailure {
    /// The frames give none, or it was given up.
    #[error(transparent)]
    Impossible(#[from] BaseEstimationError),
    /// The frames and their painted lines give none.
    #[error(transparent)]
    OnPaint(#[from] BaseOnPaintError),
    /// An internal error.
    #[error("internal error (please report it): {message}")]
    Panicked {
        /// The panic's message.
        message: String,
    },
}

/// What is being done about a base.
#[derive(Debug, Default)]
pub enum BaseWork {
    /// Nothing.
    #[default]
    Idle,
    /// It is being estimated.
    Estimating(Estimating),
    /// Found and shown, but not taken over.
    Proposed(Arc<EstimatedBase>),
    /// Taken over; its tables stay to be worked with.
    Applied(Arc<EstimatedBase>),
}

/// An estimation under way.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Estimating {
    /// From what, in words.
    pub from: String,
    /// How far it has come; none before it says so.
    pub progress: Option<EstimateProgress>,
}

/// How far the estimation of a base has come.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum EstimateProgress {
    /// Adjustments to points, or to points and paint.
    Adjusting(BaseProgress),
    /// Pictures whose painted lines were looked at.
    Looking {
        /// So far.
        pictures: usize,
    },
}

impl EstimateProgress {
    /// Whether this was told later than another.
    #[must_use]
    pub const fn is_later_than(self, other: Self) -> bool {
        match (self, other) {
            (Self::Adjusting(this), Self::Adjusting(other)) => this.done > other.done,
            (Self::Looking { pictures }, Self::Looking { pictures: before }) => pictures > before,
            _ => true,
        }
    }

    /// In a few words: "12 of 40 adjustments".
    #[must_use]
    pub fn describe(self) -> String {
        match self {
            Self::Adjusting(BaseProgress { done, total }) => format!("{done} of {total} adjustments"),
            Self::Looking { pictures: 1 } => "1 picture looked at".to_owned(),
            Self::Looking { pictures } => format!("{pictures} pictures looked at"),
        }
    }

    /// The share that is done, where it is known.
    #[must_use]
    pub fn share(self) -> Option<f32> {
        match self {
            Self::Adjusting(BaseProgress { done, total }) => Some(done as f32 / total.max(1) as f32),
            Self::Looking { .. } => None,
        }
    }
}

impl Estimating {
    /// What is being done, in one sentence.
    #[must_use]
    pub fn describe(&self) -> String {
        let far = self.progress.map(|progress| format!(": {}", progress.describe()));
        format!("Estimating the base from {}{}…", self.from, far.unwrap_or_default())
    }
}

impl BaseWork {
    /// What was found last, taken over or not.
    #[must_use]
    pub fn found(&self) -> Option<&EstimatedBase> {
        match self {
            Self::Proposed(found) | Self::Applied(found) => Some(found),
            Self::Idle | Self::Estimating(_) => None,
        }
    }

    /// Something is being estimated or waits for a decision.
    #[must_use]
    pub const fn is_open(&self) -> bool {
        matches!(self, Self::Estimating(_) | Self::Proposed(_))
    }

    /// What was found and waits for a decision.
    #[must_use]
    pub fn proposed(&self) -> Option<&Arc<EstimatedBase>> {
        match self {
            Self::Proposed(found) => Some(found),
            _ => None,
        }
    }
}

/// The shown frame as it would be with a base that waits for a decision.
#[derive(Clone, Debug)]
pub struct WithProposal {
    /// The field with the crown that was found.
    pub field: Arc<FieldModel>,
    /// The camera's base as it was found.
    pub base: CameraBase,
    /// The frame's camera; none where its clicks do not give one.
    pub camera: Option<PtzCamera>,
    /// What its clicks say; none without any.
    pub solution: Option<Result<FrameSolution, CalibrationError>>,
    /// One word and its reason.
    pub judgement: Option<Judgement>,
    /// The clicks that the others contradict.
    pub disputed: Vec<usize>,
}

impl WithProposal {
    pub(super) fn derive(open: &mut OpenProject, index: usize, found: &EstimatedBase) -> Option<Self> {
        let frame = open.document.frames.get(index).filter(|frame| frame.camera == found.camera)?;
        let mut document = open.document.clone();
        found.write_camera(&mut document);
        let field = open.derived.field_in(&document, frame).ok()?;
        let base = document.camera_of(frame)?.base_for(frame)?;
        let is_named = frame.clicks.iter().any(|click| click.target.is_some());
        let solution =
            is_named.then(|| calibrate(&document, open.derived.lookup(&open.document), frame, &field, index));
        let solved = solution.as_ref().and_then(|solution| solution.as_ref().ok());
        let camera = solved.map(|solved| PtzCamera::new(base, solved.ptz));
        let judgement = solved.map(|solved| judge(solved, frame.image_size));
        let disputed = solved.map(FrameSolution::disputed).unwrap_or_default();
        Some(Self { field: Arc::new(field), base, camera, solution, judgement, disputed })
    }
}
