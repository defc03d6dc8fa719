//! The list of names beside a point that has no name yet.
//!
//! The candidates come ranked from the application; `typing.rs` reads the keys. This file draws the
//! list and reads the pointer.

use crate::ui::controls::theme::{self, Themed as _};
use crate::ui::drawing::labels::text_width;
use crate::ui::drawing::placement::Placement;
use crate::ui::{Panel, PictureState};
use egui::{
    Align2, Area, FontId, Id, Order, Pos2, Rect, Role, Sense, Vec2, WidgetInfo, pos2, vec2,
};
use touchline_application::app::corner_looks::CornerLooks;
use touchline_application::app::naming::NameCandidate;
use touchline_application::app::session::{Mode, Naming, OFFERED};
use touchline_application::app::{Action, EditAction, Navigation};

/// Minimum width of the list, points: the hint fits into it.
const LEAST_WIDTH: f32 = 340.0;
/// Where the labels begin, points from the left end of a row.
const LABEL: f32 = 28.0;
/// Gap between the columns of a row and at its right end, points.
const SPACE: f32 = 10.0;
/// Height of a row, of the title and of the hint, points.
const ROW: f32 = 24.0;
/// Horizontal gap between the point and the list, points. The marker and its ring stay visible.
const GAP: f32 = 32.0;
/// Margin around the list, points.
const MARGIN: f32 = 6.0;

/// Farther away a name is not meant, and its distance says nothing, px of the picture.
const FAR_PX: f64 = 40.0;

/// Shows the list beside its point.
pub fn show(panel: &mut Panel<'_>, ui: &egui::Ui, placement: &Placement) {
    let Mode::Naming(naming) = &panel.app.session.mode else {
        return;
    };
    let Some(click) = panel
        .app
        .frame()
        .and_then(|frame| frame.clicks.get(naming.click))
    else {
        return;
    };
    // The picture is looked at once, as the list opens; the next frame of the window ranks by it.
    if naming.looks.is_none()
        && let PictureState::Ready(_, picture) = panel.pictures.current()
    {
        let looks = CornerLooks::from_picture(&picture, click.image);
        panel.act(Action::Navigate(Navigation::LookAtClick(looks)));
    }
    // The size must be known before the list is laid out, because the list stands at its left or
    // its right side beside the point. At least one row, for the note that no name matches.
    let point = placement.screen_from_image(click.image);
    let offered = naming.listed_candidates();
    let rows = offered.len().max(1) as f32;
    let columns = Columns::measure(ui, naming);
    let size = vec2(
        columns.width() + 2.0 * MARGIN,
        (rows + 2.0) * ROW + 2.0 * MARGIN,
    );
    // An area of its own above all panels. egui must not move it into the window, because then it
    // could cover its point.
    Area::new(Id::NULL.with("naming"))
        .order(Order::Foreground)
        .fixed_pos(beside(point, size, placement.rect))
        .constrain(false)
        .show(ui.ctx(), |ui| {
            egui::Frame::popup(ui.style())
                .inner_margin(MARGIN)
                .show(ui, |ui| {
                    ui.set_width(columns.width());
                    ui.spacing_mut().item_spacing = Vec2::ZERO;
                    title(ui, naming);
                    for (index, candidate) in offered.iter().enumerate() {
                        if let Some(action) =
                            row(ui, &columns, index, candidate, index == naming.highlighted)
                        {
                            panel.act(action);
                        }
                    }
                    if offered.is_empty() {
                        nothing(ui, naming);
                    }
                    hint(ui, naming);
                });
        });
}

/// Where a list of this size goes: beside its point, never over it; within the bounds if they are
/// wide enough. To the right, unless only the left has room.
fn beside(point: Pos2, size: Vec2, bounds: Rect) -> Pos2 {
    // If the point is out of view, the list stays at the border.
    let point = point.clamp(bounds.min, bounds.max);
    let right = point.x + GAP;
    let left = point.x - GAP - size.x;
    let x = if right + size.x <= bounds.right() || left < bounds.left() {
        right
    } else {
        left
    };
    // The title of the list is level with the point, unless the border is too near.
    let lowest = (bounds.bottom() - size.y - MARGIN).max(bounds.top() + MARGIN);
    let y = (point.y - ROW).clamp(bounds.top() + MARGIN, lowest);
    pos2(x.round(), y.round())
}

/// Shows what is to be chosen, or what was typed so far.
fn title(ui: &mut egui::Ui, naming: &Naming) {
    let (rect, _) = ui.allocate_exact_size(vec2(ui.available_width(), ROW), Sense::hover());
    let what = if naming.lines {
        "Which line?"
    } else {
        "Which landmark?"
    };
    let (text, colour) = if naming.typed.is_empty() {
        (what.to_owned(), ui.palette().text)
    } else {
        (format!("{}|", naming.typed), ui.palette().strong)
    };
    ui.painter().text(
        rect.left_center() + vec2(6.0, 0.0),
        Align2::LEFT_CENTER,
        text,
        FontId::proportional(theme::BODY),
        colour,
    );
}

/// Widths of the columns, points. They fit every candidate, so that filtering moves nothing.
struct Columns {
    label: f32,
    code: f32,
    distance: Option<f32>,
}

impl Columns {
    /// Measures all candidates. The last column exists if a candidate has a distance or is the name
    /// of another point.
    fn measure(ui: &egui::Ui, naming: &Naming) -> Self {
        let candidates = &naming.candidates;
        let with_distance = candidates
            .iter()
            .any(|candidate| candidate.distance_px.is_some_and(|px| px < FAR_PX));
        // The text about the point with the largest number is the widest of its kind, and wider
        // than any distance.
        let used = candidates
            .iter()
            .filter_map(|candidate| candidate.in_use)
            .max();
        let last = used
            .map(in_use)
            .or_else(|| with_distance.then(|| "88.8 px".to_owned()));
        Self {
            label: candidates
                .iter()
                .map(|candidate| text_width(ui.painter(), &candidate.label, label_font()))
                .fold(0.0, f32::max),
            code: candidates
                .iter()
                .map(|candidate| text_width(ui.painter(), &candidate.code, code_font()))
                .fold(0.0, f32::max),
            distance: last.map(|last| text_width(ui.painter(), &last, distance_font())),
        }
    }

    /// Width of a row, points.
    fn width(&self) -> f32 {
        let distance = self.distance.map_or(0.0, |width| SPACE + width);
        (LABEL + self.label + SPACE + self.code + distance + SPACE)
            .max(LEAST_WIDTH)
            .ceil()
    }
}

/// The text beside a name that another point has: the two names are exchanged.
fn in_use(other: usize) -> String {
    format!("swap with point {}", other + 1)
}

fn label_font() -> FontId {
    FontId::proportional(theme::BODY)
}

fn code_font() -> FontId {
    FontId::monospace(theme::SMALL)
}

fn distance_font() -> FontId {
    FontId::proportional(theme::SMALL)
}

/// Shows a candidate: number, label, code, and distance from the click. Returns what the pointer
/// did.
fn row(
    ui: &mut egui::Ui,
    columns: &Columns,
    index: usize,
    candidate: &NameCandidate,
    highlighted: bool,
) -> Option<Action> {
    let (rect, response) = ui.allocate_exact_size(vec2(columns.width(), ROW), Sense::click());
    let used = candidate
        .in_use
        .map(|other| format!(", {}", in_use(other)))
        .unwrap_or_default();
    let name = format!("{} {}{used}", index + 1, candidate.label);
    response.widget_info(|| WidgetInfo::selected(Role::Button, true, highlighted, &name));
    let painter = ui.painter();
    if highlighted {
        painter.rect_filled(rect, 4.0, ui.palette().accent_ground);
    }
    let (weak, strong) = if highlighted {
        (ui.palette().text, ui.palette().strong)
    } else {
        (ui.palette().weak, ui.palette().text)
    };
    let at = |x| pos2(x, rect.center().y);
    // From left to right: number, label, code, distance.
    painter.text(
        at(rect.left() + LABEL / 2.0),
        Align2::CENTER_CENTER,
        index + 1,
        distance_font(),
        weak,
    );
    painter.text(
        at(rect.left() + LABEL),
        Align2::LEFT_CENTER,
        &candidate.label,
        label_font(),
        strong,
    );
    let mut right = rect.right() - SPACE;
    if let Some(width) = columns.distance {
        let says = match (candidate.in_use, candidate.distance_px) {
            (Some(other), _) => in_use(other),
            (None, Some(px)) if px < FAR_PX => format!("{px:.1} px"),
            (None, _) => String::new(),
        };
        painter.text(at(right), Align2::RIGHT_CENTER, says, distance_font(), weak);
        right -= width + SPACE;
    }
    painter.text(
        at(right - columns.code),
        Align2::LEFT_CENTER,
        &candidate.code,
        code_font(),
        weak,
    );
    if response.clicked() {
        return Some(Action::Edit(EditAction::TakeName(index)));
    }
    // The list may open under a resting pointer. Only a moving one takes the highlight from the
    // arrow keys.
    let pointed = response.hovered() && ui.input(|input| input.pointer.delta() != Vec2::ZERO);
    (pointed && !highlighted).then_some(Action::Navigate(Navigation::HighlightName(index)))
}

/// Says that no name matches.
fn nothing(ui: &mut egui::Ui, naming: &Naming) {
    let (rect, _) = ui.allocate_exact_size(vec2(ui.available_width(), ROW), Sense::hover());
    let kind = if naming.lines { "line" } else { "landmark" };
    let text = format!("No {kind} matches “{}”.", naming.typed);
    let at = rect.left_center() + vec2(6.0, 0.0);
    ui.painter().text(
        at,
        Align2::LEFT_CENTER,
        text,
        FontId::proportional(theme::BODY),
        ui.palette().caution,
    );
}

/// Shows which keys choose, filter and cancel.
fn hint(ui: &mut egui::Ui, naming: &Naming) {
    let (rect, _) = ui.allocate_exact_size(vec2(ui.available_width(), ROW), Sense::hover());
    let other = if naming.lines { "landmarks" } else { "lines" };
    let text = format!("Enter or 1–{OFFERED}: choose · type to filter · Tab: {other} · Esc");
    let at = rect.left_center() + vec2(6.0, 2.0);
    ui.painter().text(
        at,
        Align2::LEFT_CENTER,
        text,
        FontId::proportional(theme::SMALL),
        ui.palette().weak,
    );
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_list_never_covers_its_point_and_stays_within_the_picture() {
        let bounds = Rect::from_min_size(pos2(0.0, 24.0), vec2(980.0, 580.0));
        let size = vec2(300.0, 160.0);
        for x in [-50.0, 0.0, 200.0, 500.0, 700.0, 980.0, 2000.0] {
            for y in [24.0, 100.0, 590.0, 604.0] {
                let list = Rect::from_min_size(beside(pos2(x, y), size, bounds), size);
                assert!(
                    !list.expand(GAP - 1.0).contains(pos2(x, y)),
                    "{list:?} covers {x}, {y}"
                );
                assert!(
                    bounds.contains_rect(list),
                    "{list:?} leaves the picture for {x}, {y}"
                );
            }
        }
    }
}
