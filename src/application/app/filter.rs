//! Which frames the filmstrip shows, and which of them wait for a person.

use touchline_documents::document::{Frame, FrameStatus};

/// Which frames the filmstrip shows.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Filter {
    /// All of them.
    #[default]
    All,
    /// Neither accepted nor rejected.
    ToDo,
    /// The forest has no answer for them.
    Unanswered,
    /// One status.
    Status(FrameStatus),
}

impl Filter {
    /// Every filter, in the order of the list.
    pub const ALL: [Self; 8] = [
        Self::All,
        Self::ToDo,
        Self::Status(FrameStatus::New),
        Self::Status(FrameStatus::Draft),
        Self::Status(FrameStatus::Suggested),
        Self::Unanswered,
        Self::Status(FrameStatus::Reference),
        Self::Status(FrameStatus::Rejected),
    ];

    /// Whether a frame is shown.
    #[must_use]
    pub fn shows(self, frame: &Frame) -> bool {
        match self {
            Self::All => true,
            Self::ToDo => is_to_do(frame),
            Self::Unanswered => frame.is_unanswered(),
            Self::Status(wanted) => frame.status == wanted,
        }
    }

    /// What the list says.
    #[must_use]
    pub const fn label(self) -> &'static str {
        match self {
            Self::All => "All frames",
            Self::ToDo => "To do",
            Self::Unanswered => "No answer",
            Self::Status(status) => status_label(status),
        }
    }
}

/// Whether a frame is still to do: it is neither accepted nor rejected. The filmstrip, the keys,
/// every count and every sentence mean this by it.
#[must_use]
pub const fn is_to_do(frame: &Frame) -> bool {
    !matches!(frame.status, FrameStatus::Reference | FrameStatus::Rejected)
}

/// A status as a person reads it.
#[must_use]
pub const fn status_label(status: FrameStatus) -> &'static str {
    match status {
        FrameStatus::New => "New",
        FrameStatus::Draft => "Draft",
        FrameStatus::Suggested => "Suggested",
        FrameStatus::Reference => "Reference",
        FrameStatus::Rejected => "Rejected",
    }
}
