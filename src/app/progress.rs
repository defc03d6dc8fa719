//! Messages after accepting a frame, and when nothing is left to do.

use super::derived::FrameCounts;
use super::review::Review;
use super::where_to_label::where_to_label;
use crate::calibrate::WIDE_FRAMES;

/// The message after a frame has been accepted.
#[must_use]
pub fn just_accepted(counts: &FrameCounts, review: &Review, used_for_training: bool) -> String {
    let (left, references) = (counts.need_me, counts.used_for_training);
    let plural = if references == 1 { "" } else { "s" };
    match (left, WIDE_FRAMES.saturating_sub(references)) {
        (0, _) => nothing_needs_you(review),
        _ if !used_for_training => format!("Accepted (not used for training), {left} left."),
        (_, 0) => format!("Reference saved: {references} reference{plural}, {left} left."),
        (_, missing) => {
            format!("Reference saved. {missing} more, spread left to right, and proposals become useful.")
        }
    }
}

/// Nothing needs the user, or what is left to label.
#[must_use]
pub fn nothing_needs_you(review: &Review) -> String {
    match where_to_label(&review.advice) {
        Some(advice) => format!("Nothing needs you. {advice}"),
        None => "Nothing needs you.".to_owned(),
    }
}
