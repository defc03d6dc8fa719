//! The user's choices in panels and on the filmstrip, as plain values.

use crate::scene::shot_list::ShotOrder;
use touchline_documents::document::{CameraId, Frame, FrameStatus};

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
#[derive(Clone, Copy, Debug, PartialEq, Eq, strum::EnumIter)]
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

/// The filter of the filmstrip.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Filter {
    /// All frames.
    #[default]
    All,
    /// Frames that are neither accepted nor rejected.
    ToDo,
    /// Frames for which the forest has no answer.
    Unanswered,
    /// Suggestions that the paint of their pictures does not support.
    OffPaint,
    /// Frames with a status.
    Status(FrameStatus),
}

impl Filter {
    /// All filters, in the order of the list.
    pub const ALL: [Self; 9] = [
        Self::All,
        Self::ToDo,
        Self::Status(FrameStatus::New),
        Self::Status(FrameStatus::Draft),
        Self::Status(FrameStatus::Suggested),
        Self::OffPaint,
        Self::Unanswered,
        Self::Status(FrameStatus::Reference),
        Self::Status(FrameStatus::Rejected),
    ];

    /// Whether the filter shows a frame.
    pub fn shows(self, frame: &Frame) -> bool {
        match self {
            Self::All => true,
            Self::ToDo => is_to_do(frame),
            Self::Unanswered => frame.is_unanswered(),
            Self::OffPaint => frame.is_suggested_off_paint(),
            Self::Status(wanted) => frame.status == wanted,
        }
    }

    pub const fn label(self) -> &'static str {
        match self {
            Self::All => "All frames",
            Self::ToDo => "To do",
            Self::Unanswered => "No answer",
            Self::OffPaint => "Suggested, not on paint",
            Self::Status(status) => status_label(status),
        }
    }
}

/// Whether a frame is to do: neither accepted nor rejected. The filmstrip, the keys, all counts and
/// all texts use this definition.
pub const fn is_to_do(frame: &Frame) -> bool {
    !matches!(frame.status, FrameStatus::Reference | FrameStatus::Rejected)
}

pub const fn status_label(status: FrameStatus) -> &'static str {
    match status {
        FrameStatus::New => "New",
        FrameStatus::Draft => "Draft",
        FrameStatus::Suggested => "Suggested",
        FrameStatus::Reference => "Reference",
        FrameStatus::Rejected => "Rejected",
    }
}

/// The order of the list of suggestions.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, strum::IntoStaticStr, strum::EnumIter)]
pub enum ReviewOrder {
    /// Lowest confidence first.
    #[default]
    Confidence,
    /// Largest disagreement with the neighbours first.
    Disagreement,
    /// Those first that the painted lines contradict.
    Paint,
    /// Those first that mending moved farthest.
    Moved,
    /// From left to right, by where the camera looks.
    Pan,
    /// In the document's order.
    Time,
}

impl ReviewOrder {
    /// The label in the panel.
    pub fn label(self) -> &'static str {
        self.into()
    }

    /// The explanation in the panel.
    pub const fn about(self) -> &'static str {
        match self {
            Self::Confidence => {
                "Lowest confidence first: look at these. Those above a threshold can be accepted at once."
            }
            Self::Disagreement => {
                "Those most out of line with the frames before and after come first."
            }
            Self::Paint => {
                "Those first that the painted lines contradict, then those on which they do not \
                 decide; among equals those that mending moved farthest."
            }
            Self::Moved => {
                "Those first whose imported camera mending moved farthest, in px of the picture."
            }
            Self::Pan => "From left to right: frames that look alike stand together.",
            Self::Time => "In the order of the frames.",
        }
    }
}

/// The user's choices in the review panel.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ReviewChoice {
    /// The order of the list.
    pub order: ReviewOrder,
    /// Minimum confidence of suggestions that are accepted together.
    pub threshold: f64,
    /// Whether suggestions that disagree with their neighbours are accepted, too.
    pub with_disagreeing: bool,
    /// Whether the list shows one suggestion per shot.
    pub one_per_shot: bool,
    /// Whether the pointer is over the list; then its rows do not move.
    pub held: bool,
    /// The list of shots.
    pub shots: ShotChoice,
}

/// The user's choices for the list of shots in the review panel.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct ShotChoice {
    /// Whether it is shown instead of the suggestions.
    pub is_shown: bool,
    /// Its order.
    pub order: ShotOrder,
    /// Whether shots without a field, and transitions, are left out of it.
    pub fields_only: bool,
}

impl Default for ReviewChoice {
    fn default() -> Self {
        Self {
            order: ReviewOrder::default(),
            threshold: 0.95,
            with_disagreeing: false,
            one_per_shot: false,
            held: false,
            shots: ShotChoice::default(),
        }
    }
}
