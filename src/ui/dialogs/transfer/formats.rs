//! The pages of exports and imports: a list of formats, what each is, its options, and what the
//! result would be.

use super::frames::frames;
use super::options::{export_options, import_options};
use super::parts::{cameras_of, fact, line, notes, show_left_out_frames};
use crate::ui::Panel;
use crate::ui::controls::theme;
use crate::ui::controls::theme::{Themed as _, section};
use egui::{Align, Button, Id, Layout, RichText, ScrollArea, TextEdit, TextStyle, Ui, vec2};
use strum::IntoEnumIterator as _;
use touchline_application::app::transfer::{
    FormatGroup, PreviewResult, TransferAction, describe_survey, formats_in, group_and_name,
    in_dialog,
};
use touchline_application::app::{Action, sentence};
use touchline_core::geometry::pluralise;
use touchline_documents::exchange::{Format, JoinedImport, JoinedPair};

/// Number of formats that were used last and stand above the groups.
const LAST_USED: usize = 3;
/// Width of the list of formats, points.
const LIST: f32 = 210.0;

/// Distance up to which an export that is read again counts as exact, px. Text with six decimals is
/// within it.
const EXACT_PX: f64 = 0.01;

/// Shows the page of exports.
pub fn export(panel: &mut Panel<'_>, ui: &mut Ui) {
    let chosen = panel.app.operations.transfer.format;
    let last = panel.app.settings.formats.clone();
    ui.horizontal_top(|ui| {
        if let Some(format) = list(ui, chosen, &last, Format::exports) {
            panel.act(Action::Transfer(TransferAction::Format(format)));
        }
        ui.separator();
        ui.vertical(|ui| {
            about(ui, chosen);
            ui.add_space(2.0 * theme::SPACE);
            let before = &panel.app.operations.transfer.export;
            let mut options = before.clone();
            frames(ui, &mut options.frames, &cameras_of(panel.app));
            export_options(ui, chosen, &mut options);
            if options != *before {
                panel.act(Action::Transfer(TransferAction::Export(Box::new(options))));
            }
            ui.separator();
            ScrollArea::vertical()
                .id_salt("export")
                .auto_shrink(false)
                .show(ui, |ui| show_export_preview(panel, ui));
        });
    });
}

/// Shows the page of imports.
pub fn import(panel: &mut Panel<'_>, ui: &mut Ui) {
    let chosen = panel.app.operations.transfer.import_format;
    ui.horizontal_top(|ui| {
        if let Some(format) = list(ui, chosen, &[], Format::imports) {
            panel.act(Action::Transfer(TransferAction::ImportFormat(format)));
        }
        ui.separator();
        ui.vertical(|ui| {
            about(ui, chosen);
            ui.add_space(2.0 * theme::SPACE);
            let before = &panel.app.operations.transfer.import;
            let mut options = before.clone();
            import_options(ui, chosen, &mut options);
            if options != *before {
                panel.act(Action::Transfer(TransferAction::Import(Box::new(options))));
            }
            ui.separator();
            show_import_preview(panel, ui);
        });
    });
}

/// Shows the list of formats in groups, those that were used last first, with a field that finds
/// one by a word. Returns the one that was clicked.
fn list(ui: &mut Ui, chosen: Format, last: &[String], goes: fn(Format) -> bool) -> Option<Format> {
    let mut clicked = None;
    let column = vec2(LIST, ui.available_height());
    ui.allocate_ui_with_layout(column, Layout::top_down(Align::Min), |ui| {
        // What is typed is lost with the dialog, so it is no state of the application.
        let memory = Id::unique("typed format");
        let mut typed: String = ui.data_mut(|data| data.get_temp(memory).unwrap_or_default());
        let field = TextEdit::singleline(&mut typed).hint_text("Find a format");
        ui.add(field.desired_width(LIST - 16.0))
            .accessible_name("Find a format");
        ui.data_mut(|data| data.insert_temp(memory, typed.clone()));
        ScrollArea::vertical()
            .id_salt("formats")
            .auto_shrink(false)
            .show(ui, |ui| {
                let mut group = |ui: &mut Ui, title: &str, formats: &[Format]| {
                    if formats.is_empty() {
                        return;
                    }
                    section(ui, title);
                    for &format in formats {
                        if entry(ui, format, chosen) {
                            clicked = Some(format);
                        }
                    }
                };
                let last: Vec<Format> = last
                    .iter()
                    .filter_map(|name| Format::all().find(|format| format.name() == name))
                    .filter(|format| goes(*format) && typed.trim().is_empty())
                    .take(LAST_USED)
                    .collect();
                group(ui, "Last used", &last);
                for of in FormatGroup::iter() {
                    let formats = formats_in(of, &typed, goes);
                    group(ui, of.title(), &formats);
                }
            });
    });
    clicked
}

/// Shows a format of the list. Returns whether it was chosen now.
fn entry(ui: &mut Ui, format: Format, chosen: Format) -> bool {
    let is_chosen = format == chosen;
    let size = vec2(LIST - 16.0, 20.0);
    let left = Layout::left_to_right(Align::Center).with_main_justify(true);
    let button = Button::selectable(is_chosen, group_and_name(format).1).truncate();
    let entry = ui.allocate_ui_with_layout(size, left.with_main_align(Align::Min), |ui| {
        ui.add(button.min_size(size))
    });
    let about = sentence(format.about().title);
    let clicked = entry.inner.on_hover_text(about).clicked();
    clicked && !is_chosen
}

/// Describes a format: conventions, programs that read it, what it cannot express.
fn about(ui: &mut Ui, format: Format) {
    let palette = ui.palette();
    let about = format.about();
    ui.add(egui::Label::new(RichText::new(sentence(about.title)).color(palette.strong)).wrap());
    fact(ui, "Conventions", &in_dialog(about.conventions));
    fact(ui, "Who reads it", &in_dialog(about.users));
    if let Some(loses) = about.loses {
        fact(ui, "Leaves out", loses);
    }
}

/// Shows what the export would be: frames and files, whether reading it again gives the same, and
/// what is lost.
fn show_export_preview(panel: &Panel<'_>, ui: &mut Ui) {
    let palette = ui.palette();
    let Some(found) = &panel.app.operations.transfer.found else {
        return;
    };
    match &found.look {
        PreviewResult::Export(Ok(made)) => {
            let frames = pluralise(made.frames, "frame");
            let files = match made.files.len() {
                1 => "one file".to_owned(),
                count => format!("{count} files"),
            };
            line(ui, format!("{frames} in {files}."), palette.strong);
            // One statement about what is lost: the stated loss, or what was found on reading the
            // export again.
            match &made.loss {
                Some(loss) => line(ui, sentence(&loss.to_string()), palette.caution),
                None if !made.format.is_proved() => {}
                None if made.worst_px < EXACT_PX => {
                    line(ui, "Checked: reads back exactly.", palette.good);
                }
                None => {
                    let off = format!("Checked: reads back within {:.1} px.", made.worst_px);
                    line(ui, off, palette.caution);
                }
            }
            notes(ui, &made.notes);
            show_left_out_frames(ui, &made.left_out);
        }
        PreviewResult::Export(Err(why)) => line(ui, why, palette.bad),
        PreviewResult::Dataset(_) | PreviewResult::Import(_) => {}
    }
}

/// Shows what the import would bring.
fn show_import_preview(panel: &Panel<'_>, ui: &mut Ui) {
    let palette = ui.palette();
    let Some(found) = &panel.app.operations.transfer.found else {
        line(
            ui,
            "Choose the files; what they bring is shown here before anything changes.",
            palette.weak,
        );
        return;
    };
    match &found.look {
        PreviewResult::Import(Ok(look)) => {
            let joined = &look.joined;
            line(ui, describe_gain(joined), palette.strong);
            for text in look.survey.iter().flat_map(describe_survey) {
                line(ui, text, palette.text);
            }
            if joined.kept > 0 {
                let frames = pluralise(joined.kept, "frame");
                let text = format!("{frames} with own labels, which stay.");
                line(ui, text, palette.text);
            }
            if joined.other_size > 0 {
                let frames = pluralise(joined.other_size, "frame");
                let text = format!("{frames} left out: another size of picture here.");
                line(ui, text, palette.caution);
            }
            notes(ui, &joined.notes);
            notes(ui, &joined.failures);
            pairs(ui, &joined.pairs);
        }
        PreviewResult::Import(Err(why)) => line(ui, why, palette.bad),
        PreviewResult::Export(_) | PreviewResult::Dataset(_) => {}
    }
}

/// How many frames, clicks and cameras an import brings.
fn describe_gain(joined: &JoinedImport) -> String {
    let matched = pluralise(joined.matched, "frame");
    let get = if joined.matched == 1 { "gets" } else { "get" };
    let mut parts = vec![format!("{matched} of this document {get} labels")];
    for (count, noun) in [
        (joined.added, "new frame"),
        (joined.clicks, "click"),
        (joined.cameras, "new camera"),
    ] {
        if count > 0 {
            parts.push(pluralise(count, noun));
        }
    }
    parts.join(", ") + "."
}

/// Lists which imported frame was matched to which frame of the document, so that the user sees a
/// wrong match before it is merged.
fn pairs(ui: &mut Ui, pairs: &[JoinedPair]) {
    let palette = ui.palette();
    if pairs.is_empty() {
        return;
    }
    line(ui, "Taken for the same pictures:", palette.weak);
    // There may be as many pairs as frames, so only those in view are laid out.
    let height = ui.text_style_height(&TextStyle::Body);
    ScrollArea::vertical()
        .id_salt("pairs")
        .auto_shrink(false)
        .show_rows(ui, height, pairs.len(), |ui, rows| {
            for JoinedPair { imported, document } in pairs.get(rows).into_iter().flatten() {
                ui.add(egui::Label::new(format!("{imported} → {document}")).truncate());
            }
        });
}
