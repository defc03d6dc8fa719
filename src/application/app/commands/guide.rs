//! The pages of the user guide.

/// A page of the user guide.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, strum::EnumIter)]
pub enum GuidePage {
    /// From a folder or video to exported labels.
    #[default]
    FirstProject,
    /// Keys, panels, messages, preferences.
    Window,
    /// Position, rotation and lens of a camera.
    Base,
    /// Verdict, residuals and uncertainty.
    Trust,
    /// Timeline, cuts, tracking.
    Video,
    /// Review of suggestions.
    Review,
    /// The quality page, gold frames.
    Quality,
    /// Exports, datasets, imports.
    Export,
    /// Two annotators, changes by other programs.
    SeveralPeople,
    /// Words.
    Glossary,
}

impl GuidePage {
    /// The title in the list of pages.
    pub const fn title(self) -> &'static str {
        match self {
            Self::FirstProject => "First project",
            Self::Window => "The window",
            Self::Base => "The base",
            Self::Trust => "Trust",
            Self::Video => "Video",
            Self::Review => "Review",
            Self::Quality => "Quality",
            Self::Export => "Export",
            Self::SeveralPeople => "Several people",
            Self::Glossary => "Glossary",
        }
    }
}
