//! Marks and colours of the three kinds of frames, for the plots of the page and their legends.

use crate::ui::controls::theme::{Palette, Themed as _};
use egui::{
    Color32, CornerRadius, Painter, Pos2, Rect, Response, Role, Sense, Shape, Stroke, StrokeKind,
    TextStyle, Ui, WidgetInfo, pos2, vec2,
};
use touchline_application::app::quality::PointKind;
use touchline_core::geometry::pluralise;

/// Height of a legend entry, and the width that its mark takes, points.
const ROW: f32 = 16.0;
const MARK: f32 = 14.0;

/// The colour of a kind of frame.
pub const fn colour(palette: &Palette, kind: PointKind) -> Color32 {
    palette.status(kind.status())
}

/// Draws the mark of a frame: a disc for a reference, a diamond for a suggestion, a square for a
/// draft.
pub fn mark(painter: &Painter, at: Pos2, kind: PointKind) {
    // Kinds differ in shape as well as in colour; the areas look about equal.
    let stroke = Stroke::new(1.2, colour(painter.palette(), kind));
    match kind {
        PointKind::Reference => {
            painter.circle_filled(at, 2.8, stroke.color);
        }
        PointKind::Suggested => {
            let by = |x: f32, y: f32| pos2(at.x + 3.2 * x, at.y + 3.2 * y);
            painter.add(Shape::closed_line(
                vec![by(0.0, -1.0), by(1.0, 0.0), by(0.0, 1.0), by(-1.0, 0.0)],
                stroke,
            ));
        }
        PointKind::Draft => {
            let square = Rect::from_center_size(at, vec2(4.6, 4.6));
            painter.rect_stroke(square, CornerRadius::ZERO, stroke, StrokeKind::Middle);
        }
    }
}

/// Draws the ring around a frame that is out of line with its neighbours.
pub fn ring(painter: &Painter, at: Pos2) {
    painter.circle_stroke(at, 5.5, Stroke::new(1.5, painter.palette().bad));
}

/// A mark with its text as one widget, so that a line break never separates them. `paint` receives
/// the centre of the mark.
pub fn entry(ui: &mut Ui, words: &str, paint: impl FnOnce(&Painter, Pos2)) -> Response {
    let font = TextStyle::Small.resolve(ui.style());
    let galley = ui
        .painter()
        .layout_no_wrap(words.to_owned(), font, ui.palette().text);
    let (place, response) =
        ui.allocate_exact_size(vec2(MARK + galley.size().x, ROW), Sense::hover());
    response.widget_info(|| WidgetInfo::labeled(Role::Label, true, words));
    paint(
        ui.painter(),
        place.left_center() + vec2(MARK / 2.0 - 2.0, 0.0),
    );
    let text = pos2(
        place.left() + MARK,
        place.center().y - galley.size().y / 2.0,
    );
    ui.painter().galley(text, galley, ui.palette().text);
    response
}

/// A count with the name of the kind in singular or plural.
pub fn describe_count(kind: PointKind, count: usize) -> String {
    let name = match kind {
        PointKind::Reference => "reference",
        PointKind::Suggested => "suggestion",
        PointKind::Draft => "draft",
    };
    pluralise(count, name)
}
