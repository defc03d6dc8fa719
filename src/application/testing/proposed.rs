//! Documents whose frames are proposed, and what a forest says of a frame.

use super::base;
use touchline_calibration::proposals::{Answer, FrameRequest, Proposal, Timings};
use touchline_core::camera::Ptz;
use touchline_core::testing::SIZE;
use touchline_documents::document::{
    Clip, Document, FramePtz, FrameStatus, Solution, SolutionSource, SolutionWarning,
};
use touchline_documents::testing::{match_from, new_frame};
use touchline_vision::relocalize::NotFound;

/// The truth of frame `index`: a slow pan.
pub fn truth(index: usize) -> Ptz {
    Ptz::from_degrees(-4.0 + 0.2 * index as f64, -14.0, 2300.0)
}

/// Frames of one camera and one clip, nothing done.
pub fn blank(frames: usize) -> Document {
    let mut document = match_from(&base(), SIZE);
    for index in 0..frames {
        let mut frame = new_frame(&format!("images/{index:04}.jpg"), SIZE);
        frame.clip = Some(Clip::Number(1));
        document.frames.push(frame.into());
    }
    document
}

/// A document whose frames are suggested with these confidences; none: the forest has no answer.
pub fn suggestions(confidences: &[Option<f64>]) -> Document {
    let mut document = blank(confidences.len());
    for (index, (frame, confidence)) in document.frames.iter_mut().zip(confidences).enumerate() {
        let mut solution = Solution {
            source: Some(SolutionSource::Forest),
            confidence: *confidence,
            ..Solution::default()
        };
        if confidence.is_some() {
            frame.ptz = Some(FramePtz::new(truth(index), None));
            frame.status = FrameStatus::Suggested;
        } else {
            solution.warnings.push(SolutionWarning::new(
                "coverage",
                "3 features are too few".to_owned(),
            ));
        }
        frame.solution = Some(solution);
    }
    document
}

/// What the forest says of a frame of a document.
pub fn proposal_in(
    document: &Document,
    frame: usize,
    generation: u64,
    pan_deg: Option<f64>,
) -> Proposal {
    let outcome = match pan_deg {
        Some(pan_deg) => Ok(Answer {
            ptz: FramePtz::new(Ptz::from_degrees(pan_deg, -14.0, 2300.0), None),
            inliers: 100,
            ..Answer::at_pan(pan_deg, 0.9)
        }),
        None => Err(NotFound::FewMatches {
            matched: 3,
            needed: 12,
        }
        .into()),
    };
    let frame = &document.frames[frame];
    let request = FrameRequest::from_frame(document, frame);
    Proposal {
        frame: frame.id.clone(),
        request,
        generation,
        outcome,
        timings: Timings::default(),
    }
}
