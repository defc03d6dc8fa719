//! The list of suggestions: a miniature with the proposed lines, how certain it is, how far from its neighbours. Only what
//! is in view is laid out.

use crate::app::Action;
use crate::app::review::{ReviewOrder, ReviewRow, percent};
use crate::ui::menu::file_name;
use crate::ui::{Panel, miniature, theme};
use egui::text::{LayoutJob, TextWrapping};
use egui::{
    Align2, Color32, CornerRadius, FontId, Id, Painter, Rect, Role, ScrollArea, Sense, Stroke, Ui, WidgetInfo, pos2,
    vec2,
};

/// The height of a row, points.
const ROW: f32 = 44.0;
/// A miniature's size, points.
const PICTURE: egui::Vec2 = vec2(64.0, 36.0);
/// The width of the bar that shows the confidence, points.
const BAR: f32 = 64.0;

/// Shows the list.
pub fn show(panel: &mut Panel<'_>, ui: &mut Ui) {
    let review = panel.app.review();
    let choice = panel.app.session.review;
    let rows = &review.rows;
    let current = panel.app.session.frame;
    let place = rows.iter().position(|row| row.frame == current);
    let moved = what_moved(ui, (current, choice.order));
    ScrollArea::vertical().id_salt("review list").auto_shrink(false).show_viewport(ui, |ui, viewport| {
        let origin = ui.max_rect().min;
        let width = ui.available_width();
        ui.allocate_exact_size(vec2(width, ROW * rows.len() as f32), Sense::hover());
        let rect_of = |at: usize| Rect::from_min_size(origin + vec2(0.0, ROW * at as f32), vec2(width, ROW));
        let in_view = match moved {
            Moved::Nothing => None,
            Moved::Frame => place.map(|place| rect_of(place).expand2(vec2(0.0, ROW))),
            // The beginning of an order is what it is chosen for.
            Moved::Order => Some(rect_of(0)),
        };
        if let Some(rect) = in_view {
            ui.scroll_to_rect_animation(rect, None, egui::style::ScrollAnimation::none());
        }
        let first = (viewport.top() / ROW).floor().max(0.0) as usize;
        let last = ((viewport.bottom() / ROW).ceil() as usize).min(rows.len());
        for at in first..last {
            show_row(panel, ui, rows[at], rect_of(at));
            let below = |row: &ReviewRow| row.confidence.unwrap_or(0.0) < choice.threshold;
            let begins = at > 0 && below(&rows[at]) && !below(&rows[at - 1]);
            if begins && choice.order == ReviewOrder::Confidence {
                threshold_line(ui.painter(), rect_of(at), choice.threshold);
            }
        }
    });
}

/// What changed since the list was drawn last.
enum Moved {
    Nothing,
    Frame,
    Order,
}

fn what_moved(ui: &Ui, now: (usize, ReviewOrder)) -> Moved {
    let memory = Id::unique("review list shows");
    let before = ui.data_mut(|data| {
        let before = data.get_temp::<(usize, ReviewOrder)>(memory);
        data.insert_temp(memory, now);
        before
    });
    match before {
        Some(before) if before == now => Moved::Nothing,
        Some((_, order)) if order != now.1 => Moved::Order,
        _ => Moved::Frame,
    }
}

/// What lies above the line is accepted together.
fn threshold_line(painter: &Painter, row: Rect, threshold: f64) {
    painter.hline(row.x_range(), row.top(), Stroke::new(1.0, theme::ACCENT));
    let said = painter.layout_no_wrap(percent(threshold), FontId::proportional(10.0), theme::ACCENT);
    let place = Align2::CENTER_CENTER.anchor_size(row.center_top(), said.size());
    painter.rect_filled(place.expand2(vec2(4.0, 0.0)), CornerRadius::ZERO, theme::PANEL);
    painter.galley(place.min, said, theme::ACCENT);
}

fn show_row(panel: &mut Panel<'_>, ui: &Ui, row: ReviewRow, place: Rect) {
    let Some((open, frame)) = panel.app.open().and_then(|open| Some((open, open.frame(row.frame)?))) else { return };
    let response = ui.interact(place, Id::unique(("review row", row.frame)), Sense::click());
    let current = row.frame == panel.app.session.frame;
    let name = file_name(&frame.name());
    let confidence = row.confidence.map_or_else(|| "not known".to_owned(), percent);
    let neighbours = row.apart_px().map(|px| format!("{px:.0} px from neighbours"));
    response.widget_info(|| {
        let apart = neighbours.as_ref().map(|text| format!(", {text}")).unwrap_or_default();
        let label = format!("Suggestion, frame {}, {name}, {confidence}{apart}", row.frame + 1);
        WidgetInfo::selected(Role::Button, true, current, label)
    });
    let painter = ui.painter();
    if current || response.hovered() {
        let ground = if current { theme::ACCENT_GROUND } else { theme::RAISED };
        painter.rect_filled(place.shrink2(vec2(4.0, 1.0)), CornerRadius::same(4), ground);
    }
    let picture = Rect::from_min_size(place.min + vec2(8.0, (ROW - PICTURE.y) / 2.0), PICTURE);
    miniature::paint(panel, painter, open, row.frame, picture);
    if response.has_focus() {
        painter.rect_stroke(place.shrink(2.0), 4.0, Stroke::new(1.0, theme::ACCENT), egui::StrokeKind::Inside);
    }
    let left = picture.right() + 8.0;
    let right = place.right() - 14.0;
    let bar = Rect::from_min_size(pos2(right - BAR, place.top() + 27.0), vec2(BAR, 6.0));
    let first_line = place.top() + 14.0;
    painter.text(pos2(right, first_line), Align2::RIGHT_CENTER, &confidence, FontId::proportional(12.0), theme::STRONG);
    text_within(
        painter,
        pos2(left, first_line),
        right - 46.0 - left,
        format!("{}  {name}", row.frame + 1),
        theme::TEXT,
    );
    confidence_bar(painter, bar, row.confidence);
    if let Some(text) = &neighbours {
        let colour = if row.disagrees() { theme::CAUTION } else { theme::WEAK };
        text_within(painter, pos2(left, bar.center().y), bar.left() - 6.0 - left, text.clone(), colour);
    }
    let tip = format!(
        "{}: right with probability {confidence}{}. Click to look at it.",
        frame.name(),
        neighbours.map(|text| format!(", {text}")).unwrap_or_default()
    );
    if response.on_hover_text(tip).clicked() {
        panel.actions.push(Action::GoTo(row.frame));
    }
}

fn confidence_bar(painter: &Painter, track: Rect, confidence: Option<f64>) {
    painter.rect_filled(track, CornerRadius::same(2), theme::LINE);
    let share = confidence.unwrap_or(0.0).clamp(0.0, 1.0) as f32;
    let filled = Rect::from_min_size(track.min, vec2(track.width() * share, track.height()));
    painter.rect_filled(filled, CornerRadius::same(2), theme::ACCENT);
}

/// A line of text that ends in an ellipsis where there is no more room.
fn text_within(painter: &Painter, left_centre: egui::Pos2, width: f32, text: String, colour: Color32) {
    let mut job = LayoutJob::simple_singleline(text, FontId::proportional(12.0), colour);
    job.wrap = TextWrapping::truncate_at_width(width.max(8.0));
    let galley = painter.layout_job(job);
    painter.galley(left_centre - vec2(0.0, galley.size().y / 2.0), galley, colour);
}
