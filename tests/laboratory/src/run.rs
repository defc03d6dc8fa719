//! Runs an experiment by its name.

use super::progress::Progress;
use super::{Experiment, ExperimentError, SharedInputs, ransac};
use crate::report::Report;
use crate::studies::{
    annotator, assumptions, baselines, descriptors, errors, fov, homographies, motion, pose,
    sequences, synthetic, threshold, trees,
};

impl Experiment {
    /// Runs the experiment.
    ///
    /// # Errors
    /// Its data is missing or cannot be read, or its frames cannot be drawn.
    pub fn run(self, inputs: &SharedInputs, progress: Progress) -> Result<Report, ExperimentError> {
        match self {
            Self::Synthetic => Ok(synthetic::run(&inputs.options, progress)),
            Self::Ransac => Ok(ransac::run(&inputs.options, progress)),
            Self::Highlights => sequences::highlights(inputs, progress),
            Self::Assumptions => assumptions::run(inputs, progress),
            Self::Worldcup => sequences::worldcup(inputs, progress),
            Self::Errors => errors::run(inputs, progress),
            Self::Threshold => threshold::run(inputs, progress),
            Self::Trees => trees::run(inputs, progress),
            Self::Fov => fov::run(inputs, progress),
            Self::Baselines => baselines::run(inputs, progress),
            Self::Descriptors => descriptors::run(inputs, progress),
            Self::Pose => pose::run(inputs, progress),
            Self::Homographies => {
                homographies::run(&inputs.options, &inputs.data_folder(self)?, progress)
            }
            Self::Annotator => annotator::run(
                &inputs.options,
                inputs.data_folder(self).ok().as_deref(),
                progress,
            ),
            Self::Motion => motion::run(&inputs.options, &inputs.data_folder(self)?, progress),
        }
    }
}
