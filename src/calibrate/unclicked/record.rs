//! A base that was found without clicks, written into its document.

use super::UnclickedBase;
use crate::document::{CameraId, Document, FramePtz, FrameStatus, Solution, SolutionSource};

/// Writes a found base into a camera, and the cameras of the frames that it was found from as suggestions. `frames` are their
/// places in the document.
pub fn record_found(document: &mut Document, camera: &CameraId, frames: &[usize], found: &UnclickedBase) {
    let Some(of_document) = document.camera_mut(camera) else { return };
    of_document.set_base(&found.base);
    let field = if of_document.field.is_some() { of_document.field.as_mut() } else { Some(&mut document.field) };
    if let Some(field) = field {
        field.set_crown_m(found.crown_m);
    }
    for (&index, ptz) in frames.iter().zip(&found.ptz) {
        let (Some(frame), Some(ptz)) = (document.frames.get_mut(index), ptz) else { continue };
        let lens = Some(found.base.distortion.radial_at(ptz.focal_px)).filter(|lens| !lens.is_none());
        frame.ptz = Some(FramePtz::new(*ptz, lens));
        frame.status = FrameStatus::Suggested;
        frame.solution = Some(Solution { source: Some(SolutionSource::Markings), ..Solution::default() });
    }
}
