//! The whole application without a window.
//!
//! The window (and every test) passes [`Action`]s to [`App::update`], the only place that changes state; it returns
//! [`Effect`]s that the shell carries out through `jobs`; reports come back as actions. [`Current`] is what follows for
//! the shown frame: derived, never stored. [`scene`](crate::scene) turns it into what is drawn, as plain data.

mod action;
mod action_kind;
pub mod base;
mod bulk;
mod burnt_in;
pub mod camera_text;
mod camera_watch;
mod choices;
mod command;
mod command_kind;
mod compared;
mod current;
mod derived;
mod dialog;
mod effect;
mod filter;
pub mod guidance;
pub mod guide;
mod keymap;
mod line_checks;
mod menu_group;
mod mode;
pub mod naming;
mod notice;
mod open_project;
mod opened;
mod paint_orders;
pub mod place;
pub mod playing;
mod point_snaps;
mod prepared;
mod progress;
pub mod quality;
pub mod reclick;
pub mod review;
mod review_choice;
pub mod selection;
mod sentence;
pub mod session;
pub mod settings;
mod shot_search;
mod shown;
pub mod synonyms;
pub mod tour;
pub mod tracking;
mod trainer;
pub mod transfer;
pub mod unclicked;
mod update;
mod versioned;
pub mod video;
pub mod where_to_label;

pub use action::Action;
pub use action_kind::ActionKind;
pub use bulk::{BulkFailure, BulkOrder, BulkWork};
pub use burnt_in::BurntInSearch;
pub use camera_watch::{CameraWatch, WatchPanicked};
pub use choices::{CameraChoice, MaskList, MaskScope};
pub use command::Command;
pub use command_kind::CommandKind;
pub use compared::{Compared, Comparison};
pub use current::Current;
pub use derived::{FrameCounts, GoldWork};
pub use effect::Effect;
pub use keymap::{Chord, ChordError, Keymap};
pub use line_checks::PaintSays;
pub use menu_group::MenuGroup;
pub use open_project::OpenProject;
pub use opened::{Opened, OutsideChoice};
pub use paint_orders::{CheckedLines, LineCheckOrder, PointSnapOrder, SnapFailure, SnapOrder, SnappedFrame};
pub use sentence::sentence;
pub use session::Question;
pub use settings::{Settings, WindowPlace};
pub use shot_search::{FoundShots, ShotFailure, ShotProgress, ShotSearch};
pub use shown::Shown;
pub use tracking::{CarriedShot, LastCarried, TrackAction, TrackFailure, TrackOrder, Tracking};
pub use trainer::{
    Doing, ForestFacts, Share, TrainerOrder, TrainerState, TrainerStatus, UnusableReference, describe_left,
};
pub use update::{App, MAX_SCALE};
pub use versioned::Versioned;
pub use video::VideoAction;
