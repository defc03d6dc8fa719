//! The whole application without a window.
//!
//! The window, and every test, passes [`Action`]s to [`App::update`], the only function that
//! changes state. It returns [`Effect`]s (read a document, write the journal, run slow work), which
//! the shell carries out through [`jobs`](crate::jobs). Their reports come back as actions.
//!
//! | part of the state | what it is |
//! |---|---|
//! | [`Settings`] | the user's preferences, kept on disk |
//! | [`Session`] | what the window shows and what the user is doing: neither saved nor undone |
//! | [`OpenProject`] | the document, its history of undo, and the suggestions |
//! | [`Operations`] | slow work on the open document, and its results |
//! | [`Current`], [`Review`], [`Quality`] | derived from the others after every action |
//!
//! [`scene`](crate::scene) derives from the state what is drawn, as plain data.

mod action;
pub mod camera_text;
mod choices;
mod command;
mod current;
mod derived;
mod dialog;
mod effect;
mod filter;
pub mod guidance;
pub mod guide;
mod keymap;
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
mod review_queue;
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
pub use command::{Command, CommandKind, MenuGroup};
pub use current::Current;
pub use derived::{FrameCounts, GoldWork};
pub use effect::{Effect, Opening, OrphanOrder, Snapshot};
pub use keymap::{Chord, ChordError, Keymap};
pub use open_project::OpenProject;
pub use opened::{Opened, OutsideChoice};
pub use operations::{LineCheckSummary, transfer};
pub use proposed_base::WithProposal;
pub use review_queue::{QueuedFrame, ReviewQueue};
pub use sentence::sentence;
pub use session::{Question, Tool};
pub use settings::{Settings, WindowPlace};
pub use shown::DisplayedValues;
pub use trainer::{
    AnswerKey, ForestFacts, TrainerActivity, TrainerOrder, TrainerReport, TrainerState,
    TrainerStatus, UnusableReference, describe_estimate, describe_left,
};
pub use update::MAX_SCALE;
pub use versioned::Versioned;

use current::FreshSolve;
use operation::{Report, RequestId};
use operations::{ForeignLabels, Operations};
use quality::Quality;
use review::{AcceptQuestion, AcceptSheet, Review};
use session::Session;
use std::sync::Arc;

/// The state of the application; see the module.
#[derive(Debug, Default)]
pub struct App {
    /// The user's preferences, independent of the document.
    pub settings: Settings,
    /// What the window shows and what the user is doing.
    pub session: Session,
    /// The slow work on the open document, and its results.
    pub operations: Operations,
    open: Option<OpenProject>,
    current: Current,
    /// The solution of the shown frame, if the action just computed it.
    fresh: Option<FreshSolve>,
    review: Review,
    /// While frames are about to be accepted together.
    accept_sheet: Option<Arc<AcceptSheet>>,
    /// What it asks about, as it was when it opened.
    accept_question: Option<AcceptQuestion>,
    quality: Quality,
    /// Returns the present time, which is stored with repeated clicks. None in tests: no time is
    /// stored.
    clock: Option<fn() -> jiff::Timestamp>,
    /// Labels of another program that are imported as soon as their pictures are open.
    waiting_labels: Option<ForeignLabels>,
    /// The review queue of a season that is being looked through.
    queue: Option<ReviewQueue>,
    /// Whether the tour begins as soon as the demo match is open.
    tour_waits: bool,
    /// The number of the last request; see [`RequestId`].
    last_request: RequestId,
    /// Results that wait until the user ends the present change, such as a drag.
    waiting_reports: Vec<Report>,
    /// Effects of the present action; [`App::update`] returns them.
    effects: Vec<Effect>,
}
