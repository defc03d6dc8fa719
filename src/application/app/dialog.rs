//! What lies over or beside the picture: dialogs, what they ask for, and the side panel.

use super::choices::Scope;
use super::guide::GuidePage;
use std::path::PathBuf;
use touchline_documents::exchange::Format;

/// What the right-hand side shows.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum SidePanel {
    /// Field map, clicks, solution, verdict.
    #[default]
    Frame,
    /// The frame's camera.
    Camera,
    /// What the forest is trained on and how accurate it is.
    Trainer,
    /// What is proposed.
    Review,
}

/// What lies over the window.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Dialog {
    /// Every command, by typing.
    Palette,
    /// Every key.
    Keys,
    /// Version, licence, citation.
    About,
    /// Every message of this session.
    Messages,
    /// The sport, and with it the field.
    Sport,
    /// Brightness, contrast and gamma of the picture.
    PictureLook,
    /// The user's own.
    Preferences,
    /// The user guide.
    Guide {
        /// The page that it shows.
        page: GuidePage,
        /// What it was opened from, and closes to.
        behind: Option<Box<Self>>,
    },
    /// Colour, width and opacity of the overlay.
    OverlayStyle,
    /// Suggestions to be accepted together.
    AcceptAll,
    /// A frame or a time to go to.
    GoToPlace,
    /// A comment on the frame.
    Comment(String),
    /// Which camera took these frames.
    AssignToCamera(Scope),
    /// A path, where the system has no file dialog.
    Path(Question),
    /// Another program changed the document.
    ChangedOutside,
    /// Edits that were set aside.
    Orphans,
    /// Exports, datasets and imports.
    Transfer,
    /// Edits would be lost.
    NotSaved(Leaving),
}

/// What was asked for while edits are only in memory.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Leaving {
    /// To close the window.
    Close,
    /// To open something else.
    Open(PathBuf),
    /// To open the demo match.
    OpenDemo,
}

/// What the file dialog asks for.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Question {
    /// A project or dataset to open.
    Project,
    /// A folder of frames to open.
    Folder,
    /// A video to open.
    Video,
    /// Where to write a copy of the project.
    CopyTo,
    /// Where to write the document in a format.
    ExportAs(Format),
    /// The folder for a dataset.
    DatasetTo,
    /// The file or folder of a format to import.
    ImportFrom(Format),
    /// The document to take a camera from.
    CameraFrom,
    /// Another annotator's document of the same frames.
    CompareWith,
}
