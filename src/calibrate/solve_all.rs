//! Every frame of a document, solved from its clicks.

use super::{CalibrationError, calibrate, warn_of_better_camera};
use crate::document::{Document, Fields, Frame, Target};
use crate::field::FieldError;
use crate::solve::{FrameSolution, SolveError};
use rayon::prelude::*;
use std::path::Path;

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

/// Solves every frame with enough clicks, in parallel; statuses stay. `folder` is the document's; `progress` is called
/// once for each frame, from any thread. One outcome for each frame, whatever the number of threads.
///
/// A frame whose clicks fit two cameras alike is decided by its neighbours, those that are solved in the same run among
/// them.
///
/// # Errors
/// The field of a frame is not valid.
pub fn solve_document(
    document: &mut Document,
    folder: &Path,
    progress: &(dyn Fn() + Sync),
) -> Result<Vec<SolveOutcome>, FieldError> {
    let fields = Fields::of(document.at(folder))?;
    let first: Vec<Attempt> = (0..document.frames.len())
        .into_par_iter()
        .map(|index| {
            let attempt = attempt(document, index, &fields);
            progress();
            attempt
        })
        .collect();
    record(document, &first);
    let undecided: Vec<usize> = first
        .iter()
        .enumerate()
        .filter(|(_, attempt)| matches!(attempt, Attempt::Done(Ok(solved)) if !solved.alternatives.is_empty()))
        .map(|(index, _)| index)
        .collect();
    let second: Vec<(usize, Attempt)> =
        undecided.into_par_iter().map(|index| (index, attempt(document, index, &fields))).collect();
    for (index, attempt) in &second {
        if let Attempt::Done(Ok(solved)) = attempt {
            document.frames[*index].record(solved);
        }
    }
    Ok(first
        .into_iter()
        .map(|attempt| match attempt {
            Attempt::TooFewClicks => SolveOutcome::TooFewClicks,
            Attempt::Done(Ok(_)) => SolveOutcome::Solved,
            Attempt::Done(Err(error)) => SolveOutcome::Failed(error),
        })
        .collect())
}

enum Attempt {
    TooFewClicks,
    Done(Result<Box<FrameSolution>, CalibrationError>),
}

fn attempt(document: &Document, index: usize, fields: &Fields) -> Attempt {
    let frame = &document.frames[index];
    if equations(frame) < UNKNOWNS {
        return Attempt::TooFewClicks;
    }
    let field = fields.of_frame(document, frame);
    match calibrate(document, frame, field, index) {
        Err(CalibrationError::Solve(SolveError::TooFewObservations { .. })) => Attempt::TooFewClicks,
        Ok(mut solved) => {
            warn_of_better_camera(document, frame, &mut solved, &fields.of_cameras(document));
            Attempt::Done(Ok(Box::new(solved)))
        }
        Err(error) => Attempt::Done(Err(error)),
    }
}

/// How many equations the named clicks of a frame give; check clicks give none.
fn equations(frame: &Frame) -> usize {
    let used = frame.clicks.iter().filter(|click| !click.check);
    used.filter_map(|click| click.target.as_ref()).map(Target::equations).sum()
}

fn record(document: &mut Document, attempts: &[Attempt]) {
    for (frame, attempt) in document.frames.iter_mut().zip(attempts) {
        if let Attempt::Done(Ok(solved)) = attempt {
            frame.record(solved);
        }
    }
}
