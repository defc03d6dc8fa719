//! Other versions of the document: edits that were set aside, a file that another program changed,
//! and what would be lost by leaving.

use super::{cancel, closing_button, sheet};
use crate::ui::Panel;
use crate::ui::controls::show_button;
use crate::ui::controls::theme::{self, Themed as _};
use egui::{Align, Button, Context, Label, Layout, RichText, ScrollArea, Ui, vec2};
use touchline_application::app::session::{Leaving, Saving};
use touchline_application::app::{Action, Command, OutsideChoice};
use touchline_documents::store::Orphan;

/// Shows the dialog.
pub fn show_orphans(panel: &mut Panel<'_>, ctx: &Context) {
    sheet(
        panel,
        ctx,
        "Edits set aside",
        vec2(560.0, 320.0),
        |panel, ui| {
            let text =
                "These edits were made to another version of this document and are not part of it.";
            theme::strong_text(ui, text);
            ui.add_space(2.0 * theme::SPACE);
            ScrollArea::vertical()
                .id_salt("edits set aside")
                .show(ui, |ui| {
                    for orphan in &panel.app.session.disk.orphans.clone() {
                        entry(panel, ui, orphan);
                    }
                });
        },
    );
}

/// Shows one set of edits with its two buttons.
fn entry(panel: &mut Panel<'_>, ui: &mut Ui, orphan: &Orphan) {
    let count = orphan.edits.len();
    let last = orphan.edits.last().map(String::as_str).unwrap_or_default();
    let text = if count == 1 {
        format!("1 edit: {last}")
    } else {
        format!("{count} edits, the last: {last}")
    };
    ui.add(Label::new(text).truncate())
        .on_hover_text(orphan.path.display().to_string());
    ui.horizontal(|ui| {
        let merge = ui.button("Merge").on_hover_text(
            "Merge them into the document frame by frame. Where both sides changed a frame, these edits win. One step of \
             undo.",
        );
        if merge.clicked() {
            panel.act(Action::MergeOrphan(orphan.path.clone()));
        }
        let save = ui
            .button("Save as a document")
            .on_hover_text("Save the result of these edits as a separate document beside this one.");
        if save.clicked() {
            panel.act(Action::SaveOrphan(orphan.path.clone()));
        }
    });
    ui.add_space(theme::SPACE);
}

/// Shows the dialog. `leaving` is what the user was about to do.
pub fn show_not_saved(panel: &mut Panel<'_>, ctx: &Context, leaving: &Leaving) {
    let (title, does, does_only) = match leaving {
        Leaving::Close => ("Quit without saving?", "Quit and lose edits", "Quit"),
        Leaving::Open(_) => ("Open without saving?", "Open and lose edits", "Open"),
    };
    sheet(panel, ctx, title, vec2(520.0, 220.0), |panel, ui| {
        // Why edits may be lost. After a change by another program nothing is lost, but the version
        // is set aside.
        let (what, does) = match &panel.app.session.disk.saving {
            Saving::Failed { message, since } => {
                let edits = since.as_ref().map_or_else(
                    || "Your edits are only in memory.".to_owned(),
                    |at| format!("Your edits since {at} are only in memory."),
                );
                (format!("{edits} {message}."), does)
            }
            Saving::Pending => (
                "Your last edits are still being written to disk.".to_owned(),
                does,
            ),
            Saving::Untouched | Saving::Saved { .. } => (
                "Another program changed the document. Your version is kept beside it and is offered for merging when you open \
                 it again."
                    .to_owned(),
                does_only,
            ),
        };
        theme::strong_text(ui, what);
        ui.add_space(2.0 * theme::SPACE);
        let row = vec2(ui.available_width(), 28.0);
        ui.allocate_ui_with_layout(row, Layout::right_to_left(Align::Center), |ui| {
            let elsewhere = Button::new("Save elsewhere…").fill(ui.palette().accent_ground);
            closing_button(panel, ui, elsewhere, Command::SaveAs);
            cancel(panel, ui, "Continue working; saving is tried again. (Esc)");
            if show_button(
                ui,
                Button::new(RichText::new(does).color(ui.palette().bad)),
                "This cannot be undone.",
            ) {
                panel.act(Action::LeaveUnsaved);
            }
        });
    });
}

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
pub fn show_changed_outside(panel: &mut Panel<'_>, ctx: &Context) {
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
            theme::strong_text(ui, text);
            ui.add_space(2.0 * theme::SPACE);
            for (choice, says, does) in CHOICES {
                // Merging combines both versions, so it is the main choice.
                let mut button = Button::new(says).min_size(vec2(180.0, 26.0));
                if choice == OutsideChoice::Merge {
                    button = button.fill(ui.palette().accent_ground);
                }
                if show_button(ui, button, does) {
                    panel.act(Action::ResolveOutside(choice));
                }
                theme::small_weak_text(ui, does);
            }
            let elsewhere = Button::new("Save elsewhere…").min_size(vec2(180.0, 26.0));
            closing_button(panel, ui, elsewhere, Command::SaveAs);
        },
    );
}
