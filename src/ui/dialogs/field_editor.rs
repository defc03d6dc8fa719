//! The field editor: a template of the user's own, as text on the right and as a drawing on the
//! left. What is typed is drawn at once, and a line that is drawn is written into the text.

use super::sheet;
use crate::ui::Panel;
use crate::ui::controls::show_button;
use crate::ui::controls::theme::{self, Themed as _};
use egui::{
    Button, Color32, Context, FontId, Id, Label, Painter, Pos2, Rect, RichText, Role, ScrollArea,
    Sense, Shape, Stroke, TextEdit, TextStyle, Ui, UiBuilder, WidgetInfo, vec2,
};
use touchline_application::app::field_draft::{DrawnLine, FieldDraft, Mirrored};
use touchline_application::app::{EditAction, FieldChange, ViewAction};
use touchline_application::scene::field_map::FieldMap;
use touchline_core::field::{FieldModel, builtin, builtin_names};
use touchline_core::geometry::{ImagePoint, Vec3, pluralise};

/// Width of the text as a share of the dialog's.
const TEXT: f32 = 0.45;
/// Height of the rows below drawing and text, points.
const ROWS: f32 = 64.0;
/// Margin around the field, as a share of its length.
const MARGIN: f64 = 0.08;
/// A drawn end moves to a landmark or an end of a line that is this near, points of the screen.
const SNAP: f32 = 8.0;
/// Else it moves to whole multiples of this, m.
const GRID_M: f64 = 0.05;
/// Number of straight pieces for a curve.
const PIECES: u32 = 48;

/// What a drag draws.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
enum Tool {
    #[default]
    Line,
    Circle,
}

/// The choices below the drawing, and where a drag began. They are kept while the window runs.
#[derive(Clone, Copy, Debug, Default)]
struct Choices {
    tool: Tool,
    mirrored: Mirrored,
    from: Option<[f64; 2]>,
}

/// Shows the dialog.
pub fn show(panel: &mut Panel<'_>, ctx: &Context) {
    let app = panel.app;
    let Some(draft) = &app.session.field_draft else {
        panel.close_dialog();
        return;
    };
    let window = ctx.content_rect().size();
    let size = 0.9 * window;
    sheet(panel, ctx, "Field of your own", size, |panel, ui| {
        let area = ui.available_rect_before_wrap();
        let height = (area.height().min(size.y) - ROWS - 60.0).max(120.0);
        let (whole, _) = ui.allocate_exact_size(vec2(area.width(), height), Sense::hover());
        let middle = whole.right() - TEXT * whole.width();
        let memory = Id::unique("field editor");
        let mut choices: Choices = ui.data(|data| data.get_temp(memory)).unwrap_or_default();
        let left = whole.with_max_x(middle - theme::SPACE);
        drawing(panel, ui, left, draft, &mut choices);
        ui.scope_builder(UiBuilder::new().max_rect(whole.with_min_x(middle)), |ui| {
            text(panel, ui, draft);
        });
        tools(panel, ui, draft, &mut choices);
        ui.data_mut(|data| data.insert_temp(memory, choices));
        end(panel, ui, draft);
    });
}

fn change(panel: &mut Panel<'_>, change: FieldChange) {
    panel.view(ViewAction::ChangeFieldTemplate(change));
}

/// The template as text.
fn text(panel: &mut Panel<'_>, ui: &mut Ui, draft: &FieldDraft) {
    ScrollArea::both().auto_shrink(false).show(ui, |ui| {
        let mut typed = draft.text().to_owned();
        let field = TextEdit::multiline(&mut typed)
            .code_editor()
            .font(TextStyle::Monospace)
            .desired_width(f32::INFINITY);
        let response = ui.add(field).accessible_name("Template");
        if response.changed() {
            change(panel, FieldChange::Text(typed));
        }
    });
}

/// The field from above, into which a drag draws a line or a circle.
fn drawing(panel: &mut Panel<'_>, ui: &Ui, rect: Rect, draft: &FieldDraft, choices: &mut Choices) {
    let response = ui.interact(rect, Id::unique("field drawing"), Sense::drag());
    response.widget_info(|| WidgetInfo::labeled(Role::Canvas, true, "Drawing of the field"));
    let painter = ui.painter_at(rect);
    painter.rect_filled(rect, 4.0, ui.palette().backdrop);
    let Some(field) = draft.last_field() else {
        return;
    };
    let view = Drawing::new(field, rect);
    view.paint(&painter);
    if draft.field().is_err() {
        // The text has a mistake: this is the field before it.
        painter.rect_filled(rect, 4.0, ui.palette().backdrop.gamma_multiply(0.6));
        return;
    }
    let Some(pointer) = response.interact_pointer_pos().or(response.hover_pos()) else {
        return;
    };
    let at = view.snap(pointer);
    if response.drag_started() {
        let pressed = ui.input(|input| input.pointer.press_origin());
        choices.from = pressed.map(|pressed| view.snap(pressed));
    }
    let drawn = choices.from.map(|from| match choices.tool {
        Tool::Line => DrawnLine::Straight { from, to: at },
        Tool::Circle => DrawnLine::Circle {
            centre: from,
            radius_m: (at[0] - from[0]).hypot(at[1] - from[1]),
        },
    });
    let stroke = Stroke::new(2.0, ui.palette().accent);
    match drawn {
        Some(DrawnLine::Straight { from, to }) => {
            let ends = [from, to].map(|end| view.screen(end));
            painter.line_segment(ends, stroke);
        }
        Some(DrawnLine::Circle { centre, radius_m }) => {
            let radius = radius_m * view.map.px_per_m;
            painter.circle_stroke(view.screen(centre), radius as f32, stroke);
        }
        None => {
            painter.circle_stroke(view.screen(at), 4.0, stroke);
        }
    }
    painter.text(
        rect.left_bottom() + vec2(8.0, -6.0),
        egui::Align2::LEFT_BOTTOM,
        describe(drawn, at),
        FontId::proportional(theme::SMALL),
        ui.palette().text,
    );
    if response.drag_stopped() {
        choices.from = None;
        if let Some(line) = drawn.filter(|line| length_m(*line) >= GRID_M) {
            change(panel, FieldChange::Draw(line, choices.mirrored));
        }
    }
}

/// What is drawn, or where the pointer is, in metres from the middle of the field.
fn describe(drawn: Option<DrawnLine>, [x, y]: [f64; 2]) -> String {
    match drawn {
        Some(line @ DrawnLine::Straight { from, .. }) => format!(
            "{:.2}, {:.2} to {x:.2}, {y:.2}: {:.2} m",
            from[0],
            from[1],
            length_m(line)
        ),
        Some(DrawnLine::Circle { centre, radius_m }) => format!(
            "Circle about {:.2}, {:.2}, radius {radius_m:.2} m",
            centre[0], centre[1]
        ),
        None => format!("{x:.2}, {y:.2} m from the middle"),
    }
}

/// The length of a line, or the radius of a circle, m.
fn length_m(line: DrawnLine) -> f64 {
    match line {
        DrawnLine::Straight { from, to } => (to[0] - from[0]).hypot(to[1] - from[1]),
        DrawnLine::Circle { radius_m, .. } => radius_m,
    }
}

/// A field in a part of the screen.
struct Drawing<'a> {
    field: &'a FieldModel,
    map: FieldMap,
    origin: Pos2,
}

impl<'a> Drawing<'a> {
    /// The whole field with a margin, in the middle of an area.
    fn new(field: &'a FieldModel, area: Rect) -> Self {
        let margin_m = MARGIN * field.length_m;
        let [length_m, width_m] =
            [field.length_m, field.width_m].map(|side_m| side_m + 2.0 * margin_m);
        let px_per_m = (f64::from(area.width()) / length_m).min(f64::from(area.height()) / width_m);
        let map = FieldMap::new(field, margin_m, px_per_m);
        let size = vec2((length_m * px_per_m) as f32, (width_m * px_per_m) as f32);
        Self {
            field,
            map,
            origin: area.center() - size / 2.0,
        }
    }

    /// The point of the screen for a place, m.
    fn screen(&self, [x, y]: [f64; 2]) -> Pos2 {
        let at = self.map.map_from_world(Vec3::new(x, y, 0.0));
        self.origin + vec2(at.x as f32, at.y as f32)
    }

    /// The place for a point of the screen, m: a landmark or an end of a line near it, else on a
    /// grid.
    fn snap(&self, at: Pos2) -> [f64; 2] {
        let landmarks = self.field.landmarks.iter().map(|known| known.nominal_m);
        let lines = self.field.lines.iter();
        let ends = lines.flat_map(|line| [0.0, 1.0].map(|end| line.curve.point_at(end)));
        let near = landmarks
            .chain(ends)
            .filter(|place| place.z == 0.0)
            .map(|place| [place.x, place.y])
            .map(|place| (self.screen(place).distance(at), place))
            .min_by(|a, b| a.0.total_cmp(&b.0));
        if let Some((_, place)) = near.filter(|(distance, _)| *distance <= SNAP) {
            return place;
        }
        let offset = at - self.origin;
        let place = ImagePoint::new(f64::from(offset.x), f64::from(offset.y));
        let place = self.map.world_from_map(place);
        [place.x, place.y].map(|part| (part / GRID_M).round() * GRID_M)
    }

    /// Draws ground, lines and landmarks.
    fn paint(&self, painter: &Painter) {
        let (x, y) = (self.field.length_m / 2.0, self.field.width_m / 2.0);
        let ground = Rect::from_two_pos(self.screen([-x, -y]), self.screen([x, y]));
        painter.rect_filled(ground, 0.0, Color32::from_rgb(46, 92, 62));
        for line in &self.field.lines {
            let ends = [0.0, 1.0].map(|end| line.curve.point_at(end));
            if ends.iter().any(|end| end.z != 0.0) {
                continue;
            }
            let colour = if line.painted {
                Color32::from_gray(235)
            } else {
                Color32::from_rgb(127, 180, 255)
            };
            for piece in line.pieces(&line.curve) {
                let points = (0..=PIECES).map(|step| {
                    let at = piece.point_at(f64::from(step) / f64::from(PIECES));
                    self.screen([at.x, at.y])
                });
                painter.add(Shape::line(points.collect(), Stroke::new(1.5, colour)));
            }
        }
        for landmark in &self.field.landmarks {
            let at = self.screen([landmark.nominal_m.x, landmark.nominal_m.y]);
            painter.circle_filled(at, 2.5, Color32::from_rgb(255, 138, 36));
        }
    }
}

/// What a drag draws, on which sides, and what can be added.
fn tools(panel: &mut Panel<'_>, ui: &mut Ui, draft: &FieldDraft, choices: &mut Choices) {
    ui.add_space(theme::SPACE);
    ui.horizontal(|ui| {
        ui.label("Draw");
        ui.selectable_value(&mut choices.tool, Tool::Line, "line")
            .on_hover_text("Drag from one end to the other.");
        ui.selectable_value(&mut choices.tool, Tool::Circle, "circle")
            .on_hover_text("Drag from the middle to the rim.");
        ui.separator();
        let Mirrored {
            to_other_end,
            to_other_side,
        } = &mut choices.mirrored;
        ui.checkbox(to_other_end, "at both ends")
            .on_hover_text("What is drawn is painted at the other end as well, left for right.");
        ui.checkbox(to_other_side, "on both sides")
            .on_hover_text("What is drawn is painted on the other side as well, near for far.");
        ui.separator();
        let tip = "Add a landmark at every place where lines meet or end and none is yet.";
        if show_button(ui, Button::new("Add landmarks"), tip) {
            change(panel, FieldChange::AddLandmarks);
        }
        ui.add_enabled_ui(draft.can_undo(), |ui| {
            let tip = "Take back the line or the landmarks that came last.";
            if show_button(ui, Button::new("Take back"), tip) {
                change(panel, FieldChange::Undo);
            }
        });
        ui.separator();
        begin_with(panel, ui);
    });
}

/// The choice of a template to begin with.
fn begin_with(panel: &mut Panel<'_>, ui: &mut Ui) {
    let choice = egui::ComboBox::from_id_salt("begin with").selected_text("Begin again with…");
    let shown = choice.show_ui(ui, |ui| {
        if ui.selectable_label(false, "Boundary lines").clicked() {
            panel.view(ViewAction::EditFieldTemplate(Some(String::new())));
        }
        for name in builtin_names() {
            let title = builtin(name).map_or(name, |known| &known.title);
            if ui.selectable_label(false, title).clicked() {
                panel.view(ViewAction::EditFieldTemplate(Some(name.to_owned())));
            }
        }
    });
    shown.response.accessible_name("Begin again with");
}

/// What the text is or what is wrong with it, and the button that saves it.
fn end(panel: &mut Panel<'_>, ui: &mut Ui, draft: &FieldDraft) {
    ui.add_space(theme::SPACE);
    ui.horizontal(|ui| {
        let (says, colour) = match draft.field() {
            Ok((template, field)) => (
                format!(
                    "{}: {} × {} m, {}, {}.",
                    template.title,
                    field.length_m,
                    field.width_m,
                    pluralise(field.lines.len(), "line"),
                    pluralise(field.landmarks.len(), "landmark")
                ),
                ui.palette().text,
            ),
            Err(error) => (error.to_string(), ui.palette().bad),
        };
        let file = draft.file_name();
        let button = Button::new("Save and use").fill(ui.palette().accent_ground);
        let saves = ui.add_enabled(file.is_some(), button);
        let file = file.unwrap_or_default();
        let tip = format!("Keep it in {file} beside the project, which uses it from then on.");
        if saves.on_hover_text(tip).clicked() {
            panel.edit(EditAction::SaveFieldTemplate);
        }
        ui.add(Label::new(RichText::new(says).color(colour)).wrap());
    });
}
