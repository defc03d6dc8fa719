//! What the pages of the dialog share.

use crate::app::sentence;
use crate::app::transfer::{Look, Transfer};
use crate::document::FrameStatus;
use crate::exchange::FrameChoice;
use crate::ui::theme;
use egui::{Color32, RichText, Ui};

/// Whether there is something to write or to take over.
pub fn is_ready(transfer: &Transfer) -> bool {
    transfer.found.as_ref().is_some_and(|found| match &found.look {
        Look::Export(made) => made.is_ok(),
        Look::Dataset(plan) => plan.is_ok(),
        Look::Import(joined) => joined.as_ref().is_ok_and(|joined| joined.matched + joined.added > 0),
    })
}

/// A line of text that wraps.
pub fn line(ui: &mut Ui, text: impl Into<String>, colour: Color32) {
    ui.add(egui::Label::new(RichText::new(text).color(colour)).wrap());
}

/// A name and what it is.
pub fn fact(ui: &mut Ui, name: &str, value: &str) {
    ui.horizontal_wrapped(|ui| {
        ui.spacing_mut().item_spacing.x = theme::SPACE;
        ui.label(RichText::new(format!("{name}:")).color(theme::WEAK));
        ui.label(RichText::new(value).color(theme::TEXT));
    });
}

/// Frames that are left out, the first by name.
pub fn left_out(ui: &mut Ui, frames: &[(String, String)]) {
    const SHOWN: usize = 3;
    for (frame, why) in frames.iter().take(SHOWN) {
        line(ui, format!("Left out: {frame}: {why}."), theme::CAUTION);
    }
    if frames.len() > SHOWN {
        line(ui, format!("Left out: {} more frames.", frames.len() - SHOWN), theme::CAUTION);
    }
}

/// What a user should know.
pub fn notes(ui: &mut Ui, notes: &[String]) {
    for note in notes {
        line(ui, sentence(note), theme::CAUTION);
    }
}

/// Which frames by status; none chosen means all that are not rejected.
pub fn statuses(ui: &mut Ui, choice: &mut FrameChoice) {
    ui.horizontal(|ui| {
        ui.label("Frames");
        for (status, name, tip) in [
            (FrameStatus::Reference, "references", "Frames that a person accepted."),
            (FrameStatus::Suggested, "suggestions", "Frames whose camera nobody has looked at."),
            (FrameStatus::Draft, "drafts", "Frames that somebody began."),
        ] {
            let is_all = choice.statuses.is_empty();
            let mut chosen = is_all || choice.statuses.contains(&status);
            if ui.checkbox(&mut chosen, name).on_hover_text(tip).changed() {
                if is_all {
                    choice.statuses = vec![FrameStatus::Reference, FrameStatus::Suggested, FrameStatus::Draft];
                }
                choice.statuses.retain(|known| *known != status);
                if chosen {
                    choice.statuses.push(status);
                }
                choice.statuses.sort_unstable();
            }
        }
    });
}
