//! The bottom row: the next step, the pointer's position, the zoom, and what undo would revert.

use super::{Panel, theme::Themed as _};
use crate::app::guidance::next_step;
use crate::app::session::PictureView;
use crate::app::{Action, App, Command};
use egui::{Align, Button, Label, Layout, RichText, Ui};

/// Shows the row.
pub fn show(panel: &mut Panel<'_>, ui: &mut Ui) {
    ui.horizontal_centered(|ui| {
        ui.with_layout(Layout::right_to_left(Align::Center), |ui| {
            undo(panel, ui);
            zoom(panel, ui);
            pointer(panel.app, ui);
            ui.with_layout(Layout::left_to_right(Align::Center), |ui| step(panel, ui));
        });
    });
}

fn step(panel: &mut Panel<'_>, ui: &mut Ui) {
    let guidance = next_step(panel.app);
    let offers_width: f32 = guidance.offers.iter().map(|(says, _)| 7.5 * says.len() as f32 + 24.0).sum();
    ui.scope(|ui| {
        ui.set_max_width((ui.available_width() - offers_width).max(60.0));
        ui.add(Label::new(RichText::new(&guidance.text).color(ui.palette().strong)).truncate())
            .on_hover_text(guidance.text.clone());
    });
    for (says, command) in guidance.offers {
        if ui.add(Button::new(says).small()).on_hover_text(panel.app.settings.keys.tooltip(command)).clicked() {
            panel.actions.push(Action::Command(command));
        }
    }
}

fn undo(panel: &mut Panel<'_>, ui: &mut Ui) {
    let Some(open) = panel.app.open() else { return };
    let Some(step) = open.history.next_undo() else { return };
    let position = step.frame.as_ref().and_then(|id| open.document.frames.position_of(id));
    let elsewhere = position.filter(|position| *position != panel.app.session.frame);
    let place = elsewhere.map(|position| format!(" (frame {})", open.frame_number(position))).unwrap_or_default();
    let button =
        Button::new(RichText::new(format!("Undo: {}{place}", step.name)).color(ui.palette().weak)).frame(false);
    if ui.add(button).on_hover_text(panel.app.settings.keys.tooltip(Command::Undo)).clicked() {
        panel.actions.push(Action::Command(Command::Undo));
    }
    ui.separator();
}

fn zoom(panel: &mut Panel<'_>, ui: &mut Ui) {
    if panel.app.frame().is_none() {
        return;
    }
    let (scale, fits) = match panel.app.session.view {
        PictureView::Fit => (panel.app.session.fit_scale, true),
        PictureView::Zoomed { scale, .. } => (scale, false),
    };
    if scale > 0.0 {
        let text = format!("{:.0} %{}", 100.0 * scale, if fits { " fit" } else { "" });
        let button = Button::new(RichText::new(text).color(ui.palette().text)).frame(false);
        let tip = format!(
            "Screen px per px of the picture. {} The wheel zooms to the pointer.",
            panel.app.settings.keys.tooltip(Command::ZoomToFit)
        );
        if ui.add(button).on_hover_text(tip).clicked() {
            panel.actions.push(Action::Command(Command::ZoomToFit));
        }
        ui.separator();
    }
}

fn pointer(app: &App, ui: &mut Ui) {
    let Some(at) = app.session.hover else { return };
    ui.label(RichText::new(format!("{:.1}, {:.1}", at.x, at.y)).monospace().color(ui.palette().text))
        .on_hover_text("The pointer, px of the picture from its top-left corner.");
    ui.separator();
}
