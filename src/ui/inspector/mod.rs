//! The inspector: everything about the shown frame, on the right of the picture.
//!
//! From top to bottom: field map, points, solution, details. Verdict and main button are at the
//! bottom and always in view, because they are the decision for which the rest is the evidence.

mod accept;
mod clicks;
mod details;
mod solution;
mod verdict;

pub use solution::{TILT_DEG, focal_range_px};

/// Shows the main button, for other panels.
pub use accept::show as accept;

use super::Panel;
use crate::ui::controls::theme::{self, Themed as _};
use crate::ui::maps::field_map;
use egui::{Frame, Margin, ScrollArea, Sense, Ui, vec2};

/// Minimum height below the list of points, for the solution and the collapsed details, points.
const BELOW_CLICKS: f32 = 148.0;
/// Height that points and solution need below the field map, points. In a low window the field map
/// gives way to them.
const BELOW_MAP: f32 = 284.0;
/// Minimum height of the field map, points.
const LEAST_MAP: f32 = 104.0;
/// Maximum height of the verdict as a share of the panel; beyond that it scrolls.
const MOST_VERDICT: f32 = 0.4;

pub fn show(panel: &mut Panel<'_>, ui: &mut Ui) {
    if panel.app.frame().is_none() {
        return;
    }
    let height = ui.available_height();
    // From the bottom: the main button and the verdict; then the map at the top; the rest scrolls.
    decide(panel, ui);
    verdict_row(ui, MOST_VERDICT * height, |ui| verdict::show(panel, ui));
    if panel.app.settings.field_map {
        // The room is computed with the verdict's minimum height, not with its present one, so that
        // the map does not change its size with every verdict.
        field_map::show(
            panel,
            ui,
            (height - DECIDE - verdict::HEIGHT - BELOW_MAP).max(LEAST_MAP),
        );
    }
    // Expanded details need room, so the list of points is limited to eight rows.
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

/// Shows the verdict above the main button, as high as its contents but at most `most` points.
fn verdict_row(ui: &mut Ui, most: f32, contents: impl FnOnce(&mut Ui)) {
    // The panel's height must be known before its contents are laid out. So the height of the
    // previous frame of the window is used, and one that differs is drawn again at once.
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

/// Height of the row at the bottom with the main button, points.
const DECIDE: f32 = 44.0 + 4.0 * theme::SPACE;

/// Shows the row at the bottom of a panel with its main button.
pub fn decide(panel: &mut Panel<'_>, ui: &mut Ui) {
    egui::Panel::bottom("accept")
        .resizable(false)
        .exact_size(DECIDE)
        .frame(Frame::new().inner_margin(Margin::same(8)))
        .show(ui, |ui| accept::show(panel, ui));
}

/// Draws a thin line between two groups.
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
