//! What clip tracking says to the user: its progress, and how many frames it found.

use touchline_calibration::calibrate::{ClipProgress, TrackedClip};
use touchline_core::geometry::pluralise;

/// The progress of a tracking, as text.
pub(in crate::app::operations) fn describe_progress(progress: &ClipProgress) -> String {
    match progress {
        ClipProgress::Following(done, of) => format!("Following points: frame {done} of {of}"),
        ClipProgress::Painting(done, of) => {
            format!("Looking at painted lines: {done} of {of} frames")
        }
        ClipProgress::Adjusting => "Adjusting all frames of the shot together".to_owned(),
    }
}

/// The share of a tracking's present step that is done, 0 to 1; none if it is unknown.
pub(in crate::app::operations) fn share_of(progress: &ClipProgress) -> Option<f32> {
    match progress {
        ClipProgress::Following(done, of) | ClipProgress::Painting(done, of) => {
            Some(*done as f32 / (*of).max(1) as f32)
        }
        ClipProgress::Adjusting => None,
    }
}

/// The result of tracking again after a correction, as text.
pub(super) fn describe_followed(taken: usize) -> String {
    match taken {
        0 => "No other frame of the shot follows this correction.".to_owned(),
        1 => "1 other frame of the shot follows this correction.".to_owned(),
        many => format!("{many} other frames of the shot follow this correction."),
    }
}

/// The result of tracking, as text.
pub(super) fn describe_tracked(tracked: &TrackedClip, taken: usize) -> String {
    let got = match taken {
        1 => "1 frame got its camera".to_owned(),
        many => format!("{many} frames got their cameras"),
    };
    let painted = match tracked.painted {
        0 => String::new(),
        many => format!("; {many} also checked against their painted lines"),
    };
    let ended = if let Some(stop) = tracked.stops.first() {
        format!(
            ". It stopped at {}: only {} of {} points agree",
            stop.picture, stop.agreeing, stop.seen
        )
    } else if tracked.missed.is_empty() {
        String::new()
    } else {
        let count = tracked.missed.len();
        let were = if count == 1 { "was" } else { "were" };
        format!("; {} {were} not reached", pluralise(count, "frame"))
    };
    format!("{got}{painted}{ended}.")
}
