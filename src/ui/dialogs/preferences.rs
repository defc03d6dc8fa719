//! Everything that belongs to the user and not to a project, in one place.

use super::sheet;
use crate::app::settings::TEXT_SIZE;
use crate::app::{Action, Command};
use crate::ui::{Panel, theme};
use egui::{Button, Context, Label, RichText, Slider, Ui, vec2};

/// Switches, with what the settings say of each.
const SWITCHES: [Command; 4] =
    [Command::SnapPoints, Command::SnapSuggestions, Command::BaseOnPaint, Command::ShowFieldMap];
/// Dialogs with more of the user's own.
const MORE: [Command; 3] = [Command::OverlayStyle, Command::PictureLook, Command::Keys];
/// What is kept, and where nothing goes.
const KEPT: &str = "Every edit is saved at once, to a journal beside the project. Forest and features are in the hidden folder \
                    .touchline beside the project, which can be deleted at any time. There is no telemetry: touchline sends nothing anywhere.";

/// Shows the sheet.
pub fn show(panel: &mut Panel<'_>, ctx: &Context) {
    sheet(panel, ctx, "Preferences", vec2(480.0, 460.0), |panel, ui| {
        theme::title(ui, "WINDOW");
        text_size(panel, ui);
        let sized = panel.app.settings.side_width.is_some() || panel.app.settings.filmstrip_height.is_some();
        let reset = ui.add_enabled(sized, Button::new("Reset the sizes of the panels"));
        let reset = reset.on_hover_text("Give side panel and filmstrip their default sizes.");
        if reset.on_disabled_hover_text("The panels have their default sizes.").clicked() {
            panel.actions.push(Action::SetPanelSizes { side: None, filmstrip: None });
        }
        ui.add_space(2.0 * theme::SPACE);
        theme::title(ui, "LABELLING");
        for command in SWITCHES {
            switch(panel, ui, command);
        }
        ui.add_space(2.0 * theme::SPACE);
        theme::title(ui, "LOOK AND KEYS");
        ui.horizontal(|ui| {
            for command in MORE {
                if ui.button(command.name()).on_hover_text(panel.app.settings.keys.tooltip(command)).clicked() {
                    panel.actions.push(Action::Command(command));
                }
            }
        });
        ui.add_space(2.0 * theme::SPACE);
        theme::title(ui, "WHAT IS KEPT");
        ui.add(Label::new(RichText::new(KEPT).color(theme::TEXT)).wrap());
    });
}

/// How large texts and controls are; it changes once the slider is let go, as it moves the slider itself.
fn text_size(panel: &mut Panel<'_>, ui: &mut Ui) {
    let memory = egui::Id::unique("text size");
    let known = panel.app.settings.text_size;
    let mut size = ui.data(|data| data.get_temp::<f32>(memory)).unwrap_or(known);
    ui.horizontal(|ui| {
        ui.label("Text size");
        let slider = Slider::new(&mut size, TEXT_SIZE).step_by(0.05).fixed_decimals(2);
        let response = ui.add(slider).accessible_name("Text size");
        let response = response.on_hover_text("The size of texts and controls; 1 is the system's.");
        let held = response.dragged();
        ui.data_mut(|data| {
            if held {
                data.insert_temp(memory, size);
            } else {
                data.remove::<f32>(memory);
            }
        });
        if !held && size != known {
            panel.actions.push(Action::SetTextSize(size));
        }
    });
}

fn switch(panel: &mut Panel<'_>, ui: &mut Ui, command: Command) {
    let settings = &panel.app.settings;
    let before = match command {
        Command::SnapPoints => settings.snap_points,
        Command::SnapSuggestions => settings.snap_suggestions,
        Command::BaseOnPaint => settings.base_on_paint,
        _ => settings.field_map,
    };
    let why_not = panel.app.why_not(command);
    let mut on = before;
    ui.add_enabled_ui(why_not.is_none(), |ui| {
        let switch = ui.checkbox(&mut on, command.name()).on_hover_text(command.about());
        switch.on_disabled_hover_text(why_not.unwrap_or_default());
    });
    if on != before {
        panel.actions.push(Action::Command(command));
    }
}
