//! A field for an optional value that is typed. A text that cannot be read stays in the field, with
//! an example beside it.

use crate::ui::controls::theme::Themed as _;
use egui::{Id, RichText, TextEdit, Ui};

/// A field for an optional typed value.
pub struct Typed<'a, T> {
    /// The page that it is on. A field of the same name on another page has a text of its own.
    pub page: &'a str,
    /// The name, which is shown before the field.
    pub name: &'a str,
    /// The tooltip: what the value is for.
    pub tip: &'a str,
    /// A value as the user types it.
    pub example: &'a str,
    /// Width of the field, points.
    pub width: f32,
    /// Writes a value as text.
    pub text: fn(&T) -> String,
    /// Reads a text; `None` if it is not a value.
    pub read: fn(&str) -> Option<T>,
}

impl<T> Typed<'_, T> {
    /// Shows the field with its name. An empty field means no value.
    pub fn show(self, ui: &mut Ui, value: &mut Option<T>) {
        // The typed text is remembered while the field has the focus, or else a value that is
        // shorter than its text ("29.970") would be written over it at each key.
        let palette = ui.palette();
        let id = id_of_text(self.page, self.name);
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
        // While a text cannot be read, there is no value, and the text is kept for the user to
        // correct.
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

/// Where the text of a field is remembered while it is typed or cannot be read.
fn id_of_text(page: &str, name: &str) -> Id {
    Id::unique(("typed", page, name))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_text_that_cannot_be_read_stays_on_its_page() {
        let ctx = egui::Context::default();
        let unreadable = "wide".to_owned();
        ctx.data_mut(|data| data.insert_temp(id_of_text("export", "Picture size"), unreadable));
        let kept = ["export", "import"].map(|page| {
            let id = id_of_text(page, "Picture size");
            ctx.data(|data| data.get_temp::<String>(id))
        });
        assert_eq!(kept, [Some("wide".to_owned()), None]);
    }
}
