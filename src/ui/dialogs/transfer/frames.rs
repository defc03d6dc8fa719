//! The choice of frames for an export or a dataset.

use egui::{ComboBox, DragValue, Ui};
use touchline_documents::document::{CameraId, FrameStatus};
use touchline_documents::exchange::FrameChoice;

/// Confidence at which the choice begins, per cent.
const USUAL_PERCENT: f64 = 90.0;

/// The choice by status, camera and confidence.
pub fn frames(ui: &mut Ui, choice: &mut FrameChoice, cameras: &[CameraId]) {
    ui.horizontal_wrapped(|ui| {
        statuses(ui, choice);
        ui.separator();
        if cameras.len() > 1 {
            show_camera_choice(ui, choice, cameras);
        }
        confident(ui, choice);
    });
}

/// The choice by camera: one, or all.
fn show_camera_choice(ui: &mut Ui, choice: &mut FrameChoice, cameras: &[CameraId]) {
    let text = match choice.cameras.as_slice() {
        [] => "all cameras",
        [one] => one.as_str(),
        _ => "several",
    };
    let combo = ComboBox::from_id_salt("cameras")
        .width(140.0)
        .selected_text(text)
        .show_ui(ui, |ui| {
            if ui
                .selectable_label(choice.cameras.is_empty(), "all cameras")
                .clicked()
            {
                choice.cameras.clear();
            }
            for camera in cameras {
                if ui
                    .selectable_label(choice.cameras.contains(camera), camera.as_str())
                    .clicked()
                {
                    choice.cameras = vec![camera.clone()];
                }
            }
        });
    combo.response.on_hover_text("Only frames of this camera.");
}

/// The choice by confidence.
fn confident(ui: &mut Ui, choice: &mut FrameChoice) {
    let mut is_limited = choice.min_confidence.is_some();
    let tip = "Frames whose stated confidence is lower are left out. References that were clicked state none and stay.";
    ui.checkbox(&mut is_limited, "confidence of at least")
        .on_hover_text(tip);
    // A share from 0 to 1 in the choice, per cent in the field.
    let mut percent = choice
        .min_confidence
        .map_or(USUAL_PERCENT, |share| 100.0 * share);
    if is_limited {
        let field = DragValue::new(&mut percent)
            .range(0.0..=100.0)
            .suffix(" %")
            .update_while_editing(false);
        ui.add(field)
            .accessible_name("Least confidence")
            .on_hover_text(tip);
    }
    choice.min_confidence = is_limited.then_some(percent / 100.0);
}

/// The choice by status. An empty list means all that are not rejected.
fn statuses(ui: &mut Ui, choice: &mut FrameChoice) {
    ui.label("Frames");
    for (status, name, tip) in [
        (
            FrameStatus::Reference,
            "references",
            "Frames that a person accepted.",
        ),
        (
            FrameStatus::Suggested,
            "suggestions",
            "Frames whose camera has not been reviewed.",
        ),
        (
            FrameStatus::Draft,
            "drafts",
            "Frames with points that have not been accepted.",
        ),
    ] {
        let is_all = choice.statuses.is_empty();
        let mut chosen = is_all || choice.statuses.contains(&status);
        if ui.checkbox(&mut chosen, name).on_hover_text(tip).changed() {
            // The first change replaces "all" by a list, from which the status is then removed.
            if is_all {
                choice.statuses = vec![
                    FrameStatus::Reference,
                    FrameStatus::Suggested,
                    FrameStatus::Draft,
                ];
            }
            choice.statuses.retain(|known| *known != status);
            if chosen {
                choice.statuses.push(status);
            }
            // In one order, so that equal choices compare as equal whatever was clicked first. The
            // last status cannot be taken away: an empty list means all of them again.
            choice.statuses.sort_unstable();
        }
    }
}
