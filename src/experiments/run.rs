//! Experiments by name.

use super::progress::Progress;
use super::{
    Experiment, ExperimentError, Workshop, baselines, descriptors, homographies, motion, pose, ransac, relocalization,
    synthetic,
};
use crate::report::Report;

impl Experiment {
    /// Runs it.
    ///
    /// # Errors
    /// What it needs is missing or cannot be read.
    pub fn run(self, workshop: &Workshop, progress: Progress) -> Result<Report, ExperimentError> {
        match self {
            Self::Synthetic => Ok(synthetic::run(&workshop.options, progress)),
            Self::Ransac => Ok(ransac::run(&workshop.options, progress)),
            Self::Highlights => relocalization::highlights(workshop, progress),
            Self::Worldcup => relocalization::worldcup(workshop, progress),
            Self::Errors => relocalization::errors(workshop, progress),
            Self::Threshold => relocalization::threshold(workshop, progress),
            Self::Trees => relocalization::trees(workshop, progress),
            Self::Fov => relocalization::fov(workshop, progress),
            Self::Baselines => baselines::run(workshop, progress),
            Self::Descriptors => descriptors::run(workshop, progress),
            Self::Pose => pose::run(workshop, progress),
            Self::Homographies => homographies::run(&workshop.options, &workshop.given_for(self)?, progress),
            Self::Motion => motion::run(&workshop.options, &workshop.given_for(self)?, progress),
        }
    }
}
