//! Solves many frames of a document at once.

use super::better_camera::warn_of_better_camera;
use crate::calibrate::{CalibrationError, FrameLookup, calibrate};
use rayon::prelude::*;
use std::path::Path;
use std::sync::Arc;
use touchline_core::field::{FieldError, FieldModel};
use touchline_core::progress::Progress;
use touchline_core::solve::{FrameSolution, SolveError};
use touchline_documents::document::{Document, Fields, Frame};

/// The result of solving a frame from its clicks.
type Solved = Result<Box<FrameSolution>, CalibrationError>;

/// The fields of the frames to be solved.
#[derive(Clone, Copy)]
pub(in crate::calibrate) enum FrameFields<'a> {
    /// All fields of the document. A frame gets a warning if another camera fits it better.
    Document(&'a Fields),
    /// The field of a single camera, which all frames belong to.
    Camera(&'a FieldModel),
}

/// Number of frames that are solved before their results are written; limits the memory.
const AT_ONCE: usize = 4096;

/// Solves frames, given by their indices, in parallel. `settle` writes each result into its frame.
/// Returns for each frame whether it was solved. The result does not depend on the number of
/// threads. `progress` counts frames; none if it cancels this, and no frame has changed then.
///
/// Every frame is solved with its neighbours as they were before. A frame whose clicks fit two
/// cameras equally well is then solved once more, with its neighbours as solved.
pub(in crate::calibrate) fn solve_frames(
    document: &mut Document,
    places: &[usize],
    fields: FrameFields<'_>,
    settle: fn(&mut Frame, Result<&FrameSolution, &CalibrationError>),
    progress: &Progress<'_, ()>,
) -> Option<Vec<Result<(), CalibrationError>>> {
    let mut lookup = FrameLookup::from_document(document);
    let of_cameras = match fields {
        FrameFields::Document(fields) => fields.per_camera(document),
        FrameFields::Camera(_) => Vec::new(),
    };
    // First pass: all frames see the document as it was given, so that neither order nor number of
    // threads matters. It runs in batches, because the solutions of a long video together need much
    // memory.
    let given = document.clone();
    let (mut settled, mut again) = (Vec::with_capacity(places.len()), Vec::new());
    for some in places.chunks(AT_ONCE) {
        let first = some.par_iter().map(|&index| {
            let solved = solve_one(&given, &lookup, index, fields, &of_cameras);
            progress.report(()).is_continue().then_some(solved)
        });
        let Some(first) = first.collect::<Option<Vec<Solved>>>() else {
            // Cancelled: undo the batches that are written.
            *document = given;
            return None;
        };
        for (&index, solved) in some.iter().zip(first) {
            settle(&mut document.frames[index], solved.as_deref());
            let is_undecided = solved
                .as_ref()
                .is_ok_and(|solved| !solved.alternatives.is_empty());
            again.extend(is_undecided.then_some(index));
            // The solutions are in the document; only their outcome is returned.
            settled.push(solved.map(drop));
        }
    }
    drop(given);
    // Second pass: ambiguous frames are decided by their neighbours' new solutions. They are not
    // written until all are solved, for the same reason.
    if !again.is_empty() {
        lookup.update(document);
    }
    let second: Vec<Solved> = again
        .par_iter()
        .map(|&index| solve_one(document, &lookup, index, fields, &of_cameras))
        .collect();
    for (index, solved) in again.into_iter().zip(second) {
        // A frame that the second pass cannot solve keeps its solution of the first.
        if let Ok(solved) = solved {
            settle(&mut document.frames[index], Ok(&solved));
        }
    }
    Some(settled)
}

fn solve_one(
    document: &Document,
    lookup: &FrameLookup,
    index: usize,
    fields: FrameFields<'_>,
    of_cameras: &[Arc<FieldModel>],
) -> Solved {
    let frame = &document.frames[index];
    let field = match fields {
        FrameFields::Document(fields) => fields.for_frame(document, frame),
        FrameFields::Camera(field) => field,
    };
    let mut solved = calibrate(document, lookup, frame, field, index)?;
    warn_of_better_camera(document, frame, &mut solved, of_cameras);
    Ok(Box::new(solved))
}

/// Solves those of some frames again whose camera comes from clicks, or would if there had been a
/// base; returns the number of frames that were solved. Call it after a camera or a field has
/// changed. `folder` is the document's. If `progress` cancels this, no frame is changed.
///
/// # Errors
/// A field of the document is not valid; no frame is solved then.
pub(in crate::calibrate) fn solve_by_clicks(
    document: &mut Document,
    folder: &Path,
    places: &[usize],
    progress: &Progress<'_, ()>,
) -> Result<usize, FieldError> {
    let fields = Fields::from_document(document.at(folder))?;
    let places = places
        .iter()
        .copied()
        .filter(|&index| is_by_clicks(&document.frames[index]));
    let places: Vec<usize> = places.collect();
    let results = solve_frames(
        document,
        &places,
        FrameFields::Document(&fields),
        record_outcome,
        progress,
    );
    Ok(results.into_iter().flatten().flatten().count())
}

/// Whether a frame has clicks and its camera comes from them, or would if there had been a base.
pub fn is_by_clicks(frame: &Frame) -> bool {
    !frame.clicks.is_empty() && (frame.is_solved_by_clicks() || frame.ptz.is_none())
}

/// Writes the result of solving a frame into it.
///
/// | result | frame |
/// |---|---|
/// | solved | gets the camera |
/// | camera unknown or without a base | stays |
/// | too few clicks, with a proposal | gets the proposal back |
/// | too few clicks, no proposal | loses a camera from clicks, keeps any other |
/// | other errors | loses its camera |
pub fn record_outcome(frame: &mut Frame, solved: Result<&FrameSolution, &CalibrationError>) {
    match solved {
        Ok(solved) => frame.record(solved),
        Err(CalibrationError::NoBase { .. } | CalibrationError::UnknownCamera { .. }) => {}
        Err(error) => {
            let too_few = matches!(
                error,
                CalibrationError::Solve(SolveError::TooFewObservations { .. })
            );
            if too_few && frame.restore_proposed() {
                return;
            }
            if frame.is_solved_by_clicks() || !too_few {
                frame.ptz = None;
                frame.solution = None;
            }
        }
    }
}

/// Writes a solution into its frame; without one the frame stays.
pub(super) fn record_if_solved(
    frame: &mut Frame,
    solved: Result<&FrameSolution, &CalibrationError>,
) {
    if let Ok(solved) = solved {
        frame.record(solved);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::ops::ControlFlow;
    use std::sync::atomic::{AtomicUsize, Ordering};
    use touchline_core::geometry::ImageSize;
    use touchline_core::testing::{TestBase, base_at, soccer};
    use touchline_documents::document::Click;
    use touchline_documents::testing::match_from;
    use touchline_documents::testing::new_frame;

    /// So many frames, each with four exact points.
    fn clicked(frames: usize) -> (Document, FieldModel) {
        let (size, field) = (ImageSize::new(1280, 720), soccer());
        let base = base_at([0.0, -66.0, 18.0], size);
        let pointed = base.aim(-30.0, -12.0, 1500.0);
        let mut document = match_from(&base, size);
        let seen = field.landmarks.iter().filter_map(|landmark| {
            let image = pointed
                .image_from_world(field.landmark_in_world(landmark))
                .ok()?;
            size.contains(image)
                .then(|| Click::landmark(landmark.id.clone(), image))
        });
        let clicks: Vec<Click> = seen.take(4).collect();
        for index in 0..frames {
            let mut frame = new_frame(&format!("{index}.jpg"), size);
            frame.clicks.clone_from(&clicks);
            document.frames.push(frame.into());
        }
        (document, field)
    }

    #[test]
    fn frames_are_solved_some_at_a_time_and_all_or_none_of_them() {
        let (given, field) = clicked(AT_ONCE + 20);
        let places: Vec<usize> = (0..given.frames.len()).collect();
        let (solved, mut document) = (AtomicUsize::new(0), given.clone());
        let ended = Progress::new(|()| match solved.fetch_add(1, Ordering::Relaxed) {
            AT_ONCE.. => ControlFlow::Break(()),
            _ => ControlFlow::Continue(()),
        });
        let result = solve_frames(
            &mut document,
            &places,
            FrameFields::Camera(&field),
            record_if_solved,
            &ended,
        );
        assert_eq!(result, None);
        assert_eq!(
            document, given,
            "what was written before it was ended is taken back"
        );
        let goes_on = Progress::default();
        let results = solve_frames(
            &mut document,
            &places,
            FrameFields::Camera(&field),
            record_if_solved,
            &goes_on,
        );
        assert_eq!(
            results
                .unwrap()
                .iter()
                .filter(|result| result.is_ok())
                .count(),
            AT_ONCE + 20
        );
        let focal_px = document
            .frames
            .iter()
            .map(|frame| frame.ptz.as_ref().unwrap().ptz().focal_px);
        assert!(
            focal_px
                .into_iter()
                .all(|focal_px| (focal_px - 1500.0).abs() < 1e-3)
        );
    }
}
