//! The gallery: all suggestions as pictures with their lines, over the whole window, in the order
//! of the review panel. Frames are selected by clicks, by dragging over them and by keys, and
//! accepted or rejected together. What was not drawn cannot be accepted.

use super::{has_just_opened, recall, sheet};
use crate::ui::Panel;
use crate::ui::controls::show_button;
use crate::ui::controls::theme::{self, Themed as _};
use crate::ui::maps::miniature;
use crate::ui::review::{RowFacts, orders};
use egui::{
    Align, Button, Color32, Context, FontId, Id, Key, Layout, Modifiers, Rect, Response, Role,
    ScrollArea, Sense, Stroke, StrokeKind, Ui, WidgetInfo, pos2, vec2,
};
use std::collections::BTreeSet;
use std::sync::Arc;
use touchline_application::app::review::ReviewRow;
use touchline_application::app::session::reason_label;
use touchline_application::app::{EditAction, ViewAction};
use touchline_documents::document::RejectReason;

/// Least width of a picture, points. As many as fit stand beside each other.
const LEAST_WIDTH: f32 = 236.0;
/// Width of a picture over its height.
const ASPECT: f32 = 16.0 / 9.0;
/// Height of a caption: number and confidence, and below them the reason in two lines, points.
const CAPTION: f32 = 52.0;
/// Gap between pictures, points.
const GAP: f32 = 8.0;

/// Which picture the keys begin at, and which frames were seen, while the gallery is open.
#[derive(Clone, Debug, Default, PartialEq)]
struct GalleryState {
    /// The place in the list from which a range extends.
    anchor: usize,
    /// The place in the list that the keys move.
    cursor: usize,
    /// Whether keys moved it last: then it is scrolled into view.
    is_moved: bool,
    /// The frames that were drawn with their pictures.
    seen: Arc<BTreeSet<usize>>,
}

/// Shows the gallery.
pub fn show(panel: &mut Panel<'_>, ctx: &Context) {
    let memory = Id::unique("gallery");
    let opened = has_just_opened(ctx, "gallery");
    let mut state: GalleryState = recall(ctx, memory, opened).unwrap_or_default();
    let review = panel.app.review();
    let rows: Vec<ReviewRow> = review
        .rows
        .iter()
        .filter(|row| !row.gone)
        .copied()
        .collect();
    let whole = ctx.content_rect().size();
    sheet(panel, ctx, "Gallery", whole, |panel, ui| {
        ui.set_min_height(whole.y - 140.0);
        if rows.is_empty() {
            theme::weak_text(ui, "There are no suggestions to look at.");
            return;
        }
        orders(panel, ui);
        let room = ui.available_height() - 40.0;
        ui.allocate_ui(vec2(ui.available_width(), room), |ui| {
            grid(panel, ui, &rows, &mut state);
        });
        ui.add_space(theme::SPACE);
        let row = vec2(ui.available_width(), 28.0);
        ui.allocate_ui_with_layout(row, Layout::right_to_left(Align::Center), |ui| {
            buttons(panel, ui, &rows, &state);
        });
    });
    ctx.data_mut(|data| data.insert_temp(memory, state));
}

/// Draws the pictures. Only those in view are laid out.
fn grid(panel: &mut Panel<'_>, ui: &mut Ui, rows: &[ReviewRow], state: &mut GalleryState) {
    // As many columns as fit; 10 points are for the scroll bar.
    let width = ui.available_width() - 10.0;
    let columns = (((width + GAP) / (LEAST_WIDTH + GAP)) as usize).max(1);
    let picture_width = (width + GAP) / columns as f32 - GAP;
    let size = vec2(picture_width, picture_width / ASPECT + CAPTION);
    move_by_keys(panel, ui, rows, state, columns);
    ui.spacing_mut().item_spacing.y = GAP;
    ScrollArea::vertical()
        .id_salt("gallery")
        .auto_shrink(false)
        .show_viewport(ui, |ui, viewport| {
            let origin = ui.max_rect().min;
            let lines = rows.len().div_ceil(columns);
            let height = (size.y + GAP) * lines as f32;
            ui.allocate_exact_size(vec2(width, height), Sense::hover());
            let place_of = |at: usize| {
                let (line, column) = ((at / columns) as f32, (at % columns) as f32);
                let corner = vec2(column * (size.x + GAP), line * (size.y + GAP));
                Rect::from_min_size(origin + corner, size)
            };
            if std::mem::take(&mut state.is_moved) {
                ui.scroll_to_rect(place_of(state.cursor), None);
            }
            let line = size.y + GAP;
            let first = (viewport.top() / line).floor().max(0.0) as usize * columns;
            let last = ((viewport.bottom() / line).ceil() as usize * columns).min(rows.len());
            for at in first..last {
                cell(panel, ui, rows, at, place_of(at), state);
            }
        });
}

/// Shows one picture with its caption.
fn cell(
    panel: &mut Panel<'_>,
    ui: &Ui,
    rows: &[ReviewRow],
    at: usize,
    place: Rect,
    state: &mut GalleryState,
) {
    let row = rows[at];
    let Some(open) = panel.app.open() else { return };
    let Some(facts) = RowFacts::new(panel, &row) else {
        return;
    };
    let is_selected = panel.app.session.frames_selected.contains(&row.frame);
    let number = open.frame_number(row.frame);
    let id = Id::unique(("gallery cell", row.frame));
    let response = ui.interact(place, id, Sense::click_and_drag());
    response.widget_info(|| {
        let label = format!("Frame {number}, {}", facts.in_full());
        WidgetInfo::selected(Role::Button, true, is_selected, label)
    });

    // The picture with its lines, and an edge where it is selected or the keys stand.
    let size = vec2(place.width(), place.width() / ASPECT);
    let picture = Rect::from_min_size(place.min, size);
    if miniature::paint(panel, ui.painter(), open, row.frame, picture) {
        Arc::make_mut(&mut state.seen).insert(row.frame);
    }
    let palette = ui.palette();
    if is_selected {
        let tint = palette.accent.gamma_multiply(0.25);
        ui.painter().rect_filled(picture, 2.0, tint);
    }
    let edge = if is_selected {
        Stroke::new(2.0, palette.accent)
    } else if at == state.cursor || response.hovered() || response.has_focus() {
        Stroke::new(1.0, palette.text)
    } else {
        Stroke::NONE
    };
    ui.painter()
        .rect_stroke(picture, 2.0, edge, StrokeKind::Inside);

    // Number and confidence, and below them the reason, which may take two lines.
    let line = picture.bottom() + 3.0;
    write(
        ui,
        number.to_string(),
        pos2(place.left() + 2.0, line),
        size.x,
        palette.weak,
    );
    let said = facts.confidence.clone();
    let width = ui
        .painter()
        .layout_no_wrap(said.clone(), font(), palette.text)
        .size()
        .x;
    write(
        ui,
        said,
        pos2(place.right() - width - 2.0, line),
        size.x,
        palette.text,
    );
    let colour = if facts.is_odd {
        palette.caution
    } else {
        palette.weak
    };
    write(
        ui,
        facts.reasons(),
        pos2(place.left() + 2.0, line + 16.0),
        size.x - 4.0,
        colour,
    );

    choose(panel, ui, rows, at, &response, state);
}

fn font() -> FontId {
    FontId::proportional(theme::SMALL)
}

/// Writes a text that wraps.
fn write(ui: &Ui, text: String, at: egui::Pos2, width: f32, colour: Color32) {
    let galley = ui.painter().layout(text, font(), colour, width);
    ui.painter().galley(at, galley, colour);
}

/// What the pointer does to a picture: a click selects it alone, with Ctrl in addition, with Shift
/// all up to it; dragging selects what it passes; a double click opens the frame.
fn choose(
    panel: &mut Panel<'_>,
    ui: &Ui,
    rows: &[ReviewRow],
    at: usize,
    response: &Response,
    state: &mut GalleryState,
) {
    let modifiers = ui.input(|input| input.modifiers);
    if response.double_clicked() {
        panel.close_dialog();
        panel.go_to(rows[at].frame);
        return;
    }
    let is_dragged_over = ui.input(|input| input.pointer.is_decidedly_dragging())
        && response.contains_pointer()
        && !response.drag_started();
    if response.drag_started() || (response.clicked() && !modifiers.shift) {
        state.anchor = at;
    }
    if response.clicked() || response.drag_started() || (is_dragged_over && at != state.cursor) {
        state.cursor = at;
        if response.clicked() && modifiers.command {
            toggle(panel, rows[at].frame);
        } else {
            select_range(panel, rows, state);
        }
    }
}

/// Selects the frames between the anchor and the cursor.
fn select_range(panel: &mut Panel<'_>, rows: &[ReviewRow], state: &GalleryState) {
    let (first, last) = (
        state.anchor.min(state.cursor),
        state.anchor.max(state.cursor),
    );
    let range = rows.iter().take(last + 1).skip(first);
    panel.view(ViewAction::SelectFrames(
        range.map(|row| row.frame).collect(),
    ));
}

/// Selects a frame in addition, or no longer.
fn toggle(panel: &mut Panel<'_>, frame: usize) {
    let mut selected = panel.app.session.frames_selected.clone();
    if !selected.remove(&frame) {
        selected.insert(frame);
    }
    panel.view(ViewAction::SelectFrames(selected));
}

/// Moves and selects by keys: arrows, with Shift as a range; Space; Ctrl+A; 1 to 6 reject.
fn move_by_keys(
    panel: &mut Panel<'_>,
    ui: &Ui,
    rows: &[ReviewRow],
    state: &mut GalleryState,
    columns: usize,
) {
    let last = rows.len() - 1;
    (state.cursor, state.anchor) = (state.cursor.min(last), state.anchor.min(last));
    for (key, by) in [
        (Key::ArrowLeft, -1),
        (Key::ArrowRight, 1),
        (Key::ArrowUp, -(columns as isize)),
        (Key::ArrowDown, columns as isize),
    ] {
        let [extends, moves] = [Modifiers::SHIFT, Modifiers::NONE]
            .map(|modifiers| ui.input_mut(|input| input.consume_key(modifiers, key)));
        if extends || moves {
            state.cursor = state.cursor.saturating_add_signed(by).min(last);
            state.is_moved = true;
            if extends {
                select_range(panel, rows, state);
            } else {
                state.anchor = state.cursor;
            }
        }
    }
    if ui.input_mut(|input| input.consume_key(Modifiers::NONE, Key::Space)) {
        toggle(panel, rows[state.cursor].frame);
    }
    if ui.input_mut(|input| input.consume_key(Modifiers::COMMAND, Key::A)) {
        let all = rows.iter().map(|row| row.frame).collect();
        panel.view(ViewAction::SelectFrames(all));
    }
}

/// The buttons: accept, which waits until every selected picture was drawn, and the reasons to
/// reject.
fn buttons(panel: &mut Panel<'_>, ui: &mut Ui, rows: &[ReviewRow], state: &GalleryState) {
    let selected = &panel.app.session.frames_selected;
    let count = rows
        .iter()
        .filter(|row| selected.contains(&row.frame))
        .count();
    let unseen = selected
        .iter()
        .filter(|frame| !state.seen.contains(frame))
        .count();
    let fill = ui.palette().accent_ground;
    let accept = Button::new(format!("Accept {count}")).fill(fill);
    let accept = ui.add_enabled(count > 0 && unseen == 0, accept);
    let by_key = unseen == 0
        && count > 0
        && ui.input_mut(|input| input.consume_key(Modifiers::NONE, Key::Enter));
    let tip = "Accept the selected frames: labels that are not used for training. (Enter)";
    if accept.on_hover_text(tip).clicked() || by_key {
        panel.edit(EditAction::AcceptSelected);
    }
    ui.add_enabled_ui(count > 0, |ui| {
        ui.menu_button(format!("Reject {count}"), |ui| {
            for &reason in RejectReason::ALL {
                let button = Button::new(reason_label(reason));
                if show_button(
                    ui,
                    button,
                    "Mark the selected frames as not calibratable. One step of undo.",
                ) {
                    panel.edit(EditAction::RejectSelected(reason));
                }
            }
        });
    });
    let says = match (count, unseen) {
        (0, _) => {
            "Click, drag or use Space and the arrow keys to select; a double click opens a frame."
                .to_owned()
        }
        (_, 0) => String::new(),
        (_, unseen) => format!("{unseen} of them not seen yet: scroll through them first."),
    };
    theme::weak(ui, says);
}
