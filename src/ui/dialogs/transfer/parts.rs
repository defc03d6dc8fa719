//! Parts that the pages of the dialog share.

use crate::ui::controls::theme;
use crate::ui::controls::theme::Themed as _;
use egui::{Color32, RichText, Ui};
use touchline_application::app::App;
use touchline_application::app::transfer::{PreviewResult, TransferState, in_dialog};
use touchline_core::geometry::pluralise;
use touchline_documents::document::CameraId;

/// Whether there is something to write or to merge: an export or a dataset without an error, or an
/// import that brings labels or frames.
pub fn is_ready(transfer: &TransferState) -> bool {
    transfer
        .found
        .as_ref()
        .is_some_and(|found| match &found.look {
            PreviewResult::Export(made) => made.is_ok(),
            PreviewResult::Dataset(plan) => plan.is_ok(),
            PreviewResult::Import(look) => look
                .as_ref()
                .is_ok_and(|look| look.joined.matched + look.joined.added > 0),
        })
}

/// Whether an import brings cameras that can be mended afterwards.
pub fn can_mend(transfer: &TransferState) -> bool {
    let Some(PreviewResult::Import(Ok(look))) = transfer.found.as_ref().map(|found| &found.look)
    else {
        return false;
    };
    look.can_be_mended()
}

/// The cameras of the open document.
pub fn cameras_of(app: &App) -> Vec<CameraId> {
    let cameras = app
        .open()
        .map(|open| open.document.cameras.iter().map(|camera| camera.id.clone()));
    cameras.into_iter().flatten().collect()
}

/// A line of text that wraps.
pub fn line(ui: &mut Ui, text: impl Into<String>, colour: Color32) {
    ui.add(egui::Label::new(RichText::new(text).color(colour)).wrap());
}

/// A name and its value in one line.
pub fn fact(ui: &mut Ui, name: &str, value: &str) {
    let palette = ui.palette();
    ui.horizontal_wrapped(|ui| {
        ui.spacing_mut().item_spacing.x = theme::SPACE;
        ui.label(RichText::new(format!("{name}:")).color(palette.weak));
        ui.label(RichText::new(value).color(palette.text));
    });
}

/// Lists frames that are left out, with the reasons: the first few by name, the number of the
/// others.
pub fn show_left_out_frames(ui: &mut Ui, frames: &[(String, String)]) {
    const SHOWN: usize = 3;
    let palette = ui.palette();
    for (frame, why) in frames.iter().take(SHOWN) {
        // A reason that contains the name does not need it twice.
        let says = if why.contains(frame.as_str()) {
            why.clone()
        } else {
            format!("{frame}: {why}")
        };
        line(ui, in_dialog(&format!("Left out: {says}")), palette.caution);
    }
    if frames.len() > SHOWN {
        let more = pluralise(frames.len() - SHOWN, "more frame");
        line(ui, format!("Left out: {more}."), palette.caution);
    }
}

/// Shows notes for the user.
pub fn notes(ui: &mut Ui, notes: &[String]) {
    let palette = ui.palette();
    for note in notes {
        line(ui, in_dialog(note), palette.caution);
    }
}
