//! The shown frame: field map, points, solution, verdict, details, and the button that accepts it.

mod accept;
mod clicks;
mod details;
mod solution;
mod verdict;

use super::{
    Panel, field_map,
    theme::{self, Themed as _},
};
use egui::{Frame, Margin, ScrollArea, Sense, Ui, vec2};

/// The least height below the list of points, for solution and verdict, points.
const BELOW_CLICKS: f32 = 276.0;

/// Shows the panel.
pub fn show(panel: &mut Panel<'_>, ui: &mut Ui) {
    if panel.app.frame().is_none() {
        return;
    }
    decide(panel, ui);
    if panel.app.settings.field_map {
        field_map::show(panel, ui);
    }
    // Unfolded details need room as well.
    let most = if panel.app.settings.details { 8.0 } else { f32::INFINITY };
    let room = (ui.available_height() - BELOW_CLICKS).clamp(4.0 * theme::LIST_ROW, most * theme::LIST_ROW);
    ScrollArea::vertical().id_salt("inspector").auto_shrink(false).show(ui, |ui| {
        Frame::new().inner_margin(Margin::symmetric(8, 6)).show(ui, |ui| {
            ui.set_width(ui.available_width());
            clicks::show(panel, ui, room);
            line(ui);
            solution::show(panel, ui);
            line(ui);
            verdict::show(panel, ui);
            line(ui);
            details::show(panel, ui);
        });
    });
}

/// The row at the bottom of a panel with its main button.
pub fn decide(panel: &mut Panel<'_>, ui: &mut Ui) {
    egui::Panel::bottom("accept")
        .resizable(false)
        .exact_size(44.0 + 4.0 * theme::SPACE)
        .frame(Frame::new().inner_margin(Margin::same(8)))
        .show(ui, |ui| accept::show(panel, ui));
}

/// The button that makes the shown frame a reference, for other panels too.
pub fn accept(panel: &mut Panel<'_>, ui: &mut Ui) {
    accept::show(panel, ui);
}

/// A thin line between two groups.
fn line(ui: &mut Ui) {
    let (rect, _) = ui.allocate_exact_size(vec2(ui.available_width(), 2.0 * theme::SPACE + 1.0), Sense::hover());
    ui.painter().hline(rect.x_range(), rect.center().y, egui::Stroke::new(1.0, ui.palette().line));
}
