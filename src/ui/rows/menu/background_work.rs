//! The right end of the top row: background work, the trainer, and whether every edit is on the
//! disk. A click shows more about each or cancels it.

use super::document_name::{LONGEST_NAME, file_name, shorten_text};
use crate::ui::controls::show_button;
use crate::ui::controls::symbol;
use crate::ui::controls::theme::{self, Themed as _};
use crate::ui::{Panel, key_in_brackets};
use egui::{Button, Color32, Response, RichText, Ui};
use touchline_application::app::session::Saving;
use touchline_application::app::{Action, Command};

/// Shows whether every edit is on disk, and what to do if not.
pub(super) fn saving(panel: &mut Panel<'_>, ui: &mut Ui) {
    // A change by another program stops saving until the user has chosen, so it is shown beside
    // whatever the state of saving is.
    if panel.app.session.disk.changed_outside.is_some() {
        let choose = Button::new(RichText::new("Changed outside").color(ui.palette().on_accent))
            .fill(ui.palette().caution)
            .small();
        let tip = "Another program changed the document. It is not written until you choose which version to keep.";
        if show_button(ui, choose, tip) {
            panel.act(Action::AskOutside);
        }
    }
    match &panel.app.session.disk.saving {
        Saving::Untouched => {}
        Saving::Pending => {
            theme::weak(ui, "saving…").on_hover_text("The last edit is being written to disk.");
        }
        Saving::Saved { at } => {
            theme::weak(ui, format!("saved {at}"))
                .on_hover_text("Every edit is on disk. You do not have to save.");
        }
        Saving::Failed { message, since } => {
            let edits = since.as_ref().map_or_else(
                || "Edits are only in memory.".to_owned(),
                |at| format!("Edits since {at} are only in memory."),
            );
            let elsewhere =
                Button::new(RichText::new("Save elsewhere").color(ui.palette().on_accent))
                    .fill(ui.palette().bad)
                    .small();
            panel.run_on_click(ui.add(elsewhere), Command::SaveAs);
            let text = RichText::new(format!("NOT SAVED: {message}. {edits}"))
                .color(ui.palette().bad)
                .strong();
            ui.add(egui::Label::new(text).truncate())
                .on_hover_text(format!("{message}. {edits}"));
        }
    }
}

/// Shows the background work that is going on.
pub(super) fn jobs(panel: &mut Panel<'_>, ui: &mut Ui) {
    if let Some(opening) = &panel.app.session.disk.opening {
        ui.add(egui::Spinner::new().size(12.0));
        ui.label(RichText::new(shorten_text(opening, LONGEST_NAME)).color(ui.palette().accent))
            .on_hover_text(format!("{opening} The window stays usable meanwhile."));
        let key = key_in_brackets(&panel.app.settings.keys, Command::Cancel);
        let palette = ui.palette();
        let give_up = symbol::button(ui, symbol::Symbol::Cross, "Stop opening", palette.weak);
        if give_up
            .on_hover_text(format!("Stop opening.{key}"))
            .clicked()
        {
            panel.run(Command::Cancel);
        }
    }
    trainer(panel, ui);
    shot_search(panel, ui);
    // The counts are those of the previous frame of the window: this one has not laid out its
    // lists yet.
    let thumbnails = panel.pictures.thumbnails_in_view();
    if thumbnails.done < thumbnails.wanted {
        let text = format!("thumbnails {}/{}", thumbnails.done, thumbnails.wanted);
        theme::small_weak(ui, text).on_hover_text("Thumbnails of the frames in view.");
    }
}

/// Shows how far the search for cuts is; a click stops it.
fn shot_search(panel: &mut Panel<'_>, ui: &mut Ui) {
    let state = &panel.app.operations.shot_search;
    let Some(search) = state.running() else {
        return;
    };
    let text = format!("cuts {} %", state.progress().percent());
    let weak = ui.palette().weak;
    let says = work_button(ui, text, weak);
    let tip = format!(
        "Looking for cuts in {}. Click to stop.",
        file_name(&search.video)
    );
    if says.on_hover_text(tip).clicked() {
        panel.run(Command::StopShotSearch);
    }
}

/// Shows background work as a text that can be clicked.
fn work_button(ui: &mut Ui, text: String, colour: Color32) -> Response {
    ui.add(Button::new(RichText::new(text).small().color(colour)).frame(false))
}

/// Shows what the trainer is doing; a click shows its panel.
pub(super) fn trainer(panel: &mut Panel<'_>, ui: &mut Ui) {
    let status = &panel.app.session.trainer.status;
    let (text, colour) = match (&status.trouble, status.doing.in_brief()) {
        (Some(_), _) => ("trainer: problem".to_owned(), ui.palette().caution),
        (None, Some(brief)) => (brief, ui.palette().weak),
        (None, None) => return,
    };
    let tip = status
        .trouble
        .clone()
        .unwrap_or_else(|| format!("{}.", status.doing.describe()));
    let says = work_button(ui, text, colour);
    let keys = &panel.app.settings.keys;
    let key = keys.with_key(Command::TrainerPanel, |key| {
        format!(" Trainer panel: {key}.")
    });
    if says.on_hover_text(format!("{tip}{key}")).clicked() {
        panel.run(Command::TrainerPanel);
    }
}
