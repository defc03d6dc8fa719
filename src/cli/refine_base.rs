//! `touchline refine-base`: the cameras' positions, base rotations and lenses from the clicks of all frames.

use super::Outcome;
use super::document::{DocumentArg, DocumentOutput, Loaded};
use super::messages::Messages;
use crate::calibrate::{
    BaseEstimationError, BaseProblem, EstimatedBase, SolveOutcome, describe_mirrored, describe_size, solve_document,
};
use crate::document::{CameraId, Document, DocumentAt};
use crate::solve::base::{BaseOptions, CrownModel, LensModel};
use clap::ValueEnum;
use std::ops::ControlFlow;

/// Camera position, base rotation, lens and the pitch's crown from the clicks of all frames but the rejected ones; every
/// frame is solved with them, statuses stay.
#[derive(clap::Args, Debug)]
pub struct RefineBaseArgs {
    #[command(flatten)]
    document: DocumentArg,
    #[command(flatten)]
    output: DocumentOutput,
    /// The lens; auto compares all by cross-validation.
    #[arg(long, value_enum, default_value_t = Distortion::Auto)]
    distortion: Distortion,
    /// How much higher the middle of the pitch is than its touchlines, m; auto finds it where that is worth it.
    #[arg(long, value_name = "auto|METRES", default_value = "auto", value_parser = crown, allow_negative_numbers = true)]
    crown: Crown,
    /// Also find the principal point (unstable with few frames).
    #[arg(long)]
    principal_point: bool,
    /// Also find the field's length and width, within what the rules allow (unstable with few frames).
    #[arg(long)]
    field_size: bool,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
enum Distortion {
    /// Chosen by cross-validation.
    Auto,
    /// A pinhole.
    None,
    /// One k₁ at every focal length.
    K1,
    /// k₁ linear in the focal length.
    K1Focal,
    /// The same with k₂ = 2 k₁², which folds at no focal length.
    K1FocalK2,
}

#[derive(Clone, Copy, Debug, PartialEq)]
enum Crown {
    Auto,
    Metres(f64),
}

fn crown(text: &str) -> Result<Crown, String> {
    if text == "auto" {
        return Ok(Crown::Auto);
    }
    let metres = text.parse().ok().filter(|metres: &f64| metres.is_finite());
    metres.map(Crown::Metres).ok_or_else(|| "auto or a number of metres".to_owned())
}

/// Carries out the command.
///
/// # Errors
/// The document cannot be read, no camera's base can be estimated, or the result cannot be written.
pub fn refine_base(args: &RefineBaseArgs, messages: Messages) -> anyhow::Result<Outcome> {
    args.output.refuse_existing()?;
    let Loaded { location, mut document } = args.document.load(messages)?;
    let before = document.clone();
    if let Some(noise) = document.click_noise_in_use() {
        messages.note(&noise.describe());
    }
    let options = BaseOptions {
        lens: match args.distortion {
            Distortion::Auto => None,
            Distortion::None => Some(LensModel::Pinhole),
            Distortion::K1 => Some(LensModel::K1),
            Distortion::K1Focal => Some(LensModel::K1Focal),
            Distortion::K1FocalK2 => Some(LensModel::K1FocalK2),
        },
        crown: match args.crown {
            Crown::Auto => None,
            Crown::Metres(metres) => Some(CrownModel::Fixed(metres)),
        },
        principal_point: args.principal_point,
        ..BaseOptions::default()
    };
    let cameras: Vec<CameraId> = document.cameras.iter().map(|camera| camera.id.clone()).collect();
    let mut estimates = Vec::new();
    let mut errors = Vec::new();
    for camera in &cameras {
        match estimate(document.at(location.folder()), camera, &options, args.field_size) {
            Ok(estimate) => estimates.push(estimate),
            Err(error) => errors.push(format!("camera {:?}: {error}", camera.as_str())),
        }
    }
    if estimates.is_empty() {
        anyhow::bail!(if errors.is_empty() { "the document has no camera".to_owned() } else { errors.join("; ") });
    }
    for error in &errors {
        messages.note(error);
    }
    for estimate in &estimates {
        report(estimate, &document, messages);
        estimate.write_camera(&mut document);
    }
    let bar = messages.progress(document.frames.len(), "Solving");
    let outcomes = solve_document(&mut document, location.folder(), &|| bar.inc(1))?;
    bar.finish_and_clear();
    let mut failed = errors.len();
    for (frame, outcome) in document.frames.iter().zip(&outcomes) {
        if let SolveOutcome::Failed(error) = outcome {
            messages.frame_failed(&frame.name(), &error.to_string());
            failed += 1;
        }
    }
    for estimate in &estimates {
        estimate.mark_disputes(&mut document);
    }
    document.count_edits_since(&before);
    args.output.write(&document, location.folder())?;
    let solved = outcomes.iter().filter(|outcome| matches!(outcome, SolveOutcome::Solved)).count();
    messages.note(&format!("{} cameras estimated, {solved} frames solved", estimates.len()));
    Ok(if failed > 0 { Outcome::SomeFailed } else { Outcome::Done })
}

/// The base of a camera; with `size` that of its field as well.
fn estimate(
    document: DocumentAt<'_>,
    camera: &CameraId,
    options: &BaseOptions,
    size: bool,
) -> Result<EstimatedBase, BaseEstimationError> {
    let problem = BaseProblem::of(document, camera)?;
    if size {
        problem.estimate_with_size(document, options, &|_| ControlFlow::Continue(()))
    } else {
        problem.estimate(&document, options)
    }
}

/// What was found, which models were compared, what disagrees.
fn report(estimated: &EstimatedBase, document: &Document, messages: Messages) {
    let found = &estimated.estimate;
    let name = estimated.camera.as_str();
    let (at, sigma, angles) = (found.base.position_m, found.base.sigma.position_m, found.base.angles());
    messages.note(&format!(
        "{name}: position ({:.2}, {:.2}, {:.2}) ± ({:.2}, {:.2}, {:.2}) m, pitch {:.2}, roll {:.2}",
        at.x, at.y, at.z, sigma.x, sigma.y, sigma.z, angles.pitch, angles.roll
    ));
    for score in &found.scores {
        let chosen = if score.model == found.model { " (chosen)" } else { "" };
        messages.note(&format!(
            "{name}: {}: {:.2} px cross-validated, 90 % {:.2} px{chosen}",
            score.model, score.median_px, score.p90_px
        ));
    }
    messages.note(&format!("{name}: {}: {}", found.model, found.reason));
    if let Some(frame) = &found.one_more_frame {
        messages.note(&format!("{name}: {frame}"));
    }
    let before = found.previous_median_px.map_or_else(String::new, |before| format!(", {before:.2} px before"));
    messages.note(&format!(
        "{name}: all clicks {:.2} px, 90 % {:.2} px{before}; crown {:.2} m",
        found.median_px, found.p90_px, found.crown_m
    ));
    for size in &estimated.sizes {
        messages.note(&format!("{name}: field {}", describe_size(size)));
    }
    if let Some(reason) = found.one_view() {
        messages.note(&format!("{name}: {reason}"));
    }
    let frame_name = |index: usize| document.frames[index].name();
    for click in &found.disputed {
        let error = click.error_px.map_or_else(|| "behind the camera".to_owned(), |error| format!("{error:.0} px off"));
        let better = click.fits_better.as_ref().map_or_else(String::new, |(id, _)| format!(", {id} would fit"));
        messages.note(&format!("{}: point {} is {error}{better}", frame_name(click.frame), click.click + 1));
    }
    for frame in &found.mirrored {
        let words = describe_mirrored(frame);
        messages.note(&format!("{}: the names look mirrored: {words}", frame_name(frame.frame)));
    }
}
