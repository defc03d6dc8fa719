//! All settings of the user, as opposed to those of a project.

use super::overlay_style::show_swatches;
use super::sheet;
use crate::ui::Panel;
use crate::ui::controls::theme::{self};
use egui::{Button, Context, Grid, ScrollArea, Slider, Ui, vec2};
use touchline_application::app::settings::{Loupe, PICTURE_MEMORY_MIB, TEXT_SIZE, ThemeChoice};
use touchline_application::app::{Command, SettingsAction};
use touchline_application::scene::SPORTS;

/// Commands that switch a setting on and off.
const SWITCHES: [Command; 4] = [
    Command::SnapPoints,
    Command::SnapSuggestions,
    Command::BaseOnPaint,
    Command::ShowFieldMap,
];
/// Commands that open further settings.
const MORE: [Command; 3] = [Command::OverlayStyle, Command::PictureLook, Command::Keys];
/// What is stored, and where.
const KEPT: &str = "Every edit is saved at once, to a journal beside the project. Forest and features are in the hidden folder \
                    .touchline beside the project, which can be deleted at any time.";
/// What is sent: nothing.
const TELEMETRY: &str = "Telemetry: none. touchline sends nothing anywhere.";
/// Width of the names of sports, points.
const SPORT: f32 = 130.0;

/// Shows the dialog.
pub fn show(panel: &mut Panel<'_>, ctx: &Context) {
    sheet(
        panel,
        ctx,
        "Preferences",
        vec2(520.0, 620.0),
        |panel, ui| {
            ScrollArea::vertical()
                .auto_shrink([false, true])
                .show(ui, |ui| {
                    group(ui, "WINDOW", |ui| {
                        theme_choice(panel, ui);
                        text_size(panel, ui);
                        panel_sizes(panel, ui);
                    });
                    group(ui, "LABELLING", |ui| {
                        for command in SWITCHES {
                            switch(panel, ui, command);
                        }
                    });
                    group(ui, "LOUPE", |ui| loupe(panel, ui));
                    group(ui, "COLOUR OF THE FIELD'S LINES, BY SPORT", |ui| {
                        colours(panel, ui);
                    });
                    group(ui, "MEMORY", |ui| memory(panel, ui));
                    group(ui, "MORE", |ui| {
                        ui.horizontal(|ui| {
                            for command in MORE {
                                panel.command_button(ui, Button::new(command.name()), command);
                            }
                        });
                    });
                    group(ui, "WHAT IS KEPT AND SENT", |ui| {
                        for text in [KEPT, TELEMETRY] {
                            theme::text(ui, text);
                        }
                    });
                });
        },
    );
}

/// A title and the settings below it.
fn group(ui: &mut Ui, title: &str, contents: impl FnOnce(&mut Ui)) {
    theme::title(ui, title);
    contents(ui);
    ui.add_space(2.0 * theme::SPACE);
}

fn theme_choice(panel: &mut Panel<'_>, ui: &mut Ui) {
    let before = panel.app.settings.theme;
    ui.horizontal(|ui| {
        ui.label("Theme");
        for (choice, name, tip) in [
            (
                ThemeChoice::Dark,
                "Dark",
                "Light on dark: pictures are assessed best on a dark background.",
            ),
            (ThemeChoice::Light, "Light", "Dark on light."),
            (
                ThemeChoice::System,
                "As the system",
                "Dark or light, as the system has it.",
            ),
        ] {
            if ui
                .radio(before == choice, name)
                .on_hover_text(tip)
                .clicked()
                && before != choice
            {
                panel.set(SettingsAction::Theme(choice));
            }
        }
    });
}

/// The button that restores the default sizes of the panels.
fn panel_sizes(panel: &mut Panel<'_>, ui: &mut Ui) {
    let sized =
        panel.app.settings.side_width.is_some() || panel.app.settings.filmstrip_height.is_some();
    let reset = ui.add_enabled(sized, Button::new("Reset the sizes of the panels"));
    let reset = reset.on_hover_text("Give side panel and filmstrip their default sizes.");
    if reset
        .on_disabled_hover_text("The panels have their default sizes.")
        .clicked()
    {
        panel.set(SettingsAction::PanelSizes {
            side: None,
            filmstrip: None,
        });
    }
}

/// The settings of the loupe.
fn loupe(panel: &mut Panel<'_>, ui: &mut Ui) {
    let before = panel.app.settings.loupe;
    let mut look = before;
    ui.checkbox(&mut look.shown, "Show the loupe")
        .on_hover_text("A magnified view around a point while you place or drag it.");
    ui.add_enabled_ui(look.shown, |ui| {
        Grid::new("loupe")
            .num_columns(2)
            .spacing([12.0, 4.0])
            .show(ui, |ui| {
                ui.label("Magnification");
                let slider = Slider::new(&mut look.magnification, Loupe::MAGNIFICATION)
                    .step_by(1.0)
                    .suffix(" ×");
                ui.add(slider)
                    .accessible_name("Magnification of the loupe")
                    .on_hover_text("Points of the screen per px.");
                ui.end_row();
                ui.label("Size");
                let slider = Slider::new(&mut look.side, Loupe::SIDE).step_by(20.0);
                ui.add(slider)
                    .accessible_name("Size of the loupe")
                    .on_hover_text("The side of the loupe, points.");
                ui.end_row();
            });
    });
    if look != before {
        panel.set(SettingsAction::Loupe(look));
    }
}

/// The colours of lines for each sport. The underlined ones can be distinguished from the sport's
/// ground with every kind of colour vision.
fn colours(panel: &mut Panel<'_>, ui: &mut Ui) {
    let text = "Underlined: easy to see on the sport's ground with every kind of colour vision.";
    theme::small_weak(ui, text);
    Grid::new("line colours")
        .num_columns(2)
        .min_col_width(SPORT)
        .spacing([8.0, 4.0])
        .show(ui, |ui| {
            for sport in &SPORTS {
                ui.label(sport.name);
                let chosen = panel.app.settings.overlay_of(sport.id).colour;
                if let Some(taken) =
                    show_swatches(ui, &format!("{}: ", sport.name), Some(sport.ground), chosen)
                {
                    panel.set(SettingsAction::LineColour(sport, taken));
                }
                ui.end_row();
            }
        });
}

/// The maximum memory for decoded frames.
fn memory(panel: &mut Panel<'_>, ui: &mut Ui) {
    let before = panel.app.settings.picture_memory_mib;
    let mut mib = before;
    ui.horizontal(|ui| {
        ui.label("Decoded frames");
        let slider = Slider::new(&mut mib, PICTURE_MEMORY_MIB).logarithmic(true).step_by(64.0).suffix(" MiB");
        ui.add(slider).accessible_name("Memory for decoded frames").on_hover_text(
            "Frames that were shown, or are about to be, stay decoded within this memory: a frame of 1920 × 1080 px takes 8 MiB.",
        );
    });
    if mib != before {
        panel.set(SettingsAction::PictureMemory(mib));
    }
}

/// The size of texts and controls. It changes when the slider is released, because the change moves
/// the slider itself.
fn text_size(panel: &mut Panel<'_>, ui: &mut Ui) {
    // The size of the drag is in egui's memory until then; without one it is that of the settings.
    let memory = egui::Id::unique("text size");
    let known = panel.app.settings.text_size;
    let mut size = ui
        .data(|data| data.get_temp::<f32>(memory))
        .unwrap_or(known);
    ui.horizontal(|ui| {
        ui.label("Text size");
        let slider = Slider::new(&mut size, TEXT_SIZE)
            .step_by(0.05)
            .fixed_decimals(2);
        let response = ui.add(slider).accessible_name("Text size");
        let response = response.on_hover_text("The size of texts and controls; 1 is the system's.");
        // During the drag the size is only remembered.
        let held = response.dragged();
        ui.data_mut(|data| {
            if held {
                data.insert_temp(memory, size);
            } else {
                data.remove::<f32>(memory);
            }
        });
        if !held && size != known {
            panel.set(SettingsAction::TextSize(size));
        }
    });
}

/// A setting as a check box.
fn switch(panel: &mut Panel<'_>, ui: &mut Ui, command: Command) {
    // A check box needs a value to change, but the command alone changes the setting.
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
        let switch = ui
            .checkbox(&mut on, command.name())
            .on_hover_text(command.about());
        switch.on_disabled_hover_text(why_not.unwrap_or_default());
    });
    if on != before {
        panel.run(command);
    }
}
