//! `touchline solve`: finds pan, tilt and focal length of every frame with enough clicks.

use super::Outcome;
use crate::cli::terminal::document::{DocumentArg, DocumentOutput, Loaded};
use crate::cli::terminal::messages::{Messages, count_steps};
use std::path::Path;
use touchline_calibration::calibrate::{
    DecidedFrames, SolveOutcome, check_cameras, check_frame, record_line_check, solve_document_with,
};
use touchline_calibration::proposals::{FramePicture, PictureStream};
use touchline_core::geometry::pluralise;
use touchline_documents::document::{Document, DocumentAt, Fields, FrameStatus};

/// Solves every frame with enough clicks; statuses stay as they are. A camera that was set by hand,
/// aligned to paint or accepted from another source stays, too. New frames with points of a model
/// alone become suggestions.
#[derive(clap::Args, Debug)]
pub struct SolveArgs {
    #[command(flatten)]
    document: DocumentArg,
    #[command(flatten)]
    output: DocumentOutput,
    /// Also check each solved camera against the painted lines of its picture; the result is
    /// written into its solution.
    #[arg(long)]
    line_check: bool,
    #[command(flatten)]
    decided: DecidedArg,
}

/// Whether decided frames are solved.
#[derive(clap::Args, Debug)]
pub(super) struct DecidedArg {
    /// Also solve frames whose camera was set by hand, aligned to paint or accepted from another
    /// source, and replace it.
    #[arg(long)]
    replace_decided: bool,
}

impl From<&DecidedArg> for DecidedFrames {
    fn from(arg: &DecidedArg) -> Self {
        if arg.replace_decided {
            Self::Replace
        } else {
            Self::Keep
        }
    }
}

/// Solves the document and writes it. [`Outcome::SomeFailed`] if a frame with enough clicks has no
/// solution.
///
/// # Errors
/// The document cannot be read, its field is invalid, or the result cannot be written.
pub fn solve(args: &SolveArgs, messages: Messages) -> anyhow::Result<Outcome> {
    let input = &args.document.document;
    let output = args.output.reserve("solve", &[input], messages)?;
    let Loaded {
        location,
        mut document,
    } = output.read(input)?;
    let before = document.clone();
    if let Some(noise) = document.click_noise_in_use() {
        messages.note(&noise.describe());
    }
    let SolveCounts {
        solved,
        failed,
        passed,
    } = solve_and_report(
        &mut document,
        location.folder(),
        (&args.decided).into(),
        messages,
    )?;
    if args.line_check {
        check_lines(&mut document, location.folder(), messages)?;
    }
    report_cameras(document.at(location.folder()), messages);
    document.count_edits_since(&before);
    drop(before);
    output.write(document, location.folder())?;
    messages.note(&format!(
        "{} solved, {failed} failed, {passed} with too few clicks",
        pluralise(solved, "frame")
    ));
    Ok(Outcome::from_failure(failed > 0))
}

/// How many frames became what.
#[derive(Default)]
pub(super) struct SolveCounts {
    /// Frames with a solution.
    pub solved: usize,
    /// Frames whose clicks should suffice but give no camera.
    pub failed: usize,
    /// Frames with too few clicks.
    pub passed: usize,
}

/// Solves the document's frames. Counts the outcomes, and reports each frame that fails.
///
/// # Errors
/// The field is invalid.
pub(super) fn solve_and_report(
    document: &mut Document,
    folder: &Path,
    decided: DecidedFrames,
    messages: Messages,
) -> anyhow::Result<SolveCounts> {
    let bar = messages.progress(document.frames.len(), "Solving");
    let outcomes = solve_document_with(document, folder, decided, &count_steps(&bar))?;
    bar.finish_and_clear();
    let mut counts = SolveCounts::default();
    let mut kept = 0;
    let mut failures = Vec::new();
    for (frame, outcome) in document.frames.iter().zip(&outcomes) {
        match outcome {
            SolveOutcome::Solved => counts.solved += 1,
            SolveOutcome::Kept => kept += 1,
            SolveOutcome::Failed(error) => {
                counts.failed += 1;
                failures.push((frame.name(), error));
            }
            _ => counts.passed += 1,
        }
    }
    messages.frames_failed(failures);
    if kept > 0 {
        messages.note(&format!(
            "{} with enough clicks kept as decided: the camera was set by hand, aligned to paint \
             or accepted from another source; --replace-decided solves them, too",
            pluralise(kept, "frame")
        ));
    }
    Ok(counts)
}

/// Compares every solved frame with the painted lines in its picture and records the result in it.
/// Reports pictures that cannot be read.
fn check_lines(document: &mut Document, folder: &Path, messages: Messages) -> anyhow::Result<()> {
    let fields = Fields::from_document(document.at(folder))?;
    let bar = messages.progress(document.frames.len(), "Checking the lines");
    // Pictures are read by a copy, because results are written while they are read. It shares its
    // frames with the document.
    let solved = document.clone();
    let checked = (0..solved.frames.len()).filter(|&index| {
        let frame = &solved.frames[index];
        frame.ptz.is_some() && frame.status != FrameStatus::Rejected
    });
    for FramePicture {
        index,
        frame,
        picture,
    } in PictureStream::new(solved.at(folder), checked)
    {
        bar.set_position(index as u64 + 1);
        match picture {
            Ok(picture) => {
                let field = fields.for_frame(document, frame);
                if let Some(check) = check_frame(document, frame, field, &picture) {
                    record_line_check(&mut document.frames[index], &check);
                }
            }
            // The frame is solved. Only the check is missing, which is no failure of the command.
            Err(error) => messages.note(&format!(
                "{}: its lines were not checked: {error}",
                frame.name()
            )),
        }
    }
    bar.finish_and_clear();
    Ok(())
}

/// Reports frames that fit another camera better, and cameras that stop fitting at some frame.
fn report_cameras(document: DocumentAt<'_>, messages: Messages) {
    for problem in check_cameras(document) {
        messages.note(&problem.to_string());
    }
}
