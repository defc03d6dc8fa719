//! Actions: everything that changes the state of the application.
//!
//! They are grouped by what they may change: an [`EditAction`] changes the document, a
//! [`ViewAction`] does not. The group decides what is allowed during a blind round.

mod disk;
mod edit;
mod navigation;
mod pointer;
mod settings;
mod view;

pub use disk::DiskReport;
pub use edit::EditAction;
pub use navigation::Navigation;
pub use pointer::PointerAction;
pub use settings::SettingsAction;
pub use view::ViewAction;

use super::Command;
use super::operation::Report;
use super::trainer::TrainerReport;
use super::transfer::TransferAction;
use crate::app::project::opened::{Opened, OutsideChoice};
use crate::app::window_state::session::Question;
use std::path::PathBuf;

/// An action. It is sent by the window, by `jobs` or by a test.
#[derive(Debug, PartialEq)]
pub enum Action {
    /// Carry out a command of the menu, the keys or the palette.
    Command(Command),
    /// The key of a command that acts while its key is down was pressed (true) or released.
    Hold(Command, bool),

    /// The pointer over the picture was used.
    Pointer(PointerAction),
    /// Change how something is displayed.
    View(ViewAction),
    /// Show another frame or click, or change the list of names.
    Navigate(Navigation),
    /// Change the document.
    Edit(EditAction),
    /// Change a setting of the user.
    Settings(SettingsAction),

    /// An operation reports progress or its result.
    Report(Report),
    /// A choice in the dialog of exports and imports.
    Transfer(TransferAction),
    /// Compare the open document with another annotator's, in this file.
    Compare(PathBuf),
    /// The background trainer reports.
    Trainer(TrainerReport),
    /// The picture of the shown frame is still being decoded (true), or is displayed.
    PictureAwaited(bool),

    /// The user chose a path for this question.
    Answer(Question, PathBuf),
    /// Open a document, a folder or a video.
    Open(PathBuf),
    /// Open or import what lies at these paths, which the user dropped or typed.
    OpenAny(Vec<PathBuf>),
    /// A document was read.
    Opened(Box<Opened>),
    /// The disk reports.
    Disk(DiskReport),
    /// Ask again what to do with another program's version.
    AskOutside,
    /// Merge with, replace or open another program's version.
    ResolveOutside(OutsideChoice),
    /// Merge edits that were set aside into the document.
    MergeOrphan(PathBuf),
    /// Save edits that were set aside as a separate document.
    SaveOrphan(PathBuf),
    /// Close the window or open another document although edits exist only in memory.
    LeaveUnsaved,
    /// The user wants to close the window.
    CloseRequested,
}

impl Action {
    /// Whether the action is allowed during a blind round, because it neither changes nor shows
    /// labels, nor leaves the round. For commands,
    /// [`CommandKind::is_blind`](super::CommandKind::is_blind) decides in addition.
    pub const fn is_blind(&self) -> bool {
        !matches!(
            self,
            Self::Edit(_)
                | Self::Navigate(_)
                | Self::Hold(..)
                | Self::Transfer(TransferAction::TakeOver | TransferAction::TakeOverAndMend)
        )
    }
}
