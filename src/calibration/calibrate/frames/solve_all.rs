//! Solves all frames of a document from their clicks.

use super::solve_frames::{FrameFields, record_if_solved, solve_frames};
use crate::calibrate::CalibrationError;
use std::path::Path;
use touchline_core::field::FieldError;
use touchline_core::progress::Progress;
use touchline_core::solve::SolveError;
use touchline_documents::document::{Document, Fields, Frame, Target};

/// Pan, tilt and focal length: the minimum number of equations.
const UNKNOWNS: usize = 3;

/// The result of solving a frame.
#[derive(Debug)]
#[non_exhaustive]
pub enum SolveOutcome {
    /// The frame has its `ptz` and `solution`.
    Solved,
    /// It has too few clicks for a camera and was not changed.
    TooFewClicks,
    /// Its clicks should suffice but give no camera; it was not changed.
    Failed(CalibrationError),
}

/// Solves every frame with enough clicks, in parallel; statuses do not change. `folder` is the
/// document's; `progress` counts frames, from any thread. Returns one outcome for each frame,
/// independent of the number of threads; an empty list if `progress` cancels this, and the document
/// has not changed then.
///
/// A frame whose clicks fit two cameras equally well is decided by its neighbours, including those
/// solved in the same run.
///
/// # Errors
/// The field of a frame is not valid.
pub fn solve_document(
    document: &mut Document,
    folder: &Path,
    progress: &Progress<'_, ()>,
) -> Result<Vec<SolveOutcome>, FieldError> {
    let fields = Fields::from_document(document.at(folder))?;
    let (enough, too_few): (Vec<usize>, Vec<usize>) = (0..document.frames.len())
        .partition(|&index| equations(&document.frames[index]) >= UNKNOWNS);
    // Frames with too few clicks count as done at once.
    for _ in &too_few {
        if progress.report(()).is_break() {
            return Ok(Vec::new());
        }
    }
    let fields = FrameFields::Document(&fields);
    let Some(solved) = solve_frames(document, &enough, fields, record_if_solved, progress) else {
        return Ok(Vec::new());
    };
    // Frames that were not solved have too few clicks; the others get their outcome by index.
    let mut outcomes: Vec<SolveOutcome> = document
        .frames
        .iter()
        .map(|_| SolveOutcome::TooFewClicks)
        .collect();
    for (index, solved) in enough.into_iter().zip(solved) {
        outcomes[index] = match solved {
            Ok(()) => SolveOutcome::Solved,
            Err(CalibrationError::Solve(SolveError::TooFewObservations { .. })) => {
                SolveOutcome::TooFewClicks
            }
            Err(error) => SolveOutcome::Failed(error),
        };
    }
    Ok(outcomes)
}

/// Number of equations that the named clicks of a frame give; check clicks give none.
fn equations(frame: &Frame) -> usize {
    let used = frame.clicks.iter().filter(|click| !click.check);
    used.filter_map(|click| click.target.as_ref())
        .map(Target::equations)
        .sum()
}
