//! The field in the camera panel: its template, the venue's dimensions in m, whether its size is
//! confirmed, and to which edge of the painted lines the size refers.

use super::{numbers, remark, section};
use crate::ui::Panel;
use crate::ui::controls::number::{Number, shortest};
use crate::ui::controls::show_button;
use crate::ui::controls::theme::{self, Themed as _};
use crate::ui::maps::field_map::sport_title;
use egui::{
    Button, Color32, ComboBox, CornerRadius, Label, Rect, RichText, Role, Sense, Stroke, Ui,
    WidgetInfo, pos2, vec2,
};
use std::ops::RangeInclusive;
use touchline_application::app::{Action, Command, EditAction, ViewAction};
use touchline_core::field::{
    Curve, FieldError, FieldModel, MAX_CROWN_M, PaintEdge, Param, builtin, builtin_names,
};
use touchline_documents::document::{CROWN, FieldSize, FieldSpec};

/// Size of the sketch of a painted line, points.
const SKETCH: egui::Vec2 = egui::Vec2::new(64.0, 26.0);

/// Shows the field of the shown frame.
pub fn show(panel: &mut Panel<'_>, ui: &mut Ui) {
    section(ui, "FIELD");
    let Some(spec) = panel.app.shown_field_spec().cloned() else {
        return;
    };
    // Cameras of one document may look at different fields.
    let open = panel.app.open();
    if open
        .zip(panel.app.frame())
        .is_some_and(|(open, frame)| *open.document.field_of(frame) != open.document.field)
    {
        theme::small_weak(ui, "Of this camera only")
            .on_hover_text("Other cameras of the document have another field.");
    }
    template(panel, ui, &spec);
    if let Some(Err(error)) = &panel.app.current().field
        && problem(ui, &spec, error)
    {
        panel.view(ViewAction::ReadFailedTemplatesAgain);
    }
    params(panel, ui, &spec);
    size(panel, ui, &spec);
    if let Some(field) = panel.app.current().field().cloned() {
        edge(ui, &field);
    }
}

/// Shows why there is no field. Returns whether the user wants its template to be read again.
fn problem(ui: &mut Ui, spec: &FieldSpec, error: &FieldError) -> bool {
    let is_being_read = matches!(error, FieldError::BeingRead { .. });
    let colour = if is_being_read {
        ui.palette().weak
    } else {
        ui.palette().bad
    };
    ui.add(Label::new(RichText::new(error.to_string()).color(colour)).wrap());
    spec.is_file() && !is_being_read && ui.add(Button::new("Read again").small()).clicked()
}

/// Shows the choice of the sport.
fn template(panel: &mut Panel<'_>, ui: &mut Ui, spec: &FieldSpec) {
    let shown = ComboBox::from_id_salt("field template")
        .width(ui.available_width())
        .selected_text(sport_title(&spec.template))
        .show_ui(ui, |ui| {
            for name in builtin_names() {
                let is_chosen = spec.template == name;
                if ui.selectable_label(is_chosen, sport_title(name)).clicked() {
                    panel.edit(EditAction::ChooseSport(name.to_owned()));
                }
            }
        });
    shown
        .response
        .accessible_name("Field template")
        .on_hover_text("The sport: its field with landmarks and lines.");
}

/// Shows the dimensions that the template leaves open, each with the range that the rules allow,
/// and the crown.
fn params(panel: &mut Panel<'_>, ui: &mut Ui, spec: &FieldSpec) {
    // Only built-in templates state their parameters here. A template from a file shows none.
    let known = builtin(&spec.template).map_or(&[][..], |template| &template.params);
    for param in known {
        let tip = format!("{} {}.", range(param), param.source.trim_end_matches('.'));
        let value = spec
            .params
            .get(&param.name)
            .copied()
            .unwrap_or(param.default);
        let length = metres(
            &param.label,
            &tip,
            value,
            param.min..=param.max,
            param.source.trim_end_matches('.'),
        );
        row(panel, ui, spec, &param.name, length);
        // Below the number: what the rules allow, and which rules.
        let rule = param.source.split(':').next().unwrap_or_default();
        let allowed = format!("{} {rule}", range(param));
        ui.add(Label::new(RichText::new(allowed).small().color(ui.palette().weak)).truncate())
            .on_hover_text(&param.source);
    }
    // The crown belongs to every field, so no template lists it.
    let tip = "How much higher the middle is than the touchlines, m. Usually 0.05 to 0.25.";
    let value = spec.crown_m();
    let crown = metres(
        "Crown",
        tip,
        value,
        -MAX_CROWN_M..=MAX_CROWN_M,
        "no field is that far from flat",
    );
    row(
        panel,
        ui,
        spec,
        CROWN,
        Number {
            speed: 0.002,
            decimals: 3,
            ..crown
        },
    );
}

/// The range that the rules allow, as text: "90 to 120 m."
fn range(param: &Param) -> String {
    let (min, max, unit) = (shortest(param.min), shortest(param.max), &param.unit);
    if param.min < param.max {
        format!("{min} to {max} {unit}.")
    } else {
        format!("Always {min} {unit}.")
    }
}

/// A number in m. `why` is the reason that a user sees for a value outside the range.
fn metres<'a>(
    name: &'a str,
    tip: &'a str,
    value: f64,
    range: RangeInclusive<f64>,
    why: &'a str,
) -> Number<'a> {
    Number {
        name,
        step: "Change field",
        tip,
        value,
        speed: 0.05,
        decimals: 2,
        range,
        why,
        suffix: " m",
        width: numbers::FIELD,
    }
}

/// Shows a parameter. Changing a dimension, but not the crown, makes the size assumed again.
fn row(panel: &mut Panel<'_>, ui: &mut Ui, spec: &FieldSpec, param: &str, number: Number<'_>) {
    numbers::line(ui, number.name, number.tip, |ui| {
        number.show(ui, panel.app, panel.actions, |value| {
            let mut changed = spec.clone();
            changed.params.insert(param.to_owned(), value);
            // The size was confirmed or fitted for other dimensions.
            if param != CROWN {
                changed.size = None;
            }
            Action::Edit(EditAction::Field(changed))
        });
    });
}

/// Shows whether the size is assumed, confirmed or fitted. An assumed one can be confirmed or
/// fitted.
fn size(panel: &mut Panel<'_>, ui: &mut Ui, spec: &FieldSpec) {
    ui.add_space(theme::SPACE);
    // An assumed size can be confirmed or fitted; a known one can be doubted again.
    let known = match (spec.describe_assumed_size(), spec.size()) {
        (Some(description), _) => {
            remark(ui, &description, |ui| {
                for (word, command) in [
                    ("Confirm", Command::ConfirmFieldSize),
                    ("Fit", Command::FitFieldSize),
                ] {
                    panel.command_button(ui, Button::new(word).small(), command);
                }
            });
            return;
        }
        (None, FieldSize::Confirmed) => "Size confirmed",
        (None, FieldSize::Fitted) => "Size fitted to the points",
        (None, _) => return,
    };
    numbers::line(
        ui,
        known,
        "Exported with the dataset. A change of length or width makes it assumed again.",
        |ui| {
            if show_button(
                ui,
                Button::new("Not sure").small(),
                "Mark the size as assumed again.",
            ) {
                panel.edit(EditAction::Field(FieldSpec {
                    size: None,
                    ..spec.clone()
                }));
            }
        },
    );
}

/// Shows to which edge of the boundary lines length and width refer, as a sketch and in words.
fn edge(ui: &mut Ui, field: &FieldModel) {
    let Some(edge) = boundary_edge(field) else {
        return;
    };
    let (says, at) = match edge {
        PaintEdge::Outer => (
            "Length and width are measured to the outer edge of the lines.",
            1.0,
        ),
        PaintEdge::Inner => (
            "Length and width are measured to the inner edge of the lines.",
            0.0,
        ),
        PaintEdge::Centre => (
            "Length and width are measured to the middle of the lines.",
            0.5,
        ),
    };
    ui.add_space(theme::SPACE);
    ui.horizontal(|ui| {
        let (rect, response) = ui.allocate_exact_size(SKETCH, Sense::hover());
        response.widget_info(|| WidgetInfo::labeled(Role::Image, true, says));
        // A strip of grass with a line of paint; the arrow ends at the edge to which the size is
        // measured. The field is to the left, so the outer edge of the paint is its right one.
        let painter = ui.painter();
        painter.rect_filled(rect, CornerRadius::same(3), Color32::from_rgb(38, 74, 48));
        let paint = Rect::from_min_size(
            pos2(rect.right() - 24.0, rect.top()),
            vec2(10.0, rect.height()),
        );
        painter.rect_filled(paint, CornerRadius::ZERO, ui.palette().strong);
        let end = pos2(paint.left() + at * paint.width(), rect.center().y);
        let stroke = Stroke::new(1.5, ui.palette().caution);
        painter.line_segment([pos2(rect.left(), end.y), end], stroke);
        for dy in [-3.5, 3.5] {
            painter.line_segment([end, end + vec2(-5.0, dy)], stroke);
        }
        painter.vline(
            end.x,
            rect.y_range(),
            Stroke::new(1.0, ui.palette().caution),
        );
        theme::small_weak_text(ui, says);
    });
}

/// The edge to which the first touchline of the template refers; `None` without a straight
/// touchline.
fn boundary_edge(field: &FieldModel) -> Option<PaintEdge> {
    field
        .lines
        .iter()
        .find(|line| is_on_touchline(&line.curve, field.width_m))
        .map(|line| line.edge)
}

/// Whether a line is straight and on a long border of the ground.
fn is_on_touchline(curve: &Curve, width_m: f64) -> bool {
    /// Tolerance for being on the border, m.
    const NEAR_M: f64 = 0.01;
    match curve {
        // Crossbars and other lines above the ground are no borders.
        Curve::Segment { from, to } => [from, to]
            .iter()
            .all(|end| end.z == 0.0 && (end.y.abs() - width_m / 2.0).abs() < NEAR_M),
        Curve::Arc { .. } => false,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_soccer_touchline_belongs_to_the_field_and_every_field_says_its_edge() {
        let model = |name: &str| builtin(name).unwrap().default_model().unwrap();
        assert_eq!(boundary_edge(&model("soccer")), Some(PaintEdge::Outer));
        assert_eq!(
            boundary_edge(&model("basketball_fiba")),
            Some(PaintEdge::Inner)
        );
    }
}
