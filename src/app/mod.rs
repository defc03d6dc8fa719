//! The whole application without a window.
//!
//! The window (and every test) hands [`Action`]s to [`App::update`], the only place that changes state; it returns
//! [`Effect`]s that the shell carries out through `jobs`; reports come back as actions.

mod command;
pub mod drawing;
mod keymap;
mod settings;

pub use command::{Command, Group};
pub use keymap::{Chord, ChordError, Keymap};
pub use settings::{OverlayStyle, Settings, SettingsError};
