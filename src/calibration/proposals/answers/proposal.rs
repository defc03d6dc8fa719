//! A proposed camera as plain data: its frame, the forest that found it, and the camera or the
//! reason why there is none.

use crate::calibrate::paint_evidence;
use crate::proposals::{FrameRequest, PictureError, SuggestionUpdate};
use std::time::Duration;
use thiserror::Error;
use touchline_core::geometry::Mat3;
use touchline_documents::document::{
    Document, Frame, FrameId, FramePtz, Solution, SolutionSource, SolutionWarning, Suggestion,
    TimingsMs,
};
use touchline_vision::paint::LineCheck;
use touchline_vision::relocalize::{Evidence, NotFound};

/// The answer of a forest for a frame.
#[derive(Clone, Debug, PartialEq)]
pub struct Proposal {
    /// Id of the frame.
    pub frame: FrameId,
    /// The frame at the time of the request, by which a stale answer is recognised.
    pub request: FrameRequest,
    /// Generation of the forest: later ones have greater numbers.
    pub generation: u64,
    /// The camera, or why there is none.
    pub outcome: Result<Answer, NoProposal>,
    /// Durations of the steps.
    pub timings: Timings,
}

/// A camera that the forest proposes.
#[derive(Clone, Debug, PartialEq)]
pub struct Answer {
    /// Pan, tilt and focal length, in the form of documents.
    pub ptz: FramePtz,
    /// Covariance of (pan deg, tilt deg, focal px).
    pub covariance: Mat3,
    /// The same with the base taken as exact.
    pub own_covariance: Mat3,
    /// Root mean square distance of the inliers, px.
    pub rms_px: f64,
    /// 1-σ of the overlay at the worst corner of the picture, px.
    pub worst_corner_sigma_px: f64,
    /// The probability that the overlay is right within 10 px at 1920 px width.
    pub confidence: f64,
    /// Number of inlier features.
    pub inliers: usize,
    /// Number of separate places in the picture where they lie.
    pub places: usize,
    /// The evidence of the features.
    pub evidence: Evidence,
    /// The check against the painted lines, if it was made.
    pub line_check: Option<LineCheck>,
    /// Number of line samples of the alignment, if the camera was aligned to the paint.
    pub samples: Option<usize>,
}

/// Why there is no proposal.
#[derive(Clone, Debug, PartialEq, Error)]
#[non_exhaustive]
pub enum NoProposal {
    /// The forest found no camera.
    #[error(transparent)]
    NotFound(#[from] NotFound),
    /// The forest has no reference of this camera.
    #[error("the forest has no references of camera {camera:?}")]
    NoReferences {
        /// The camera's name.
        camera: String,
    },
    /// The base of its camera is unknown.
    #[error("its camera {camera:?} has no base")]
    NoBase {
        /// The camera's name.
        camera: String,
    },
    /// The painted lines contradict the camera that was found.
    #[error(
        "the painted lines are not where the camera that was found puts them (paint at {found} of {open} open places)"
    )]
    Contradicted {
        /// Number of line samples that show paint.
        found: usize,
        /// Number of line samples that show paint or bare ground.
        open: usize,
    },
    /// The frame has a camera that was found without a forest, and this answer is no better.
    #[error("the camera that it has, which no forest proposed, is at least as good")]
    NoBetter,
    /// The picture or its features are not available.
    #[error(transparent)]
    Picture(#[from] PictureError),
    /// An internal error of this program.
    #[error("internal error (please report it): {message}")]
    Panicked {
        /// The panic's message.
        message: String,
    },
}

/// Durations of the steps of an answer.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Timings {
    /// Feature extraction, without reading the picture.
    pub features: Duration,
    /// Prediction by the forest.
    pub predict: Duration,
    /// Pose estimation.
    pub pose: Duration,
}

#[cfg(any(test, feature = "testing"))]
impl Answer {
    /// A good answer for a test: a camera at this pan.
    pub fn at_pan(pan_deg: f64, confidence: f64) -> Self {
        Self {
            ptz: FramePtz::new(
                touchline_core::camera::Ptz::from_degrees(pan_deg, -9.0, 900.0),
                None,
            ),
            covariance: Mat3::identity(),
            own_covariance: Mat3::identity(),
            rms_px: 1.0,
            worst_corner_sigma_px: 2.0,
            confidence,
            inliers: 50,
            places: 20,
            evidence: Evidence {
                breadth_px: 200.0,
                features_sigma_px: 0.5,
                labelled_sigma_px: 2.0,
                from_reference: touchline_vision::relocalize::FromReference::default(),
                at_most: 1.0,
            },
            line_check: None,
            samples: None,
        }
    }
}

impl NoProposal {
    /// The code of the warning in documents.
    pub const fn code(&self) -> &'static str {
        match self {
            Self::NotFound(reason) => reason.code(),
            Self::NoReferences { .. } => "coverage",
            Self::NoBase { .. } => "no_base",
            Self::Contradicted { .. } => "line_check",
            Self::NoBetter => "no_better",
            Self::Picture(_) => "picture",
            Self::Panicked { .. } => "failed",
        }
    }
}

impl Proposal {
    /// A proposal without an answer, and its reason.
    pub fn without_answer(
        document: &Document,
        index: usize,
        generation: u64,
        reason: NoProposal,
    ) -> Self {
        let frame = &document.frames[index];
        let request = FrameRequest::from_frame(document, frame);
        Self {
            frame: frame.id.clone(),
            request,
            generation,
            outcome: Err(reason),
            timings: Timings::default(),
        }
    }

    /// The proposal as one that follows an earlier one about the same frame: it takes the time of
    /// both.
    #[must_use]
    pub fn after(mut self, earlier: &Self) -> Self {
        self.timings.features += earlier.timings.features;
        self.timings.predict += earlier.timings.predict;
        self.timings.pose += earlier.timings.pose;
        self
    }

    /// The suggestion for its frame: a camera, or none with the reason as a warning.
    pub(in crate::proposals) fn suggestion(&self) -> Suggestion {
        let timings_ms = Some(TimingsMs::from(self.timings));
        let solution = Solution {
            source: Some(SolutionSource::Forest),
            timings_ms,
            ..Solution::default()
        };
        let (ptz, solution) = match &self.outcome {
            Ok(answer) => {
                let solution = Solution {
                    covariance: Some(answer.covariance),
                    own_covariance: Some(answer.own_covariance),
                    rms_px: Some(answer.rms_px),
                    worst_corner_sigma_px: Some(answer.worst_corner_sigma_px)
                        .filter(|sigma_px| sigma_px.is_finite()),
                    confidence: Some(answer.confidence),
                    samples: answer.samples,
                    line_check: answer.line_check.as_ref().map(paint_evidence),
                    ..solution
                };
                (Some(answer.ptz.clone()), solution)
            }
            Err(reason) => {
                // The reason takes the place of the camera, so that the user sees why there is
                // none.
                let warnings = vec![SolutionWarning::new(reason.code(), reason.to_string())];
                (
                    None,
                    Solution {
                        warnings,
                        ..solution
                    },
                )
            }
        };
        Suggestion {
            revision: self.request.revision,
            base: self.request.base,
            ptz,
            solution: Some(solution),
        }
    }

    /// The suggestion as an update of a project. None if the camera has no base, because then the
    /// forest was not queried.
    pub fn update(&self) -> Option<SuggestionUpdate> {
        let is_answer = !matches!(self.outcome, Err(NoProposal::NoBase { .. }));
        is_answer.then(|| SuggestionUpdate {
            id: self.frame.clone(),
            request: self.request.clone(),
            suggestion: self.suggestion(),
        })
    }

    /// Writes the suggestion into its frame, in the form of files.
    pub fn record(&self, frame: &mut Frame) {
        self.suggestion().show_in(frame);
    }

    /// Whether the answer may replace the camera of its frame. A camera that was found without a
    /// forest stays if there is no answer or a less confident one.
    pub fn may_replace_camera_of(&self, frame: &Frame) -> bool {
        // A camera without a stated confidence has nothing to compare with, and gives way to any
        // answer.
        let earlier = frame.confidence();
        let is_more_certain = self
            .outcome
            .as_ref()
            .is_ok_and(|answer| earlier.is_none_or(|earlier| answer.confidence > earlier));
        !frame.is_answered_without_forest() || is_more_certain
    }
}

impl From<Timings> for TimingsMs {
    fn from(timings: Timings) -> Self {
        Self {
            features: milliseconds(timings.features),
            predict: milliseconds(timings.predict),
            pose: milliseconds(timings.pose),
            ..Self::default()
        }
    }
}

/// A duration in ms, to the microsecond.
fn milliseconds(time: Duration) -> f64 {
    (time.as_secs_f64() * 1e6).round() / 1e3
}

#[cfg(test)]
mod tests {
    use super::*;
    use touchline_core::geometry::ImageSize;
    use touchline_documents::document::FrameStatus;
    use touchline_documents::testing::{a_match, answered_by, new_frame};

    /// A document of one frame with a camera of this confidence from a source.
    fn answered(source: SolutionSource, confidence: f64) -> Document {
        let size = ImageSize::new(640, 360);

        let mut document = a_match(size);
        let mut frame = new_frame("a.png", size);
        frame.status = FrameStatus::Suggested;
        frame.ptz = Some(Answer::at_pan(1.0, confidence).ptz);
        frame.solution = answered_by(source, Some(confidence));
        document.frames.push(frame.into());
        document
    }

    /// Whether a forest's answer may be recorded in the document's frame.
    fn may_replace(document: &Document, outcome: Result<Answer, NoProposal>) -> bool {
        let proposal = Proposal {
            outcome,
            ..Proposal::without_answer(document, 0, 1, NoProposal::NoBetter)
        };
        proposal.may_replace_camera_of(&document.frames[0])
    }

    #[test]
    fn a_tracked_camera_gives_way_to_a_more_certain_answer_only() {
        let tracked = answered(SolutionSource::Tracking, 0.9);
        assert!(may_replace(&tracked, Ok(Answer::at_pan(2.0, 0.95))));
        assert!(!may_replace(&tracked, Ok(Answer::at_pan(2.0, 0.85))));
        assert!(!may_replace(
            &tracked,
            Err(NoProposal::Contradicted { found: 1, open: 20 })
        ));
    }

    #[test]
    fn an_earlier_answer_of_a_forest_gives_way_to_what_a_later_one_says() {
        let proposed = answered(SolutionSource::Forest, 0.9);
        assert!(may_replace(&proposed, Ok(Answer::at_pan(2.0, 0.85))));
        assert!(may_replace(
            &proposed,
            Err(NoProposal::Contradicted { found: 1, open: 20 })
        ));
    }
}
