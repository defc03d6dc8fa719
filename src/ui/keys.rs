//! From the keyboard to commands.

use super::Panel;

/// Reads the keys of this frame.
pub fn read(_panel: &mut Panel<'_>, _ctx: &egui::Context) {}
