//! Choosing which version to keep after another program has changed the document.

use super::{closing_button, sheet};
use crate::ui::Panel;
use crate::ui::controls::theme;
use crate::ui::controls::theme::Themed as _;
use egui::{Button, Context, Label, RichText, vec2};
use touchline_application::app::{Action, Command, OutsideChoice};

/// The choices with name and explanation.
const CHOICES: [(OutsideChoice, &str, &str); 3] = [
    (
        OutsideChoice::Merge,
        "Merge",
        "Combine both versions frame by frame. Where both changed a frame, yours is kept. One step of undo.",
    ),
    (
        OutsideChoice::Replace,
        "Replace it",
        "Write your version. The other version is kept as a copy beside it.",
    ),
    (
        OutsideChoice::TakeTheirs,
        "Open the other version",
        "Your edits are set aside and can be merged later.",
    ),
];

/// Shows the dialog.
pub fn show(panel: &mut Panel<'_>, ctx: &Context) {
    sheet(
        panel,
        ctx,
        "Changed by another program",
        vec2(560.0, 320.0),
        |panel, ui| {
            let disk = &panel.app.session.disk;
            let file = disk.changed_outside.as_ref().map_or_else(
                || "the document".to_owned(),
                |file| file.display().to_string(),
            );
            let own = disk.own_version.as_ref().map_or_else(String::new, |own| {
                format!(" Your version is kept beside it as {}.", own.display())
            });
            let text = format!(
                "Another program changed {file} after you opened it.{own} The document is not written until you choose."
            );
            ui.add(Label::new(RichText::new(text).color(ui.palette().strong)).wrap());
            ui.add_space(2.0 * theme::SPACE);
            for (choice, says, does) in CHOICES {
                // Merging combines both versions, so it is the main choice.
                let mut button = Button::new(says).min_size(vec2(180.0, 26.0));
                if choice == OutsideChoice::Merge {
                    button = button.fill(ui.palette().accent_ground);
                }
                if ui.add(button).on_hover_text(does).clicked() {
                    panel.actions.push(Action::ResolveOutside(choice));
                }
                ui.add(Label::new(RichText::new(does).small().color(ui.palette().weak)).wrap());
            }
            let elsewhere = Button::new("Save elsewhere…").min_size(vec2(180.0, 26.0));
            closing_button(panel, ui, elsewhere, Command::SaveAs);
        },
    );
}
