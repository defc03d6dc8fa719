//! The masks (boxes that are excluded from feature detection), as a list.

use super::section;
use crate::app::{Action, Command};
use crate::document::Camera;
use crate::geometry::PixelBox;
use crate::ui::symbol::{self, Symbol};
use crate::ui::{Panel, theme};
use egui::{Align, Button, Layout, RichText, Ui};

/// Shows the list.
pub fn show(panel: &mut Panel<'_>, ui: &mut Ui, camera: &Camera) {
    section(ui, "MASKS");
    let of_frame = panel.app.frame().map(|frame| frame.masks.clone()).unwrap_or_default();
    if camera.masks.is_empty() && of_frame.is_empty() {
        ui.label(RichText::new("None. Shift-drag a box around the score bug and each logo.").color(theme::WEAK));
    }
    for (of_camera, masks) in [(true, &camera.masks), (false, &of_frame)] {
        for (index, mask) in masks.iter().enumerate() {
            row(panel, ui, of_camera, index, mask);
        }
    }
    let command = Command::ShowMasks;
    let says = if panel.app.session.masks { "Done drawing" } else { "Draw masks" };
    if ui.add(Button::new(says).small()).on_hover_text(panel.app.settings.keys.tooltip(command)).clicked() {
        panel.actions.push(Action::Command(command));
    }
}

fn row(panel: &mut Panel<'_>, ui: &mut Ui, of_camera: bool, index: usize, mask: &PixelBox) {
    ui.horizontal(|ui| {
        let whose = if of_camera { "every frame" } else { "this frame" };
        ui.label(format!("{:.0}, {:.0}", mask.x, mask.y)).on_hover_text("Left and top edge, px.");
        ui.label(RichText::new(format!("{:.0} × {:.0} px", mask.width, mask.height)).color(theme::WEAK));
        ui.with_layout(Layout::right_to_left(Align::Center), |ui| {
            let name = format!("Remove mask {} of {whose}", index + 1);
            if symbol::button(ui, Symbol::Cross, &name, theme::WEAK).on_hover_text("Remove this mask.").clicked() {
                panel.actions.push(Action::RemoveMask { of_camera, index });
            }
            let other = if of_camera { "this frame only" } else { "every frame of the camera" };
            let shown = Button::new(RichText::new(whose).small()).small();
            if ui.add(shown).on_hover_text(format!("Make it a mask of {other}.")).clicked() {
                panel.actions.push(Action::MoveMask { of_camera, index });
            }
        });
    });
}
