//! The state of the window: not saved, not undone.

pub use super::dialog::{Dialog, Leaving, Question, SidePanel};
pub use super::filter::{Filter, is_to_do, status_label};
pub use super::mode::{Mode, Naming, OFFERED};
pub use super::notice::{Level, Messages, Notice, in_row};

use super::choices::QualityChoice;
use super::guide::GuidePage;
use super::review_choice::ReviewChoice;
use super::tour::Tour;
use super::video::VideoState;
use super::{Command, TrainerState};
use crate::scene::uncertainty::UncertaintyView;
use std::collections::BTreeSet;
use std::path::PathBuf;
use touchline_core::geometry::ImagePoint;
use touchline_documents::document::{FrameId, RejectReason};
use touchline_documents::store::Orphan;

/// What the window shows and what has been begun.
#[derive(Debug, Default)]
pub struct Session {
    /// The current frame's place in the document.
    pub frame: usize,
    /// The frames selected on the filmstrip: none, or at least two.
    pub frames_selected: BTreeSet<usize>,
    /// What has been begun.
    pub mode: Mode,
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
    /// What was chosen in the review panel.
    pub review: ReviewChoice,
    /// Suggestions that a person took out of those that are accepted together.
    pub unticked: BTreeSet<FrameId>,
    /// What was chosen on the quality page, and whether it takes the window.
    pub quality: QualityChoice,
    /// What the background trainer is doing.
    pub trainer: TrainerState,
    /// The frame, as it was, of which it was asked whether it is to be accepted although its
    /// verdict is wrong.
    pub doubted: Option<Doubted>,
    /// What is done with the video of the shown frame.
    pub video: VideoState,
    /// The tour on the demo match, while it lasts.
    pub tour: Option<Tour>,
    /// The messages.
    pub messages: Messages,
    /// The points of the shown frame: which is selected, which were just placed.
    pub points: PointState,
    /// How the picture is shown.
    pub picture: PictureDisplay,
    /// How far what was done is on disk, and what waits for that.
    pub disk: DiskState,
}

/// The points of the shown frame.
#[derive(Debug, Default)]
pub struct PointState {
    /// The selected click of the current frame.
    pub selected: Option<usize>,
    /// Where the pointer is over the picture, px of the picture.
    pub hover: Option<ImagePoint>,
    /// The click that was just placed and named without asking, until something else is done.
    pub named_unasked: Option<usize>,
    /// The clicks of the shown frame that were just moved onto the paint, until something else is
    /// done.
    pub just_snapped: Vec<usize>,
    /// The next click is a point on a line.
    pub next_on_line: bool,
}

/// How the picture is shown; kept from frame to frame.
#[derive(Debug, Default)]
pub struct PictureDisplay {
    /// How the picture is shown; kept from frame to frame.
    pub view: PictureView,
    /// The scale at which the picture fits its canvas, physical px of the screen per px of the
    /// picture; the viewport keeps it true.
    pub fit_scale: f64,
    /// Commands that act while their key is down.
    pub held: Held,
    /// How the uncertainty is shown.
    pub uncertainty: UncertaintyView,
    /// The masks are shown and can be drawn.
    pub masks: bool,
}

/// How far what was done is on disk, and what waits for that.
#[derive(Debug, Default)]
pub struct DiskState {
    /// How far what was done is on disk.
    pub saving: Saving,
    /// How often the document was asked to be written.
    pub save_requests: u64,
    /// A document is being read.
    pub opening: Option<String>,
    /// What is done once everything is on disk and nobody else has changed the document.
    pub leaving: Option<Leaving>,
    /// Another program changed this file of the document, and the user has not decided what to do
    /// about it.
    pub changed_outside: Option<PathBuf>,
    /// Where what the window holds is kept until then.
    pub own_version: Option<PathBuf>,
    /// The revision that is being copied elsewhere, and the one that was.
    pub copies: Copies,
    /// Edits of another version of the document that were set aside.
    pub orphans: Vec<Orphan>,
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

impl Session {
    /// Something else is done: what was said of the points that were just placed goes.
    pub fn forget_placed(&mut self) {
        self.points.named_unasked = None;
        self.points.just_snapped.clear();
    }

    /// Shows a message; one that says the same is replaced.
    pub fn notify(&mut self, level: Level, text: impl Into<String>) {
        self.notify_with(level, text, []);
    }

    /// Shows a message with commands that it offers.
    pub fn notify_with(
        &mut self,
        level: Level,
        text: impl Into<String>,
        offers: impl IntoIterator<Item = (&'static str, Command)>,
    ) {
        self.messages
            .show(level, text.into(), offers.into_iter().collect());
    }

    /// Whether a message offers a command.
    #[must_use]
    pub fn offers(&self, command: Command) -> bool {
        self.messages
            .notices
            .iter()
            .any(|notice| notice.offers(command))
    }

    /// Takes back the messages that offer a command: it has been done, or makes no sense any more.
    pub fn retract(&mut self, command: Command) {
        self.messages
            .notices
            .retain(|notice| !notice.offers(command));
    }
}
