//! The shown frame: field map, points, solution, details; at the bottom, always in sight, the
//! verdict and the button that accepts the frame.

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

/// The least height below the list of points, for the solution and the folded details, points.
const BELOW_CLICKS: f32 = 148.0;
/// What the points and the solution need, points: in a low window the field map gives way to them.
const BELOW_MAP: f32 = 284.0;
/// The field map is at least this high, points.
const LEAST_MAP: f32 = 104.0;
/// The most that the verdict takes, as a share of the panel; more scrolls.
const MOST_VERDICT: f32 = 0.4;

/// Shows the panel.
pub fn show(panel: &mut Panel<'_>, ui: &mut Ui) {
    if panel.app.frame().is_none() {
        return;
    }
    let height = ui.available_height();
    decide(panel, ui);
    verdict_row(ui, MOST_VERDICT * height, |ui| verdict::show(panel, ui));
    if panel.app.settings.field_map {
        // Not from the verdict's height of this moment: the map must not jump with it.
        field_map::show(
            panel,
            ui,
            (height - DECIDE - verdict::HEIGHT - BELOW_MAP).max(LEAST_MAP),
        );
    }
    // Unfolded details need room as well.
    let most = if panel.app.settings.details {
        8.0
    } else {
        f32::INFINITY
    };
    let room =
        (ui.available_height() - BELOW_CLICKS).clamp(4.0 * theme::LIST_ROW, most * theme::LIST_ROW);
    ScrollArea::vertical()
        .id_salt("inspector")
        .auto_shrink(false)
        .show(ui, |ui| {
            Frame::new()
                .inner_margin(Margin::symmetric(8, 6))
                .show(ui, |ui| {
                    ui.set_width(ui.available_width());
                    clicks::show(panel, ui, room);
                    line(ui);
                    solution::show(panel, ui);
                    line(ui);
                    details::show(panel, ui);
                });
        });
}

/// The verdict above the main button, as high as it is.
fn verdict_row(ui: &mut Ui, most: f32, contents: impl FnOnce(&mut Ui)) {
    let memory = egui::Id::unique("height of the verdict");
    let before = ui
        .data(|data| data.get_temp::<f32>(memory))
        .unwrap_or(verdict::HEIGHT);
    let frame = Frame::new().inner_margin(Margin {
        left: 8,
        right: 8,
        top: 6,
        bottom: 0,
    });
    let area = egui::Panel::bottom("verdict")
        .resizable(false)
        .exact_size(before.min(most))
        .frame(frame);
    area.show(ui, |ui| {
        let shown = ScrollArea::vertical().id_salt("verdict").show(ui, contents);
        let height = shown.content_size.y + 8.0;
        if (height - before).abs() > 0.5 {
            ui.data_mut(|data| data.insert_temp(memory, height));
            ui.ctx().request_repaint();
        }
    });
}

/// The height of the row at the bottom with the main button, points.
const DECIDE: f32 = 44.0 + 4.0 * theme::SPACE;

/// The row at the bottom of a panel with its main button.
pub fn decide(panel: &mut Panel<'_>, ui: &mut Ui) {
    egui::Panel::bottom("accept")
        .resizable(false)
        .exact_size(DECIDE)
        .frame(Frame::new().inner_margin(Margin::same(8)))
        .show(ui, |ui| accept::show(panel, ui));
}

/// The button that makes the shown frame a reference, for other panels too.
pub fn accept(panel: &mut Panel<'_>, ui: &mut Ui) {
    accept::show(panel, ui);
}

/// A thin line between two groups.
fn line(ui: &mut Ui) {
    let (rect, _) = ui.allocate_exact_size(
        vec2(ui.available_width(), 2.0 * theme::SPACE + 1.0),
        Sense::hover(),
    );
    ui.painter().hline(
        rect.x_range(),
        rect.center().y,
        egui::Stroke::new(1.0, ui.palette().line),
    );
}
