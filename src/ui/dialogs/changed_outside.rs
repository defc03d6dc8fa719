//! Choosing which version to keep after another program has changed the document.

use super::sheet;
use crate::ui::{
    Panel,
    theme::{self, Themed as _},
};
use egui::{Button, Context, Label, RichText, vec2};
use touchline_application::app::{Action, Command, OutsideChoice, ViewAction};

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
            let file = panel
                .app
                .session
                .disk
                .changed_outside
                .as_ref()
                .map(|file| file.display().to_string());
            let own = panel
                .app
                .session
                .disk
                .own_version
                .as_ref()
                .map(|own| own.display().to_string());
            let own = own.map_or_else(String::new, |own| {
                format!(" Your version is kept beside it as {own}.")
            });
            let text = format!(
                "Another program changed {} after you opened it.{own} The document is not written until you choose.",
                file.unwrap_or_else(|| "the document".to_owned())
            );
            ui.add(Label::new(RichText::new(text).color(ui.palette().strong)).wrap());
            ui.add_space(2.0 * theme::SPACE);
            for (choice, says, does) in CHOICES {
                let button = Button::new(says).min_size(vec2(180.0, 26.0));
                let button = if choice == OutsideChoice::Merge {
                    button.fill(ui.palette().accent_ground)
                } else {
                    button
                };
                if ui.add(button).on_hover_text(does).clicked() {
                    panel.actions.push(Action::ResolveOutside(choice));
                }
                ui.add(Label::new(RichText::new(does).small().color(ui.palette().weak)).wrap());
            }
            let elsewhere = ui.add(Button::new("Save elsewhere…").min_size(vec2(180.0, 26.0)));
            if elsewhere
                .on_hover_text(panel.app.settings.keys.tooltip(Command::SaveAs))
                .clicked()
            {
                panel.actions.push(Action::View(ViewAction::CloseDialog));
                panel.actions.push(Action::Command(Command::SaveAs));
            }
        },
    );
}
