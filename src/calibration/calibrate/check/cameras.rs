//! Checks of the clicks against cameras: another camera fits better, or a base stops fitting.

use super::super::{FrameLookup, better_camera, calibrate, camera_change};
use super::fault::{Fault, Problem};
use rayon::prelude::*;
use touchline_documents::document::{DocumentAt, Fields};

/// Frames whose clicks fit another camera of the document better, and cameras whose base stops
/// fitting from some frame on. An invalid field is reported by
/// [`check_values`](super::check_values).
pub fn check_cameras(document: DocumentAt<'_>) -> Vec<Problem> {
    let Ok(fields) = Fields::from_document(document) else {
        return Vec::new();
    };
    let of_cameras = fields.per_camera(&document);
    let lookup = FrameLookup::from_document(&document);
    let mut problems: Vec<Problem> = (0..document.frames.len())
        .into_par_iter()
        // With one camera no other one can fit. Solving all frames again is what takes time.
        .filter(|_| document.cameras.len() > 1)
        .filter_map(|index| {
            let frame = &document.frames[index];
            let field = fields.for_frame(&document, frame);
            let solved = calibrate(&document, &lookup, frame, field, index).ok()?;
            let better = better_camera(&document, frame, &solved, &of_cameras)?;
            let fault = Fault::OtherCamera {
                camera: better.camera.as_str().to_owned(),
                rms_px: better.rms_px,
                own_rms_px: better.own_rms_px,
            };
            Some(Problem::in_frame(index, frame, fault))
        })
        .collect();
    // The base of each camera over the sequence of its frames.
    for (camera, field) in document.cameras.iter().zip(&of_cameras) {
        if let Some(change) = camera_change(&document, &lookup, &camera.id, field) {
            let fault = Fault::StoppedFitting {
                frame: document.frames[change.frame].name(),
                before_px: change.before_px,
                after_px: change.after_px,
            };
            problems.push(Problem {
                place: format!("camera {}", camera.id),
                frame: None,
                fault,
            });
        }
    }
    problems
}
