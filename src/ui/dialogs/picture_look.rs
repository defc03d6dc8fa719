//! Brightness, contrast and gamma of the picture. The picture stays in view and follows at once.

use super::floating;
use crate::ui::Panel;
use crate::ui::controls::theme;
use crate::ui::controls::theme::Themed as _;
use egui::{Button, Context, Grid, RichText, Slider};
use touchline_application::app::{Action, Command, SettingsAction};
use touchline_application::scene::PictureLook;

/// Shows the dialog.
pub fn show(panel: &mut Panel<'_>, ctx: &Context) {
    floating(panel, ctx, "Brightness and contrast", |panel, ui| {
        let before = panel.app.settings.picture;
        let mut look = before;
        Grid::new("picture look")
            .num_columns(2)
            .spacing([12.0, 8.0])
            .show(ui, |ui| {
                for (name, value, tip) in [
                    (
                        "Brightness",
                        &mut look.brightness,
                        "Brightness; 1 = unchanged.",
                    ),
                    ("Contrast", &mut look.contrast, "Contrast; 1 = unchanged."),
                    (
                        "Gamma",
                        &mut look.gamma,
                        "More brightens shadows and keeps black and white; 1 = unchanged.",
                    ),
                ] {
                    ui.label(name);
                    // Logarithmic: these are factors, and half is as far from 1 as double.
                    let slider = Slider::new(value, PictureLook::RANGE)
                        .logarithmic(true)
                        .fixed_decimals(2);
                    ui.add(slider).accessible_name(name).on_hover_text(tip);
                    ui.end_row();
                }
            });
        ui.add_space(theme::SPACE);
        let default = PictureLook::default();
        let reset = ui.add_enabled(look != default, Button::new("Reset to defaults"));
        let reset = reset
            .on_hover_text("Show the picture as it is.")
            .on_disabled_hover_text("The picture is as it is.");
        if reset.clicked() {
            look = default;
        }
        let keys = &panel.app.settings.keys;
        let tip = keys.with_key(Command::PictureLook, |key| {
            format!("{key} opens and closes this.")
        });
        ui.label(RichText::new(tip).small().color(ui.palette().weak));
        if look != before {
            panel
                .actions
                .push(Action::Settings(SettingsAction::PictureLook(look)));
        }
    });
}
