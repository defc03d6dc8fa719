//! Options of the pose search, shared by consensus and refinement.

use touchline_core::camera::Ptz;
use touchline_core::geometry::ImageSize;
use touchline_core::solve::PtzRanges;

/// Refinement ends when a step in (pan rad, tilt rad, ln f) is below this: a thousandth of the
/// uncertainty that features leave.
pub(super) const SHORT_STEP: f64 = 1e-8;

/// Minimum number of inliers; fewer are chance.
pub(super) const MIN_INLIERS: usize = 6;

/// Options of the pose search.
#[derive(Clone, Debug, PartialEq)]
pub struct PoseOptions {
    /// Inlier threshold, px at 1920 px width. Default: 6.
    pub agreement_px: f64,
    /// Allowed pan, tilt and focal length; `None` allows all that any camera could have.
    pub ranges: Option<PtzRanges>,
    /// Maximum number of hypotheses. Default: 4000; a small share of inliers needs many.
    pub max_hypotheses: usize,
    /// The search ends when the probability of having missed a better camera is below this.
    /// Default: 0.001.
    pub miss_probability: f64,
    /// Answers below this probability are "not found". Default: 0.5.
    pub min_confidence: f64,
    /// Seed of the random draws.
    pub seed: u64,
}

impl Default for PoseOptions {
    fn default() -> Self {
        Self {
            agreement_px: 6.0,
            ranges: None,
            max_hypotheses: 4000,
            miss_probability: 1e-3,
            min_confidence: 0.5,
            seed: 0,
        }
    }
}

impl PoseOptions {
    /// Whether an answer is within the allowed ranges.
    pub(super) fn allows(&self, ptz: &Ptz, image_size: ImageSize) -> bool {
        match &self.ranges {
            Some(ranges) => ranges.contains(ptz),
            None => PtzRanges::for_size(image_size).contains(ptz),
        }
    }
}
