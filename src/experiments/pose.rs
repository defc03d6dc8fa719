//! The pose with and without distortion in the optimisation.

use super::answers::{Tally, ask, tally_table};
use super::progress::Progress;
use super::sets::SetKind;
use super::{ExperimentError, SharedInputs};
use crate::camera::{CameraBase, FocalCurve, PtzCamera};
use crate::relocalize::{RelocalizeOptions, TrainOptions};
use crate::report::{Cell, Report};

/// Runs the experiment.
///
/// # Errors
/// The frames cannot be had.
pub fn run(inputs: &SharedInputs, progress: Progress) -> Result<Report, ExperimentError> {
    let set = inputs.distorted(progress)?;
    let mut report = Report::new("pose", &set.heading("Pose: with and without k1"));
    let lens = match set.kind {
        SetKind::Drawn => {
            "The lens bends strongly, and more at long focal lengths; low sun, motion blur, defocus and noise besides."
        }
        SetKind::Published | SetKind::Own => "The lens is what the documents' cameras hold (`distortion`).",
    };
    report.text(&format!(
        "Frames: {}. {lens} The rays that the forest has learnt are right in both cases; only the optimisation differs.",
        set.title
    ));
    let training = TrainOptions { seed: inputs.options.seed, ..TrainOptions::default() };
    let mut asking = RelocalizeOptions::default();
    asking.pose.seed = inputs.options.seed;
    let without = |truth: &PtzCamera| CameraBase { distortion: FocalCurve::NONE, ..*truth.base() };
    let tallies: [(Cell, Tally); 2] = [
        ("with k1".into(), Tally::of(ask(set, &training, &asking, &|truth| *truth.base()).iter())),
        ("without".into(), Tally::of(ask(set, &training, &asking, &without).iter())),
    ];
    report.table("k1", "Errors with and without k1.", tally_table(("optimisation", "optimisation"), &tallies));
    Ok(report)
}
