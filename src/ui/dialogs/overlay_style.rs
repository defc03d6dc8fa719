//! The look of the overlay (colour, width and opacity of the lines) and of the picture (brightness,
//! contrast, gamma). The picture stays in view and follows at once.

use super::floating;
use crate::ui::Panel;
use crate::ui::controls::theme::{self, Themed as _};
use egui::{
    Button, Color32, Context, CornerRadius, Grid, Rect, Role, Sense, Slider, Stroke, StrokeKind,
    Ui, Vec2, WidgetInfo, vec2,
};
use touchline_application::app::{Action, Command, SettingsAction};
use touchline_application::scene::{
    Ground, LINE_COLOURS, LineColour, OverlayStyle, PictureLook, Sport,
};

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
            panel.set(SettingsAction::OverlayStyle(style));
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
    if let Some(taken) = show_swatches(ui, "", ground, panel.app.overlay_style().colour) {
        panel.act(match sport {
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

/// Side of a colour's square, points.
const SIDE: f32 = 20.0;

/// Shows the colours, and at the end a button for any other. Returns the one that was chosen.
/// `whose` is put before the accessible names.
pub fn show_swatches(
    ui: &mut Ui,
    whose: &str,
    ground: Option<Ground>,
    chosen: [u8; 3],
) -> Option<[u8; 3]> {
    // Without a known sport no colour is safe, and all are shown without an underline.
    let is_safe =
        |colour: &LineColour| ground.is_some_and(|ground| colour.safe_on.contains(&ground));
    let (safe, other): (Vec<_>, Vec<_>) = LINE_COLOURS.iter().partition(|colour| is_safe(colour));
    let mut taken = None;
    ui.horizontal(|ui| {
        ui.spacing_mut().item_spacing.x = theme::SPACE;
        let safe_width = safe.len() as f32 * (SIDE + theme::SPACE) - theme::SPACE;
        // The line that underlines the safe colours.
        let below = Rect::from_min_size(
            ui.cursor().left_top() + vec2(0.0, SIDE + 1.0),
            vec2(safe_width, 1.0),
        );
        for colour in safe.iter().chain(&other) {
            let tip = match (ground, is_safe(colour)) {
                (Some(_), true) => format!(
                    "{}: easy to see on the ground with every kind of colour vision.",
                    colour.name
                ),
                (Some(_), false) => format!(
                    "{}: hard to see on the ground with some kinds of colour vision.",
                    colour.name
                ),
                (None, _) => format!("{}.", colour.name),
            };
            if swatch(ui, colour, whose, chosen == colour.rgb, &tip) {
                taken = Some(colour.rgb);
            }
        }
        if !safe.is_empty() {
            ui.painter().hline(
                below.x_range(),
                below.top(),
                Stroke::new(2.0, ui.palette().good),
            );
        }
        let mut any = chosen;
        ui.color_edit_button_srgb(&mut any)
            .accessible_name(format!("{whose}Any colour"))
            .on_hover_text("Any other colour.");
        if any != chosen {
            taken = Some(any);
        }
    });
    // A click on the present colour is no choice.
    taken.filter(|taken| *taken != chosen)
}

/// Shows a colour as a button. Returns whether it was clicked.
fn swatch(ui: &mut Ui, colour: &LineColour, whose: &str, chosen: bool, tip: &str) -> bool {
    let (rect, response) = ui.allocate_exact_size(Vec2::splat(SIDE), Sense::click());
    let name = format!("{whose}{}", colour.name);
    response.widget_info(|| WidgetInfo::selected(Role::Button, true, chosen, &name));
    let painter = ui.painter();
    let [r, g, b] = colour.rgb;
    painter.rect_filled(
        rect.shrink(2.0),
        CornerRadius::same(3),
        Color32::from_rgb(r, g, b),
    );
    // The border makes white visible on a light ground.
    let border = Stroke::new(1.0, ui.palette().window_line);
    painter.rect_stroke(
        rect.shrink(2.0),
        CornerRadius::same(3),
        border,
        StrokeKind::Inside,
    );
    if chosen || response.hovered() || response.has_focus() {
        let line = Stroke::new(if chosen { 2.0 } else { 1.0 }, ui.palette().strong);
        painter.rect_stroke(rect, CornerRadius::same(4), line, StrokeKind::Inside);
    }
    response.on_hover_text(tip).clicked()
}

/// Shows the dialog.
pub fn show_picture_look(panel: &mut Panel<'_>, ctx: &Context) {
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
        theme::small_weak(ui, tip);
        if look != before {
            panel.set(SettingsAction::PictureLook(look));
        }
    });
}
