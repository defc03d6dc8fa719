//! Stored solutions from clicks that no longer follow from the document's base.

use super::super::{FrameLookup, calibrate, observations};
use super::fault::{Fault, Problem};
use crate::calibrate::frames::calibration::rms_of_clicks_px;
use rayon::prelude::*;
use touchline_core::field::FieldModel;
use touchline_documents::document::{Document, DocumentAt, Fields, Frame};

/// A stored camera may have residuals larger than those of a new solution by at most this, px at
/// 1920 px width. Rounding in a file and other solvers cause far less; a base that moved by a metre
/// moves lines by tens of px.
const TOLERATED_PX: f64 = 2.0;

/// Frames whose stored camera misses the clicks that it was solved from, although these give a
/// better one on the document's base: the base or the field has changed since. An invalid field is
/// reported by [`check_values`](super::check_values).
pub fn check_solutions(document: DocumentAt<'_>) -> Vec<Problem> {
    let Ok(fields) = Fields::from_document(document) else {
        return Vec::new();
    };
    let lookup = FrameLookup::from_document(&document);
    (0..document.frames.len())
        .into_par_iter()
        .filter_map(|index| {
            let frame = &document.frames[index];
            let field = fields.for_frame(&document, frame);
            let fault = find_stale(&document, &lookup, index, field)?;
            Some(Problem::in_frame(index, frame, fault))
        })
        .collect()
}

fn find_stale(
    document: &Document,
    lookup: &FrameLookup,
    index: usize,
    field: &FieldModel,
) -> Option<Fault> {
    let frame = &document.frames[index];
    let stored_px =
        distance_of_clicks_px(document, frame, field).filter(|_| frame.is_solved_by_clicks())?;
    let tolerated_px = TOLERATED_PX * frame.image_size.scale_from_1920();
    if stored_px <= tolerated_px {
        return None;
    }
    // Clicks that contradict each other miss every camera. Only a much better new solution shows
    // that the stored one is stale. This is computed only for the frames that miss their clicks.
    let solved = calibrate(document, lookup, frame, field, index).ok()?;
    let is_stale = stored_px > solved.rms_px + tolerated_px;
    is_stale.then_some(Fault::StaleSolution {
        stored_px,
        rms_px: solved.rms_px,
    })
}

/// Root mean square residual of a frame's clicks with its stored camera, px; none without a camera
/// or clicks.
fn distance_of_clicks_px(document: &Document, frame: &Frame, field: &FieldModel) -> Option<f64> {
    let camera = document.ptz_camera(frame)?;
    rms_of_clicks_px(&observations(frame, field).ok()?, &camera)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::calibrate::solve_document;
    use std::path::Path;
    use touchline_core::progress::Progress;
    use touchline_core::testing::{SIZE, TestBase, base_at, landmark_in, soccer};
    use touchline_documents::document::Click;
    use touchline_documents::testing::match_from;
    use touchline_documents::testing::new_frame;

    #[test]
    fn a_solution_of_another_base_is_named() {
        let field = soccer();
        let base = base_at([1.0, -62.0, 17.0], SIZE);
        let pointed = base.aim(-4.0, -14.0, 2300.0);
        let mut document = match_from(&base, SIZE);
        let mut frame = new_frame("a.jpg", SIZE);
        for landmark in ["centre_mark", "halfway_far"] {
            let at = landmark_in(&pointed, &field, landmark);
            frame.clicks.push(Click::landmark(landmark.into(), at));
        }
        document.frames.push(frame.into());
        solve_document(&mut document, Path::new(""), &Progress::default()).unwrap();
        assert_eq!(check_solutions(document.at(Path::new(""))), []);
        document.cameras[0].set_base(&base_at([4.0, -62.0, 17.0], SIZE));
        let problems = check_solutions(document.at(Path::new("")));
        assert!(
            matches!(
                &problems[..],
                [Problem {
                    frame: Some(0),
                    fault: Fault::StaleSolution { .. },
                    ..
                }]
            ),
            "{problems:?}"
        );
    }
}
