//! The choice of the sport, by drawings of the fields.

use super::{has_just_opened, sheet};
use crate::ui::Panel;
use crate::ui::controls::show_button;
use crate::ui::controls::theme::{self, Themed as _};
use crate::ui::drawing::labels::{PlateStyle, plate};
use egui::{
    Align2, Button, Color32, Context, CornerRadius, FontId, Painter, Rect, Response, Role,
    ScrollArea, Sense, Shape, Stroke, StrokeKind, Ui, WidgetInfo, pos2, vec2,
};
use touchline_application::app::{App, EditAction, ViewAction};
use touchline_application::scene::{Ground, Sport};
use touchline_core::field::{FieldModel, builtin, builtin_names};
use touchline_core::geometry::pluralise;

/// Size of a drawing with its name, points.
const CARD: egui::Vec2 = vec2(150.0, 132.0);
/// Height of the name and of the organisation that makes the rules, points.
const NAME: f32 = 36.0;
/// Number of segments that approximate a curve.
const PIECES: u32 = 32;

/// Shows the dialog.
pub fn show(panel: &mut Panel<'_>, ctx: &Context) {
    let opened = has_just_opened(ctx, "sport");
    sheet(
        panel,
        ctx,
        "Sport and field",
        vec2(660.0, 500.0),
        |panel, ui| {
            theme::text(ui, cost(panel.app));
            own_template(panel, ui);
            ui.add_space(theme::SPACE);
            let chosen = panel
                .app
                .shown_field_spec()
                .map(|spec| spec.template.clone())
                .unwrap_or_default();
            let guess = panel.app.session.sport_guess;
            ScrollArea::vertical()
                .auto_shrink([false, true])
                .show(ui, |ui| {
                    ui.horizontal_wrapped(|ui| {
                        for name in names(&panel.app.settings.sports) {
                            let Ok(template) = builtin(name) else {
                                continue;
                            };
                            let Ok(field) = template.default_model() else {
                                continue;
                            };
                            let card = card(
                                ui,
                                (&template.title, ground_colour(name)),
                                &field,
                                name == chosen,
                                guess == Some(name),
                            );
                            // Enter takes the most likely sport.
                            if opened && name == guess.unwrap_or(&chosen) {
                                card.request_focus();
                            }
                            if card.clicked() {
                                panel.edit(EditAction::ChooseSport(name.to_owned()));
                            }
                        }
                    });
                });
        },
    );
}

/// The button that opens the field editor: for the project's own template, or for a new one.
fn own_template(panel: &mut Panel<'_>, ui: &mut Ui) {
    let spec = panel.app.shown_field_spec();
    let (says, tip) = match spec.filter(|spec| spec.is_file()) {
        Some(spec) => ("Change the field…", format!("Edit {}.", spec.template)),
        None => (
            "A field of your own…",
            "Draw and type a court that is not here, or one that differs from its rules."
                .to_owned(),
        ),
    };
    if show_button(ui, Button::new(says).small(), tip) {
        panel.view(ViewAction::EditFieldTemplate(None));
    }
}

/// The names of all templates, those that the user chose last first.
fn names(last: &[String]) -> Vec<&'static str> {
    let mut names = builtin_names();
    // A stable sort: the others keep their order.
    names.sort_by_key(|name| {
        let place = last.iter().position(|used| used == name);
        place.unwrap_or(usize::MAX)
    });
    names
}

/// Says what a change of the field costs: the names of points.
fn cost(app: &App) -> String {
    match app.points_of_field() {
        0 => "Which sport is it? Until points are named, changing it costs nothing.".to_owned(),
        points => format!(
            "{} of this project {} a landmark or line of the current field. Another field does not have these names: the points have to be named again. One step of undo.",
            pluralise(points, "point"),
            if points == 1 { "names" } else { "name" },
        ),
    }
}

/// The colour of a sport's ground, dark enough for white lines but on ice.
fn ground_colour(template: &str) -> Color32 {
    // Beach volleyball's lines have the colour of an indoor sport, but it is played on sand.
    if template == "beach_volleyball" {
        return Color32::from_rgb(150, 122, 78);
    }
    match Sport::from_template(template).map(|sport| sport.ground) {
        Some(Ground::Wood) => Color32::from_rgb(138, 94, 52),
        Some(Ground::Ice) => Color32::from_rgb(222, 232, 240),
        Some(Ground::Painted) => Color32::from_rgb(44, 84, 142),
        Some(Ground::Turf) | None => Color32::from_rgb(38, 74, 48),
    }
}

/// A field with its name, as a button.
fn card(
    ui: &mut Ui,
    (title, turf): (&str, Color32),
    field: &FieldModel,
    chosen: bool,
    guessed: bool,
) -> Response {
    // Drawn by hand: a drawing with two lines of text below it, as one button.
    let (rect, response) = ui.allocate_exact_size(CARD, Sense::click());
    response.widget_info(|| WidgetInfo::selected(Role::Button, true, chosen, title));
    let painter = ui.painter();
    painter.rect_filled(
        rect,
        CornerRadius::same(5),
        if chosen {
            ui.palette().accent_ground
        } else {
            ui.palette().raised
        },
    );
    if chosen || response.hovered() || response.has_focus() {
        let line = Stroke::new(if chosen { 2.0 } else { 1.0 }, ui.palette().accent);
        painter.rect_stroke(rect, CornerRadius::same(5), line, StrokeKind::Inside);
    }
    let ground = Rect::from_min_max(rect.min, pos2(rect.right(), rect.bottom() - NAME)).shrink(6.0);
    draw(painter, ground, field, turf);
    // "Sport (rules)" is written in two lines.
    let (sport, rules) = title.split_once(" (").unwrap_or((title, ""));
    let at = pos2(rect.center().x, rect.bottom() - NAME);
    painter.text(
        at,
        Align2::CENTER_TOP,
        sport,
        FontId::proportional(theme::SMALL),
        ui.palette().strong,
    );
    let at = at + vec2(0.0, NAME / 2.0 - 2.0);
    painter.text(
        at,
        Align2::CENTER_TOP,
        rules.trim_end_matches(')'),
        FontId::proportional(theme::SMALL),
        ui.palette().text,
    );
    if guessed {
        let style = PlateStyle::new(
            FontId::proportional(theme::SMALL),
            ui.palette().on_accent,
            ui.palette().accent,
        );
        plate(
            painter,
            rect.left_top() + vec2(10.0, 12.0),
            Align2::LEFT_CENTER,
            "guessed from its name",
            style,
        );
    }
    response.on_hover_text(format!(
        "{title}: {:.1} × {:.1} m.",
        field.length_m, field.width_m
    ))
}

/// Draws the lines of a field from above, x to the right and y upwards. Lines above the ground,
/// such as crossbars, are left out.
fn draw(painter: &Painter, ground: Rect, field: &FieldModel, colour: Color32) {
    // The field with a margin around it, as large as the card allows. Templates lie with their
    // length to the right, whatever their size, so each fills its card.
    let scale = (f64::from(ground.width()) / (1.1 * field.length_m))
        .min(f64::from(ground.height()) / (1.1 * field.width_m));
    let (half_length, half_width) = (
        (0.53 * field.length_m * scale) as f32,
        (0.53 * field.width_m * scale) as f32,
    );
    let turf = Rect::from_center_size(ground.center(), 2.0 * vec2(half_length, half_width));
    painter.rect_filled(turf, CornerRadius::same(2), colour);
    // White paint is not seen on ice, where lines are red and blue.
    let is_bright = colour.intensity() > 0.7;
    let paint = if is_bright {
        Color32::from_rgb(176, 32, 48)
    } else {
        Color32::from_gray(235)
    };
    for line in field
        .lines
        .iter()
        .filter(|line| line.curve.point_at(0.5).z == 0.0)
    {
        let points =
            (0..=PIECES).map(|piece| line.curve.point_at(f64::from(piece) / f64::from(PIECES)));
        let shown = points.map(|point| {
            ground.center() + vec2((point.x * scale) as f32, (-point.y * scale) as f32)
        });
        painter.add(Shape::line(shown.collect(), Stroke::new(1.0, paint)));
    }
}
