//! Refinement of the camera with and without lens distortion.

use crate::progress::Progress;
use crate::report::Report;
use crate::scoring::answers::{Tally, frame_table, tally_table};
use crate::scoring::forests::{ForestKind, Trained};
use crate::sets::SetKind;
use crate::{ExperimentError, SharedInputs};
use touchline::camera::{CameraBase, FocalCurve, PtzCamera};
use touchline::report::Cell;

/// Runs the experiment.
///
/// # Errors
/// The frames cannot be drawn or read.
pub fn run(inputs: &SharedInputs, progress: Progress) -> Result<Report, ExperimentError> {
    let set = inputs.distorted_set(progress)?;
    let mut report = Report::new("pose", &set.heading("Pose: with and without k1"));
    let lens = match set.kind {
        SetKind::Drawn => {
            "The lens bends strongly, and more at long focal lengths; low sun, motion blur, defocus and noise besides."
        }
        SetKind::Published | SetKind::Own => {
            "The lens is what the documents' cameras hold (`distortion`)."
        }
    };
    report.text(&format!(
        "Frames: {}. {lens} The rays that the forest has learnt are right in both cases; only \
         the optimisation differs. One seed, the default forest.",
        set.title
    ));
    let kind = ForestKind::Default;
    let (trained, asking) = (
        Trained::train(set, 0, &kind.training(set.seed)),
        kind.asking(set.seed),
    );
    // Position, rotation and principal point stay the true ones, so that k1 alone differs.
    let without = |truth: &PtzCamera| CameraBase {
        distortion: FocalCurve::NONE,
        ..*truth.base()
    };
    let answers = [trained.ask_plainly(&asking), trained.ask(&asking, &without)];
    let names = ["with k1", "without"];
    let tallies: Vec<(Cell, Tally)> = names
        .iter()
        .zip(&answers)
        .map(|(name, answers)| ((*name).into(), Tally::from_answers(answers.iter())))
        .collect();
    report.table(
        "k1",
        "Errors with and without k1.",
        tally_table(("optimisation", "optimisation"), &tallies),
    );
    let ways = names.into_iter().zip(answers.iter().map(Vec::as_slice));
    report.data(
        "frames",
        "Every frame, with and without k1.",
        frame_table(std::slice::from_ref(set), ways),
    );
    Ok(report)
}
