//! Cameras that are tracked to a frame from neighbours with a camera from the forest or the user.

use crate::calibrate::{TrackedClip, TrackedFrame, record_tracked_frame};
use crate::proposals::{FrameRequest, SuggestionUpdate};
use touchline_documents::document::{Document, Frame, FrameId, Suggestion};

/// A camera that was tracked to a frame.
#[derive(Clone, Debug, PartialEq)]
pub struct TrackedProposal {
    /// Id of the frame.
    pub frame: FrameId,
    /// The frame at the time of the request, by which a stale answer is recognised.
    pub request: FrameRequest,
    /// Generation of the forest that answered for its neighbours.
    pub generation: u64,
    suggestion: Suggestion,
}

impl TrackedProposal {
    /// The proposal for a tracked frame; none if the document has no such frame or the user has
    /// decided on it.
    pub fn from_tracked_frame(
        document: &Document,
        clip: &TrackedClip,
        tracked: &TrackedFrame,
        generation: u64,
    ) -> Option<Self> {
        let SuggestionUpdate {
            id,
            request,
            suggestion,
        } = suggest_tracked(document, clip, tracked)?;
        Some(Self {
            frame: id,
            request,
            generation,
            suggestion,
        })
    }

    /// The suggestion as an update of a project.
    pub fn update(&self) -> SuggestionUpdate {
        SuggestionUpdate {
            id: self.frame.clone(),
            request: self.request.clone(),
            suggestion: self.suggestion.clone(),
        }
    }

    /// Writes the camera into its frame, in the form in which files have it.
    pub fn record(&self, frame: &mut Frame) {
        self.suggestion.show_in(frame);
    }
}

/// The cameras of a tracked clip, as suggestions for the frames on which the user has not decided.
pub fn suggest_tracked_clip(document: &Document, clip: &TrackedClip) -> Vec<SuggestionUpdate> {
    clip.frames
        .iter()
        .filter_map(|tracked| suggest_tracked(document, clip, tracked))
        .collect()
}

/// The camera of one tracked frame as a suggestion; none if the user has decided on the frame.
fn suggest_tracked(
    document: &Document,
    clip: &TrackedClip,
    tracked: &TrackedFrame,
) -> Option<SuggestionUpdate> {
    // Written into a copy of the frame by the function that also writes documents, so that both
    // agree.
    SuggestionUpdate::from_recorded(document, tracked.place, |frame| {
        record_tracked_frame(frame, clip, tracked);
    })
}

#[cfg(any(test, feature = "testing"))]
impl TrackedProposal {
    /// A camera at this pan for a test.
    pub fn at_pan(document: &Document, place: usize, pan_deg: f64, generation: u64) -> Self {
        use touchline_documents::document::{FramePtz, Solution, SolutionSource};
        let frame = &document.frames[place];
        let request = FrameRequest::from_frame(document, frame);
        let solution = Solution {
            source: Some(SolutionSource::Tracking),
            confidence: Some(0.95),
            ..Solution::default()
        };
        let ptz = Some(FramePtz::new(
            touchline_core::camera::Ptz::from_degrees(pan_deg, -9.0, 900.0),
            None,
        ));
        let suggestion = Suggestion {
            revision: frame.revision,
            base: request.base,
            ptz,
            solution: Some(solution),
        };
        Self {
            frame: frame.id.clone(),
            request,
            generation,
            suggestion,
        }
    }
}
