//! Every frame of a document, solved from its clicks.

use super::CalibrationError;
use super::solve_frames::{ShownFields, record_if_solved, solve_frames};
use std::path::Path;
use touchline_core::field::FieldError;
use touchline_core::progress::Progress;
use touchline_core::solve::SolveError;
use touchline_documents::document::{Document, Fields, Frame, Target};

/// Pan, tilt and focal length: as many equations are needed.
const UNKNOWNS: usize = 3;

/// How solving a frame ended.
#[derive(Debug)]
#[non_exhaustive]
pub enum SolveOutcome {
    /// The frame has its `ptz` and `solution` now.
    Solved,
    /// Its clicks are too few to say anything; it is as it was.
    TooFewClicks,
    /// Its clicks should be enough, but give no camera; it is as it was.
    Failed(CalibrationError),
}

/// Solves every frame with enough clicks, in parallel; statuses stay. `folder` is the document's;
/// `progress` hears of each frame, from any thread. One outcome for each frame, whatever the number
/// of threads; none at all where `progress` cancels this, which leaves the document as it was.
///
/// A frame whose clicks fit two cameras alike is decided by its neighbours, those that are solved
/// in the same run among them.
///
/// # Errors
/// The field of a frame is not valid.
pub fn solve_document(
    document: &mut Document,
    folder: &Path,
    progress: &Progress<'_, ()>,
) -> Result<Vec<SolveOutcome>, FieldError> {
    let fields = Fields::of(document.at(folder))?;
    let (enough, too_few): (Vec<usize>, Vec<usize>) = (0..document.frames.len())
        .partition(|&index| equations(&document.frames[index]) >= UNKNOWNS);
    for _ in &too_few {
        if progress.report(()).is_break() {
            return Ok(Vec::new());
        }
    }
    let fields = ShownFields::Document(&fields);
    let Some(solved) = solve_frames(document, &enough, fields, record_if_solved, progress) else {
        return Ok(Vec::new());
    };
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

/// How many equations the named clicks of a frame give; check clicks give none.
fn equations(frame: &Frame) -> usize {
    let used = frame.clicks.iter().filter(|click| !click.check);
    used.filter_map(|click| click.target.as_ref())
        .map(Target::equations)
        .sum()
}
