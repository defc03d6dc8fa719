//! The question before a large batch of suggestions is discarded.

use super::{cancel, sheet};
use crate::ui::Panel;
use crate::ui::controls::theme;
use crate::ui::controls::theme::Themed as _;
use egui::{Align, Context, Label, Layout, RichText, vec2};
use touchline_application::app::{Action, EditAction};
use touchline_calibration::proposals::BatchId;

/// Shows the dialog. `frames` is the number of frames that show the batch.
pub fn show_discard_batch(panel: &mut Panel<'_>, ctx: &Context, batch: BatchId, frames: usize) {
    let title = format!("Discard the suggestions of {frames} frames?");
    sheet(panel, ctx, &title, vec2(460.0, 180.0), |panel, ui| {
        let what = "They show again what was suggested before, or nothing. Frames that you have \
                    changed or accepted since are kept. Undo gives the suggestions back.";
        ui.add(Label::new(RichText::new(what).color(ui.palette().strong)).wrap());
        ui.add_space(2.0 * theme::SPACE);
        let row = vec2(ui.available_width(), 28.0);
        ui.allocate_ui_with_layout(row, Layout::right_to_left(Align::Center), |ui| {
            let does = RichText::new(format!("Discard {frames}")).color(ui.palette().bad);
            if ui.button(does).on_hover_text("One step of undo.").clicked() {
                let discard = EditAction::DiscardBatch(batch);
                panel.actions.push(Action::Edit(discard));
            }
            cancel(panel, ui, "Keep them. (Esc)");
        });
    });
}
