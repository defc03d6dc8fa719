//! Opens the window, and says what ended it.

use super::Shell;
use std::path::PathBuf;
use thiserror::Error;
use touchline_application::app::WindowPlace;
use touchline_application::jobs::{Panicked, load_settings, settings_path, until_it_panics};

/// Why there is no window, or none any more.
#[derive(Debug, Error)]
pub enum WindowError {
    /// There is no display or no way to draw on it.
    #[error("{0}")]
    Closed(#[from] eframe::Error),
    /// The window system's code or the program's own gave up while the window was open, as the
    /// former does when the display goes away.
    #[error("{0}")]
    BrokeDown(#[from] Panicked),
}

/// Opens the window and returns when it is closed.
///
/// # Errors
/// There is no display or no way to draw on it, or the window broke down.
pub fn run(document: Option<PathBuf>) -> Result<(), WindowError> {
    // What is wrong with the settings is told by the window itself.
    let known = settings_path()
        .as_deref()
        .map(load_settings)
        .and_then(|(settings, _)| settings.window);
    let mut viewport = egui::ViewportBuilder::default()
        .with_title("touchline")
        .with_app_id("touchline")
        .with_inner_size(known.map_or([1280.0, 720.0], |place| place.size))
        .with_maximized(known.is_some_and(|place| place.maximized))
        .with_min_inner_size(WindowPlace::LEAST)
        .with_drag_and_drop(true);
    if let Some(position) = known.and_then(|place| place.position) {
        viewport = viewport.with_position(position);
    }
    let options = eframe::NativeOptions {
        viewport,
        ..eframe::NativeOptions::default()
    };
    let open = || {
        eframe::run_native(
            "touchline",
            options,
            Box::new(|creation| {
                let shell = Shell::new(creation, settings_path(), document)?;
                Ok(Box::new(shell))
            }),
        )
    };
    Ok(until_it_panics(open)??)
}
