//! Actions: everything that changes the state of the application.
//!
//! They are grouped by what they may change: an [`EditAction`] changes the document, a
//! [`ViewAction`] does not. The group decides what is allowed during a blind round.

mod edit;

pub use edit::EditAction;

use super::commands::guide::GuidePage;
use super::operation::Report;
use super::review::ReviewOrder;
use super::settings::{Loupe, ThemeChoice};
use super::trainer::TrainerReport;
use super::transfer::TransferAction;
use super::window_state::choices::{Scope, Selecting, TimeAxis};
use super::window_state::corner_looks::CornerLooks;
use super::window_state::place::FrameOrTime;
use super::window_state::session::{Filter, Level, PictureView};
use super::window_state::video::PlaySpeed;
use super::{Chord, Command};
use crate::app::project::opened::{Opened, OutsideChoice};
use crate::app::window_state::field_draft::{DrawnLine, Mirrored};
use crate::app::window_state::session::Question;
use crate::scene::match_list::MatchState;
use crate::scene::shot_list::ShotOrder;
use crate::scene::{OverlayStyle, PictureLook, Sport};
use std::collections::BTreeSet;
use std::path::PathBuf;
use touchline_core::field::{FieldError, Template};
use touchline_core::geometry::ImagePoint;
use touchline_documents::document::{Camera, CameraId, Target};
use touchline_documents::store::{Orphan, OrphanEdits, Outside};

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
    /// Open the match at this place of the queue.
    OpenMatch(usize),
    /// A document was read.
    Opened(Box<Opened>),
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
                | Self::OpenMatch(_)
                | Self::Transfer(TransferAction::TakeOver | TransferAction::TakeOverAndMend)
        )
    }
}

/// A change of the template in the field editor.
#[derive(Clone, Debug, PartialEq)]
pub enum FieldChange {
    /// The text was typed.
    Text(String),
    /// A line was drawn.
    Draw(DrawnLine, Mirrored),
    /// Add landmarks where lines meet or end.
    AddLandmarks,
    /// Take back what was drawn or added last.
    Undo,
}

/// The result of a request to the disk, or its progress.
#[derive(Debug, PartialEq)]
pub enum DiskReport {
    /// Progress of opening a document, as text.
    Progress(String),
    /// How far a match of the queue has come.
    MatchSeen {
        /// The file of its project.
        project: PathBuf,
        state: Box<MatchState>,
    },
    /// This window has the document open already.
    AlreadyOpen(PathBuf),
    /// One of the user's own field templates was read, or could not be.
    TemplateRead {
        /// The file of the document that names it.
        of: PathBuf,
        /// The template's path as the document writes it.
        name: String,
        /// The template, or the error.
        template: Result<Box<Template>, FieldError>,
    },
    /// The text of a template for the field editor.
    TemplateText {
        /// The file of the document that uses it.
        of: PathBuf,
        /// The template's path as the document writes it.
        name: String,
        text: String,
    },
    /// The template in the field editor is in its file.
    TemplateWritten {
        /// The file of the document that will use it.
        of: PathBuf,
        /// The template's path as the document writes it.
        name: String,
        /// The template.
        template: Box<Template>,
    },
    /// A request failed; the error in one line.
    Failed(String),
    /// A camera base was read from another document.
    CameraLoaded(Box<Camera>),
    /// Every edit up to this revision is in the journal or the document.
    Saved {
        revision: u64,
        /// The local time, "12:03:41".
        at: String,
        /// The number of the last [`Effect::Save`](crate::app::Effect::Save) that this write
        /// answers, if the document itself was written and not only the journal.
        document: Option<u64>,
    },
    /// Writing failed: some edits exist only in memory.
    SaveFailed(String),
    /// Another program changed the document.
    ChangedOutside {
        /// The document's file.
        path: PathBuf,
        /// The window's version, which was set aside, if it has edits of its own.
        own: Option<Orphan>,
    },
    /// The version that another program wrote.
    Outside(Box<Outside>),
    /// Edits that were set aside were read.
    OrphanRead {
        /// Their file.
        orphan: PathBuf,
        edits: Box<OrphanEdits>,
    },
    /// Edits that were set aside were saved as a separate document.
    OrphanSaved {
        /// The new document's file.
        document: PathBuf,
    },
    /// Edits that were set aside are merged into the document, and their file was renamed.
    OrphanPutAway {
        /// Their former file.
        orphan: PathBuf,
        /// The new name.
        renamed: PathBuf,
    },
    /// A copy was written.
    Copied {
        /// The file of the document that was copied.
        of: PathBuf,
        /// The revision that was copied.
        revision: u64,
        /// The copy's folder.
        folder: PathBuf,
    },
}

/// An action that shows another frame or click, or changes the list of names.
#[derive(Debug, PartialEq)]
pub enum Navigation {
    /// Select a click by its index, or none.
    Select(Option<usize>),
    /// Show the frame at an index.
    GoTo(usize),
    /// Change the selection on the filmstrip.
    SelectFrame {
        /// The index of the clicked frame.
        frame: usize,
        /// Whether a range is selected or the frame toggled.
        how: Selecting,
    },
    /// Ask to which camera the frames of a scope belong.
    AskCamera(Scope),
    /// Close the quality page, and show a frame and optionally one of its clicks.
    LookAt {
        /// The index of the frame.
        frame: usize,
        /// The index of the click.
        click: Option<usize>,
    },
    /// Filter the list of names by a text.
    TypeName(String),
    /// Show other names for a point that was just named automatically, filtered by a text.
    RefineName(String),
    /// Confirm the name that a point was given automatically.
    ConfirmName,
    /// Highlight the candidate at an index in the list.
    HighlightName(usize),
    /// Rank the listed names by how the point looks in the picture.
    LookAtClick(CornerLooks),
    /// List lines (true) or landmarks.
    ListLines(bool),
    /// Show the frame with a number or at a time.
    GoToPlace(FrameOrTime),
}

/// An action of the pointer over the picture. Its effect depends on the mode.
#[derive(Clone, Debug, PartialEq)]
pub enum PointerAction {
    /// The pointer moved to a point, px of the picture, or left the picture.
    Hover(Option<ImagePoint>),
    /// The primary button was pressed on the picture.
    Press {
        /// The point, px of the picture.
        at: ImagePoint,
        /// The index of the click under the pointer, if any.
        on: Option<usize>,
    },
    /// The primary button went down on a landmark or line that is drawn over the picture and can be
    /// dragged.
    Grab {
        /// Where, px of the picture.
        at: ImagePoint,
        /// What is drawn there.
        element: Target,
    },
    /// The pointer moved with the button down.
    Drag(ImagePoint),
    /// The button was released.
    Release,
    /// The button was released with Alt down: the point stays where it is, even if its landmark is
    /// painted nearby.
    ReleaseExactly,
}

/// A change of the user's settings.
#[derive(Debug, PartialEq)]
pub enum SettingsAction {
    OverlayStyle(OverlayStyle),
    /// Dark or light.
    Theme(ThemeChoice),
    /// The colour of a sport's lines.
    LineColour(&'static Sport, [u8; 3]),
    Loupe(Loupe),
    /// The memory for decoded frames, MiB.
    PictureMemory(u32),
    /// Brightness, contrast and gamma of the displayed picture.
    PictureLook(PictureLook),
    /// The size of texts and controls; 1 is the system's.
    TextSize(f32),
    /// The sizes of the side panel and the filmstrip, points; none: derived from the window's size.
    PanelSizes {
        /// The side panel's width.
        side: Option<f32>,
        /// The filmstrip's height.
        filmstrip: Option<f32>,
    },
    AssignKey(Command, Chord),
    /// Reset all keys to their defaults.
    ResetKeys,
    /// Whether the details in the inspector are unfolded.
    Details(bool),
}

/// An action that changes how something is displayed. It neither changes a label nor shows more of
/// it.
#[derive(Debug, PartialEq)]
pub enum ViewAction {
    /// Show another part of the picture.
    Picture(PictureView),
    /// The scale at which the picture fits its canvas changed.
    FitScale(f64),
    /// Clear the selection on the filmstrip.
    SelectNoFrames,
    /// Select frames, by their indices.
    SelectFrames(BTreeSet<usize>),
    /// Set the filter of the filmstrip.
    SetFilter(Filter),
    /// The pointer entered (true) or left the list in the review panel; see [`crate::app::review`].
    HoldReview(bool),
    /// Set the order of the list in the review panel.
    SetReviewOrder(ReviewOrder),
    /// Set the minimum confidence of suggestions that are accepted together.
    SetReviewThreshold(f64),
    /// Set whether suggestions that disagree with their neighbours are accepted, too.
    SetWithDisagreeing(bool),
    /// Include a suggestion in the common acceptance, or exclude it.
    TickSuggestion {
        /// The index of the frame.
        frame: usize,
        /// Whether it is included.
        ticked: bool,
    },
    /// Set whether the list in the review panel shows one suggestion per shot.
    SetOnePerShot(bool),
    /// Set whether the review panel lists shots instead of suggestions.
    ListShots(bool),
    /// Set the order of the list of shots.
    SetShotOrder(ShotOrder),
    /// Set whether the list of shots has those of fields alone.
    ListFieldsOnly(bool),
    /// Select the camera of the quality page.
    SetQualityCamera(CameraId),
    /// Select the unit of time on the quality page.
    SetTimeAxis(TimeAxis),
    /// Show a part of the time on the quality page, or all of it.
    ShowSpan(Option<[f64; 2]>),
    /// Read the field templates again that could not be read.
    ReadFailedTemplatesAgain,
    /// Open the field editor; with a copy of a template if one is named.
    EditFieldTemplate(Option<String>),
    /// Change the template in the field editor.
    ChangeFieldTemplate(FieldChange),
    CloseDialog,
    /// Show another page of the guide.
    ShowGuidePage(GuidePage),
    /// Remove a message by its id.
    DismissNotice(u64),
    /// Show a message from outside of the application.
    Notify(Level, String),
    /// Ask for a typed path, because the system has no file dialog.
    TypePath(Question),
    /// Set the speed of the video.
    SetSpeed(PlaySpeed),
    /// Show the frame that is due in the playing video.
    PlayTo(usize),
    /// Pause the video, at its end or because the user does something else.
    Pause,
}
