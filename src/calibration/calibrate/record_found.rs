//! Writes the result of autocalibration into its document.

use super::field_size::{field_of_camera_mut, set_field_size};
use super::{AutocalibratedCamera, record_snapped};
use touchline_core::camera::PtzCamera;
use touchline_core::solve::Uncertainty;
use touchline_documents::document::{CameraId, Document, FrameStatus, Solution, SolutionSource};

/// Writes the result of autocalibration into a document: base, size of the field, crown, and its
/// frames as suggestions. References do not change.
pub fn record_found(document: &mut Document, camera: &CameraId, found: &AutocalibratedCamera) {
    let Some(of_document) = document.camera_mut(camera) else {
        return;
    };
    of_document.set_base(&found.base);
    // The size may give this camera a field of its own, so the crown is written after it.
    set_field_size(document, camera, &found.sizes);
    if let Some(field) = field_of_camera_mut(document, camera) {
        field.set_crown_m(found.field.crown_m);
    }
    for of_found in &found.frames {
        let Some(frame) = document.frames.get_mut(of_found.index) else {
            continue;
        };
        // A person accepted this frame; the search does not overrule that.
        if frame.status == FrameStatus::Reference {
            continue;
        }
        if frame.status == FrameStatus::New {
            frame.status = FrameStatus::Suggested;
        }
        let camera = PtzCamera::new(found.base, of_found.ptz);
        frame.point(of_found.ptz, camera.lens());
        let known = of_found.uncertainty.as_ref();
        frame.solution = Some(Solution {
            source: Some(SolutionSource::Markings),
            covariance: known.map(Uncertainty::ptz_covariance_deg),
            own_covariance: known.map(Uncertainty::own_covariance_deg),
            worst_corner_sigma_px: known
                .and_then(|known| known.corner_sigma_px_if_known(&camera, frame.image_size)),
            ..Solution::default()
        });
        // The frame's own picture takes precedence over the adjustment of all frames.
        if let Some(snapped) = &of_found.snapped {
            record_snapped(frame, &found.base, snapped);
        }
    }
}
