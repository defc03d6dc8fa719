//! `touchline solve`: pan, tilt and focal length of every frame with enough clicks.

use super::Outcome;
use super::document::{DocumentArg, DocumentOutput, Loaded};
use super::messages::Messages;
use crate::calibrate::{SolveOutcome, check_cameras, solve_document};
use crate::document::DocumentAt;

/// Solves every frame with enough clicks; statuses stay as they are.
#[derive(clap::Args, Debug)]
pub struct SolveArgs {
    #[command(flatten)]
    document: DocumentArg,
    #[command(flatten)]
    output: DocumentOutput,
}

/// Carries out the command.
///
/// # Errors
/// The document cannot be read, its field is not valid, or the result cannot be written.
pub fn solve(args: &SolveArgs, messages: Messages) -> anyhow::Result<Outcome> {
    args.output.refuse_existing()?;
    let Loaded { location, mut document } = args.document.load(messages)?;
    if let Some(hand) = document.hand_in_use() {
        messages.note(&hand.describe());
    }
    let bar = messages.progress(document.frames.len(), "Solving");
    let outcomes = solve_document(&mut document, location.folder(), &|| bar.inc(1))?;
    bar.finish_and_clear();
    let count = |wanted: fn(&SolveOutcome) -> bool| outcomes.iter().filter(|outcome| wanted(outcome)).count();
    let solved = count(|outcome| matches!(outcome, SolveOutcome::Solved));
    let passed = count(|outcome| matches!(outcome, SolveOutcome::TooFewClicks));
    for (frame, outcome) in document.frames.iter().zip(&outcomes) {
        if let SolveOutcome::Failed(error) = outcome {
            messages.frame_failed(&frame.name(), &error.to_string());
        }
    }
    report_cameras(document.at(location.folder()), messages);
    args.output.write(&document, location.folder())?;
    let failed = outcomes.len() - solved - passed;
    messages.note(&format!("{solved} frames solved, {failed} failed, {passed} with too few clicks"));
    Ok(if failed > 0 { Outcome::SomeFailed } else { Outcome::Done })
}

/// Tells of frames that fit another camera, and of cameras that stop fitting.
fn report_cameras(document: DocumentAt<'_>, messages: Messages) {
    for problem in check_cameras(document) {
        messages.note(&problem.to_string());
    }
}
