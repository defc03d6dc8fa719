//! The known cameras of a clip's frames as pose priors.

use super::frames::ClipFrames;
use crate::calibrate::own_covariance;
use touchline_core::camera::{CameraBase, PtzCamera};
use touchline_core::field::FieldModel;
use touchline_documents::document::{Document, Frame, FrameStatus, SolutionSource};
use touchline_vision::relocalize::CERTAIN;
use touchline_vision::track::{ClipCamera, PosePrior, PriorSource};

/// The pose priors of a clip's frames, each with its confidence.
pub(super) fn anchors(
    document: &Document,
    clip: &ClipFrames,
    field: &FieldModel,
    camera: &ClipCamera,
) -> Vec<(PosePrior, f64)> {
    let frames = clip
        .frames
        .iter()
        .enumerate()
        .filter_map(|(at, frame)| Some((at, &**document.frames.get(frame.place?)?)));
    frames
        .filter_map(|(at, frame)| anchor_from_frame(frame, at, field, &camera.base_at(at)))
        .collect()
}

/// Whether a frame's camera is certain enough to be propagated, and was not tracked itself.
pub fn is_anchor(frame: &Frame) -> bool {
    confidence_of(frame).is_some()
}

/// The confidence in a frame's camera; none if it is no prior.
fn confidence_of(frame: &Frame) -> Option<f64> {
    frame.ptz.as_ref()?;
    if is_persons(frame) {
        return Some(1.0);
    }
    let solution = frame.solution.as_ref()?;
    // Another program's camera comes without a confidence. It counts as just certain enough: its
    // covariance is large, and the points and the paint of the clip correct it.
    let unstated = (solution.source == Some(SolutionSource::Import)).then_some(CERTAIN);
    let confidence = solution.confidence.or(unstated)?;
    (confidence >= CERTAIN && !frame.is_tracked()).then_some(confidence)
}

fn is_persons(frame: &Frame) -> bool {
    frame.status == FrameStatus::Reference || frame.is_solved_by_clicks()
}

fn anchor_from_frame(
    frame: &Frame,
    at: usize,
    field: &FieldModel,
    base: &CameraBase,
) -> Option<(PosePrior, f64)> {
    let confidence = confidence_of(frame)?;
    let ptz = frame.ptz.as_ref()?.ptz();
    let camera = PtzCamera::new(*base, ptz);
    let covariance = own_covariance(frame, &camera, Some(field));
    // The source decides the robust loss and which errors count as common.
    let source = match frame.source() {
        _ if is_persons(frame) => PriorSource::Person,
        // Aligned to the painted lines, whoever found it.
        Some(SolutionSource::Markings) => PriorSource::Paint,
        _ => PriorSource::Proposal,
    };
    Some((
        PosePrior::from_covariance(at, ptz, &covariance, source),
        confidence,
    ))
}

#[cfg(test)]
mod tests {
    use super::*;
    use touchline_core::geometry::ImageSize;
    use touchline_documents::testing::{answered_by, new_frame, ptz_at};

    fn frame(source: SolutionSource, confidence: Option<f64>, status: FrameStatus) -> Frame {
        let mut frame = new_frame("1.jpg", ImageSize::new(1920, 1080));
        frame.ptz = ptz_at(3.0, -10.0, 2400.0);
        frame.solution = answered_by(source, confidence);
        frame.status = status;
        frame
    }

    #[test]
    fn imported_cameras_hold_without_a_sigma_and_uncertain_or_tracked_ones_do_not() {
        use FrameStatus::{Draft, Reference, Suggested};
        use SolutionSource::{Forest, Import, Markings, Tracking};
        for (source, confidence, status, holds) in [
            (Import, None, Draft, Some(CERTAIN)),
            (Import, None, Reference, Some(1.0)),
            (Markings, Some(0.97), Suggested, Some(0.97)),
            (Forest, Some(0.6), Suggested, None),
            (Forest, None, Suggested, None),
            (Tracking, Some(0.99), Suggested, None),
        ] {
            assert_eq!(
                confidence_of(&frame(source, confidence, status)),
                holds,
                "{source:?} {status:?}"
            );
        }
    }
}
