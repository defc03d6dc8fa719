//! The user's choices in panels and on the filmstrip, as plain values.

use touchline_documents::document::CameraId;

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

/// A camera of the document, or one to be made.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum CameraChoice {
    /// The document has it.
    Known(CameraId),
    /// It gets this name, and pictures like those of the shown frame's camera.
    New(CameraId),
}

/// One of the lists of masks that cover a frame.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum MaskList {
    /// Those of the camera for all of its frames.
    Camera,
    /// Those of the camera that have a range of frames, or were found.
    Ranged,
    /// Those of the frame alone.
    Frame,
}

/// Which frames a mask is to cover.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum MaskScope {
    /// Every frame of the camera.
    All,
    /// The shown frame's shot.
    Shot,
    /// The frames that are selected on the filmstrip; of a video all between the first and the
    /// last.
    Selected,
    /// The shown frame of a video and those after it.
    FromHere,
    /// The shown frame of a video and those before it.
    UpToHere,
    /// The shown frame alone.
    Frame,
}

impl MaskScope {
    /// Every scope, the largest first.
    pub const ALL: [Self; 6] = [
        Self::All,
        Self::Shot,
        Self::Selected,
        Self::FromHere,
        Self::UpToHere,
        Self::Frame,
    ];

    /// What a person reads.
    #[must_use]
    pub const fn label(self) -> &'static str {
        match self {
            Self::All => "Every frame",
            Self::Shot => "This shot",
            Self::Selected => "Selected frames",
            Self::FromHere => "From this frame on",
            Self::UpToHere => "Up to this frame",
            Self::Frame => "This frame",
        }
    }
}

/// What time is counted in.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum TimeAxis {
    /// The frame's position in the document, from 0.
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
