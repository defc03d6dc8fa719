//! The window: panels as functions of the state.
//!
//! A panel reads the [`App`] and pushes [`Action`]s; only the shell hands them to `App::update` and
//! carries effects out. Everything that can be tested without widgets lives in `app`.

mod bar;
mod camera_panel;
mod canvas;
mod coverage_map;
mod dialogs;
mod empty;
mod field_map;
mod files;
mod filmstrip;
mod input_queue;
mod inspector;
mod keys;
mod labels;
mod layout;
mod loupe;
mod masks;
mod menu;
mod miniature;
mod naming;
mod notices;
mod number;
mod overlay;
mod pictures;
mod placement;
mod plot;
mod quality;
mod reclick;
mod rejecting;
mod resizing;
mod review;
mod shell;
mod status;
mod symbol;
mod theme;
mod timeline;
mod tour;
mod trainer;
mod typing;
mod viewport;
mod window;

pub use layout::{read, show};
pub use pictures::Pictures;
pub use shell::Shell;
pub use theme::apply as apply_theme;
pub use touchline_application::jobs::PictureState;
pub use window::{WindowError, run};

use touchline_application::app::{Action, App};

/// What every panel is given.
pub struct Panel<'a> {
    /// The state.
    pub app: &'a App,
    /// Pictures and thumbnails of frames.
    pub pictures: &'a mut Pictures,
    /// What the user asks for.
    pub actions: &'a mut Vec<Action>,
    /// The graphics adapter's name and interface, for the diagnostic report.
    pub adapter: &'a str,
}
