//! The state of the window. It is neither saved nor undone.

pub use super::choices::{Filter, is_to_do, status_label};

pub use crate::app::commands::notice::{Level, Messages, Notice, in_row};

use super::choices::{QualityChoice, ReviewChoice, Scope};
use super::corner_looks::CornerLooks;
use super::field_draft::FieldDraft;
use super::naming::{NameCandidate, filter_by_text};
use super::reclick::Reclick;
use super::video::VideoState;
use crate::app::commands::guide::GuidePage;
use crate::app::commands::tour::Tour;
use crate::app::{Command, TrainerState};
use crate::scene::uncertainty::UncertaintyView;
use std::collections::BTreeSet;
use std::path::PathBuf;
use touchline_calibration::proposals::BatchId;
use touchline_core::geometry::ImagePoint;
use touchline_documents::document::{FrameId, RejectReason, Target};
use touchline_documents::exchange::Format;
use touchline_documents::store::Orphan;
use touchline_season::queue::QueuedMatch;

/// What the window shows and what the user is doing.
#[derive(Debug, Default)]
pub struct Session {
    /// The index of the shown frame in the document.
    pub frame: usize,
    /// The indices of the frames selected on the filmstrip: none, or at least two.
    pub frames_selected: BTreeSet<usize>,
    /// What the user has begun and not ended, such as a drag.
    pub mode: Mode,
    /// Which frames the filmstrip shows.
    pub filter: Filter,
    /// What the right-hand side shows.
    pub panel: SidePanel,
    /// The open dialog, if any.
    pub dialog: Option<Dialog>,
    /// The page of the guide that was shown last.
    pub guide_page: GuidePage,
    /// The sport that the pictures' file name suggests, while the user chooses the sport.
    pub sport_guess: Option<&'static str>,
    /// The choices in the review panel.
    pub review: ReviewChoice,
    /// Suggestions that the user unticked on the sheet *Accept all*.
    pub unticked: BTreeSet<FrameId>,
    /// The choices on the quality page, and whether it is open.
    pub quality: QualityChoice,
    /// What the background trainer is doing.
    pub trainer: TrainerState,
    /// The frame with a bad verdict whose acceptance the user was to confirm.
    pub doubted: Option<PendingAcceptance>,
    /// The playback state of the shown frame's video.
    pub video: VideoState,
    /// The tour on the demo match, while it lasts.
    pub tour: Option<Tour>,
    /// The messages to the user.
    pub messages: Messages,
    /// The points of the shown frame: which one is selected, which were just placed.
    pub points: PointState,
    /// How the picture is displayed.
    pub picture: PictureDisplay,
    /// What has been written to disk, and what waits for it.
    pub disk: DiskState,
    /// The field template that the user writes.
    pub field_draft: Option<FieldDraft>,
}

/// The points of the shown frame.
#[derive(Debug, Default)]
pub struct PointState {
    /// The index of the selected click.
    pub selected: Option<usize>,
    /// Where the pointer is over the picture, px of the picture.
    pub hover: Option<ImagePoint>,
    /// The index of the click that was just placed and named automatically, until the next action
    /// of the user.
    pub named_automatically: Option<usize>,
    /// The indices of the clicks that were just moved onto the paint, until the next action of the
    /// user.
    pub just_snapped: Vec<usize>,
    /// The drawn landmark or line under the button that is down, until the pointer moves.
    pub grabbed: Option<Target>,
    /// Whether the next click becomes a point on a line.
    pub next_on_line: bool,
}

/// How the picture is displayed; the same for every frame.
#[derive(Debug, Default)]
pub struct PictureDisplay {
    /// Whether the whole picture is shown or a part.
    pub view: PictureView,
    /// The scale at which the picture fits its canvas, physical px of the screen per px of the
    /// picture. The viewport updates it.
    pub fit_scale: f64,
    /// The commands that act while their key is down.
    pub held: HeldCommands,
    /// How the uncertainty is displayed.
    pub uncertainty: UncertaintyView,
    /// What a press in the picture does. The masks are shown while they are drawn.
    pub tool: Tool,
}

/// What a press in the picture does.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Tool {
    /// Places a point, or drags the point, landmark or line under it.
    #[default]
    Point,
    /// Selects and drags points and moves the picture; places nothing.
    Select,
    /// Places a point on a line.
    Line,
    /// Places a check point: it is left out of the solve, and its error is shown.
    Check,
    /// Draws a mask: a box that is excluded from feature detection.
    Mask,
}

/// What has been written to disk, and what waits for it.
#[derive(Debug, Default)]
pub struct DiskState {
    /// Whether all edits are on disk.
    pub saving: Saving,
    /// The number of requests to write the document; see `Effect::Save`.
    pub save_requests: u64,
    /// The name of the document that is being opened.
    pub opening: Option<String>,
    /// What to do as soon as everything is on disk and no change by another program is undecided.
    pub leaving: Option<Leaving>,
    /// The document's file, if another program changed it and the user has not decided what to do.
    pub changed_outside: Option<PathBuf>,
    /// The file in which the window's version is kept until that decision.
    pub own_version: Option<PathBuf>,
    /// The latest revision of the document that was copied to another folder.
    pub copied: Option<u64>,
    /// Edits that belong to another version of the document and were set aside.
    pub orphans: Vec<Orphan>,
}

/// A frame that the user wanted to accept although its verdict is bad.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct PendingAcceptance {
    /// The frame's id.
    pub frame: FrameId,
    /// The document's version at the question. If it has changed, the question is shown again.
    pub version: u64,
    /// Whether the frame was to stay shown after it is accepted.
    pub stay: bool,
}

/// The label of a reason for rejection.
pub const fn reason_label(reason: RejectReason) -> &'static str {
    match reason {
        RejectReason::CloseUp => "Close-up",
        RejectReason::Replay => "Replay",
        RejectReason::OtherCamera => "Other camera",
        RejectReason::Graphic => "Graphic",
        RejectReason::Blur => "Blur",
        RejectReason::TooLittleField => "Too little field",
    }
}

/// Which part of the picture the canvas shows.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub enum PictureView {
    /// The whole picture.
    #[default]
    Fit,
    /// A part, enlarged.
    Zoomed {
        /// Physical px of the screen per px of the picture; 1 is 100 % at any pixel density.
        scale: f64,
        /// The point in the middle of the canvas, px of the picture.
        centre: ImagePoint,
    },
}

/// Which commands are active because their key is down.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct HeldCommands {
    /// The overlay is hidden.
    pub hide_overlay: bool,
    /// The other solution is shown, for comparison.
    pub compare: bool,
    /// The camera is shown as it was before it was aligned to the paint.
    pub before_snap: bool,
}

/// Whether all edits are on disk.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub enum Saving {
    /// There has been no edit.
    #[default]
    Untouched,
    /// An edit is being written.
    Pending,
    /// Every edit is on disk.
    Saved {
        /// The local time of the last write, such as "12:03:41".
        at: String,
    },
    /// Writing failed: some edits exist only in memory.
    Failed {
        /// The error, in one line.
        message: String,
        /// The time of the last successful write, if any.
        since: Option<String>,
    },
}

impl Session {
    /// Clears the marks on points that were just placed or moved, because the user does something
    /// else.
    pub fn forget_placed(&mut self) {
        self.points.named_automatically = None;
        self.points.just_snapped.clear();
    }

    /// Whether the next point that is placed lies on a line.
    pub fn is_next_on_line(&self) -> bool {
        self.points.next_on_line || self.picture.tool == Tool::Line
    }

    /// Shows a message. It replaces an earlier one with the same text.
    pub fn notify(&mut self, level: Level, text: impl Into<String>) {
        self.notify_with(level, text, []);
    }

    /// Shows a message that needs no action.
    pub fn note(&mut self, text: impl Into<String>) {
        self.notify(Level::Info, text);
    }

    /// Shows a message that may need one.
    pub fn warn(&mut self, text: impl Into<String>) {
        self.notify(Level::Warning, text);
    }

    /// Shows a message with commands as buttons.
    pub fn notify_with(
        &mut self,
        level: Level,
        text: impl Into<String>,
        offers: impl IntoIterator<Item = (&'static str, Command)>,
    ) {
        self.messages
            .show(level, text.into(), offers.into_iter().collect());
    }

    /// Whether a message on display has a button for a command.
    pub fn offers(&self, command: Command) -> bool {
        self.messages
            .notices
            .iter()
            .any(|notice| notice.offers(command))
    }

    /// Removes the messages with a button for a command, because the command has been executed or
    /// no longer makes sense.
    pub fn retract(&mut self, command: Command) {
        self.messages
            .notices
            .retain(|notice| !notice.offers(command));
    }
}

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
    /// A field template of the user's own, as text and drawing.
    FieldEditor,
    /// Brightness, contrast and gamma of the picture.
    PictureLook,
    /// The user's settings.
    Preferences,
    /// The user guide.
    Guide {
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
    /// All suggestions as pictures.
    Gallery,
    /// Question whether to discard a large batch of suggestions.
    DiscardBatch {
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
    Open(Opening),
}

/// What to open.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Opening {
    /// A document, folder, video or queue.
    Path(PathBuf),
    /// Several of them, as a queue.
    Paths(Vec<PathBuf>),
    /// A match of the queue that is open: its project, or what it is made of.
    Match(Box<QueuedMatch>),
    /// A fresh copy of the demo match.
    Demo,
    /// The open document again, as it is on disk; the open state is dropped first.
    Again(PathBuf),
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
    /// The queue of several matches to open.
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

/// Maximum number of candidates listed at the cursor.
pub const OFFERED: usize = 5;

/// What the user has begun and not ended.
#[derive(Clone, Debug, Default, PartialEq)]
pub enum Mode {
    /// Nothing.
    #[default]
    Idle,
    /// The user drags a point.
    Dragging {
        /// The index of the click.
        click: usize,
        /// Whether the same press placed the point; then it has no name yet.
        placed: bool,
    },
    /// A point waits for its name.
    Naming(Naming),
    /// The landmark was chosen first; the next click in the picture places it.
    Placing(Target),
    /// The user chooses the reason of a rejection.
    Rejecting {
        /// Whether the rejection is for every frame of the shot.
        whole_shot: bool,
    },
    /// The user edits a number.
    Editing,
    /// The user clicks gold frames again, without seeing the first clicks.
    ClickingAgain(Reclick),
}

/// A point that waits for its name, and the list from which the user chooses.
#[derive(Clone, Debug, PartialEq)]
pub struct Naming {
    /// The index of the click.
    pub click: usize,
    /// All candidates, best first.
    pub candidates: Vec<NameCandidate>,
    /// How the point looks in the picture, once it was looked at.
    pub looks: Option<CornerLooks>,
    /// Whether the point was named automatically and keeps that name unless the user chooses
    /// another one.
    pub refines: bool,
    /// The text that the user typed to filter them.
    pub typed: String,
    /// Whether lines are listed in place of landmarks.
    pub lines: bool,
    /// The index of the highlighted candidate among those listed, by pointer or arrow keys.
    pub highlighted: usize,
}

impl Naming {
    /// The candidates in the list: the first [`OFFERED`] that pass the filter.
    pub fn listed_candidates(&self) -> Vec<&NameCandidate> {
        let mut offered = filter_by_text(&self.candidates, &self.typed);
        offered.truncate(OFFERED);
        offered
    }

    /// The candidate that Enter chooses.
    pub fn chosen(&self) -> Option<&NameCandidate> {
        self.listed_candidates().get(self.highlighted).copied()
    }
}
