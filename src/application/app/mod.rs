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
//! These parts are in rooms: `window_state` (the session), `project` (the open document),
//! `panel_values` (what is derived for the panels), `commands` (what the user can start). `update`
//! has what each action does, `operation` and `operations` the slow work.
//!
//! [`scene`](crate::scene) derives from the state what is drawn, as plain data.

mod action;
mod commands;
mod effect;
mod now;
pub mod operation;
pub mod operations;
mod panel_values;
pub mod playing;
mod project;
pub mod quality;
pub mod review;
pub mod settings;
mod trainer;
mod update;
mod window_state;

pub use action::{
    Action, DiskReport, EditAction, FieldChange, Navigation, PointerAction, SettingsAction,
    ViewAction,
};
pub use commands::command::{Command, CommandKind, CommandNeeds, MenuGroup};
pub use commands::keymap::{Chord, ChordError, Keymap};
pub use commands::{guide, synonyms, tour};
pub use effect::{Beside, Effect, OrphanOrder, OutsideOrder, Snapshot, TemplateOrder};
pub use now::MissingBase;
pub use operations::{BESIDE_PX, LineCheckSummary, LineOffset, transfer};
pub use panel_values::current::Current;
pub use panel_values::proposed_base::WithProposal;
pub use panel_values::sentence::sentence;
pub use panel_values::shown::DisplayedValues;
pub use panel_values::{camera_text, guidance, where_to_label};
pub use project::derived::{FrameCounts, GoldWork};
pub use project::open_project::OpenProject;
pub use project::opened::{Opened, OutsideChoice};
pub use project::review_queue::{MatchRow, QueuedFrame, ReviewQueue};
pub use project::selection;
pub use project::versioned::Versioned;
pub use settings::{Settings, WindowPlace};
pub use trainer::{
    AnswerKey, ForestFacts, TrainerActivity, TrainerOrder, TrainerReport, TrainerState,
    TrainerStatus, TrainerWishes, UnusableReference, describe_estimate, describe_left,
};
pub use update::MAX_SCALE;
pub use window_state::choices::{CameraChoice, MaskList, MaskScope};
pub use window_state::session::{Opening, Question, Tool};
pub use window_state::{corner_looks, field_draft, naming, place, reclick, session, video};

use operation::{Report, RequestId};
use operations::{ForeignLabels, Operations};
use panel_values::current::FreshSolve;
use quality::Quality;
use review::{AcceptQuestion, AcceptSheet, Review};
use std::sync::Arc;
use window_state::session::Session;

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
    /// The queue of matches that is being worked through.
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
