//! The whole application without a window.
//!
//! The window (and every test) passes [`Action`]s to [`App::update`], the only place that changes
//! state; it returns
//! [`Effect`]s that the shell carries out through `jobs`; reports come back as actions. [`Current`] is what follows for
//! the shown frame: derived, never stored. [`scene`](crate::scene) turns it into what is drawn, as
//! plain data.

mod action;
pub mod camera_text;
mod choices;
mod command;
mod command_kind;
mod current;
mod derived;
mod dialog;
mod effect;
mod filter;
pub mod guidance;
pub mod guide;
mod keymap;
mod menu_group;
mod mode;
pub mod naming;
mod notice;
mod open_project;
mod opened;
pub mod operation;
pub mod operations;
pub mod place;
pub mod playing;
mod prepared;
mod progress;
mod proposed_base;
pub mod quality;
pub mod reclick;
pub mod review;
mod review_choice;
pub mod selection;
mod sentence;
pub mod session;
pub mod settings;
mod shown;
pub mod synonyms;
pub mod tour;
mod trainer;
mod update;
mod versioned;
pub mod video;
pub mod where_to_label;

pub use action::{
    Action, DiskReport, EditAction, Navigation, PointerAction, SettingsAction, ViewAction,
};
pub use choices::{CameraChoice, MaskList, MaskScope};
pub use command::Command;
pub use command_kind::CommandKind;
pub use current::Current;
pub use derived::{FrameCounts, GoldWork};
pub use effect::{Effect, Opening, OrphanOrder, Snapshot};
pub use keymap::{Chord, ChordError, Keymap};
pub use menu_group::MenuGroup;
pub use open_project::OpenProject;
pub use opened::{Opened, OutsideChoice};
pub use operations::{PaintSays, transfer};
pub use proposed_base::WithProposal;
pub use sentence::sentence;
pub use session::Question;
pub use settings::{Settings, WindowPlace};
pub use shown::Shown;
pub use trainer::{
    AnswerKey, Doing, ForestFacts, TrainerOrder, TrainerReport, TrainerState, TrainerStatus,
    UnusableReference, describe_left,
};
pub use update::MAX_SCALE;
pub use versioned::Versioned;

use current::FreshSolve;
use operation::{Report, RequestId};
use operations::Operations;
use quality::Quality;
use review::{AcceptSheet, Review};
use session::Session;
use std::sync::Arc;
use touchline_documents::document::Frames;

/// The whole application without a window.
#[derive(Debug, Default)]
pub struct App {
    /// What belongs to the user.
    pub settings: Settings,
    /// What the window shows and what has been begun.
    pub session: Session,
    /// What runs in the background on the open document, and what came of it.
    pub operations: Operations,
    open: Option<OpenProject>,
    current: Current,
    fresh: Option<FreshSolve>,
    review: Review,
    /// While suggestions are about to be accepted together.
    accept_sheet: Option<Arc<AcceptSheet>>,
    /// The frames as they were when it was opened.
    asked_to_accept: Option<Frames>,
    quality: Quality,
    /// Tells the time of what people do; none: it is not written down.
    clock: Option<fn() -> jiff::Timestamp>,
    /// A tour begins once the demo is open.
    tour_waits: bool,
    /// The last request of an operation.
    last_request: RequestId,
    /// Results that wait for the end of what the user is doing.
    waiting_reports: Vec<Report>,
    effects: Vec<Effect>,
}
