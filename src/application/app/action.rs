//! Actions, which change state.

use super::choices::{CameraChoice, MaskList, MaskScope, Scope, Selecting, TimeAxis};
use super::guide::GuidePage;
use super::opened::{Opened, OutsideChoice};
use super::operation::Report;
use super::review::ReviewOrder;
use super::session::{Filter, Level, PictureView, Question};
use super::settings::{Loupe, ThemeChoice};
use super::transfer::TransferAction;
use super::{Chord, Command, TrainerStatus, VideoAction};
use crate::scene::{OverlayStyle, PictureLook, Sport};
use std::path::PathBuf;
use touchline_calibration::proposals::{CarriedProposal, Proposal, UsedFeatures};
use touchline_core::camera::Ptz;
use touchline_core::field::{FieldError, Symmetry, Template};
use touchline_core::geometry::{ImagePoint, PixelBox};
use touchline_documents::document::{Camera, CameraId, FieldSpec, RejectReason, Target};
use touchline_documents::store::{Orphan, OrphanEdits, Outside};

/// What changes state; sent by the window, the jobs and the tests.
#[derive(Debug, PartialEq)]
pub enum Action {
    /// A command by menu, key or palette.
    Command(Command),
    /// A key of a command that acts while it is held went down or up.
    Hold(Command, bool),

    /// The pointer is over the picture, or left it.
    Hover(Option<ImagePoint>),
    /// The primary button went down on the picture.
    Press {
        /// Where, px of the picture.
        at: ImagePoint,
        /// The click under the pointer, if any.
        on: Option<usize>,
    },
    /// The pointer moved with the button down.
    Drag(ImagePoint),
    /// The button went up.
    Release,
    /// The button went up with Alt held: the point stays where it is, whatever is painted near by.
    ReleaseExactly,
    /// A click was selected, or none.
    Select(Option<usize>),
    /// The selected click moves by px of the picture.
    Nudge {
        /// To the right.
        dx_px: f64,
        /// Downwards.
        dy_px: f64,
        /// The key is held down: this belongs to the nudge before.
        held: bool,
    },
    /// The view of the picture changes.
    View(PictureView),
    /// The scale at which the picture fits its canvas changed.
    FitScale(f64),

    /// What is typed while a point waits for its name.
    TypeName(String),
    /// What is typed right after a point was named by itself: other names for it are offered.
    RefineName(String),
    /// The name that a point was given by itself is right.
    ConfirmName,
    /// A candidate on offer is under the pointer.
    HighlightName(usize),
    /// A candidate on offer is taken.
    TakeName(usize),
    /// Landmarks or lines are offered.
    OfferLines(bool),
    /// A landmark or line was picked on the field map or in a list.
    Pick(Target),
    /// A click gets a name.
    Name {
        /// Which click.
        click: usize,
        /// Its name.
        target: Target,
    },
    /// A click is removed.
    DeleteClick(usize),
    /// A click is held out of the solve, or takes part again.
    SetCheck {
        /// Which click.
        click: usize,
        /// Held out.
        check: bool,
    },

    /// Another frame.
    GoTo(usize),
    /// A frame of the filmstrip is added to the selection, or taken out.
    SelectFrame {
        /// Its place.
        frame: usize,
        /// How.
        how: Selecting,
    },
    /// No frames are selected.
    SelectNoFrames,
    /// Frames are assigned to a camera.
    AssignToCamera {
        /// Which frames.
        scope: Scope,
        /// Which camera.
        camera: CameraChoice,
    },
    /// The dialog that assigns frames is about another scope.
    AskCamera(Scope),
    /// The frame (or its shot) is not calibratable.
    RejectAs(RejectReason),
    /// The frame's comment; empty: none.
    SetComment(String),
    /// The filmstrip shows other frames.
    SetFilter(Filter),
    /// A mask is drawn: for the camera, or for this frame only.
    AddMask {
        /// Of every frame of the camera.
        of_camera: bool,
        /// The box, px.
        mask: PixelBox,
    },
    /// A mask is to cover other frames.
    ScopeMask {
        /// The list that it is in so far.
        list: MaskList,
        /// Which, from 0.
        index: usize,
        /// Which frames.
        scope: MaskScope,
    },
    /// A mask is removed.
    RemoveMask {
        /// The list that it is in.
        list: MaskList,
        /// Which, from 0.
        index: usize,
    },

    /// A number begins to change; the name is the undo step's.
    BeginEdit(&'static str),
    /// Something about a video: its shots, playing it.
    Video(VideoAction),

    /// Pan, tilt and focal length by hand.
    EditPtz(Ptz),
    /// The frame's camera by hand.
    EditCamera(Box<Camera>),
    /// The field by hand.
    EditField(FieldSpec),
    /// The number is as wanted.
    EndEdit,
    /// The number goes back to what it was.
    AbortEdit,
    /// The frame's clicks decide again, instead of numbers by hand.
    SolveAgain,

    /// Cameras that the forest proposes for frames that nobody has looked at.
    Proposals(Vec<Proposal>),
    /// Cameras carried from such frames to those between them.
    CarriedProposals(Vec<CarriedProposal>),
    /// The pointer is over the review panel's list, or has left it: see [`super::review`].
    HoldReview(bool),
    /// The order of the review panel's list.
    SetReviewOrder(ReviewOrder),
    /// Suggestions of at least this probability are accepted together.
    SetReviewThreshold(f64),
    /// Also those that disagree with their neighbours.
    SetWithDisagreeing(bool),
    /// The review panel's list has one suggestion a shot.
    SetOnePerShot(bool),
    /// A suggestion is accepted together with the others, or taken out of them.
    TickSuggestion {
        /// Its place.
        frame: usize,
        /// It is accepted with the others.
        ticked: bool,
    },
    /// The suggestions that the preview speaks of are accepted together.
    AcceptAll,
    /// The forest is trained with a reference, or not.
    SetUseForTraining {
        /// Which frame.
        frame: usize,
        /// Whether it is.
        used: bool,
    },

    /// The quality page is about this camera.
    SetQualityCamera(CameraId),
    /// What the quality page counts time in.
    SetTimeAxis(TimeAxis),
    /// The part of the time that the quality page shows; none: all of it.
    ShowSpan(Option<[f64; 2]>),
    /// The quality page makes way for a frame and one of its clicks.
    LookAt {
        /// Which frame.
        frame: usize,
        /// Which of its clicks, if one.
        click: Option<usize>,
    },

    /// What the background trainer is doing and has found out.
    Trainer(Box<TrainerStatus>),
    /// How the forest used the shown frame's features.
    Features(Box<UsedFeatures>),

    /// An operation reports how far it has come, or what came of it.
    Report(Report),
    /// Something is exported or imported.
    Transfer(TransferAction),
    /// A frame takes part in the estimation of its camera's base, or is left out.
    UseForBase {
        /// Which frame.
        frame: usize,
        /// It takes part.
        used: bool,
    },
    /// The names of a frame's clicks are mirrored.
    MirrorNames {
        /// Which frame.
        frame: usize,
        /// Left for right, near for far, or both.
        symmetry: Symmetry,
    },

    /// The open document is compared with another annotator's.
    Compare(PathBuf),

    /// The overlay's style.
    SetOverlayStyle(OverlayStyle),
    /// Dark or light.
    SetTheme(ThemeChoice),
    /// The lines of a sport have this colour.
    SetLineColour(&'static Sport, [u8; 3]),
    /// The loupe's look.
    SetLoupe(Loupe),
    /// The memory for decoded frames, MiB.
    SetPictureMemory(u32),
    /// How bright the picture is shown.
    SetPictureLook(PictureLook),
    /// How large texts and controls are; 1 is the system's.
    SetTextSize(f32),
    /// The field is another template's.
    ChooseSport(String),
    /// The side panel or the filmstrip was made larger or smaller, points; none: by the window's size.
    SetPanelSizes {
        /// The side panel's width.
        side: Option<f32>,
        /// The filmstrip's height.
        filmstrip: Option<f32>,
    },
    /// A command gets a key.
    AssignKey(Command, Chord),
    /// Every key goes back to its default.
    ResetKeys,
    /// The inspector's details unfold or fold.
    SetDetails(bool),
    /// The dialog closes.
    CloseDialog,
    /// The guide shows another page.
    ShowGuidePage(GuidePage),
    /// A message goes away.
    DismissNotice(u64),
    /// A message from outside.
    Notify(Level, String),

    /// A path has to be typed, for want of a file dialog.
    TypePath(Question),
    /// The path that was asked for.
    Answer(Question, PathBuf),
    /// A document, folder or video is to be opened.
    Open(PathBuf),
    /// How far the opening has come, in words.
    Progress(String),
    /// It is open.
    Opened(Box<Opened>),
    /// This window has the document open already.
    AlreadyOpen(PathBuf),
    /// A field template of the user's own was read, or cannot be.
    TemplateRead {
        /// The file of the document that names it.
        of: PathBuf,
        /// Its path as the document writes it.
        name: String,
        /// What it says.
        template: Result<Box<Template>, FieldError>,
    },
    /// Read the field templates again that could not be read.
    ReadFailedTemplatesAgain,
    /// Something that was asked for could not be done: one line.
    Failed(String),
    /// A camera base was read from another document.
    CameraLoaded(Box<Camera>),
    /// Every edit up to this revision is in the journal or the document.
    Saved {
        /// The revision.
        revision: u64,
        /// The local time, "12:03:41".
        at: String,
        /// The document itself was written, not only the journal: the last [`Effect::Save`](super::Effect::Save) before that.
        document: Option<u64>,
    },
    /// Edits are only in memory.
    SaveFailed(String),
    /// The saver lost track of the document and has to be given all of it.
    WholeWanted,
    /// Another program changed the document.
    ChangedOutside {
        /// Its file.
        path: PathBuf,
        /// What this window holds, as it was kept beside, if it holds anything of its own.
        own: Option<Orphan>,
    },
    /// The question what to do with another program's version is asked again.
    AskOutside,
    /// What becomes of another program's version.
    ResolveOutside(OutsideChoice),
    /// What another program made of the document.
    Outside(Box<Outside>),
    /// Edits that were set aside are joined with the document.
    MergeOrphan(PathBuf),
    /// They were read.
    OrphanRead {
        /// Their file.
        orphan: PathBuf,
        /// What it holds.
        edits: Box<OrphanEdits>,
    },
    /// Edits that were set aside are written as a document of their own.
    SaveOrphan(PathBuf),
    /// They were.
    OrphanSaved {
        /// The document.
        document: PathBuf,
    },
    /// Edits that were set aside are in the document now; their file has another name.
    OrphanPutAway {
        /// Their file.
        orphan: PathBuf,
        /// What it is called now.
        renamed: PathBuf,
    },
    /// The window closes, or another document is opened, although edits are only in memory.
    LeaveUnsaved,
    /// A copy was written.
    Copied(PathBuf),
    /// The window asked to close.
    CloseRequested,
}
