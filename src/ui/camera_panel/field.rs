//! The field: its template and what differs between venues.

use super::{numbers, section};
use crate::app::Action;
use crate::field::{MAX_CROWN_M, builtin, builtin_names};
use crate::project::FieldSpec;
use crate::ui::number::Number;
use crate::ui::{Panel, theme};
use egui::{ComboBox, Label, RichText, Ui};
use std::ops::RangeInclusive;

/// The name of the crown in documents.
const CROWN: &str = "crown_m";

/// Shows the field.
pub fn show(panel: &mut Panel<'_>, ui: &mut Ui) {
    section(ui, "FIELD");
    let Some(open) = panel.app.open() else { return };
    let own = panel.app.frame().and_then(|frame| open.document.camera_of(frame)?.field.as_ref());
    if own.is_some() {
        ui.add(
            Label::new(RichText::new("This camera has a field of its own in the document.").color(theme::WEAK)).wrap(),
        );
        return;
    }
    let spec = open.document.field.clone();
    template(panel, ui, &spec);
    if let Some(Err(error)) = &panel.app.current().field {
        ui.add(Label::new(RichText::new(error.to_string()).color(theme::BAD)).wrap());
    }
    params(panel, ui, &spec);
}

fn template(panel: &mut Panel<'_>, ui: &mut Ui, spec: &FieldSpec) {
    let title = builtin(&spec.template).map_or_else(|_| spec.template.clone(), |template| template.title.clone());
    let shown =
        ComboBox::from_id_salt("field template").width(ui.available_width()).selected_text(title).show_ui(ui, |ui| {
            for name in builtin_names() {
                let title = builtin(name).map_or_else(|_| name.to_owned(), |template| template.title.clone());
                if ui.selectable_label(*spec.template == *name, title).clicked() && *spec.template != *name {
                    // Parameters belong to a template; the crown is every field's.
                    let crown = spec.params.get(CROWN).copied();
                    let mut changed = FieldSpec { extra: spec.extra.clone(), ..FieldSpec::new(name) };
                    changed.params.extend(crown.map(|crown_m| (CROWN.to_owned(), crown_m)));
                    panel.actions.push(Action::EditField(changed));
                }
            }
        });
    shown.response.accessible_name("Field template").on_hover_text("The sport's field with its landmarks and lines.");
}

fn params(panel: &mut Panel<'_>, ui: &mut Ui, spec: &FieldSpec) {
    let known = builtin(&spec.template).map_or(&[][..], |template| &template.params);
    for param in known {
        let tip = format!("{} to {} {}. {}.", param.min, param.max, param.unit, param.source.trim_end_matches('.'));
        let value = spec.params.get(&param.name).copied().unwrap_or(param.default);
        let length = metres(&param.label, &tip, value, param.min..=param.max);
        row(panel, ui, spec, &param.name, length);
    }
    let tip = "How much the middle is higher than the touchlines, m. Usual: 0.05 to 0.25.";
    let value = spec.params.get(CROWN).copied().unwrap_or(0.0);
    let crown = metres("Crown", tip, value, -MAX_CROWN_M..=MAX_CROWN_M);
    row(panel, ui, spec, CROWN, Number { speed: 0.002, decimals: 3, ..crown });
}

fn metres<'a>(name: &'a str, tip: &'a str, value: f64, range: RangeInclusive<f64>) -> Number<'a> {
    Number {
        name,
        step: "Change field",
        tip,
        value,
        speed: 0.05,
        decimals: 2,
        range,
        suffix: " m",
        width: numbers::FIELD,
    }
}

fn row(panel: &mut Panel<'_>, ui: &mut Ui, spec: &FieldSpec, param: &str, number: Number<'_>) {
    numbers::line(ui, number.name, number.tip, |ui| {
        number.show(ui, panel.app, panel.actions, |value| {
            let mut changed = spec.clone();
            changed.params.insert(param.to_owned(), value);
            Action::EditField(changed)
        });
    });
}
