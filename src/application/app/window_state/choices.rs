//! The user's choices in panels and on the filmstrip, as plain values.

use touchline_documents::document::CameraId;

/// How a click on the filmstrip changes the selection.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Selecting {
    /// Selects the range from the shown frame to the clicked one, without frames that the filter
    /// hides.
    Range,
    /// Adds or removes the clicked frame.
    Toggle,
}

/// The frames to which a change applies.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Scope {
    /// The shown frame.
    Frame,
    /// The selected frames.
    Selected,
    /// All frames of the shown frame's shot and camera.
    Shot,
    /// The shown frame and all later ones of its camera.
    Onwards,
}

impl Scope {
    /// All scopes, smallest first.
    pub const ALL: [Self; 4] = [Self::Frame, Self::Selected, Self::Shot, Self::Onwards];

    /// The label.
    pub const fn label(self) -> &'static str {
        match self {
            Self::Frame => "This frame",
            Self::Selected => "Selected frames",
            Self::Shot => "This shot",
            Self::Onwards => "From here on",
        }
    }
}

/// A camera of the document, or a new one.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum CameraChoice {
    /// A camera of the document.
    Known(CameraId),
    /// A new camera with this name, for pictures like those of the shown frame's camera.
    New(CameraId),
}

/// The lists of masks that cover a frame.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum MaskList {
    /// Masks of the camera for all of its frames.
    Camera,
    /// Masks of the camera with a range of frames, or found automatically.
    Ranged,
    /// Masks of the frame.
    Frame,
}

/// The frames that a mask covers.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum MaskScope {
    /// All frames of the camera.
    All,
    /// The shown frame's shot.
    Shot,
    /// The frames selected on the filmstrip. In a video: all from the first to the last of them.
    Selected,
    /// The shown frame of a video and all later ones.
    FromHere,
    /// The shown frame of a video and all earlier ones.
    UpToHere,
    /// The shown frame.
    Frame,
}

impl MaskScope {
    /// All scopes, largest first.
    pub const ALL: [Self; 6] = [
        Self::All,
        Self::Shot,
        Self::Selected,
        Self::FromHere,
        Self::UpToHere,
        Self::Frame,
    ];

    /// The label.
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

/// The unit of time on the quality page.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum TimeAxis {
    /// The index of the frame in the document.
    #[default]
    Frame,
    /// Seconds of the video.
    Video,
}

/// The user's choices on the quality page.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct QualityChoice {
    /// Whether the page is open.
    pub open: bool,
    /// The camera; none: the shown frame's.
    pub camera: Option<CameraId>,
    /// The unit of time.
    pub axis: TimeAxis,
    /// The part of the time that is shown, from and to; none: all.
    pub span: Option<[f64; 2]>,
}
