//! The state of the window: not saved, not undone.

pub use super::filter::{Filter, is_to_do, status_label};

use super::base::BaseWork;
use super::bulk::BulkWork;
use super::choices::{QualityChoice, Scope};
use super::guide::GuidePage;
use super::naming::NameCandidate;
use super::reclick::Reclick;
use super::review_choice::ReviewChoice;
use super::tour::Tour;
use super::tracking::{LastCarried, Tracking};
use super::transfer::Transfer;
use super::unclicked::UnclickedWork;
use super::video::VideoState;
use super::{Command, Comparison, TrainerState};
use crate::calibrate::FoundCamera;
use crate::camera::PtzCamera;
use crate::document::{CameraId, Frame, FrameId, RejectReason, Shared, Target};
use crate::exchange::Format;
use crate::geometry::ImagePoint;
use crate::proposals::FoundMask;
use crate::scene::uncertainty::UncertaintyView;
use crate::store::Orphan;
use std::collections::{BTreeMap, BTreeSet};
use std::path::PathBuf;
use std::sync::Arc;

/// How many candidates are offered at the cursor.
pub const OFFERED: usize = 5;

/// What the window shows and what has been begun.
#[derive(Debug, Default)]
pub struct Session {
    /// The current frame's place in the document.
    pub frame: usize,
    /// The frames selected on the filmstrip: none, or at least two.
    pub frames_selected: BTreeSet<usize>,
    /// The selected click of the current frame.
    pub selected: Option<usize>,
    /// What has been begun.
    pub mode: Mode,
    /// Where the pointer is over the picture, px of the picture.
    pub hover: Option<ImagePoint>,
    /// The click that was just placed and named without asking, until something else is done.
    pub named_unasked: Option<usize>,
    /// The clicks of the shown frame that were just moved onto the paint, until something else is done.
    pub just_snapped: Vec<usize>,
    /// The next click is a point on a line.
    pub next_on_line: bool,
    /// Which frames the filmstrip shows.
    pub filter: Filter,
    /// What the right-hand side shows.
    pub panel: SidePanel,
    /// What lies over the window.
    pub dialog: Option<Dialog>,
    /// The page of the guide that was read last.
    pub guide_page: GuidePage,
    /// The sport that the name of the pictures speaks of, while it is asked for.
    pub sport_guess: Option<&'static str>,
    /// How the picture is shown; kept from frame to frame.
    pub view: PictureView,
    /// Commands that act while their key is down.
    pub held: Held,
    /// How the uncertainty is shown.
    pub uncertainty: UncertaintyView,
    /// The masks are shown and can be drawn.
    pub masks: bool,
    /// What was chosen in the review panel.
    pub review: ReviewChoice,
    /// Suggestions that a person took out of those that are accepted together.
    pub unticked: BTreeSet<FrameId>,
    /// What was chosen on the quality page, and whether it takes the window.
    pub quality: QualityChoice,
    /// Messages that nobody has answered or dismissed, the latest last.
    pub notices: Vec<Notice>,
    /// Every message that was shown, the latest last; the oldest go.
    pub told: Vec<(Level, String)>,
    /// How far what was done is on disk.
    pub saving: Saving,
    /// Cameras that are being carried through a clip.
    pub tracking: Option<Tracking>,
    /// What was carried last.
    pub carried: Option<LastCarried>,
    /// What is being done about the camera's base.
    pub base: BaseWork,
    /// A change after which many frames are solved again, while it is worked out.
    pub bulk: Option<BulkWork>,
    /// The camera and frame of the last notice that a camera stops fitting.
    pub told_change: Option<(CameraId, usize)>,
    /// What the background trainer is doing.
    pub trainer: TrainerState,
    /// The comparison with another annotator's document.
    pub comparison: Comparison,
    /// A document is being read.
    pub opening: Option<String>,
    /// The window may close once everything is on disk.
    pub closing: bool,
    /// Another program changed this file of the document, and the user has not decided what to do about it.
    pub changed_outside: Option<PathBuf>,
    /// The revision that is being copied elsewhere, and the one that was.
    pub copies: Copies,
    /// Edits of another version of the document that were set aside.
    pub orphans: Vec<Orphan>,
    /// The scale at which the picture fits its canvas, physical px of the screen per px of the picture; the viewport keeps it true.
    pub fit_scale: f64,
    /// The frame whose camera is being pulled onto the painted lines.
    pub snapping: Option<Snapping>,
    /// What is being done about a camera without a click.
    pub unclicked: UnclickedWork,
    /// The camera that was found last without a click, for its map.
    pub found_camera: Option<Arc<FoundCamera>>,
    /// How many snaps have been asked for.
    pub snap_tickets: u64,
    /// The cameras of frames before they were snapped.
    pub before_snap: BTreeMap<FrameId, PtzCamera>,
    /// Graphics that look burned into the pictures, until somebody decides about them.
    pub burnt_in: Vec<FoundMask>,
    /// The frame, as it was, of which it was asked whether it is to be accepted although its verdict is wrong.
    pub doubted: Option<Doubted>,
    /// What is done with the video of the shown frame.
    pub video: VideoState,
    /// The tour on the demo match, while it lasts.
    pub tour: Option<Tour>,
    /// What was chosen for exports and imports, and what is under way.
    pub transfer: Transfer,
    next_notice: u64,
}

/// A frame whose camera is being pulled onto the painted lines.
#[derive(Clone, Debug, PartialEq)]
pub struct Snapping {
    /// Which order.
    pub ticket: u64,
    /// The frame as it was then.
    pub frame: Shared<Frame>,
    /// Whether its camera is searched by the lines alone.
    pub from_nothing: bool,
    /// How far a search has come, from 0 to 1; none before it says so.
    pub progress: Option<f64>,
}

impl Snapping {
    /// What is being searched for, in one sentence; none for a snap, which is over at once.
    #[must_use]
    pub fn describe(&self) -> Option<String> {
        let far = self.progress.map(|share| format!(": {:.0} %", 100.0 * share)).unwrap_or_default();
        self.from_nothing.then(|| format!("Searching the painted lines of {}{far}…", self.frame.name()))
    }
}

/// A frame that was to be accepted although its verdict is wrong.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Doubted {
    /// Which frame.
    pub frame: FrameId,
    /// The document's version then: after a change it is asked again.
    pub version: u64,
    /// It was to stay shown.
    pub stay: bool,
}

/// Copies of the document that were written elsewhere.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Copies {
    /// The revision that is being written.
    pub begun: Option<u64>,
    /// The latest that was written.
    pub written: Option<u64>,
}

/// What has been begun and not ended.
#[derive(Clone, Debug, Default, PartialEq)]
pub enum Mode {
    /// Nothing.
    #[default]
    Idle,
    /// A point is held by the pointer.
    Dragging {
        /// Which click.
        click: usize,
        /// It was placed by this very press and has no name yet.
        placed: bool,
    },
    /// A point waits for its name.
    Naming(Naming),
    /// Landmark first: the next click in the picture shows this.
    Placing(Target),
    /// The reason is asked for.
    Rejecting {
        /// For every frame of the shot.
        whole_shot: bool,
    },
    /// A number is being changed.
    Editing,
    /// Gold frames are clicked again, blind.
    ClickingAgain(Reclick),
}

/// A point that waits for its name.
#[derive(Clone, Debug, PartialEq)]
pub struct Naming {
    /// Which click.
    pub click: usize,
    /// Every name it may get, best first.
    pub candidates: Vec<NameCandidate>,
    /// What has been typed to filter them.
    pub typed: String,
    /// Lines are offered and not landmarks.
    pub lines: bool,
    /// The candidate under the pointer or chosen with the arrow keys, within those offered.
    pub highlighted: usize,
}

impl Naming {
    /// The candidates on offer: at most [`OFFERED`], after the filter.
    #[must_use]
    pub fn offered(&self) -> Vec<&NameCandidate> {
        let mut matching = super::naming::matching(&self.candidates, &self.typed);
        matching.truncate(OFFERED);
        matching
    }

    /// The candidate that Enter takes.
    #[must_use]
    pub fn chosen(&self) -> Option<&NameCandidate> {
        self.offered().get(self.highlighted).copied()
    }
}

/// A reason as a person reads it.
#[must_use]
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

/// How the picture lies in its canvas.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub enum PictureView {
    /// The whole picture.
    #[default]
    Fit,
    /// Enlarged.
    Zoomed {
        /// Physical px of the screen per px of the picture: 1 is 100 % at any density.
        scale: f64,
        /// What lies in the middle of the canvas, px of the picture.
        centre: ImagePoint,
    },
}

/// Commands that act while their key is down.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Held {
    /// The overlay is hidden.
    pub hide_overlay: bool,
    /// The other solution is shown.
    pub compare: bool,
    /// The camera is shown as it was before it was snapped.
    pub before_snap: bool,
}

/// How far what was done is on disk.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub enum Saving {
    /// Nothing has been done.
    #[default]
    Untouched,
    /// An edit is on its way.
    Pending,
    /// Every edit is on disk.
    Saved {
        /// The local time, "12:03:41".
        at: String,
    },
    /// Edits are only in memory.
    Failed {
        /// One line.
        message: String,
        /// The time of the last success, if any.
        since: Option<String>,
    },
}

/// A message that does not take the focus.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Notice {
    /// Tells messages apart.
    pub id: u64,
    /// How serious it is.
    pub level: Level,
    /// One or two sentences.
    pub text: String,
    /// Remedies, as buttons.
    pub offers: Vec<(&'static str, Command)>,
}

impl Notice {
    /// Whether a command is one of its remedies.
    #[must_use]
    pub fn offers(&self, command: Command) -> bool {
        self.offers.iter().any(|(_, offered)| *offered == command)
    }
}

/// How serious a message is.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Level {
    /// Information; without a button it disappears by itself.
    Info,
    /// Asks for a decision; stays until it is answered or closed.
    Question,
    /// Stays until it is closed.
    Warning,
    /// Something failed; stays until it is closed.
    Error,
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

impl Session {
    /// Something else is done: what was said of the points that were just placed goes.
    pub fn forget_placed(&mut self) {
        self.named_unasked = None;
        self.just_snapped.clear();
    }

    /// Shows a message; one that says the same is replaced.
    pub fn notify(&mut self, level: Level, text: impl Into<String>) {
        self.notify_with(level, text, []);
    }

    /// Shows a message with ways out.
    pub fn notify_with(
        &mut self,
        level: Level,
        text: impl Into<String>,
        offers: impl IntoIterator<Item = (&'static str, Command)>,
    ) {
        /// So many wait at most: then the oldest that only informs goes.
        const WAITING: usize = 20;
        /// So many are remembered.
        const REMEMBERED: usize = 200;
        let text = text.into();
        if self.told.len() >= REMEMBERED {
            self.told.remove(0);
        }
        self.told.push((level, text.clone()));
        self.notices.retain(|notice| notice.text != text);
        self.next_notice += 1;
        self.notices.push(Notice { id: self.next_notice, level, text, offers: offers.into_iter().collect() });
        if self.notices.len() > WAITING {
            let gone = self.notices.iter().position(|notice| notice.level == Level::Info).unwrap_or(0);
            self.notices.remove(gone);
        }
    }

    /// Whether a message offers a command.
    #[must_use]
    pub fn offers(&self, command: Command) -> bool {
        self.notices.iter().any(|notice| notice.offers(command))
    }

    /// Takes back the messages that offer a command: it has been done, or makes no sense any more.
    pub fn retract(&mut self, command: Command) {
        self.notices.retain(|notice| !notice.offers(command));
    }
}
