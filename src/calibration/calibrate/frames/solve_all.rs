//! Solves all frames of a document from their clicks.

use super::solve_frames::{FrameFields, record_if_solved, solve_frames};
use crate::calibrate::CalibrationError;
use std::path::Path;
use touchline_core::field::FieldError;
use touchline_core::progress::Progress;
use touchline_core::solve::SolveError;
use touchline_documents::document::{Document, Fields, Frame, FrameStatus, SolutionSource, Target};

/// Pan, tilt and focal length: the minimum number of equations.
const UNKNOWNS: usize = 3;

/// The result of solving a frame.
#[derive(Debug)]
#[non_exhaustive]
pub enum SolveOutcome {
    /// The frame has its `ptz` and `solution`.
    Solved,
    /// Its camera was decided otherwise than by its clicks, and was not changed.
    Kept,
    /// It has too few clicks for a camera and was not changed.
    TooFewClicks,
    /// Its clicks should suffice but give no camera; it was not changed.
    Failed(CalibrationError),
}

/// What becomes of frames whose camera was [decided](is_decided) otherwise than by their clicks.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum DecidedFrames {
    /// They keep it.
    #[default]
    Keep,
    /// They are solved like all others.
    Replace,
}

/// Whether the camera of a frame was decided otherwise than by its clicks: set by hand, aligned to
/// paint, or accepted from another source.
pub fn is_decided(frame: &Frame) -> bool {
    let source = frame.solution.as_ref().and_then(|solution| solution.source);
    frame.ptz.is_some()
        && match source {
            // A camera of unknown source is taken for one from clicks.
            None | Some(SolutionSource::Clicks | SolutionSource::Points) => false,
            Some(SolutionSource::Manual | SolutionSource::Markings) => true,
            Some(
                SolutionSource::Forest
                | SolutionSource::Tracking
                | SolutionSource::Import
                | SolutionSource::Interpolated,
            ) => frame.status == FrameStatus::Reference,
        }
}

/// Solves every frame with enough clicks as [`solve_document_with`] does; decided frames keep their
/// camera.
///
/// # Errors
/// The field of a frame is not valid.
pub fn solve_document(
    document: &mut Document,
    folder: &Path,
    progress: &Progress<'_, ()>,
) -> Result<Vec<SolveOutcome>, FieldError> {
    solve_document_with(document, folder, DecidedFrames::Keep, progress)
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
pub fn solve_document_with(
    document: &mut Document,
    folder: &Path,
    decided: DecidedFrames,
    progress: &Progress<'_, ()>,
) -> Result<Vec<SolveOutcome>, FieldError> {
    let fields = Fields::from_document(document.at(folder))?;
    let is_kept = |frame: &Frame| decided == DecidedFrames::Keep && is_decided(frame);
    let (mut enough, too_few): (Vec<usize>, Vec<usize>) = (0..document.frames.len())
        .partition(|&index| equations(&document.frames[index]) >= UNKNOWNS);
    let kept: Vec<usize> = enough
        .extract_if(.., |index| is_kept(&document.frames[*index]))
        .collect();
    // Frames that are not solved count as done at once.
    for _ in too_few.iter().chain(&kept) {
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
    for index in kept {
        outcomes[index] = SolveOutcome::Kept;
    }
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

#[cfg(test)]
mod tests {
    use super::*;
    use touchline_core::camera::Ptz;
    use touchline_core::geometry::ImageSize;
    use touchline_core::testing::{TestBase, base_at, soccer};
    use touchline_documents::document::{Click, FramePtz, Solution};
    use touchline_documents::testing::match_from;
    use touchline_documents::testing::new_frame;

    #[test]
    fn decided_cameras_are_replaced_only_on_request() {
        let (size, field) = (ImageSize::new(1280, 720), soccer());
        let base = base_at([0.0, -66.0, 18.0], size);
        let shown = base.aim(2.0, -14.0, 1300.0);
        let set = Ptz::from_degrees(3.0, -15.0, 1400.0);
        let mut document = match_from(&base, size);
        for (number, (status, source)) in [
            (FrameStatus::Reference, Some(SolutionSource::Clicks)),
            (FrameStatus::Draft, Some(SolutionSource::Manual)),
            (FrameStatus::Reference, Some(SolutionSource::Markings)),
            (FrameStatus::Reference, Some(SolutionSource::Import)),
            (FrameStatus::Draft, Some(SolutionSource::Import)),
            (FrameStatus::Reference, None),
        ]
        .into_iter()
        .enumerate()
        {
            let mut frame = new_frame(&number.to_string(), size);
            for name in ["centre_mark", "halfway_near", "halfway_far"] {
                let landmark = field.landmark(name).unwrap();
                let at = shown.image_from_world(field.world_from_nominal(landmark.nominal_m));
                if let Ok(at) = at {
                    frame.clicks.push(Click::landmark(name.into(), at));
                }
            }
            frame.status = status;
            frame.ptz = Some(FramePtz::new(set, None));
            frame.solution = Some(Solution {
                source,
                ..Solution::default()
            });
            document.frames.push(frame.into());
        }
        let kept_by = |decided: DecidedFrames| {
            let mut solved = document.clone();
            let outcomes =
                solve_document_with(&mut solved, Path::new(""), decided, &Progress::default())
                    .unwrap();
            let kept = solved.frames.iter().zip(&outcomes).map(|(frame, outcome)| {
                let is_kept = matches!(outcome, SolveOutcome::Kept);
                assert_eq!(
                    is_kept,
                    frame.ptz == Some(FramePtz::new(set, None)),
                    "{outcome:?}"
                );
                is_kept
            });
            kept.collect::<Vec<bool>>()
        };
        assert_eq!(
            kept_by(DecidedFrames::Keep),
            [false, true, true, true, false, false]
        );
        assert_eq!(kept_by(DecidedFrames::Replace), [false; 6]);
    }
}
