//! Actions, which change state.
//!
//! They are nested by what they may do: an [`EditAction`] changes the document, a [`ViewAction`]
//! nothing of it. What is allowed while something else is under way follows from that.

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
use super::opened::{Opened, OutsideChoice};
use super::operation::Report;
use super::session::Question;
use super::trainer::TrainerReport;
use super::transfer::TransferAction;
use std::path::PathBuf;

/// What changes state; sent by the window, the jobs and the tests.
#[derive(Debug, PartialEq)]
pub enum Action {
    /// A command by menu, key or palette.
    Command(Command),
    /// A key of a command that acts while it is held went down or up.
    Hold(Command, bool),

    /// The pointer over the picture.
    Pointer(PointerAction),
    /// How something is shown.
    View(ViewAction),
    /// Another frame or click, or more of the label.
    Navigate(Navigation),
    /// The document changes.
    Edit(EditAction),
    /// What belongs to the user changes.
    Settings(SettingsAction),

    /// An operation reports how far it has come, or what came of it.
    Report(Report),
    /// What is to be exported or imported.
    Transfer(TransferAction),
    /// The open document is compared with another annotator's.
    Compare(PathBuf),
    /// What the background trainer reports.
    Trainer(TrainerReport),
    /// The shown frame's picture is on its way, or is there.
    PictureAwaited(bool),

    /// The path that was asked for.
    Answer(Question, PathBuf),
    /// A document, folder or video is to be opened.
    Open(PathBuf),
    /// It is open.
    Opened(Box<Opened>),
    /// What comes back from the disk.
    Disk(DiskReport),
    /// The question what to do with another program's version is asked again.
    AskOutside,
    /// What becomes of another program's version.
    ResolveOutside(OutsideChoice),
    /// Edits that were set aside are joined with the document.
    MergeOrphan(PathBuf),
    /// Edits that were set aside are written as a document of their own.
    SaveOrphan(PathBuf),
    /// The window closes, or another document is opened, although edits are only in memory.
    LeaveUnsaved,
    /// The window asked to close.
    CloseRequested,
}

impl Action {
    /// Whether it is allowed during a blind round: it changes and shows no label and does not leave
    /// the round. For a command its own kind decides.
    #[must_use]
    pub const fn is_blind(&self) -> bool {
        !matches!(
            self,
            Self::Edit(_)
                | Self::Navigate(_)
                | Self::Hold(..)
                | Self::Transfer(TransferAction::TakeOver)
        )
    }
}
