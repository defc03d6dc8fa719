//! The button that makes the frame a reference.

use crate::app::{Action, Command};
use crate::document::FrameStatus;
use crate::ui::symbol::{self, Symbol};
use crate::ui::{Panel, theme};
use egui::{Color32, CornerRadius, FontId, Rect, Role, Sense, Stroke, StrokeKind, Ui, WidgetInfo, vec2};

/// Shows the button.
pub fn show(panel: &mut Panel<'_>, ui: &mut Ui) {
    let why_not = panel.app.unacceptable();
    let accepted = panel.app.frame().is_some_and(|frame| frame.status == FrameStatus::Reference);
    let says = if accepted { "Accepted" } else { "Accept" };
    let command = Command::Accept;
    ui.add_enabled_ui(why_not.is_none(), |ui| {
        let size = vec2(ui.available_width(), 44.0);
        let (rect, response) = ui.allocate_exact_size(size, Sense::click());
        response.widget_info(|| WidgetInfo::labeled(Role::Button, ui.is_enabled(), says));
        let (ground, text) = match (why_not.is_some(), response.is_pointer_button_down_on(), response.hovered()) {
            (true, ..) => (theme::RAISED, theme::WEAK),
            _ if accepted && !response.hovered() => (theme::RAISED, theme::GOOD),
            (_, true, _) => (theme::ACCENT.gamma_multiply(0.8), Color32::WHITE),
            (_, _, true) => (Color32::from_rgb(92, 164, 255), theme::BACKDROP),
            _ => (theme::ACCENT, theme::BACKDROP),
        };
        let painter = ui.painter();
        painter.rect_filled(rect, CornerRadius::same(6), ground);
        if response.has_focus() {
            painter.rect_stroke(rect, CornerRadius::same(6), Stroke::new(2.0, theme::STRONG), StrokeKind::Inside);
        }
        let galley = painter.layout_no_wrap(says.to_owned(), FontId::proportional(16.0), text);
        // Text and symbol are centred together.
        let word = Rect::from_center_size(rect.center() - vec2(12.0, 0.0), galley.size());
        let sign = Rect::from_center_size(word.right_center() + vec2(16.0, 0.0), vec2(16.0, 16.0));
        painter.galley(word.min, galley, text);
        symbol::paint(painter, Symbol::Return, sign, text);
        let keys = &panel.app.settings.keys;
        let stay = keys.tooltip(Command::AcceptAndStay);
        let response = response.on_hover_text(format!("{}\n{stay}", keys.tooltip(command)));
        let response = match &why_not {
            Some(reason) => response.on_disabled_hover_text(reason),
            None => response,
        };
        if response.clicked() {
            panel.actions.push(Action::Command(command));
        }
    });
}
