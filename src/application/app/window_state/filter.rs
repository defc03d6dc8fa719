//! The filter of the filmstrip, and which frames are to do.

use touchline_documents::document::{Frame, FrameStatus};

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

    /// The label.
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

/// The label of a status.
pub const fn status_label(status: FrameStatus) -> &'static str {
    match status {
        FrameStatus::New => "New",
        FrameStatus::Draft => "Draft",
        FrameStatus::Suggested => "Suggested",
        FrameStatus::Reference => "Reference",
        FrameStatus::Rejected => "Rejected",
    }
}
