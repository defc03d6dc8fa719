//! The menus of the window.

/// The menu that lists a command.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[allow(missing_docs, reason = "the menu's own titles")]
pub enum MenuGroup {
    File,
    Edit,
    Frame,
    Camera,
    View,
    Help,
}

impl MenuGroup {
    /// All menus, in order.
    pub const ALL: [Self; 6] = [
        Self::File,
        Self::Edit,
        Self::Frame,
        Self::Camera,
        Self::View,
        Self::Help,
    ];

    /// The menu's title.
    #[must_use]
    pub const fn title(self) -> &'static str {
        match self {
            Self::File => "File",
            Self::Edit => "Edit",
            Self::Frame => "Frame",
            Self::Camera => "Camera",
            Self::View => "View",
            Self::Help => "Help",
        }
    }
}
