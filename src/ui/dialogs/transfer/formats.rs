//! The formats: what each is, and what it does not hold of these frames.

use super::parts::{fact, left_out, line, notes, statuses};
use crate::app::transfer::{Look, TransferAction};
use crate::app::{Action, sentence};
use crate::exchange::{About, ExportOptions, Format, Gaps, ImportOptions, KeypointNames, LabelMap, PointSource};
use crate::ui::{Panel, theme};
use egui::{Align, Button, ComboBox, DragValue, Layout, RichText, ScrollArea, Ui, vec2};

/// The width of the list of formats, points.
const LIST: f32 = 210.0;

/// The page of exports.
pub fn export(panel: &mut Panel<'_>, ui: &mut Ui) {
    let chosen = panel.app.session.transfer.format;
    ui.horizontal_top(|ui| {
        if let Some(format) = list(ui, chosen, Format::exports) {
            panel.actions.push(Action::Transfer(TransferAction::Format(format)));
        }
        ui.separator();
        ui.vertical(|ui| {
            about(ui, chosen);
            ui.add_space(2.0 * theme::SPACE);
            let before = &panel.app.session.transfer.export;
            let mut options = before.clone();
            statuses(ui, &mut options.frames);
            options_of(ui, chosen, &mut options);
            if options != *before {
                panel.actions.push(Action::Transfer(TransferAction::Export(Box::new(options))));
            }
            ui.separator();
            ScrollArea::vertical().id_salt("export").auto_shrink(false).show(ui, |ui| exported(panel, ui));
        });
    });
}

/// The page of imports.
pub fn import(panel: &mut Panel<'_>, ui: &mut Ui) {
    let chosen = panel.app.session.transfer.import_format;
    ui.horizontal_top(|ui| {
        if let Some(format) = list(ui, chosen, Format::imports) {
            panel.actions.push(Action::Transfer(TransferAction::ImportFormat(format)));
        }
        ui.separator();
        ui.vertical(|ui| {
            about(ui, chosen);
            ui.add_space(2.0 * theme::SPACE);
            let before = &panel.app.session.transfer.import;
            let mut options = before.clone();
            labels(ui, &mut options);
            if options != *before {
                panel.actions.push(Action::Transfer(TransferAction::Import(Box::new(options))));
            }
            ui.separator();
            imported(panel, ui);
        });
    });
}

/// The list of formats; the one that was clicked.
fn list(ui: &mut Ui, chosen: Format, goes: fn(Format) -> bool) -> Option<Format> {
    let mut clicked = None;
    let column = vec2(LIST, ui.available_height());
    ui.allocate_ui_with_layout(column, Layout::top_down(Align::Min), |ui| {
        ScrollArea::vertical().id_salt("formats").auto_shrink(false).show(ui, |ui| {
            for format in Format::ALL.into_iter().filter(|format| goes(*format)) {
                let button = Button::selectable(format == chosen, format.name());
                let button = ui.add_sized(vec2(LIST - 16.0, 20.0), button.truncate());
                if button.on_hover_text(sentence(format.title())).clicked() && format != chosen {
                    clicked = Some(format);
                }
            }
        });
    });
    clicked
}

/// What a format is.
fn about(ui: &mut Ui, format: Format) {
    let About { conventions, users } = format.about();
    ui.add(egui::Label::new(RichText::new(sentence(format.title())).color(theme::STRONG)).wrap());
    fact(ui, "Conventions", conventions);
    fact(ui, "Who reads it", users);
    if format.exports() {
        fact(ui, "Does not hold", format.loses());
    }
}

/// The options of an export that its format knows.
fn options_of(ui: &mut Ui, format: Format, options: &mut ExportOptions) {
    match format {
        Format::SoccerNetLines | Format::Coco | Format::YoloPose | Format::LabelStudio | Format::Labelme => {
            ui.horizontal(|ui| {
                let mut projected = options.points == PointSource::Projected;
                let tip = "Points where the camera shows the landmarks, not where people clicked.";
                ui.checkbox(&mut projected, "where the camera shows them").on_hover_text(tip);
                options.points = if projected { PointSource::Projected } else { PointSource::Clicked };
                if matches!(format, Format::Coco | Format::YoloPose) {
                    let mut roboflow = options.names == KeypointNames::Roboflow32;
                    ui.checkbox(&mut roboflow, "names of Roboflow's 32 points")
                        .on_hover_text("Other landmarks are left out.");
                    options.names = if roboflow { KeypointNames::Roboflow32 } else { KeypointNames::Touchline };
                }
                if format == Format::SoccerNetLines {
                    ui.checkbox(&mut options.game_state, "game state")
                        .on_hover_text("Class names without the space at the end.");
                }
            });
        }
        Format::Wc14 | Format::TsWorldCup | Format::Homography => {
            let tip = "Homographies of pictures whose lens distortion has been taken out.";
            ui.checkbox(&mut options.undistorted, "of undistorted pictures").on_hover_text(tip);
        }
        Format::Csv | Format::Usda | Format::OpenTrackIo | Format::FreeD | Format::FreeDCsv | Format::Chan => {
            ui.horizontal(|ui| gaps(ui, &mut options.gaps));
        }
        _ => {}
    }
}

/// What happens where frames of a video are missing.
fn gaps(ui: &mut Ui, gaps: &mut Gaps) {
    ui.label("Missing frames");
    let mut most = if let Gaps::Interpolate(most) = *gaps { most } else { 12 };
    let tip = "Rows are missing where frames are.";
    if ui.radio(*gaps == Gaps::Keep, "stay missing").on_hover_text(tip).clicked() {
        *gaps = Gaps::Keep;
    }
    let tip = "Short gaps get cameras between those of their neighbours, marked as interpolated.";
    if ui.radio(matches!(gaps, Gaps::Interpolate(_)), "are interpolated").on_hover_text(tip).clicked() {
        *gaps = Gaps::Interpolate(most);
    }
    if matches!(gaps, Gaps::Interpolate(_)) {
        let field = DragValue::new(&mut most).range(1..=500).prefix("up to ").update_while_editing(false);
        ui.add(field).accessible_name("Longest gap").on_hover_text("Longer gaps stay, frames.");
        *gaps = Gaps::Interpolate(most);
    }
    if ui.radio(*gaps == Gaps::Takes, "begin a new take").on_hover_text("A file for each run of frames.").clicked() {
        *gaps = Gaps::Takes;
    }
}

/// What the export would be.
fn exported(panel: &Panel<'_>, ui: &mut Ui) {
    let Some(found) = &panel.app.session.transfer.found else { return };
    match &found.look {
        Look::Export(Ok(made)) => {
            let frames = if made.frames == 1 { "1 frame".to_owned() } else { format!("{} frames", made.frames) };
            let files =
                if made.files.len() == 1 { "one file".to_owned() } else { format!("{} files", made.files.len()) };
            let proof = if made.format.is_proved() {
                format!(" Read again, everything is within {:.0e} px.", made.worst_px.max(1e-12))
            } else {
                String::new()
            };
            line(ui, format!("{frames} in {files}.{proof}"), theme::STRONG);
            match &made.loss {
                Some(loss) => line(ui, sentence(&loss.to_string()), theme::CAUTION),
                None => line(ui, "Nothing that can be measured is lost.", theme::GOOD),
            }
            notes(ui, &made.notes);
            left_out(ui, &made.left_out);
        }
        Look::Export(Err(why)) => line(ui, why, theme::BAD),
        Look::Dataset(_) | Look::Import(_) => {}
    }
}

/// What labels mean, for formats of points.
fn labels(ui: &mut Ui, options: &mut ImportOptions) {
    const MAPS: [(LabelMap, &str); 4] = [
        (LabelMap::Touchline, "names of touchline"),
        (LabelMap::Roboflow32, "Roboflow's 32 points by index"),
        (LabelMap::Roboflow32Captions, "Roboflow's 32 points, 01 to 32"),
        (LabelMap::SoccerNet, "SoccerNet's classes"),
    ];
    ui.horizontal(|ui| {
        ui.label("Labels are");
        let shown = MAPS.iter().find(|(map, _)| *map == options.map).map_or("your own", |(_, name)| *name);
        let combo = ComboBox::from_id_salt("labels").width(220.0).selected_text(shown).show_ui(ui, |ui| {
            for (map, name) in MAPS {
                let is_chosen = options.map == map;
                if ui.selectable_label(is_chosen, name).clicked() {
                    options.map = map;
                }
            }
        });
        combo
            .response
            .on_hover_text("What the labels of other tools mean; formats with classes of their own ignore it.");
        ui.checkbox(&mut options.skip_unmapped, "leave out others")
            .on_hover_text("Labels without a meaning are left out, and counted.");
    });
}

/// What the import brings.
fn imported(panel: &Panel<'_>, ui: &mut Ui) {
    let Some(found) = &panel.app.session.transfer.found else {
        line(ui, "Choose the files; what they bring is shown here before anything changes.", theme::WEAK);
        return;
    };
    match &found.look {
        Look::Import(Ok(joined)) => {
            let text = format!(
                "{} frames of this document get labels, {} are new: {} clicks, {} new cameras.",
                joined.matched, joined.added, joined.clicks, joined.cameras
            );
            line(ui, text, theme::STRONG);
            if joined.kept > 0 {
                line(ui, format!("{} frames have labels of their own, which stay.", joined.kept), theme::TEXT);
            }
            if joined.other_size > 0 {
                let text = format!("{} frames are left: their pictures have another size here.", joined.other_size);
                line(ui, text, theme::CAUTION);
            }
            notes(ui, &joined.notes);
        }
        Look::Import(Err(why)) => line(ui, why, theme::BAD),
        Look::Export(_) | Look::Dataset(_) => {}
    }
}
