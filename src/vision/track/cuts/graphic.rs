//! Wipes with a graphic: a logo or a picture that covers the old shot and uncovers the new one.

use super::gradual::{CHANGED, Frames, LEAST_CHANGE, LEAST_CHANGED_SHARE};
use super::{CutFinder, LEAST_CUT, in_order};
use std::ops::Range;

/// In a wipe with a graphic, frames that change as in a cut are at most this far apart, frames.
const GRAPHIC_GAP: usize = 3;
/// Minimum number of such frames, and the maximum length of the wipe.
const LEAST_GRAPHIC: usize = 3;
pub const MOST_GRAPHIC: usize = 50;
/// Minimum of the largest difference within such a wipe, grey levels.
const GRAPHIC_PEAK: f32 = 8.0;
/// Maximum of that difference, relative to the difference of the pictures before and after.
const MOST_OF_GRAPHIC: f32 = 0.8;
/// Maximum length of such a wipe of which nearly each frame changes as in a cut, frames.
const MOST_WITHOUT_LULL: usize = 24;
/// Number of frames before and after such a wipe that tell the usual motion, and the minimum ratio
/// of the differences within it to those.
const AROUND_GRAPHIC: usize = 8;
const GRAPHIC_OVER_MOTION: f32 = 2.0;

impl CutFinder {
    /// The wipe with a graphic whose last change is at this frame: the first frame of the new shot.
    pub fn graphic_until(&self, end: usize) -> Option<Range<usize>> {
        let is_violent = |at: usize| self.measured[at].step >= LEAST_CUT;
        let after = end + 1..(end + 1 + GRAPHIC_GAP).min(self.measured.len());
        if !is_violent(end) || after.clone().any(is_violent) {
            return None;
        }
        let (mut start, mut count, mut peak) = (end, 0, 0.0_f32);
        for at in (end.saturating_sub(MOST_GRAPHIC + GRAPHIC_GAP)..=end).rev() {
            if start - at > GRAPHIC_GAP {
                break;
            }
            if is_violent(at) {
                (start, count) = (at, count + 1);
                peak = peak.max(self.measured[at].step);
            }
        }
        // A run that goes on for longer, or without a lull, is a picture that moves fast.
        let length = end + 1 - start;
        if length > MOST_WITHOUT_LULL && 10 * count >= 9 * length {
            return None;
        }
        if count < LEAST_GRAPHIC || peak < GRAPHIC_PEAK || end - start > MOST_GRAPHIC {
            return None;
        }
        let (before, after) = (self.frame(start.checked_sub(1)?)?, self.frame(end)?);
        let change = before.difference(after);
        // One frame that brings the whole change is a hard cut in a picture that moves fast, and a
        // picture that moves as fast before or after is a close-up.
        let around = start.saturating_sub(AROUND_GRAPHIC)..start;
        let beyond = end + 1..(end + 1 + AROUND_GRAPHIC).min(self.measured.len());
        let usual = self.quiet_step(around).max(self.quiet_step(beyond));
        let is_graphic = change >= LEAST_CHANGE
            && before.share_of_changed_cells(after, CHANGED) >= LEAST_CHANGED_SHARE
            && peak < MOST_OF_GRAPHIC * change
            && peak >= GRAPHIC_OVER_MOTION * usual;
        is_graphic.then_some(start..end)
    }

    /// The lower quartile of the differences of some frames from the previous one; 0 for none.
    fn quiet_step(&self, frames: Range<usize>) -> f32 {
        let steps = in_order(frames.map(|at| self.measured[at].step));
        steps.get(steps.len() / 4).copied().unwrap_or_default()
    }
}
