//! Number fields: dragged or typed, one step of undo each.

use crate::app::session::Mode;
use crate::app::{Action, App};
use egui::{DragValue, Key, Response, Ui, vec2};
use std::ops::RangeInclusive;

/// A number that can be dragged and typed.
pub struct Number<'a> {
    /// Its accessible name.
    pub name: &'a str,
    /// The name of its step of undo.
    pub step: &'static str,
    /// Its tooltip: meaning and unit.
    pub tip: &'a str,
    /// The current value.
    pub value: f64,
    /// How much it changes per point of dragging.
    pub speed: f64,
    /// Digits after the point.
    pub decimals: usize,
    /// The allowed range.
    pub range: RangeInclusive<f64>,
    /// Its unit, written after the number.
    pub suffix: &'a str,
    /// The field's width, points.
    pub width: f32,
}

impl Number<'_> {
    /// Shows the field; `change` says what a new value does.
    pub fn show(
        self,
        ui: &mut Ui,
        app: &App,
        actions: &mut Vec<Action>,
        change: impl FnOnce(f64) -> Action,
    ) -> Response {
        let mut value = self.value;
        let field = DragValue::new(&mut value)
            .speed(self.speed)
            .fixed_decimals(self.decimals)
            .range(self.range)
            .clamp_existing_to_range(false)
            .suffix(self.suffix)
            .update_while_editing(false)
            .min_size(vec2(self.width, ui.spacing().interact_size.y));
        let tip = format!("{} Drag to change it (Shift: finer), click to type.", self.tip);
        let response = ui.add(field).accessible_name(self.name).on_hover_text(tip).on_disabled_hover_text(self.tip);
        let given_up = response.lost_focus() && ui.input(|input| input.key_pressed(Key::Escape));
        let forgets = was_given_up(ui, &response, given_up);
        let begins = response.drag_started() || response.gained_focus();
        if begins {
            actions.push(Action::BeginEdit(self.step));
        }
        // A drag that Escape cancelled does not start again by itself.
        let abandoned = response.dragged() && !begins && app.session.mode != Mode::Editing;
        // A field that was entered and left reports its rounded number, which is no change.
        let same = !response.dragged() && (value - self.value).abs() <= 0.5 * 10_f64.powi(-(self.decimals as i32));
        if response.changed() && !abandoned && !same && !forgets && value.is_finite() {
            actions.push(change(value));
        }
        if given_up {
            actions.push(Action::AbortEdit);
        } else if response.drag_stopped() || response.lost_focus() {
            actions.push(Action::EndEdit);
        }
        response
    }
}

/// Whether Escape left this field in one of the last two frames of the window: a field says for two frames that it has
/// lost the focus, and in the second one it would take what was typed after all.
fn was_given_up(ui: &Ui, response: &Response, now: bool) -> bool {
    let (memory, frame) = (response.id.with("given up"), ui.ctx().cumulative_frame_nr());
    ui.data_mut(|data| {
        if now {
            data.insert_temp(memory, frame);
        }
        data.get_temp::<u64>(memory).is_some_and(|left| frame <= left + 2)
    })
}
