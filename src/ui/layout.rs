//! The layout of all panels.

use super::{
    Panel, camera_panel, dialogs, empty, filmstrip, inspector, keys, menu, naming, notices, quality, reclick,
    rejecting, review, status, theme, timeline, trainer, viewport,
};
use crate::app::session::SidePanel;
use egui::{Frame, Margin, Ui};

/// The height of the menu row and of the status row, points.
const ROW: f32 = 24.0;
/// From this width on there is room for wider panels, points.
const WIDE: f32 = 1800.0;

/// Reads keys and pointer; their actions are carried out before anything is drawn.
pub fn read(panel: &mut Panel<'_>, ctx: &egui::Context) {
    if panel.app.session.quality.open {
        // The picture is hidden, so its keys do nothing.
        keys::read(panel, ctx);
        return;
    }
    naming::read(panel, ctx);
    rejecting::read(panel, ctx);
    keys::read(panel, ctx);
    viewport::read(panel, ctx);
}

/// Shows every panel; what the user asks for is in the panel's actions afterwards.
pub fn show(panel: &mut Panel<'_>, ui: &mut Ui) {
    let (filmstrip_height, side_width) = if ui.available_width() >= WIDE { (110.0, 380.0) } else { (92.0, 300.0) };
    let row = Frame::new().fill(theme::PANEL).inner_margin(Margin::symmetric(8, 0));
    let side = Frame::new().fill(theme::PANEL);
    egui::Panel::top("menu").exact_size(ROW).resizable(false).frame(row).show(ui, |ui| menu::show(panel, ui));
    egui::Panel::bottom("status").exact_size(ROW).resizable(false).frame(row).show(ui, |ui| status::show(panel, ui));
    let is_open = panel.app.open().is_some();
    let page = panel.app.session.quality.open;
    if is_open && !page {
        egui::Panel::right("side").exact_size(side_width).resizable(false).frame(side).show(ui, |ui| {
            if panel.app.round().is_some() {
                reclick::show(panel, ui);
                return;
            }
            match panel.app.session.panel {
                SidePanel::Frame => inspector::show(panel, ui),
                SidePanel::Camera => camera_panel::show(panel, ui),
                SidePanel::Trainer => trainer::show(panel, ui),
                SidePanel::Review => review::show(panel, ui),
            }
        });
        egui::Panel::bottom("filmstrip")
            .exact_size(filmstrip_height)
            .resizable(false)
            .frame(side)
            .show(ui, |ui| filmstrip::show(panel, ui));
        if timeline::is_wanted(panel.app) {
            egui::Panel::bottom("timeline")
                .exact_size(timeline::HEIGHT)
                .resizable(false)
                .frame(row)
                .show(ui, |ui| timeline::show(panel, ui));
        }
    }
    let canvas = egui::CentralPanel::no_frame().show(ui, |ui| {
        let rect = ui.max_rect();
        if page {
            quality::show(panel, ui);
        } else if is_open {
            viewport::show(panel, ui);
        } else {
            empty::show(panel, ui);
        }
        rect
    });
    notices::show(panel, ui, canvas.inner);
    dialogs::show(panel, ui);
}
