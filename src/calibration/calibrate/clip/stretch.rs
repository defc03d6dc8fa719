//! The doubtful frames around one that a person corrected.
//!
//! A wrong camera is rarely alone: the frames beside it were wrong for the same reason. A
//! correction in their midst and the reliable cameras on both sides determine them again, by
//! tracking, without the rest of the clip.

use super::frames::ClipFrames;
use crate::calibrate::withdraw;
use std::ops::RangeInclusive;
use touchline_core::markings::LineVerdict;
use touchline_documents::document::{Document, Frame, FrameStatus};
use touchline_vision::relocalize::CERTAIN;

/// The most frames of a stretch on either side of the corrected one: as many as a person waits for.
const MAX_FRAMES: usize = 300;

/// Whether a frame's camera ends a stretch: a person accepted it, the paint supports it, or it is
/// certain and the paint does not contradict it.
fn is_reliable(frame: &Frame) -> bool {
    if frame.ptz.is_none() {
        return false;
    }
    let verdict = frame.paint_verdict();
    let is_certain = frame.confidence() >= Some(CERTAIN);
    match frame.status {
        FrameStatus::Reference => true,
        FrameStatus::Suggested => {
            verdict == Some(LineVerdict::Supports)
                || (is_certain && verdict != Some(LineVerdict::Contradicts))
        }
        FrameStatus::New | FrameStatus::Draft | FrameStatus::Rejected => false,
    }
}

/// Whether a frame's camera is to be found again where a frame beside it was corrected.
pub fn is_doubtful(frame: &Frame) -> bool {
    frame.is_open() && !is_reliable(frame)
}

/// The part of a clip around the corrected frame at `place` of the document, up to the nearest
/// reliable frames on both sides, these included. The doubtful frames in it lose their cameras, so
/// that they are no evidence. None where the corrected frame has no doubtful frame beside it.
pub fn take_doubtful_stretch(
    document: &mut Document,
    clip: &ClipFrames,
    place: usize,
) -> Option<ClipFrames> {
    // The reliable frames at both ends and the corrected one stay in the stretch: they are what is
    // tracked from.
    let corrected = clip
        .frames
        .iter()
        .position(|frame| frame.place == Some(place))?;
    let span = doubtful_span(document, clip, corrected);
    let frames = clip.frames.get(span)?.to_vec();
    let mut num_doubtful = 0;
    for place in frames.iter().filter_map(|frame| frame.place) {
        let Some(frame) = document.frames.get_mut(place) else {
            continue;
        };
        if is_doubtful(frame) {
            withdraw(frame);
            num_doubtful += 1;
        }
    }
    let camera = clip.camera.clone();
    (num_doubtful > 0).then_some(ClipFrames { camera, frames })
}

/// The indices within a clip from the reliable frame before the corrected one to that after it; the
/// clip's ends, or the most frames that a stretch has, where there is none.
fn doubtful_span(
    document: &Document,
    clip: &ClipFrames,
    corrected: usize,
) -> RangeInclusive<usize> {
    // Both limits lie within the clip, so the range can be used as indices.
    let first = corrected.saturating_sub(MAX_FRAMES);
    let last = (corrected + MAX_FRAMES).min(clip.frames.len().saturating_sub(1));
    let before = (first..corrected)
        .rev()
        .find(|index| is_trusted_at(document, clip, *index));
    let after = (corrected + 1..=last).find(|index| is_trusted_at(document, clip, *index));
    before.unwrap_or(first)..=after.unwrap_or(last)
}

/// Whether the document has this frame of the clip, and its camera is not doubtful.
fn is_trusted_at(document: &Document, clip: &ClipFrames, index: usize) -> bool {
    let place = clip.frames.get(index).and_then(|frame| frame.place);
    place
        .and_then(|place| document.frames.get(place))
        .is_some_and(|frame| !is_doubtful(frame))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::calibrate::clip_of_frame;
    use std::path::Path;
    use touchline_core::geometry::ImageSize;
    use touchline_documents::document::{Solution, VideoFrame};
    use touchline_documents::testing::{ptz_at, soccer_document};

    /// A video whose frames have these confidences; none is a frame without a camera.
    fn video(confidences: &[Option<f64>]) -> Document {
        let mut document = soccer_document();
        for (index, confidence) in confidences.iter().enumerate() {
            let video = VideoFrame::new("match.mp4", index as u64, None);
            let mut frame = Frame::from_video(video, "main".into(), ImageSize::new(1280, 720));
            if confidence.is_some() {
                frame.ptz = ptz_at(0.0, -9.0, 1500.0);
                frame.status = FrameStatus::Suggested;
                frame.solution = Some(Solution {
                    confidence: *confidence,
                    ..Solution::default()
                });
            }
            document.frames.push(frame.into());
        }
        document
    }

    fn stretch(document: &mut Document, place: usize) -> Option<Vec<usize>> {
        let clip = clip_of_frame(document.at(Path::new("/match")), place)?;
        let stretch = take_doubtful_stretch(document, &clip, place)?;
        Some(
            stretch
                .frames
                .iter()
                .filter_map(|frame| frame.place)
                .collect(),
        )
    }

    #[test]
    fn a_stretch_goes_up_to_the_reliable_frames_and_its_doubtful_ones_lose_their_cameras() {
        let (sure, doubtful) = (Some(0.99), Some(0.3));
        let mut document = video(&[
            sure, sure, doubtful, None, doubtful, doubtful, sure, doubtful,
        ]);
        document.frames[4].status = FrameStatus::Reference;
        assert_eq!(stretch(&mut document, 4), Some(vec![1, 2, 3, 4, 5, 6]));
        let has_camera = |index: usize| document.frames[index].ptz.is_some();
        let with_camera: Vec<usize> = (0..8).filter(|index| has_camera(*index)).collect();
        assert_eq!(with_camera, [0, 1, 4, 6, 7]);
    }

    #[test]
    fn a_clip_ends_a_stretch_and_reliable_neighbours_leave_nothing_to_do() {
        let mut document = video(&[Some(0.2), Some(0.2), Some(0.99), Some(0.99), Some(0.99)]);
        assert_eq!(stretch(&mut document, 1), Some(vec![0, 1, 2]));
        assert_eq!(stretch(&mut document, 3), None);
    }
}
