//! What a document knows of the cameras of a clip.

use super::frames::ClipFrames;
use crate::camera::{CameraBase, Ptz, PtzCamera};
use crate::document::{Document, Frame, FrameStatus};
use crate::geometry::{Mat3, Vec3};
use crate::solve::{Uncertainty, covariance_in_radians};
use crate::track::{Anchor, AnchorSource};

/// A proposal less certain than this holds nothing.
pub(super) const SURE: f64 = 0.9;

/// A frame that people gave a camera without saying how exact is taken as this exact, px at 1920 px width.
const UNSTATED_PX: f64 = 4.0;

/// What is known of a clip's frames, and how certain the most certain of it is.
pub(super) fn anchors(document: &Document, clip: &ClipFrames, base: &CameraBase) -> Vec<(Anchor, f64)> {
    let frames =
        clip.frames.iter().enumerate().filter_map(|(at, frame)| Some((at, &**document.frames.get(frame.place?)?)));
    frames.filter_map(|(at, frame)| of_frame(frame, at, base)).collect()
}

/// Whether a frame's camera is certain enough to be carried on from, and was not carried there itself.
pub(crate) fn is_anchor(frame: &Frame) -> bool {
    confidence_of(frame).is_some()
}

/// How certain a person or the forest is of a frame's camera; none where it holds nothing.
fn confidence_of(frame: &Frame) -> Option<f64> {
    frame.ptz.as_ref()?;
    if is_persons(frame) {
        return Some(1.0);
    }
    let confidence = frame.solution.as_ref()?.confidence?;
    (confidence >= SURE && !frame.is_carried()).then_some(confidence)
}

fn is_persons(frame: &Frame) -> bool {
    frame.status == FrameStatus::Reference || frame.is_solved_by_clicks()
}

fn of_frame(frame: &Frame, at: usize, base: &CameraBase) -> Option<(Anchor, f64)> {
    let confidence = confidence_of(frame)?;
    let ptz = frame.ptz.as_ref()?.ptz();
    let is_persons = is_persons(frame);
    let camera = PtzCamera::new(*base, ptz);
    let stated = frame.solution.as_ref().and_then(|solution| solution.covariance);
    let covariance = match stated {
        Some(stated) => Uncertainty::of_stored(&camera, &stated, frame.image_size)
            .map_or_else(|| covariance_in_radians(&stated), |uncertainty| uncertainty.clicks),
        None if is_persons => unstated(ptz, UNSTATED_PX * frame.image_size.scale_from_1920(), frame),
        None => return None,
    };
    let by = if is_persons { AnchorSource::Person } else { AnchorSource::Proposal };
    Some((Anchor { frame: at, ptz, covariance, by }, confidence))
}

fn unstated(ptz: Ptz, sigma_px: f64, frame: &Frame) -> Mat3 {
    let turn = sigma_px / ptz.focal_px;
    let zoom = 2.0 * sigma_px / f64::from(frame.image_size.width) * ptz.focal_px;
    Mat3::from_diagonal(&Vec3::new(turn * turn, turn * turn, zoom * zoom))
}
