//! Colour, width and opacity of the field's lines; the picture stays in view and follows at once.

use super::{frame, header};
use crate::app::Action;
use crate::scene::OverlayStyle;
use crate::ui::{Panel, theme};
use egui::{
    Area, Button, Color32, Context, CornerRadius, Grid, Id, Order, Role, Sense, Slider, Stroke, StrokeKind, Ui,
    WidgetInfo, vec2,
};

/// Colours that read well on grass, and what they are called.
const COLOURS: [([u8; 3], &str); 6] = [
    ([255, 221, 64], "Yellow"),
    ([90, 225, 255], "Cyan"),
    ([255, 120, 220], "Pink"),
    ([255, 150, 60], "Orange"),
    ([170, 255, 90], "Lime"),
    ([255, 255, 255], "White"),
];

/// Shows the sheet at the upper left of the picture.
pub fn show(panel: &mut Panel<'_>, ctx: &Context) {
    let corner = ctx.content_rect().min + vec2(16.0, 40.0);
    Area::new(Id::unique("overlay style"))
        .order(Order::Foreground)
        .fixed_pos(corner)
        .role(egui::accesskit::Role::Dialog)
        .accessible_name("Overlay style")
        .show(ctx, |ui| {
            frame(ui).show(ui, |ui| {
                ui.set_width(300.0);
                header(panel, ui, "Overlay style");
                let before = panel.app.settings.overlay;
                let mut style = before;
                controls(ui, &mut style);
                if style != before {
                    panel.actions.push(Action::SetOverlayStyle(style));
                }
            });
        });
}

fn controls(ui: &mut Ui, style: &mut OverlayStyle) {
    Grid::new("overlay style").num_columns(2).spacing([12.0, 8.0]).show(ui, |ui| {
        ui.label("Colour");
        ui.horizontal(|ui| {
            ui.spacing_mut().item_spacing.x = theme::SPACE;
            for (colour, name) in COLOURS {
                if swatch(ui, colour, name, style.colour == colour) {
                    style.colour = colour;
                }
            }
            ui.color_edit_button_srgb(&mut style.colour)
                .accessible_name("Any colour")
                .on_hover_text("Any other colour.");
        });
        ui.end_row();
        for (name, value, range, tip) in [
            ("Width", &mut style.width, 0.5..=12.0, "The width of a line on the screen, points."),
            ("Opacity", &mut style.opacity, 0.05..=1.0, "1 is solid; hold H to hide the lines."),
            ("Outline", &mut style.outline, 0.0..=4.0, "The dark outline on each side, points; 0: none."),
        ] {
            ui.label(name);
            ui.add(Slider::new(value, range).fixed_decimals(2)).accessible_name(name).on_hover_text(tip);
            ui.end_row();
        }
        ui.label("");
        ui.checkbox(&mut style.landmarks, "Landmarks as rings")
            .on_hover_text("Mark every landmark in view once there is a solution.");
        ui.end_row();
        ui.label("");
        ui.checkbox(&mut style.residuals_times_ten, "Residuals × 10")
            .on_hover_text("Draw the distance between a point and the solution ten times as long.");
        ui.end_row();
    });
    ui.add_space(theme::SPACE);
    let delivered = OverlayStyle::default();
    let reset = ui.add_enabled(*style != delivered, Button::new("Reset to defaults"));
    let reset = reset.on_hover_text("Restore the default style.").on_disabled_hover_text("This is the default style.");
    if reset.clicked() {
        *style = delivered;
    }
}

fn swatch(ui: &mut Ui, [r, g, b]: [u8; 3], name: &str, chosen: bool) -> bool {
    let (rect, response) = ui.allocate_exact_size(vec2(20.0, 20.0), Sense::click());
    response.widget_info(|| WidgetInfo::selected(Role::Button, true, chosen, name));
    let painter = ui.painter();
    painter.rect_filled(rect.shrink(2.0), CornerRadius::same(3), Color32::from_rgb(r, g, b));
    if chosen || response.hovered() {
        let line = Stroke::new(if chosen { 2.0 } else { 1.0 }, theme::STRONG);
        painter.rect_stroke(rect, CornerRadius::same(4), line, StrokeKind::Inside);
    }
    response.on_hover_text(name).clicked()
}
