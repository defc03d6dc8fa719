//! How a pose is looked for: what the search for a consensus and the refinement over it share.

use touchline_core::camera::Ptz;
use touchline_core::geometry::ImageSize;
use touchline_core::solve::PtzRanges;

/// Steps (rad, rad, log f) that end a refinement: a thousandth of what the features leave open.
pub(super) const ENOUGH: f64 = 1e-8;

/// Fewer agreeing features than this are chance, whatever else.
pub(super) const MIN_INLIERS: usize = 6;

/// How a pose is looked for.
#[derive(Clone, Debug, PartialEq)]
pub struct PoseOptions {
    /// A feature agrees with a camera within this distance, px at 1920 px width. 6 by default.
    pub agreement_px: f64,
    /// Pan, tilt and focal length outside are no answer; none takes what any camera could do.
    pub ranges: Option<PtzRanges>,
    /// Hypotheses at most. 4000 by default; few features that agree need many.
    pub max_hypotheses: usize,
    /// The search ends when a better camera would have been missed with this probability. 0.001 by
    /// default.
    pub miss_probability: f64,
    /// Answers that are right with less than this probability are "not found". 0.5 by default.
    pub min_confidence: f64,
    /// Where chance starts.
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
    /// Whether an answer lies where the camera may be.
    pub(super) fn allows(&self, ptz: &Ptz, image_size: ImageSize) -> bool {
        match &self.ranges {
            Some(ranges) => ranges.contains(ptz),
            None => PtzRanges::for_width(image_size.width).contains(ptz),
        }
    }
}
