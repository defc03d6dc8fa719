//! Messages after accepting a frame, and when nothing is left to do.

use crate::app::project::derived::FrameCounts;
use touchline_calibration::calibrate::WIDE_FRAMES;
use touchline_documents::document::FrameStatus;

/// Every frame is accepted or rejected.
pub const ALL_DONE: &str = "All done: every frame is accepted or rejected.";

/// The message after a frame was accepted.
pub fn just_accepted(counts: &FrameCounts, used_for_training: bool) -> String {
    let (left, references) = (counts.to_do, counts.used_for_training);
    let plural = if references == 1 { "" } else { "s" };
    match (left, missing_references(counts)) {
        (0, _) => ALL_DONE.to_owned(),
        _ if !used_for_training => format!("Accepted. {left} to do."),
        (_, 0) => format!("Reference saved: {references} reference{plural}, {left} to do."),
        (_, missing) => {
            format!(
                "Reference saved. {missing} more, spread left to right, and proposals become useful."
            )
        }
    }
}

/// Number of references that are missing until proposals become useful. Zero as soon as there are
/// proposals.
pub fn missing_references(counts: &FrameCounts) -> usize {
    let has_proposals = counts.count_with_status(FrameStatus::Suggested) > 0;
    if has_proposals {
        0
    } else {
        WIDE_FRAMES.saturating_sub(counts.used_for_training)
    }
}
