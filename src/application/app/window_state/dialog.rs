//! Dialogs, the questions for paths, and the side panel.

use super::choices::Scope;
use crate::app::commands::guide::GuidePage;
use std::path::PathBuf;
use touchline_calibration::proposals::BatchId;
use touchline_documents::exchange::Format;

/// The content of the side panel.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum SidePanel {
    /// The shown frame: field map, clicks, solution, verdict.
    #[default]
    Frame,
    /// The shown frame's camera.
    Camera,
    /// The forest: training set and accuracy.
    Trainer,
    /// The list of suggestions.
    Review,
}

/// A dialog on top of the window.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Dialog {
    /// Search for a command by typing.
    Palette,
    /// The list of all keys.
    Keys,
    /// Version, licence, citation.
    About,
    /// All messages of the session.
    Messages,
    /// Choice of the sport, and with it the field.
    Sport,
    /// Brightness, contrast and gamma of the picture.
    PictureLook,
    /// The user's settings.
    Preferences,
    /// The user guide.
    Guide {
        /// The page.
        page: GuidePage,
        /// The dialog from which it was opened, and to which closing it returns.
        behind: Option<Box<Self>>,
    },
    /// Colour, width and opacity of the overlay.
    OverlayStyle,
    /// What the search for a camera without a click has found, and what comes next.
    FoundCamera,
    /// Acceptance of several suggestions together.
    AcceptAll,
    /// Question whether to discard a large batch of suggestions.
    DiscardBatch {
        /// The batch.
        batch: BatchId,
        /// The number of frames that show it.
        frames: usize,
    },
    /// Input of a frame number or a time.
    GoToPlace,
    /// Input of a comment on the frame.
    Comment(String),
    /// Assignment of frames to a camera.
    AssignToCamera(Scope),
    /// Input of a path, if the system has no file dialog.
    Path(Question),
    /// Question what to do with another program's version.
    ChangedOutside,
    /// The list of edits that were set aside.
    Orphans,
    /// Exports, datasets and imports.
    Transfer,
    /// Question what to do with edits that exist only in memory.
    NotSaved(Leaving),
}

/// What the user wants to do next, when the document is left.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Leaving {
    /// Close the window.
    Close,
    /// Open something else.
    Open(PathBuf),
    /// Open the demo match.
    OpenDemo,
}

/// A question for a path.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Question {
    /// The project or dataset to open.
    Project,
    /// The folder of frames to open.
    Folder,
    /// The video to open.
    Video,
    /// The review queue of a season to open.
    Queue,
    /// The destination of a copy of the project.
    CopyTo,
    /// The destination of an export in a format.
    ExportAs(Format),
    /// The folder for a dataset.
    DatasetTo,
    /// The file or folder to import, in a format.
    ImportFrom(Format),
    /// The document from which to take a camera.
    CameraFrom,
    /// Another annotator's document of the same frames.
    CompareWith,
}
