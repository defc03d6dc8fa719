//! dialogs

use super::Panel;

/// The sheet of keys waits for a key.
pub fn captures_keys(_ctx: &egui::Context) -> bool {
    false
}

/// Shows it.
pub fn show(_panel: &mut Panel<'_>, _ui: &mut egui::Ui) {}
