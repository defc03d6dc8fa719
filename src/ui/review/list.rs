//! The list of suggestions: a thumbnail with the proposed lines, the confidence, and the distance
//! from what the neighbours predict. Only rows in view become widgets.
//!
//! No row may move away from under the pointer. While the pointer is over the list, the application
//! therefore keeps the order, and new suggestions come last. Otherwise the list scrolls so that the
//! row of the shown frame keeps its place.

use super::facts::RowFacts;
use crate::ui::Panel;
use crate::ui::controls::replace_remembered;
use crate::ui::controls::theme::{self, Themed as _};
use crate::ui::drawing::labels::lay_out_within;
use crate::ui::maps::miniature;
use crate::ui::rows::menu::{self, file_name};
use egui::{
    Align2, Color32, CornerRadius, FontId, Id, Painter, Rect, Response, Role, ScrollArea, Sense,
    Stroke, StrokeKind, Ui, WidgetInfo, pos2, vec2,
};
use touchline_application::app::review::{ReviewOrder, ReviewRow, percent};
use touchline_application::app::{Command, ViewAction, sentence};

/// Height of a row, points.
const ROW: f32 = 44.0;
/// Size of a thumbnail, points.
const PICTURE: egui::Vec2 = vec2(64.0, 36.0);
/// Width of the bar that shows the confidence, points.
const BAR: f32 = 64.0;
/// Height of the separator above rows that arrived while the pointer was over the list, points.
const LATE_ROWS_HEIGHT: f32 = 22.0;

/// The commands in the context menu of a row.
const MENU: [Command; 8] = [
    Command::AcceptAndStay,
    Command::Reject,
    Command::RejectShot,
    Command::Snap,
    Command::Comment,
    Command::AcceptAllAbove,
    Command::SelectShot,
    Command::AssignToCamera,
];

/// Shows the list.
pub fn show(panel: &mut Panel<'_>, ui: &mut Ui) {
    let review = panel.app.review();
    let choice = panel.app.session.review;
    let rows = &review.rows;
    let current = panel.app.session.frame;
    let place = rows.iter().position(|row| row.frame == current);
    let moved = what_moved(ui, (current, choice.order, place));
    let on_time = rows.len() - review.late;
    let late = if review.late > 0 {
        LATE_ROWS_HEIGHT
    } else {
        0.0
    };
    let area = ScrollArea::vertical()
        .id_salt("review list")
        .auto_shrink(false);
    let shown = area.show_viewport(ui, |ui, viewport| {
        let origin = ui.max_rect().min;
        let width = ui.available_width();
        ui.allocate_exact_size(vec2(width, ROW * rows.len() as f32 + late), Sense::hover());
        // Rows have one height, so places are computed and only those in view are laid out.
        let top_of = |at: usize| ROW * at as f32 + if at >= on_time { late } else { 0.0 };
        let rect_of =
            |at: usize| Rect::from_min_size(origin + vec2(0.0, top_of(at)), vec2(width, ROW));
        // Scrolling, according to what has changed since the last frame of the window.
        let in_view = match moved {
            ListChange::Nothing => None,
            // The list follows its row at once and without animation, so that the row stays where
            // it was on the screen; but not if the user has scrolled the row out of view.
            ListChange::Row { by } => {
                let seen =
                    place.is_some_and(|at| viewport.y_range().contains(top_of(at) - ROW * by));
                if seen {
                    ui.scroll_with_delta_animation(
                        vec2(0.0, -ROW * by),
                        egui::style::ScrollAnimation::none(),
                    );
                }
                None
            }
            ListChange::Frame => place.map(|place| rect_of(place).expand2(vec2(0.0, ROW))),
            // A user who chooses an order wants to see where it begins.
            ListChange::Order => Some(rect_of(0)),
        };
        if let Some(rect) = in_view {
            ui.scroll_to_rect_animation(rect, None, egui::style::ScrollAnimation::none());
        }
        // The rows in view. The separator shifts the late rows down, so one more row above may be
        // in view.
        let first = ((viewport.top() - late) / ROW).floor().max(0.0) as usize;
        let last = ((viewport.bottom() / ROW).ceil() as usize).min(rows.len());
        for at in first..last {
            show_row(panel, ui, rows[at], rect_of(at));
            // The threshold line stands where the confidence first reaches it, in the order of
            // rising confidence. Late rows are not sorted in yet.
            let below = |row: &ReviewRow| row.confidence.unwrap_or(0.0) < choice.threshold;
            let begins = at > 0 && !below(&rows[at]) && below(&rows[at - 1]);
            if begins && at < on_time && choice.order == ReviewOrder::Confidence {
                threshold_line(ui.painter(), rect_of(at), choice.threshold);
            }
            if at == on_time {
                late_line(ui, rect_of(at), review.late);
            }
        }
    });
    // The application keeps the order while the pointer is over the list.
    let held = ui.rect_contains_pointer(shown.inner_rect);
    if held != panel.app.session.review.held {
        panel.view(ViewAction::HoldReview(held));
    }
}

/// What has changed since the list was drawn last.
enum ListChange {
    Nothing,
    /// The row of the shown frame has moved by this many rows.
    Row {
        by: f32,
    },
    /// Another frame is shown.
    Frame,
    /// The user chose another order.
    Order,
}

/// What the list showed last: the frame, the order, and the row of the frame.
type Shows = (usize, ReviewOrder, Option<usize>);

/// Compares what the list shows now with what it showed in the last frame of the window.
fn what_moved(ui: &Ui, now: Shows) -> ListChange {
    let memory = Id::unique("review list shows");
    let before = replace_remembered(ui, memory, now);
    // A new order counts more than a new frame: it moves every row. A row that appears or vanishes
    // with the frame unchanged is treated as another frame.
    match (before, now) {
        (Some(before), now) if before == now => ListChange::Nothing,
        (Some((_, order, _)), now) if order != now.1 => ListChange::Order,
        (Some((frame, _, Some(before))), (shown, _, Some(after))) if frame == shown => {
            ListChange::Row {
                by: after as f32 - before as f32,
            }
        }
        _ => ListChange::Frame,
    }
}

/// Draws the separator above rows that arrived while the pointer was over the list.
fn late_line(ui: &Ui, first: Rect, count: usize) {
    let line = Rect::from_min_max(
        first.left_top() - vec2(0.0, LATE_ROWS_HEIGHT),
        first.right_top(),
    );
    let text = format!("{count} new, sorted in when the pointer leaves");
    let response = ui.interact(line, Id::unique("review late"), Sense::hover());
    response.widget_info(|| WidgetInfo::labeled(Role::Label, true, &text));
    let painter = ui.painter();
    painter.hline(
        line.x_range(),
        line.top() + 1.0,
        Stroke::new(1.0, ui.palette().line),
    );
    painter.text(
        line.center(),
        Align2::CENTER_CENTER,
        text,
        FontId::proportional(theme::SMALL),
        ui.palette().weak,
    );
}

/// Draws the line above the first row that passes the threshold; the least certain rows come first.
fn threshold_line(painter: &Painter, row: Rect, threshold: f64) {
    painter.hline(
        row.x_range(),
        row.top(),
        Stroke::new(1.0, painter.palette().accent),
    );
    let said = painter.layout_no_wrap(
        percent(threshold),
        FontId::proportional(theme::SMALL),
        painter.palette().accent,
    );
    let place = Align2::CENTER_CENTER.anchor_size(row.center_top(), said.size());
    painter.rect_filled(
        place.expand2(vec2(4.0, 0.0)),
        CornerRadius::ZERO,
        painter.palette().panel,
    );
    painter.galley(place.min, said, painter.palette().accent);
}

/// Shows a suggestion: thumbnail, number and name, confidence; below them why it is unlikely, or
/// how far it is from its neighbours. A click shows the frame.
fn show_row(panel: &mut Panel<'_>, ui: &Ui, row: ReviewRow, place: Rect) {
    let Some((open, frame)) = panel
        .app
        .open()
        .and_then(|open| Some((open, open.frame(row.frame)?)))
    else {
        return;
    };
    let response = ui.interact(place, Id::unique(("review row", row.frame)), Sense::click());
    let current = row.frame == panel.app.session.frame;
    let name = file_name(&frame.name());
    let Some(facts) = RowFacts::new(panel, &row) else {
        return;
    };
    response.widget_info(|| {
        let what = if row.gone {
            "No longer a suggestion"
        } else {
            "Suggestion"
        };
        let label = format!(
            "{what}, frame {}, {name}, {}",
            open.frame_number(row.frame),
            facts.in_full()
        );
        WidgetInfo::selected(Role::Button, true, current, label)
    });
    // Background, thumbnail with the proposed lines, line check.
    paint_ground(ui, place, &response, current);
    let painter = ui.painter();
    let picture = Rect::from_min_size(place.min + vec2(8.0, (ROW - PICTURE.y) / 2.0), PICTURE);
    miniature::paint(panel, painter, open, row.frame, picture);
    if let Some(says) = &facts.paint {
        let corner = picture.right_bottom() - vec2(5.0, 5.0);
        theme::paint_line_mark(painter, corner, says.verdict);
    }
    // First line: number and name at the left, the confidence at the right. The name ends before
    // the confidence.
    let left = picture.right() + 8.0;
    let right = place.right() - 14.0;
    let bar = Rect::from_min_size(pos2(right - BAR, place.top() + 27.0), vec2(BAR, 6.0));
    let first_line = place.top() + 14.0;
    let (strong, plain) = if row.gone {
        (ui.palette().weak, ui.palette().weak)
    } else {
        (ui.palette().strong, ui.palette().text)
    };
    let said = painter.text(
        pos2(right, first_line),
        Align2::RIGHT_CENTER,
        &facts.confidence,
        FontId::proportional(theme::SMALL),
        strong,
    );
    text_within(
        painter,
        pos2(left, first_line),
        said.left().min(right - 38.0) - 8.0 - left,
        format!("{}  {name}", open.frame_number(row.frame)),
        plain,
    );
    if !row.gone {
        confidence_bar(painter, bar, row.confidence);
    }
    // Second line: why the camera is unlikely, or else the distance from its neighbours; in the
    // orders by paint and by distance first how far mending has moved the camera.
    let order = panel.app.session.review.order;
    let is_by_moved = matches!(order, ReviewOrder::Paint | ReviewOrder::Moved);
    let RowFacts {
        confidence,
        unlikely,
        neighbours,
        mended,
        paint,
        is_odd,
    } = facts;
    let beside = mended.clone().filter(|_| is_by_moved);
    if let Some(text) = unlikely.clone().or(beside).or(neighbours.clone()) {
        let colour = if is_odd {
            ui.palette().caution
        } else {
            ui.palette().weak
        };
        text_within(
            painter,
            pos2(left, bar.center().y),
            bar.left() - 6.0 - left,
            text,
            colour,
        );
    }
    // The tooltip says the same in full.
    let is = if row.gone { "" } else { "confidence " };
    let confidence = format!("{is}{confidence}");
    let paint = paint.map(|says| says.describe());
    let facts: Vec<String> = [Some(confidence), neighbours, mended, paint]
        .into_iter()
        .flatten()
        .collect();
    let still = if row.is_still() && !row.gone {
        " Check that the picture stands still as well."
    } else {
        ""
    };
    let why = unlikely
        .map(|why| format!(" {}", sentence(&why)))
        .unwrap_or_default();
    let tip = format!(
        "{}: {}.{why}{still} Click to look at it.",
        frame.name(),
        facts.join(", ")
    );
    // A right click shows the frame as well, because the commands of its menu act on the shown one.
    if response.clicked() || response.secondary_clicked() {
        panel.go_to(row.frame);
    }
    response.context_menu(|ui| menu::entries(panel, ui, &MENU));
    response.on_hover_text(tip);
}

/// Draws the confidence as a bar.
fn confidence_bar(painter: &Painter, track: Rect, confidence: Option<f64>) {
    painter.rect_filled(track, CornerRadius::same(2), painter.palette().line);
    let share = confidence.unwrap_or(0.0).clamp(0.0, 1.0) as f32;
    let filled = Rect::from_min_size(track.min, vec2(track.width() * share, track.height()));
    painter.rect_filled(filled, CornerRadius::same(2), painter.palette().accent);
}

/// Paints the ground of a row: lit under the pointer and for what is shown, with an edge where the
/// focus is.
pub fn paint_ground(ui: &Ui, place: Rect, response: &Response, current: bool) {
    let (painter, palette) = (ui.painter(), ui.palette());
    if current || response.hovered() {
        let ground = if current {
            palette.accent_ground
        } else {
            palette.raised
        };
        painter.rect_filled(place.shrink2(vec2(4.0, 1.0)), CornerRadius::same(4), ground);
    }
    if response.has_focus() {
        let edge = Stroke::new(1.0, palette.accent);
        painter.rect_stroke(place.shrink(2.0), 4.0, edge, StrokeKind::Inside);
    }
}

/// Writes one line of text; it ends in an ellipsis if it is longer than `width` points.
pub fn text_within(
    painter: &Painter,
    left_centre: egui::Pos2,
    width: f32,
    text: String,
    colour: Color32,
) {
    let font = FontId::proportional(theme::SMALL);
    let galley = lay_out_within(painter, text, font, colour, width.max(8.0));
    painter.galley(
        left_centre - vec2(0.0, galley.size().y / 2.0),
        galley,
        colour,
    );
}
