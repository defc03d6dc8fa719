//! Tracked cameras, written into their document.

use super::certainty::DIFFER_PX;
use super::track::{TrackedClip, TrackedFrame};
use crate::calibrate::LENGTH_UNSEEN;
use touchline_core::camera::{CameraBase, Ptz, PtzCamera};
use touchline_core::solve::Uncertainty;
use touchline_documents::document::{
    Document, Frame, FramePtz, FrameStatus, Solution, SolutionSource, SolutionWarning,
};

/// The code of a warning that the cameras propagated from before and from after differ.
pub const SIDES_DIFFER: &str = "sides_differ";

/// The key under which a smoothed frame keeps its camera from before smoothing.
const RAW: &str = "raw_ptz";

/// Writes the cameras of a tracked clip into its frames, as suggestions. Frames that people decided
/// on keep everything except, where the motion was smoothed, pan, tilt and focal length.
pub fn record_tracked(document: &mut Document, tracked: &TrackedClip) {
    for of_frame in &tracked.frames {
        if let Some(frame) = document.frames.get_mut(of_frame.place) {
            record_tracked_frame(frame, tracked, of_frame);
        }
    }
    for moved in &tracked.references {
        let Some(frame) = document.frames.get_mut(moved.place) else {
            continue;
        };
        let base = frame.base_from(&tracked.base);
        frame.point(moved.ptz, PtzCamera::new(base, moved.ptz).lens());
        let solution = frame.solution.get_or_insert_default();
        keep_raw(solution, &base, moved.raw);
    }
}

/// Keeps the camera from before smoothing, unless an earlier one is there already.
fn keep_raw(solution: &mut Solution, base: &CameraBase, raw: Ptz) {
    let lens = Some(PtzCamera::new(*base, raw).lens()).filter(|lens| !lens.is_none());
    // A camera that is not finite cannot be written, and is then left out. Of a clip that is
    // smoothed twice, the camera from before the first time stays.
    if let Ok(raw) = serde_json::to_value(FramePtz::new(raw, lens)) {
        solution.extra.entry(RAW.to_owned()).or_insert(raw);
    }
}

/// Writes a tracked camera into its frame, as a suggestion.
pub(crate) fn record_tracked_frame(frame: &mut Frame, clip: &TrackedClip, tracked: &TrackedFrame) {
    let base = frame.base_from(&clip.base);
    let camera = PtzCamera::new(base, tracked.ptz);
    frame.point(tracked.ptz, camera.lens());
    frame.status = FrameStatus::Suggested;
    // Where the paint contradicts the camera, the covariance does not describe its error and is not
    // stored.
    let known = (!tracked.contradicted).then_some(&tracked.uncertainty);
    let mut solution = Solution {
        covariance: known.map(Uncertainty::ptz_covariance_deg),
        own_covariance: known.map(Uncertainty::own_covariance_deg),
        worst_corner_sigma_px: known
            .and_then(|known| known.corner_sigma_px_if_known(&camera, frame.image_size)),
        source: Some(SolutionSource::Tracking),
        confidence: Some(tracked.confidence),
        ..Solution::default()
    };
    if let Some(apart_px) = tracked
        .apart_px
        .filter(|apart| *apart > DIFFER_PX * frame.image_size.scale_from_1920())
    {
        let message = format!(
            "tracked here from the known frame before and from the one after, the cameras are {apart_px:.1} px apart: click a frame between the two"
        );
        solution
            .warnings
            .push(SolutionWarning::new(SIDES_DIFFER, message));
    }
    if tracked.contradicted {
        let message = "the painted lines are not where this camera projects them".to_owned();
        solution.warnings.push(SolutionWarning::new(
            crate::calibrate::paint::LINE_CHECK,
            message,
        ));
    }
    if let Some(px) = tracked.length_px {
        let message = format!(
            "the field's size is assumed, and lines that no known frame shows may lie ±{px:.0} px off: state the size, or click a landmark there"
        );
        solution
            .warnings
            .push(SolutionWarning::new(LENGTH_UNSEEN, message));
    }
    if let Some(raw) = tracked.raw {
        keep_raw(&mut solution, &base, raw);
    }
    frame.solution = Some(solution);
}
