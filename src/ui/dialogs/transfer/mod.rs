//! The dialog for exports, datasets and imports. It shows what will be written or merged before
//! anything happens.

mod dataset;
mod formats;
mod frames;
mod options;
mod parts;
mod typed;

use super::{cancel, sheet};
use crate::ui::Panel;
use crate::ui::controls::show_button;
use crate::ui::controls::theme::Themed as _;
use egui::{
    Align, Button, Context, Key, Layout, Modifiers, ProgressBar, RichText, Spinner, Ui, vec2,
};
use touchline_application::app::transfer::{TransferAction, TransferTab};
use touchline_application::app::{Action, Command};
use touchline_core::progress::Share;

/// Size of the dialog, points.
const SIZE: egui::Vec2 = vec2(820.0, 560.0);
/// Height below the page for progress and buttons, points.
const FOOT: f32 = 36.0;

/// The pages, with titles and tooltips.
const TABS: [(TransferTab, &str, &str); 3] = [
    (
        TransferTab::Export,
        "Formats",
        "The document in one of many formats.",
    ),
    (
        TransferTab::Dataset,
        "Dataset",
        "A folder with pictures, labels, splits, a card and a manifest.",
    ),
    (
        TransferTab::Import,
        "Import",
        "Clicks or cameras of another program, joined with this document.",
    ),
];

/// Shows the dialog.
pub fn show(panel: &mut Panel<'_>, ctx: &Context) {
    sheet(panel, ctx, "Export and import", SIZE, |panel, ui| {
        tabs(panel, ui);
        ui.separator();
        // The pages have one height, so that tabs and buttons stay in place.
        let height = (ui.available_height() - FOOT).clamp(240.0, SIZE.y - 120.0);
        let page = vec2(ui.available_width(), height);
        ui.allocate_ui_with_layout(page, Layout::top_down(Align::Min), |ui| {
            ui.set_min_size(page);
            match panel.app.operations.transfer.tab {
                TransferTab::Export => formats::export(panel, ui),
                TransferTab::Dataset => dataset::show(panel, ui),
                TransferTab::Import => formats::import(panel, ui),
            }
        });
        ui.separator();
        let row = vec2(ui.available_width(), 26.0);
        ui.allocate_ui_with_layout(row, Layout::right_to_left(Align::Center), |ui| {
            foot(panel, ui);
        });
    });
}

/// The choice of the page.
fn tabs(panel: &mut Panel<'_>, ui: &mut Ui) {
    ui.horizontal(|ui| {
        for (tab, title, tip) in TABS {
            let is_shown = panel.app.operations.transfer.tab == tab;
            let why_not = match tab {
                TransferTab::Import => panel.app.why_not(Command::Import),
                TransferTab::Export | TransferTab::Dataset => None,
            };
            let button = ui.add_enabled(why_not.is_none(), Button::selectable(is_shown, title));
            let button = button
                .on_hover_text(tip)
                .on_disabled_hover_text(why_not.unwrap_or_default());
            if button.clicked() && !is_shown {
                panel.act(Action::Transfer(TransferAction::Tab(tab)));
            }
        }
    });
}

/// The buttons, and the progress of what is going on.
fn foot(panel: &mut Panel<'_>, ui: &mut Ui) {
    let palette = ui.palette();
    let transfer = &panel.app.operations.transfer;
    let (tab, is_looking) = (transfer.tab, transfer.is_looking());
    let is_ready = parts::is_ready(transfer);
    let mut push = |action| panel.act(Action::Transfer(action));
    // While a dataset or export is written, it can only be stopped.
    if let Some(running) = transfer.writing() {
        let written = running.progress().copied();
        if show_button(ui, Button::new("Stop"), "End it; nothing is written.") {
            push(TransferAction::Stop);
        }
        progress(ui, written);
        return;
    }
    // Without the focus on a control, Enter means the main button.
    let entered = is_ready
        && ui.memory(|memory| memory.focused().is_none())
        && ui.input_mut(|input| input.consume_key(Modifiers::NONE, Key::Enter));
    let (label, tip) = match tab {
        TransferTab::Export => ("Export…", "Choose where it is written. (Enter)"),
        TransferTab::Dataset => (
            "Write dataset…",
            "Choose its folder. It is written beside it first and then renamed. (Enter)",
        ),
        TransferTab::Import => (
            "Choose files…",
            "Read them and show what they bring; nothing is changed yet.",
        ),
    };
    // An import needs two steps, choosing the files and merging them. The others need one. Enter
    // means the button that does most: mending, where that is possible, else merging.
    if tab == TransferTab::Import {
        let can_mend = parts::can_mend(transfer);
        if can_mend {
            let mend = Button::new("Import and mend").fill(palette.accent_ground);
            let tip = "Import them, then put all of them on one camera and its painted lines. \
                       Two steps of undo. (Enter)";
            if show_button(ui, mend, tip) || entered {
                push(TransferAction::TakeOverAndMend);
            }
        }
        let (label_alone, fill, key) = if can_mend {
            ("Only import", palette.control, "")
        } else {
            ("Import", palette.accent_ground, " (Enter)")
        };
        let take = ui.add_enabled(is_ready, Button::new(label_alone).fill(fill));
        let take = take
            .on_hover_text(format!(
                "Merge it into the document. One step of undo.{key}"
            ))
            .on_disabled_hover_text("Choose files first.");
        if take.clicked() || (entered && !can_mend) {
            push(TransferAction::TakeOver);
        }
        if ui
            .add_enabled(!is_looking, Button::new(label))
            .on_hover_text(tip)
            .clicked()
        {
            push(TransferAction::Choose);
        }
    } else {
        let write = ui.add_enabled(is_ready, Button::new(label).fill(palette.accent_ground));
        if write
            .on_hover_text(tip)
            .on_disabled_hover_text("There is nothing to write.")
            .clicked()
            || entered
        {
            push(TransferAction::Choose);
        }
    }
    cancel(panel, ui, "Close without a change. (Esc)");
    if is_looking {
        ui.add(Spinner::new().size(14.0));
        ui.label(RichText::new("Looking…").color(palette.weak));
    }
}

/// The progress of writing.
fn progress(ui: &mut Ui, written: Option<Share>) {
    let (share, text) = match written {
        Some(written) => (
            written.fraction(),
            format!("{} of {} pictures", written.done, written.of),
        ),
        None => (0.0, "Writing…".to_owned()),
    };
    ui.add(ProgressBar::new(share).desired_width(240.0).text(text));
}
