//! A value that may be left open and is typed: what cannot be read stays in its field, with an
//! example below.

use crate::ui::theme::Themed as _;
use egui::{Id, RichText, TextEdit, Ui};

/// A field for a typed value.
pub struct Typed<'a, T> {
    /// What it is called.
    pub name: &'a str,
    /// What it is for.
    pub tip: &'a str,
    /// A value as one types it.
    pub example: &'a str,
    /// The field's width, points.
    pub width: f32,
    /// A value as text.
    pub text: fn(&T) -> String,
    /// A text as value; none where it is none.
    pub read: fn(&str) -> Option<T>,
}

impl<T> Typed<'_, T> {
    /// Shows the field with its name; an empty one leaves the value open.
    pub fn show(self, ui: &mut Ui, value: &mut Option<T>) {
        let palette = ui.palette();
        let id = Id::unique(("typed", self.name));
        ui.label(self.name);
        let kept = ui.data(|data| data.get_temp::<String>(id));
        let mut text = kept.unwrap_or_else(|| value.as_ref().map_or_else(String::new, self.text));
        let field = TextEdit::singleline(&mut text)
            .id(id.with("field"))
            .hint_text(format!("e.g. {}", self.example));
        let field = ui
            .add(field.desired_width(self.width))
            .accessible_name(self.name)
            .on_hover_text(self.tip);
        let read = (self.read)(text.trim());
        let is_open = text.trim().is_empty();
        if !is_open && read.is_none() {
            ui.label(RichText::new(format!("such as {}", self.example)).color(palette.caution));
        }
        // Half a value is none.
        let is_whole = is_open || read.is_some();
        if field.changed() {
            *value = read;
        }
        let is_kept = field.has_focus() || !is_whole;
        ui.data_mut(|data| {
            if is_kept {
                data.insert_temp(id, text);
            } else {
                data.remove_temp::<String>(id);
            }
        });
    }
}
