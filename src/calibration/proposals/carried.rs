//! Cameras carried to a frame from those that the forest and people gave its neighbours.

use super::{Asked, Offer};
use crate::calibrate::{TrackedClip, TrackedFrame, record_tracked_frame};
use touchline_documents::document::{Document, Frame, FrameId, Suggestion};

/// A camera that was carried to a frame.
#[derive(Clone, Debug, PartialEq)]
pub struct CarriedProposal {
    /// The frame.
    pub frame: FrameId,
    /// What it was then, by which a stale answer is known.
    pub asked: Asked,
    /// Which forest answered its neighbours.
    pub generation: u64,
    suggestion: Suggestion,
}

impl CarriedProposal {
    /// Of a frame that a clip was tracked to; none where the document has no such frame or a person
    /// decided on it.
    pub fn of(
        document: &Document,
        clip: &TrackedClip,
        tracked: &TrackedFrame,
        generation: u64,
    ) -> Option<Self> {
        let Offer {
            id,
            asked,
            suggestion,
        } = offer_tracked(document, clip, tracked)?;
        Some(Self {
            frame: id,
            asked,
            generation,
            suggestion,
        })
    }

    /// The same as an offer to a project.
    #[must_use]
    pub fn offer(&self) -> Offer {
        Offer {
            id: self.frame.clone(),
            asked: self.asked.clone(),
            suggestion: self.suggestion.clone(),
        }
    }

    /// Writes the camera into its frame, as a file has it.
    pub fn record(&self, frame: &mut Frame) {
        self.suggestion.show_in(frame);
    }
}

/// The cameras that a clip was tracked with, as offers for the frames that nobody has decided on.
#[must_use]
pub fn offer_tracked_clip(document: &Document, clip: &TrackedClip) -> Vec<Offer> {
    clip.frames
        .iter()
        .filter_map(|tracked| offer_tracked(document, clip, tracked))
        .collect()
}

fn offer_tracked(document: &Document, clip: &TrackedClip, tracked: &TrackedFrame) -> Option<Offer> {
    Offer::from_recorded(document, tracked.place, |frame| {
        record_tracked_frame(frame, clip, tracked)
    })
}

#[cfg(any(test, feature = "testing"))]
impl CarriedProposal {
    /// A camera at this pan for a test.
    pub fn at_pan(document: &Document, place: usize, pan_deg: f64, generation: u64) -> Self {
        use touchline_documents::document::{FramePtz, Solution, SolutionSource};
        let frame = &document.frames[place];
        let asked = Asked::of(document, frame);
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
            base: asked.base,
            ptz,
            solution: Some(solution),
        };
        Self {
            frame: frame.id.clone(),
            asked,
            generation,
            suggestion,
        }
    }
}
