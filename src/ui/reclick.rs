//! The side panel during a blind round: the landmark to click, its place on the field, and the
//! progress.

use super::{Panel, key_in_brackets};
use crate::ui::controls::theme::{self, Themed as _};
use crate::ui::maps::field_map;
use egui::{Button, Frame, Label, Margin, ProgressBar, RichText, Ui, vec2};
use touchline_application::app::Command;
use touchline_documents::document::Target;

/// Shows the panel. Nothing outside a round.
pub fn show(panel: &mut Panel<'_>, ui: &mut Ui) {
    let Some(round) = panel.app.round() else {
        return;
    };
    let Some(target) = round.target() else { return };
    // The numbers are copied first: the map needs the panel mutably.
    let label = panel.app.label(&Target::Landmark(target.landmark.clone()));
    let (number, count, skipped) = (round.number(), round.len(), round.skipped_count());
    let title = format!("BLIND ROUND {}", round.round);
    let clicked = round.clicked_count();
    field_map::show(panel, ui, f32::INFINITY);
    Frame::new().inner_margin(Margin::symmetric(8, 6)).show(ui, |ui| {
        ui.set_width(ui.available_width());
        theme::title(ui, &title);
        ui.add(Label::new(RichText::new(&label).heading().color(ui.palette().strong)).wrap());
        ui.add_space(theme::SPACE);
        let share = (number - 1) as f32 / count.max(1) as f32;
        ui.add(ProgressBar::new(share).desired_height(6.0));
        let skipped = if skipped > 0 { format!(", {skipped} skipped") } else { String::new() };
        ui.label(RichText::new(format!("{number} of {count}{skipped}")).color(ui.palette().text));
        ui.add_space(2.0 * theme::SPACE);
        let text = "Click it as you would label it, as carefully and at the zoom you always use. The label, its lines and the \
                    proposals are hidden; the label stays as it is.";
        theme::weak_text(ui, text);
        ui.add_space(2.0 * theme::SPACE);
        // Undo and Cancel mean something else here than elsewhere, so their tooltips do, too.
        for (says, command, why_not) in [
            ("Skip", Command::SkipAgain, None),
            ("Back", Command::Undo, (clicked == 0).then_some("No points have been clicked again yet.")),
            ("End the round", Command::Cancel, None),
        ] {
            let key = key_in_brackets(&panel.app.settings.keys, command);
            let tip = match command {
                Command::SkipAgain => panel.app.settings.keys.tooltip(command),
                Command::Undo => format!("Undo the last blind click.{key}"),
                _ => format!("The clicks so far are kept.{key}"),
            };
            let button = ui.add_enabled(why_not.is_none(), Button::new(says).min_size(vec2(110.0, 24.0)));
            if button.on_hover_text(tip).on_disabled_hover_text(why_not.unwrap_or_default()).clicked() {
                panel.run(command);
            }
        }
    });
}
