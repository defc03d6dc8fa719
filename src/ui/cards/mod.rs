//! The cards at the top of the side panel: the work that runs, and what is missing for a base of
//! the shown camera. They are above every panel beside the picture, so that *now* and *next* have
//! one place.

mod base;
mod job;

use super::Panel;
use crate::ui::controls::theme::Themed as _;
use egui::{Frame, Margin, Ui};
use touchline_application::app::session::SidePanel;

/// Shows the cards that apply.
pub fn show(panel: &mut Panel<'_>, ui: &mut Ui) {
    for under_way in panel.app.under_way() {
        card(ui, |ui| job::show(panel, ui, &under_way));
    }
    // Panels about other things keep their room.
    let is_about_base = matches!(
        panel.app.session.panel,
        SidePanel::Frame | SidePanel::Camera
    );
    if is_about_base && panel.app.round().is_none() {
        base::show(panel, ui);
    }
}

/// A card: raised ground, over the whole width of the panel.
fn card(ui: &mut Ui, contents: impl FnOnce(&mut Ui)) {
    Frame::new()
        .fill(ui.palette().raised)
        .corner_radius(6)
        .outer_margin(Margin {
            left: 8,
            right: 8,
            top: 8,
            bottom: 0,
        })
        .inner_margin(Margin::same(8))
        .show(ui, |ui| {
            ui.set_width(ui.available_width());
            contents(ui);
        });
}
