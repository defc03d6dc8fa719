//! The kinds of commands, by what they act on.

/// What a command acts on. Determines whether the command is available during a blind round, or
/// while another page covers the picture.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum CommandKind {
    /// The application itself; labels are neither shown nor changed.
    Application,
    /// The zoom, of the picture or of the quality page's time axis.
    Zoom,
    /// A blind round.
    Round,
    /// The shown picture or the selection in it; not available while another page covers it.
    Picture,
    /// The document as a whole, another frame, a panel.
    Document,
}

impl CommandKind {
    /// Whether the command is available during a blind round, because it neither shows the label
    /// nor leaves the round.
    #[must_use]
    pub const fn is_blind(self) -> bool {
        matches!(self, Self::Application | Self::Zoom | Self::Round)
    }
}
