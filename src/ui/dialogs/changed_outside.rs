//! Another program changed the document: whose version stays.

use super::sheet;
use crate::app::{Action, Command, OutsideChoice};
use crate::ui::{Panel, theme};
use egui::{Button, Context, Label, RichText, vec2};

/// What each choice is called, and what it does.
const CHOICES: [(OutsideChoice, &str, &str); 3] = [
    (
        OutsideChoice::Merge,
        "Merge",
        "Frame by frame: what only one side changed is taken from it; what both changed stays as it is here. One step of undo.",
    ),
    (
        OutsideChoice::Replace,
        "Replace it",
        "The document as it is here is written; the other version is kept beside it.",
    ),
    (
        OutsideChoice::TakeTheirs,
        "Open the other version",
        "What was edited here is set aside and can be taken in later.",
    ),
];

/// Shows the sheet.
pub fn show(panel: &mut Panel<'_>, ctx: &Context) {
    sheet(panel, ctx, "Changed by another program", vec2(560.0, 320.0), |panel, ui| {
        let file = panel.app.session.changed_outside.as_ref().map(|file| file.display().to_string());
        let text = format!(
            "{} was changed since it was opened here. Your edits are in its journal; the document is not written until you \
             choose.",
            file.unwrap_or_else(|| "The document".to_owned())
        );
        ui.add(Label::new(RichText::new(text).color(theme::STRONG)).wrap());
        ui.add_space(2.0 * theme::SPACE);
        for (choice, says, does) in CHOICES {
            let button = Button::new(says).min_size(vec2(180.0, 26.0));
            let button = if choice == OutsideChoice::Merge { button.fill(theme::ACCENT_GROUND) } else { button };
            if ui.add(button).on_hover_text(does).clicked() {
                panel.actions.push(Action::ResolveOutside(choice));
            }
            ui.add(Label::new(RichText::new(does).small().color(theme::WEAK)).wrap());
        }
        let elsewhere = ui.add(Button::new("Save elsewhere…").min_size(vec2(180.0, 26.0)));
        if elsewhere.on_hover_text(panel.app.settings.keys.tooltip(Command::SaveAs)).clicked() {
            panel.actions.push(Action::CloseDialog);
            panel.actions.push(Action::Command(Command::SaveAs));
        }
    });
}
