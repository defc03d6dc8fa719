//! loupe

use super::Panel;

/// Shows it.
pub fn show(_panel: &mut Panel<'_>, _ui: &mut egui::Ui) {}
