//! Whether a test frame looks where its references look, and how wide it looks.

use crate::report::paper::{FAILURES_BELOW_DEG, NO_FAILURE_ABOVE_DEG};
use crate::sets::{FrameSet, KnownFrame};
use touchline::geometry::Angle;
use touchline::score::horizontal_view;

/// The field of view of a frame, by the paper's two limits.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ViewBin {
    Narrow,
    Middle,
    Wide,
}

impl ViewBin {
    pub const ALL: [Self; 3] = [Self::Narrow, Self::Middle, Self::Wide];

    pub fn from_view_deg(view_deg: f64) -> Self {
        if view_deg < FAILURES_BELOW_DEG {
            Self::Narrow
        } else if view_deg <= NO_FAILURE_ABOVE_DEG {
            Self::Middle
        } else {
            Self::Wide
        }
    }

    /// Its name in files.
    pub const fn key(self) -> &'static str {
        match self {
            Self::Narrow => "narrow",
            Self::Middle => "middle",
            Self::Wide => "wide",
        }
    }

    /// Its name for readers.
    pub fn describe(self) -> String {
        match self {
            Self::Narrow => format!("below {FAILURES_BELOW_DEG}°"),
            Self::Middle => format!("{FAILURES_BELOW_DEG}° to {NO_FAILURE_ABOVE_DEG}°"),
            Self::Wide => format!("above {NO_FAILURE_ABOVE_DEG}°"),
        }
    }
}

/// Whether the middle of a test frame lies within the picture of one of its references, by pan;
/// `split` is the index of the split in which the frame was tested.
pub fn is_covered(set: &FrameSet, frame: usize, split: usize) -> bool {
    let pan = set.frames[frame].truth.ptz().pan;
    let references = &set.splits[split].training_frames;
    references.iter().any(|&reference| {
        let known = &set.frames[reference];
        // The difference of angles, which does not jump at ±180°.
        let away = pan.turn_from(known.truth.ptz().pan);
        away.radians().abs() <= 0.5 * view(known).radians()
    })
}

/// The horizontal field of view of a frame.
fn view(known: &KnownFrame) -> Angle {
    horizontal_view(known.truth.ptz().focal_px, known.features.image_size)
}
