//! What each command acts on.

/// What a command acts on. It decides whether the command is available during a blind round or
/// behind another page.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum CommandKind {
    /// The application itself: shows and changes no label.
    Application,
    /// The zoom: of the picture, or of the quality page's time axis.
    Zoom,
    /// A blind round.
    Round,
    /// The shown picture or the selection in it: not available while another page hides it.
    Picture,
    /// The document as a whole, another frame, a panel.
    Document,
}

impl CommandKind {
    /// Whether it is available during a blind round: it neither shows the label nor leaves the
    /// round.
    #[must_use]
    pub const fn is_blind(self) -> bool {
        matches!(self, Self::Application | Self::Zoom | Self::Round)
    }
}
