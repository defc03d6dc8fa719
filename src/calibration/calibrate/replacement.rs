//! When a computed camera (tracked, aligned to paint, or proposed by a forest) replaces an earlier
//! one.
//!
//! Both are compared with the same picture, and the new one is checked where its adjustment ended:
//! a check made before an adjustment does not apply to its result.

use touchline_vision::paint::LineCheck;

/// The scores of two cameras that are the same answer differ by at most about this, because paint
/// is localised to half a pixel.
const SCORE_NOISE: f64 = 0.05;

/// Whether a camera may replace an earlier one, given the checks of both on the same paint: it must
/// be as probable, within the noise of the score.
pub(crate) fn may_replace(earlier: &LineCheck, now: &LineCheck) -> bool {
    now.score >= earlier.score - SCORE_NOISE
}
