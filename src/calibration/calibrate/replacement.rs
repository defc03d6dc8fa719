//! The rule by which a machine's answer takes the place of an earlier one: tracked, aligned to
//! paint, or proposed by a forest.
//!
//! Both answers are held against the same picture, and the check of the new one is made where it
//! ended. A check of before an adjustment says nothing of what came of it.

use touchline_vision::paint::LineCheck;

/// The scores of two cameras that are the same answer differ by at most about this much, because
/// paint is found to half a pixel.
const SCORE_NOISE: f64 = 0.05;

/// Whether an answer may take the place of an earlier one by what the same paint says of both: it
/// is as probable, as far as paint can tell.
pub(crate) fn may_replace(earlier: &LineCheck, now: &LineCheck) -> bool {
    now.score >= earlier.score - SCORE_NOISE
}
