//! Writes the result of autocalibration into its document.

use crate::calibrate::field_size::written::write_base;
use crate::calibrate::{AutocalibratedCamera, record_snapped};
use touchline_core::camera::PtzCamera;
use touchline_core::solve::Uncertainty;
use touchline_documents::document::{CameraId, Document, FrameStatus, Solution, SolutionSource};

/// The confidence in a camera from all frames together where its own picture says nothing of it, and
/// the most where that could not be aligned: it is never certain.
const UNCONFIRMED: f64 = 0.5;
const UNALIGNED_AT_MOST: f64 = 0.8;

/// Writes the result of autocalibration into a document: base, size of the field, crown, and its
/// frames as suggestions. References do not change. With several cameras, a field that changes
/// becomes the camera's own.
pub fn record_found(document: &mut Document, camera: &CameraId, found: &AutocalibratedCamera) {
    if document.camera(camera).is_none() {
        return;
    }
    let crown_m = found.field.crown_m;
    write_base(document, camera, &found.base, crown_m, &found.sizes);
    for of_found in &found.frames {
        let Some(frame) = document.frames.get_mut(of_found.index) else {
            continue;
        };
        // A person accepted this frame, which the search does not overrule, or it went to another
        // camera meanwhile.
        if frame.status == FrameStatus::Reference || frame.camera != *camera {
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
            imported: frame.take_imported(),
            confidence: Some(
                of_found
                    .unaligned_score
                    .map_or(UNCONFIRMED, |score| score.min(UNALIGNED_AT_MOST)),
            ),
            ..Solution::default()
        });
        // The frame's own picture takes precedence over the adjustment of all frames.
        if let Some(snapped) = &of_found.snapped {
            record_snapped(frame, &found.base, snapped);
        }
    }
}
