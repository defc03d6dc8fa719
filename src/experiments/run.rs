//! Experiments by name.

use super::progress::Progress;
use super::{
    Experiment, ExperimentError, SharedInputs, annotator, baselines, descriptors, homographies, motion, pose, ransac,
    relocalization, synthetic,
};
use crate::report::Report;

impl Experiment {
    /// Runs it.
    ///
    /// # Errors
    /// What it needs is missing or cannot be read.
    pub fn run(self, inputs: &SharedInputs, progress: Progress) -> Result<Report, ExperimentError> {
        match self {
            Self::Synthetic => Ok(synthetic::run(&inputs.options, progress)),
            Self::Ransac => Ok(ransac::run(&inputs.options, progress)),
            Self::Highlights => relocalization::highlights(inputs, progress),
            Self::Worldcup => relocalization::worldcup(inputs, progress),
            Self::Errors => relocalization::errors(inputs, progress),
            Self::Threshold => relocalization::threshold(inputs, progress),
            Self::Trees => relocalization::trees(inputs, progress),
            Self::Fov => relocalization::fov(inputs, progress),
            Self::Baselines => baselines::run(inputs, progress),
            Self::Descriptors => descriptors::run(inputs, progress),
            Self::Pose => pose::run(inputs, progress),
            Self::Homographies => homographies::run(&inputs.options, &inputs.given_for(self)?, progress),
            Self::Annotator => annotator::run(&inputs.options, inputs.given_for(self).ok().as_deref(), progress),
            Self::Motion => motion::run(&inputs.options, &inputs.given_for(self)?, progress),
        }
    }
}
