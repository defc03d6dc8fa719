//! Comparison of an estimate with the truth: the cameras of one document against those of another
//! document of the same frames.
//!
//! The truth may contain cameras, clicks or both; measures that need the others are left out. A
//! truth of clicks alone (real frames) gives errors of lines and landmarks in the picture, but not
//! of pan, tilt and focal length.

mod groups;
mod measure;
mod rescale;
mod scores;

pub use groups::{FrameGroup, GroupKind};
pub use measure::Measure;
pub use scores::FrameScores;

use super::matching::match_frames;
use rayon::prelude::*;
use scores::{TrueFrame, scores};
use serde::{Serialize, Serializer};
use thiserror::Error;
use touchline_core::field::FieldError;
use touchline_core::geometry::{Angle, ImageSize};
use touchline_core::score::{FieldView, horizontal_view};
use touchline_core::solve::ObservationError;
use touchline_documents::document::{CameraId, Clip, Document, Frame, FrameStatus};
use touchline_documents::document::{DocumentAt, Fields};

/// The comparison of an estimate with a truth.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Evaluation {
    /// The frames with a camera or clicks in the truth, in its order.
    pub frames: Vec<FrameResult>,
    /// Names of the estimate's frames without a truth.
    pub without_truth: Vec<String>,
}

/// The result of one frame.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct FrameResult {
    /// Name of the frame in messages.
    pub name: String,
    /// Index of the frame in the truth.
    pub index: usize,
    /// Its shot.
    pub clip: Option<Clip>,
    /// Its camera in the truth.
    pub camera: CameraId,
    /// The size of its picture in the truth, in whose px the scores are.
    #[serde(rename = "image_size_px")]
    pub image_size: ImageSize,
    /// The horizontal field of view: the true camera's, else the estimate's.
    #[serde(rename = "view_deg")]
    pub view: Option<Angle>,
    /// Its scores, or why it has none.
    #[serde(serialize_with = "scores_or_reason")]
    pub scores: Result<FrameScores, Unscored>,
}

/// The scores, or why there are none as text.
fn scores_or_reason<S: Serializer>(
    scores: &Result<FrameScores, Unscored>,
    serializer: S,
) -> Result<S::Ok, S::Error> {
    match scores {
        Ok(scores) => scores.serialize(serializer),
        Err(reason) => serializer.collect_str(reason),
    }
}

/// Why a frame has no score.
#[derive(Clone, Debug, PartialEq, Error)]
#[non_exhaustive]
pub enum Unscored {
    /// No frame of the estimate shows this picture.
    #[error("the estimate has no such frame")]
    Absent,
    /// The estimate has the frame, without a camera.
    #[error("the estimate has no camera for it{}", reason.as_ref().map(|reason| format!(": {reason}")).unwrap_or_default())]
    NoCamera {
        /// The warning with the reason.
        reason: Option<String>,
    },
    /// The pictures differ in size, so their px are not comparable.
    #[error(
        "the truth's picture is {} × {} px, the estimate's {} × {} px", truth.width, truth.height, estimate.width, estimate.height
    )]
    SizeDiffers {
        /// Size in the truth.
        truth: ImageSize,
        /// Size in the estimate.
        estimate: ImageSize,
    },
    /// A click of the truth is on a target that the estimate's field lacks.
    #[error("the fields differ: {0}")]
    Field(#[from] ObservationError),
}

/// Why documents cannot be compared at all.
#[derive(Debug, Error)]
#[non_exhaustive]
pub enum EvaluationError {
    /// A field is not valid.
    #[error("the {which}: {source}")]
    Field {
        /// "truth" or "estimate".
        which: &'static str,
        /// The error of the field.
        source: FieldError,
    },
    /// No frame of the truth has a camera or a named click.
    #[error(
        "no frame of the truth has a camera or a named click: there is nothing to compare with"
    )]
    NoTruth,
}

/// Compares an estimate with a truth. Frames are matched by the location of their pictures, by
/// SHA-256, or by name. Rejected frames of the truth are left out.
///
/// # Errors
/// A field is not valid, or the truth contains nothing to compare with.
pub fn evaluate(
    truth: DocumentAt<'_>,
    estimate: DocumentAt<'_>,
) -> Result<Evaluation, EvaluationError> {
    let true_fields = fields_of(truth, "truth")?;
    let estimated_fields = fields_of(estimate, "estimate")?;
    let partners = match_frames(truth, estimate);
    // The frames for which the truth has a camera or clicks. Without any, there is nothing to
    // evaluate.
    let known: Vec<usize> = (0..truth.frames.len())
        .filter(|&index| is_known(&truth, &truth.frames[index]))
        .collect();
    if known.is_empty() {
        return Err(EvaluationError::NoTruth);
    }
    let frames = known.par_iter().map(|&index| {
        let frame = &*truth.frames[index];
        let known = TrueFrame {
            frame,
            field: true_fields.for_frame(&truth, frame),
            camera: truth.ptz_camera(frame),
        };
        let partner = partners[index].map(|partner| &*estimate.frames[partner]);
        // The field of view groups frames by zoom. A truth of clicks alone has none, and takes the
        // estimate's.
        let estimated_camera = partner.and_then(|partner| estimate.ptz_camera(partner));
        let focal_px = known
            .camera
            .or(estimated_camera)
            .map(|camera| camera.ptz().focal_px);
        FrameResult {
            name: frame.name(),
            index,
            clip: frame.clip.clone(),
            camera: frame.camera.clone(),
            image_size: frame.image_size,
            view: focal_px.map(|focal_px| horizontal_view(focal_px, frame.image_size)),
            scores: score_frame(&known, &estimate, partner, &estimated_fields),
        }
    });
    let frames: Vec<FrameResult> = frames.collect();
    // The estimate's frames to which no such frame was matched.
    let mut has_truth = vec![false; estimate.frames.len()];
    for partner in known.iter().filter_map(|&index| partners[index]) {
        has_truth[partner] = true;
    }
    let without_truth = estimate
        .frames
        .iter()
        .zip(has_truth)
        .filter(|(_, known)| !known);
    let without_truth = without_truth.map(|(frame, _)| frame.name()).collect();
    Ok(Evaluation {
        frames,
        without_truth,
    })
}

/// The fields of a document; `which` names it in the error.
pub(super) fn fields_of(
    document: DocumentAt<'_>,
    which: &'static str,
) -> Result<Fields, EvaluationError> {
    Fields::from_document(document).map_err(|source| EvaluationError::Field { which, source })
}

/// Whether the truth has a camera or a named click for a frame that is not rejected.
fn is_known(truth: &Document, frame: &Frame) -> bool {
    frame.status != FrameStatus::Rejected
        && (truth.ptz_camera(frame).is_some()
            || frame.clicks.iter().any(|click| click.target.is_some()))
}

/// Scores the frame that the truth's frame was matched to, or says why there is no score.
fn score_frame(
    truth: &TrueFrame,
    estimate: &Document,
    partner: Option<&Frame>,
    fields: &Fields,
) -> Result<FrameScores, Unscored> {
    let frame = partner.ok_or(Unscored::Absent)?;
    let camera = estimate.ptz_camera(frame).ok_or_else(|| {
        // The first warning of a frame without a camera says why there is none.
        let first = frame
            .solution
            .as_ref()
            .and_then(|solution| solution.warnings.first());
        Unscored::NoCamera {
            reason: first.map(|warning| warning.message.clone()),
        }
    })?;
    let field = fields.for_frame(estimate, frame);
    let size = truth.frame.image_size;
    if frame.image_size == size {
        let camera = &camera;
        return Ok(scores(truth, frame, FieldView { field, camera })?);
    }
    let (camera, frame) = rescale::rescale(&camera, frame, size).ok_or(Unscored::SizeDiffers {
        truth: size,
        estimate: frame.image_size,
    })?;
    let camera = &camera;
    Ok(scores(truth, &frame, FieldView { field, camera })?)
}
