//! The choice of the reason why a frame cannot be calibrated: a short list at the top of the
//! picture, also by the keys 1 to 6. Over a narrow picture it wraps into two rows.

use super::typing;
use crate::ui::Panel;
use egui::{Align2, Area, Event, Id, Order, Rect, vec2};
use touchline_application::app::EditAction;
use touchline_application::app::session::{Mode, reason_label};
use touchline_documents::document::RejectReason;

/// Reads the keys 1 to 6 while a reason is chosen, and removes them from the input.
pub fn read(panel: &mut Panel<'_>, ctx: &egui::Context) {
    let is_choosing = matches!(panel.app.session.mode, Mode::Rejecting { .. });
    if !is_choosing || typing::keys_are_taken(panel.app, ctx) {
        return;
    }
    // The text counts and not the key, because a French keyboard needs Shift for digits. Texts that
    // choose no reason stay in the input.
    ctx.input_mut(|input| {
        input.events.retain(|event| {
            let Event::Text(text) = event else {
                return true;
            };
            let number = text
                .parse::<usize>()
                .ok()
                .and_then(|number| number.checked_sub(1));
            let Some(reason) = number.and_then(|index| RejectReason::ALL.get(index)) else {
                return true;
            };
            panel.edit(EditAction::RejectAs(*reason));
            false
        });
    });
}

/// Shows the list.
pub fn show(panel: &mut Panel<'_>, ui: &egui::Ui, bounds: Rect, whole_shot: bool) {
    Area::new(Id::NULL.with("rejecting"))
        .order(Order::Foreground)
        .pivot(Align2::CENTER_TOP)
        .fixed_pos(bounds.center_top() + vec2(0.0, 8.0))
        .constrain_to(bounds)
        .show(ui.ctx(), |ui| {
            egui::Frame::popup(ui.style())
                .inner_margin(8)
                .show(ui, |ui| {
                    ui.set_max_width(bounds.width() - 32.0);
                    let what = if whole_shot {
                        "Whole shot not calibratable:"
                    } else {
                        "Not calibratable:"
                    };
                    ui.horizontal_wrapped(|ui| {
                        ui.label(what);
                        for (index, &reason) in RejectReason::ALL.iter().enumerate() {
                            if ui
                                .button(format!("{}  {}", index + 1, reason_label(reason)))
                                .clicked()
                            {
                                panel.edit(EditAction::RejectAs(reason));
                            }
                        }
                        ui.weak("Esc cancels");
                    });
                });
        });
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::ui::{Pictures, open_with_click};
    use std::sync::Arc;
    use touchline_application::app::Action;
    use touchline_application::app::{App, Command};
    use touchline_core::geometry::ImagePoint;

    fn type_digit(app: &App) -> Vec<Action> {
        let ctx = egui::Context::default();
        ctx.begin_pass(egui::RawInput {
            events: vec![Event::Text("1".to_owned())],
            focused: true,
            ..egui::RawInput::default()
        });
        let mut pictures = Pictures::start(Arc::new(|| ())).unwrap();
        let mut actions = Vec::new();
        let mut panel = Panel {
            app,
            pictures: &mut pictures,
            actions: &mut actions,
            adapter: "",
        };
        read(&mut panel, &ctx);
        ctx.end_pass().textures_delta.clear();
        actions
    }

    #[test]
    fn a_digit_that_is_typed_over_a_dialog_rejects_nothing() {
        let mut app = open_with_click(ImagePoint::new(10.0, 20.0));
        app.update(Action::Command(Command::Reject));
        let first = EditAction::RejectAs(RejectReason::ALL[0]);
        assert_eq!(type_digit(&app), [Action::Edit(first)]);
        app.update(Action::Command(Command::Preferences));
        assert_eq!(type_digit(&app), []);
    }
}
