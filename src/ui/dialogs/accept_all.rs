//! Accepting frames together, suggestions above a confidence or a selected stretch: how many, how
//! many of them are wrong or left and why, and a look at the doubtful ones and at samples.

use super::{cancel, has_just_opened, sheet};
use crate::ui::controls::show_button;
use crate::ui::controls::theme::{self, Themed as _};
use crate::ui::maps::miniature;
use crate::ui::{Panel, review};
use egui::{
    Align, Align2, Button, Checkbox, Context, FontId, Id, Label, Layout, Rect, RichText, Role,
    ScrollArea, Sense, Stroke, Ui, UiBuilder, WidgetInfo, vec2,
};
use std::sync::Arc;
use touchline_application::app::review::{AcceptSheet, BulkAccept, DISAGREES_PX, percent};
use touchline_application::app::{Command, EditAction, ViewAction};
use touchline_calibration::proposals::{BatchId, ExpectedWrong};
use touchline_core::geometry::pluralise;

/// Size of the dialog, points.
const SIZE: egui::Vec2 = vec2(760.0, 560.0);
/// Size of a thumbnail, points.
const PICTURE: egui::Vec2 = vec2(232.0, 131.0);
/// Height of its caption, points.
const CAPTION: f32 = 18.0;
/// Gap between thumbnails, points.
const GAP: f32 = 8.0;

/// Shows the dialog.
pub fn show(panel: &mut Panel<'_>, ctx: &Context) {
    let opened = has_just_opened(ctx, "accept all");
    let Some(shown) = panel.app.accept_sheet().map(Arc::clone) else {
        return;
    };
    let bulk = &shown.bulk;
    let title = if bulk.of_stretch.is_some() {
        "Accept the selected frames"
    } else {
        "Accept all above"
    };
    sheet(panel, ctx, title, SIZE, |panel, ui| {
        if bulk.of_stretch.is_none() {
            ui.horizontal(|ui| {
                ui.label("Confidence at least");
                review::threshold(panel, ui);
            });
        }
        theme::strong_text(ui, describe(panel, &shown));
        disagreeing(panel, ui, bulk);
        ui.add_space(theme::SPACE);
        // The thumbnails take the height that heading and buttons leave.
        let room = ui.available_height().min(SIZE.y - 170.0);
        ui.allocate_ui(vec2(ui.available_width(), room), |ui| grid(panel, ui, bulk));
        ui.add_space(theme::SPACE);
        let row = vec2(ui.available_width(), 28.0);
        ui.allocate_ui_with_layout(row, Layout::right_to_left(Align::Center), |ui| {
            buttons(panel, ui, bulk, opened);
        });
    });
}

/// What is accepted, and what is not.
fn describe(panel: &Panel<'_>, sheet: &AcceptSheet) -> String {
    match (&sheet.bulk.of_stretch, panel.app.open()) {
        (Some(left), Some(open)) => {
            let says = left.describe(sheet.bulk.ticked_rows().count(), open);
            match sheet.bulk.late {
                0 => says,
                1 => format!("{says} 1 changed since it was counted and stays."),
                late => format!("{says} {late} changed since they were counted and stay."),
            }
        }
        _ => describe_suggestions(panel, sheet),
    }
}

fn describe_suggestions(
    panel: &Panel<'_>,
    AcceptSheet {
        bulk,
        expected_wrong,
    }: &AcceptSheet,
) -> String {
    // Rows are sorted by confidence, the most doubtful first. Without rows, the highest confidence
    // of all suggestions says how far the threshold has to come down.
    let Some(lowest) = bulk.rows.first().and_then(|row| row.confidence) else {
        let best = panel
            .app
            .review()
            .rows
            .iter()
            .filter_map(|row| row.confidence)
            .max_by(f64::total_cmp);
        let best = best.map_or_else(String::new, |best| {
            format!(" The highest is {}.", percent(best))
        });
        return format!("No suggestion has this confidence.{best}");
    };
    let count = pluralise(bulk.ticked_rows().count(), "suggestion");
    let shown = if bulk.preview().len() < bulk.rows.len() {
        "Shown: the least certain, and samples of the rest"
    } else {
        "The least certain come first"
    };
    let expected = describe_wrong(expected_wrong);
    let late = match bulk.late {
        0 => String::new(),
        late => format!(" {late} more came since and must wait for the next time."),
    };
    format!(
        "{count}, {expected}. {shown}, from {} on.{late}",
        percent(lowest)
    )
}

/// The expected number of wrong ones, as the interval that contains it in 95 of 100 cases.
fn describe_wrong(wrong: &ExpectedWrong) -> String {
    match (wrong.least, wrong.most) {
        (_, 0) => "all probably right".to_owned(),
        (least, most) if least == most => format!("{most} of them probably wrong"),
        (0, most) => format!("probably at most {most} of them wrong"),
        (least, most) => format!("about {:.0} of them wrong ({least} to {most})", wrong.mean),
    }
}

/// The choice whether to include suggestions that are out of line with their neighbours.
fn disagreeing(panel: &mut Panel<'_>, ui: &mut Ui, bulk: &BulkAccept) {
    let before = panel.app.session.review.with_disagreeing;
    if !before && bulk.left_out == 0 {
        return;
    }
    let mut with = before;
    let says = match bulk.left_out {
        0 => format!(
            "Include those more than {DISAGREES_PX:.0} px out of line with their neighbours"
        ),
        count => format!(
            "Include the {count} more than {DISAGREES_PX:.0} px out of line with their neighbours"
        ),
    };
    ui.checkbox(&mut with, says)
        .on_hover_text("A jump between neighbours means a wrong camera, a cut, or a fast pan.");
    if with != before {
        panel.view(ViewAction::SetWithDisagreeing(with));
    }
}

/// Shows thumbnails of some of the suggestions. A click shows the frame; the tick excludes it.
fn grid(panel: &mut Panel<'_>, ui: &mut Ui, bulk: &BulkAccept) {
    let shown = bulk.preview();
    // Rows of thumbnails have one height, so only those in view are laid out. 8 points are for the
    // scroll bar.
    let columns = (((ui.available_width() - 8.0) / (PICTURE.x + GAP)) as usize).max(1);
    let row = PICTURE.y + CAPTION;
    ui.spacing_mut().item_spacing.y = GAP;
    ScrollArea::vertical()
        .id_salt("accept all")
        .auto_shrink(false)
        .show_rows(ui, row, shown.len().div_ceil(columns), |ui, range| {
            for line in range {
                let (place, _) =
                    ui.allocate_exact_size(vec2(ui.available_width(), row), Sense::hover());
                let first = line * columns;
                for (column, suggestion) in shown.iter().skip(first).take(columns).enumerate() {
                    let left = place.min + vec2(column as f32 * (PICTURE.x + GAP), 0.0);
                    let confidence = suggestion.confidence.map(percent).unwrap_or_default();
                    let place = Rect::from_min_size(left, vec2(PICTURE.x, row));
                    cell(panel, ui, suggestion.frame, &confidence, place);
                    tick(
                        panel,
                        ui,
                        suggestion.frame,
                        !bulk.unticked.contains(&suggestion.frame),
                        place,
                    );
                }
            }
        });
}

/// Shows a thumbnail with number and confidence.
fn cell(panel: &mut Panel<'_>, ui: &Ui, index: usize, confidence: &str, place: Rect) {
    let Some(open) = panel.app.open() else { return };
    let number = open.frame_number(index);
    let response = ui.interact(
        place,
        Id::unique(("accept all cell", index)),
        Sense::click(),
    );
    response.widget_info(|| {
        WidgetInfo::labeled(
            Role::Button,
            true,
            format!("Look at frame {number}, {confidence}"),
        )
    });
    let picture = Rect::from_min_size(place.min, PICTURE);
    miniature::paint(panel, ui.painter(), open, index, picture);
    if response.hovered() || response.has_focus() {
        ui.painter().rect_stroke(
            picture,
            2.0,
            Stroke::new(2.0, ui.palette().accent),
            egui::StrokeKind::Inside,
        );
    }
    let line = place.bottom() - CAPTION / 2.0;
    let small = FontId::proportional(theme::SMALL);
    let painter = ui.painter();
    painter.text(
        egui::pos2(place.left() + 1.0, line),
        Align2::LEFT_CENTER,
        number,
        small.clone(),
        ui.palette().weak,
    );
    painter.text(
        egui::pos2(place.right() - 1.0, line),
        Align2::RIGHT_CENTER,
        confidence,
        small,
        ui.palette().text,
    );
    // A look at a frame closes the dialog. The application remembers the choices in it.
    if response
        .on_hover_text("Click to look at it first.")
        .clicked()
    {
        panel.close_dialog();
        panel.go_to(index);
    }
}

/// The tick of a suggestion: whether it is accepted with the others.
fn tick(panel: &mut Panel<'_>, ui: &mut Ui, index: usize, before: bool, cell: Rect) {
    let mut ticked = before;
    let number = panel
        .app
        .open()
        .map_or(index as u64, |open| open.frame_number(index));
    let place = Rect::from_min_size(cell.min + vec2(4.0, 4.0), vec2(20.0, 20.0));
    ui.painter().rect_filled(place, 3.0, ui.palette().panel);
    // A child of its own, so that the tick does not move the layout of the rows.
    let response = ui
        .new_child(UiBuilder::new().max_rect(place))
        .add(Checkbox::without_text(&mut ticked));
    response.widget_info(|| {
        WidgetInfo::selected(
            Role::CheckBox,
            true,
            before,
            format!("Accept frame {number}"),
        )
    });
    response.on_hover_text("Accept it with the others.");
    if ticked != before {
        panel.view(ViewAction::TickSuggestion {
            frame: index,
            ticked,
        });
    }
}

/// The buttons. The main one has the focus at first, so that Enter accepts.
fn buttons(panel: &mut Panel<'_>, ui: &mut Ui, bulk: &BulkAccept, opened: bool) {
    // The focus is requested once. Later the user may move it, for example to a tick.
    let count = bulk.ticked_rows().count();
    let accept = ui.add_enabled(
        count > 0,
        Button::new(format!("Accept {count}")).fill(ui.palette().accent_ground),
    );
    if opened {
        accept.request_focus();
    }
    let leave = if bulk.of_stretch.is_some() {
        "Leave all frames as they are. (Esc)"
    } else {
        "Leave them as suggestions. (Esc)"
    };
    let keys = &panel.app.settings.keys;
    let undo = keys.with_key(Command::Undo, |key| format!(" {key} undoes all of it."));
    if accept
        .on_hover_text(format!("Accept all of these at once.{undo} (Enter)"))
        .clicked()
    {
        panel.edit(EditAction::AcceptAll);
    }
    cancel(panel, ui, leave);
    let said = if bulk.of_stretch.is_some() {
        format!("They become references.{undo}")
    } else {
        format!("They become labels that are not used for training.{undo}")
    };
    ui.add(Label::new(RichText::new(said).small().color(ui.palette().weak)).truncate());
}

/// Shows the dialog. `frames` is the number of frames that show the batch.
pub fn show_discard_batch(panel: &mut Panel<'_>, ctx: &Context, batch: BatchId, frames: usize) {
    let title = format!("Discard the suggestions of {frames} frames?");
    sheet(panel, ctx, &title, vec2(460.0, 180.0), |panel, ui| {
        let what = "They show again what was suggested before, or nothing. Frames that you have \
                    changed or accepted since are kept. Undo gives the suggestions back.";
        theme::strong_text(ui, what);
        ui.add_space(2.0 * theme::SPACE);
        let row = vec2(ui.available_width(), 28.0);
        ui.allocate_ui_with_layout(row, Layout::right_to_left(Align::Center), |ui| {
            let does = RichText::new(format!("Discard {frames}")).color(ui.palette().bad);
            if show_button(ui, Button::new(does), "One step of undo.") {
                let discard = EditAction::DiscardBatch(batch);
                panel.edit(discard);
            }
            cancel(panel, ui, "Keep them. (Esc)");
        });
    });
}
