//! The page of datasets: what goes into one, and what it will contain.

use super::frames::frames;
use super::parts::{cameras_of, line, notes, show_left_out_frames};
use crate::ui::Panel;
use crate::ui::controls::theme::Themed as _;
use egui::{ComboBox, DragValue, Grid, RichText, ScrollArea, TextEdit, Ui};
use strum::VariantArray as _;
use touchline_application::app::Action;
use touchline_application::app::transfer::{PreviewResult, TransferAction, describe_bytes};
use touchline_core::geometry::pluralise;
use touchline_documents::exchange::{
    DatasetOptions, DatasetPlan, PictureFormat, Pictures, Split, SplitBy, Splitting,
};

/// Shows the page: options above, the plan of the dataset below.
pub fn show(panel: &mut Panel<'_>, ui: &mut Ui) {
    // The controls change a copy. If it differs afterwards, one action hands it over, and the plan
    // is made anew.
    let palette = ui.palette();
    let transfer = &panel.app.operations.transfer;
    let mut options = transfer.dataset.clone();
    frames(ui, &mut options.frames, &cameras_of(panel.app));
    pictures(ui, &mut options);
    splits(ui, &mut options);
    ui.horizontal(|ui| {
        ui.label("Licence");
        let mut text = options.licence.clone().unwrap_or_default();
        let field = TextEdit::singleline(&mut text)
            .hint_text("such as CC BY 4.0")
            .desired_width(200.0);
        ui.add(field)
            .accessible_name("Licence")
            .on_hover_text("The licence of labels and pictures, for the card.");
        options.licence = Some(text).filter(|text| !text.is_empty());
        let mut replace = transfer.replace;
        let tip =
            "A dataset that is in the chosen folder already is replaced; anything else never is.";
        ui.checkbox(&mut replace, "replace a dataset that is there")
            .on_hover_text(tip);
        if replace != transfer.replace {
            panel.act(Action::Transfer(TransferAction::Replace(replace)));
        }
    });
    if options != transfer.dataset {
        panel.act(Action::Transfer(TransferAction::Dataset(Box::new(options))));
    }
    ui.separator();
    let Some(found) = &transfer.found else { return };
    ScrollArea::vertical()
        .id_salt("dataset")
        .auto_shrink(false)
        .show(ui, |ui| match &found.look {
            PreviewResult::Dataset(Ok(plan)) => show_plan(ui, plan, &transfer.dataset),
            PreviewResult::Dataset(Err(why)) => line(ui, why, palette.bad),
            // A result of another tab, until that of this one is there.
            PreviewResult::Export(_) | PreviewResult::Import(_) => {}
        });
}

/// How pictures get into the dataset, and which.
fn pictures(ui: &mut Ui, options: &mut DatasetOptions) {
    ui.horizontal(|ui| {
        ui.label("Pictures");
        for (pictures, name, tip) in [
            (
                Pictures::Copied,
                "copies",
                "Image files as they are; frames of a video are decoded.",
            ),
            (
                Pictures::Linked,
                "hard links",
                "The same without storing image files twice, on one disk.",
            ),
            (
                Pictures::Extracted,
                "decoded anew",
                "Every frame from its video, else from its image.",
            ),
            (
                Pictures::Left,
                "none",
                "The dataset names the files where they lie.",
            ),
        ] {
            ui.radio_value(&mut options.pictures, pictures, name)
                .on_hover_text(tip);
        }
        ui.separator();
        for (format, name) in [(PictureFormat::Png, "PNG"), (PictureFormat::Jpeg, "JPEG")] {
            ui.radio_value(&mut options.picture_format, format, name)
                .on_hover_text("How decoded pictures are written.");
        }
    });
    let tip = "The pictures without lens distortion as well, with labels that fit them.";
    ui.horizontal(|ui| {
        ui.checkbox(&mut options.undistorted, "undistorted pictures as well").on_hover_text(tip);
        let tip =
            "Another person's project may refer to any of your files: check the list before you \
             share the dataset.";
        ui.checkbox(&mut options.outside, "pictures from outside of the project").on_hover_text(tip);
    });
}

/// Whether and how the frames are split into training, validation and test.
fn splits(ui: &mut Ui, options: &mut DatasetOptions) {
    ui.horizontal(|ui| {
        let mut divided = options.splitting.is_some();
        let tip = "Neighbouring frames are never separated.";
        ui.checkbox(&mut divided, "split into training, validation and test, %:")
            .on_hover_text(tip);
        let mut splitting = options.splitting.unwrap_or_default();
        if divided {
            for (share, split) in splitting.shares.iter_mut().zip(Split::ALL) {
                let field = DragValue::new(share)
                    .range(0..=100)
                    .update_while_editing(false);
                ui.add(field)
                    .accessible_name(format!("Share of {split}"))
                    .on_hover_text(format!("Share of {split}"));
            }
            ui.label("by");
            let shown = <&str>::from(splitting.by);
            let combo = ComboBox::from_id_salt("split by")
                .width(90.0)
                .selected_text(shown)
                .show_ui(ui, |ui| {
                    for by in SplitBy::VARIANTS {
                        ui.selectable_value(&mut splitting.by, *by, by.to_string());
                    }
                });
            combo.response.on_hover_text("What is never split.");
            ui.label("seed");
            let field = DragValue::new(&mut splitting.seed).update_while_editing(false);
            ui.add(field)
                .accessible_name("Seed")
                .on_hover_text("Another seed gives another split.");
        }
        // Shares of 0 %, 0 % and 0 % divide nothing, so the default shares return.
        let shares: u32 = splitting.shares.iter().sum();
        options.splitting = divided.then_some(if shares == 0 {
            Splitting::default()
        } else {
            splitting
        });
    });
}

/// Shows what the dataset will contain: numbers of frames and pictures, of each split and origin,
/// and what is left out.
fn show_plan(ui: &mut Ui, plan: &DatasetPlan, options: &DatasetOptions) {
    let palette = ui.palette();
    let size = describe_bytes(plan.picture_bytes);
    let pictures = match plan.pictures() {
        0 => "no pictures".to_owned(),
        count => format!("{}, about {size}", pluralise(count, "picture")),
    };
    line(
        ui,
        format!(
            "{}, {pictures}; with card, schema, table, loader and manifest.",
            pluralise(plan.frames.len(), "frame")
        ),
        palette.strong,
    );
    Grid::new("planned")
        .num_columns(2)
        .spacing([24.0, 2.0])
        .show(ui, |ui| {
            if options.splitting.is_some() {
                for (split, count) in Split::ALL.into_iter().zip(plan.counts()) {
                    ui.label(RichText::new(split.to_string()).color(palette.weak));
                    ui.label(count.to_string());
                    ui.end_row();
                }
            }
            for (origin, count) in plan.origins() {
                ui.label(RichText::new(origin.to_string().replace('_', " ")).color(palette.weak));
                ui.label(count.to_string());
                ui.end_row();
            }
        });
    notes(ui, &plan.notes);
    show_left_out_frames(ui, &plan.left_out);
}
