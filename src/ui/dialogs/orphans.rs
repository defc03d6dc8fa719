//! Edits that were made to another version of the document and were set aside. They can be merged
//! or saved as a document of their own.

use super::sheet;
use crate::ui::Panel;
use crate::ui::controls::theme;
use crate::ui::controls::theme::Themed as _;
use egui::{Context, Label, RichText, ScrollArea, Ui, vec2};
use touchline_application::app::Action;
use touchline_documents::store::Orphan;

/// Shows the dialog.
pub fn show(panel: &mut Panel<'_>, ctx: &Context) {
    sheet(
        panel,
        ctx,
        "Edits set aside",
        vec2(560.0, 320.0),
        |panel, ui| {
            let text =
                "These edits were made to another version of this document and are not part of it.";
            ui.add(Label::new(RichText::new(text).color(ui.palette().strong)).wrap());
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
            panel.actions.push(Action::MergeOrphan(orphan.path.clone()));
        }
        let save = ui.button("Save as a document").on_hover_text("Save the result of these edits as a separate document beside this one.");
        if save.clicked() {
            panel.actions.push(Action::SaveOrphan(orphan.path.clone()));
        }
    });
    ui.add_space(theme::SPACE);
}
