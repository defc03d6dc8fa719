//! Minima of the joint adjustment beside the one that a hypothesis lies in, on fields of other
//! sizes.
//!
//! A camera that stands nearer and looks with a shorter focal length sees nearly the same picture,
//! and so does one in front of a smaller field. What tells them apart is perspective, which is
//! weakest from low cameras and with long lenses; the radial distortion, which is free as well,
//! takes up much of the rest. So the adjustment has several minima in a row, and least squares does
//! not leave one: it is started again beside it.

use super::hypothesis::{Hypothesis, MIN_GAIN_NATS};
use super::joint::JointStart;
use crate::autocalibrate::field_prior::FieldPrior;
use crate::autocalibrate::frames::matched_frames::MatchedFrames;
use rayon::prelude::*;

/// Moves a hypothesis to a neighbouring field size as long as that raises the evidence by
/// [`MIN_GAIN_NATS`].
///
/// Least squares alone does not get there: while paint is assigned to the wrong lines, the size
/// that fits best is the wrong one.
pub fn try_neighbouring_sizes(
    hypothesis: &mut Hypothesis,
    field_prior: &FieldPrior,
    matched: &MatchedFrames,
) {
    const MAX_STEPS: usize = 3;
    for _ in 0..MAX_STEPS {
        // Adjust at each neighbouring size, starting from the present base and frames.
        let neighbours: Vec<Hypothesis> = field_prior
            .neighbouring_sizes(&hypothesis.camera.field)
            .into_par_iter()
            .filter_map(|field| {
                let (base, ptz) = (hypothesis.camera.base, hypothesis.ptz.clone());
                let start = JointStart { field, base, ptz };
                Hypothesis::adjust(&start, Some(field_prior), &hypothesis.frames, matched)
            })
            .collect();
        match neighbours
            .into_iter()
            .max_by(|a, b| a.nats().total_cmp(&b.nats()))
        {
            Some(best) if best.nats() > hypothesis.nats() + MIN_GAIN_NATS => *hypothesis = best,
            _ => return,
        }
    }
}
