//! Colours, spacing and type of the window.

/// Dresses a window.
pub fn apply(_ctx: &egui::Context) {}
