//! What a person chooses in panels and on the filmstrip, as plain values.

use crate::document::CameraId;

/// How a click on the filmstrip adds to the selection.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Selecting {
    /// From the shown frame to this one, as far as the filter shows them.
    Range,
    /// This one too, or no longer.
    Toggle,
}

/// Which frames are meant.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Scope {
    /// The shown one.
    Frame,
    /// The selected ones.
    Selected,
    /// All of the shown frame's shot and camera.
    Shot,
    /// The shown one and all after it of its camera.
    Onwards,
}

impl Scope {
    /// Every scope, the smallest first.
    pub const ALL: [Self; 4] = [Self::Frame, Self::Selected, Self::Shot, Self::Onwards];

    /// What a person reads.
    #[must_use]
    pub const fn label(self) -> &'static str {
        match self {
            Self::Frame => "This frame",
            Self::Selected => "Selected frames",
            Self::Shot => "This shot",
            Self::Onwards => "From here on",
        }
    }
}

/// What time is counted in.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum TimeAxis {
    /// The frame's number in the document, from 1.
    #[default]
    Frame,
    /// Seconds of the video.
    Video,
}

/// What a person chose on the quality page.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct QualityChoice {
    /// The page takes the window.
    pub open: bool,
    /// The camera it speaks of; none: the shown frame's.
    pub camera: Option<CameraId>,
    /// What time is counted in.
    pub axis: TimeAxis,
    /// The part of the time that is shown; none: all of it.
    pub span: Option<[f64; 2]>,
}
