//! Opens the window, and reports why it ended.

use crate::ui::Shell;
use std::path::PathBuf;
use thiserror::Error;
use touchline_application::app::WindowPlace;
use touchline_application::jobs::{Panicked, load_settings, settings_path, until_it_panics};

/// Why there is no window, or no longer one.
#[derive(Debug, Error)]
pub enum WindowError {
    /// There is no display, or no way to draw on it.
    #[error("{0}")]
    Closed(#[from] eframe::Error),
    /// Code of the program or of the window system panicked while the window was open. The window
    /// system does so when the display disappears.
    #[error("{0}")]
    BrokeDown(#[from] Panicked),
}

/// The icon in title bars and task lists, where the desktop has no entry of the program; empty, and
/// with it the window system's own, if it cannot be decoded.
fn icon() -> egui::IconData {
    eframe::icon_data::from_png_bytes(touchline_assets::ICON_PNG).unwrap_or_default()
}

/// Opens the window with `documents` and returns when it is closed.
///
/// # Errors
/// [`WindowError`]: there is no display or no way to draw on it, or the window broke down.
pub fn run(documents: Vec<PathBuf>) -> Result<(), WindowError> {
    // Only the window's place is needed here. The window reads the settings again and reports what
    // is wrong with them.
    let known = settings_path()
        .as_deref()
        .map(load_settings)
        .and_then(|(settings, _)| settings.window);
    let mut viewport = egui::ViewportBuilder::default()
        .with_title("touchline")
        .with_app_id("touchline")
        .with_icon(icon())
        .with_inner_size(known.map_or([1280.0, 720.0], |place| place.size))
        .with_maximized(known.is_some_and(|place| place.maximized))
        .with_min_inner_size(WindowPlace::MIN_SIZE)
        .with_drag_and_drop(true);
    if let Some(position) = known.and_then(|place| place.position) {
        viewport = viewport.with_position(position);
    }
    let options = eframe::NativeOptions {
        viewport,
        ..eframe::NativeOptions::default()
    };
    let ended = until_it_panics(|| {
        eframe::run_native(
            "touchline",
            options,
            Box::new(|creation| {
                let shell = Shell::new(creation, settings_path(), documents)?;
                Ok(Box::new(shell))
            }),
        )
    });
    Ok(ended??)
}

/// Shows a message in a dialog of the system and waits until it is closed; for what cannot be said
/// in the window. Does nothing where there is no such dialog.
pub fn say_in_dialog(message: &str) {
    rfd::MessageDialog::new()
        .set_level(rfd::MessageLevel::Error)
        .set_title("touchline")
        .set_description(message)
        .show();
}
