//! Colour, width and opacity of the field's lines. The picture stays in view and follows at once.

use super::{floating, swatches};
use crate::ui::Panel;
use crate::ui::controls::theme;
use egui::{Button, Context, Grid, Slider, Ui};
use touchline_application::app::{Action, Command, SettingsAction};
use touchline_application::scene::{OverlayStyle, Sport};

/// Shows the dialog.
pub fn show(panel: &mut Panel<'_>, ctx: &Context) {
    floating(panel, ctx, "Overlay style", |panel, ui| {
        colour(panel, ui);
        let before = panel.app.settings.overlay;
        let mut style = before;
        let keys = &panel.app.settings.keys;
        let hide = keys.with_key(Command::HideOverlay, |key| {
            format!("; hold {key} to hide the lines")
        });
        controls(ui, &mut style, &format!("1 is solid{hide}."));
        if style != before {
            panel
                .actions
                .push(Action::Settings(SettingsAction::OverlayStyle(style)));
        }
    });
}

/// The colour of lines for the shown sport. It is stored for each sport, because grounds differ.
fn colour(panel: &mut Panel<'_>, ui: &mut Ui) {
    let template = panel
        .app
        .shown_field_spec()
        .map(|spec| spec.template.clone())
        .unwrap_or_default();
    let sport = Sport::from_template(&template);
    ui.label(sport.map_or_else(
        || "Colour".to_owned(),
        |sport| {
            let name = sport.name.to_lowercase();
            if template.starts_with(sport.id) {
                format!("Colour for {name}")
            } else {
                format!("Colour for this sport and {name}")
            }
        },
    ));
    let ground = sport.map(|sport| sport.ground);
    if let Some(taken) = swatches::show(ui, "", ground, panel.app.overlay_style().colour) {
        panel.actions.push(match sport {
            Some(sport) => Action::Settings(SettingsAction::LineColour(sport, taken)),
            None => Action::Settings(SettingsAction::OverlayStyle(OverlayStyle {
                colour: taken,
                ..panel.app.settings.overlay
            })),
        });
    }
    ui.add_space(2.0 * theme::SPACE);
}

/// The sliders and switches, and the button that restores the defaults. `opacity` is the tooltip of
/// the opacity.
fn controls(ui: &mut Ui, style: &mut OverlayStyle, opacity: &str) {
    Grid::new("overlay style")
        .num_columns(2)
        .spacing([12.0, 8.0])
        .show(ui, |ui| {
            for (name, value, range, tip) in [
                (
                    "Width",
                    &mut style.width,
                    0.5..=12.0,
                    "The width of a line on the screen, points.",
                ),
                ("Opacity", &mut style.opacity, 0.05..=1.0, opacity),
                (
                    "Outline",
                    &mut style.outline,
                    0.0..=4.0,
                    "The dark outline on each side, points; 0: none.",
                ),
            ] {
                ui.label(name);
                ui.add(Slider::new(value, range).fixed_decimals(2))
                    .accessible_name(name)
                    .on_hover_text(tip);
                ui.end_row();
            }
            ui.label("");
            ui.checkbox(&mut style.landmarks, "Landmarks as rings")
                .on_hover_text("Mark every landmark in view once there is a solution.");
            ui.end_row();
            ui.label("");
            ui.checkbox(&mut style.residuals_times_ten, "Residuals × 10")
                .on_hover_text(
                    "Draw the distance between a point and the solution ten times as long.",
                );
            ui.end_row();
        });
    ui.add_space(theme::SPACE);
    // The defaults leave the colour, which is set for each sport.
    let delivered = OverlayStyle {
        colour: style.colour,
        ..OverlayStyle::default()
    };
    let reset = ui.add_enabled(*style != delivered, Button::new("Reset to defaults"));
    let reset = reset.on_hover_text("Restore everything but the colour.");
    if reset
        .on_disabled_hover_text("These are the defaults.")
        .clicked()
    {
        *style = delivered;
    }
}
