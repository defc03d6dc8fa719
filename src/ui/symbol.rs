//! Symbols that are drawn as shapes, so that they do not depend on fonts. Each button with a symbol
//! has an accessible name.

use super::theme::{self, Themed as _};
use egui::{
    Color32, Painter, Pos2, Rect, Response, Role, Sense, Shape, Stroke, Ui, WidgetInfo, pos2, vec2,
};

/// A symbol.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Symbol {
    /// Close or delete.
    Cross,
    /// A check point.
    Diamond,
    /// A point on a line.
    OnLine,
    /// A point on a landmark.
    Landmark,
    /// Selected.
    Tick,
    /// The Enter key.
    Return,
    /// A warning.
    Warning,
    /// Information.
    Info,
    /// Collapsed; a click expands.
    Folded,
    /// Expanded; a click collapses.
    Unfolded,
    /// Play.
    Play,
    /// Pause.
    Pause,
}

/// Draws a symbol into the middle of a rectangle. Coordinates are points from the centre, y down.
pub fn paint(painter: &Painter, symbol: Symbol, within: Rect, colour: Color32) {
    let centre = within.center();
    let at = |x: f32, y: f32| pos2(centre.x + x, centre.y + y);
    let stroke = Stroke::new(1.5, colour);
    match symbol {
        Symbol::Cross => {
            painter.line_segment([at(-3.5, -3.5), at(3.5, 3.5)], stroke);
            painter.line_segment([at(-3.5, 3.5), at(3.5, -3.5)], stroke);
        }
        Symbol::Diamond => {
            painter.add(Shape::closed_line(
                vec![at(0.0, -5.0), at(5.0, 0.0), at(0.0, 5.0), at(-5.0, 0.0)],
                stroke,
            ));
        }
        Symbol::OnLine => {
            painter.line_segment([at(-6.0, 4.0), at(6.0, -4.0)], stroke);
            painter.circle_filled(centre, 2.5, colour);
        }
        Symbol::Landmark => {
            for (x, y) in [(1.0, 0.0), (-1.0, 0.0), (0.0, 1.0), (0.0, -1.0)] {
                painter.line_segment([at(2.0 * x, 2.0 * y), at(6.0 * x, 6.0 * y)], stroke);
            }
        }
        Symbol::Tick => {
            painter.line(vec![at(-3.0, 0.0), at(-0.8, 2.4), at(3.2, -2.4)], stroke);
        }
        Symbol::Return => {
            painter.line(vec![at(6.0, -5.0), at(6.0, 2.0), at(-5.0, 2.0)], stroke);
            painter.line(vec![at(-1.5, -1.5), at(-5.0, 2.0), at(-1.5, 5.5)], stroke);
        }
        Symbol::Warning => {
            painter.add(Shape::convex_polygon(
                vec![at(0.0, -6.0), at(6.5, 5.5), at(-6.5, 5.5)],
                colour,
                Stroke::NONE,
            ));
            let dark = Stroke::new(1.5, painter.palette().on_accent);
            painter.line_segment([at(0.0, -2.0), at(0.0, 1.8)], dark);
            painter.circle_filled(at(0.0, 3.8), 0.9, painter.palette().on_accent);
        }
        Symbol::Info => {
            painter.circle_stroke(centre, 6.0, stroke);
            painter.line_segment([at(0.0, -0.5), at(0.0, 3.2)], stroke);
            painter.circle_filled(at(0.0, -3.0), 1.0, colour);
        }
        Symbol::Folded => triangle(
            painter,
            [at(-2.5, -4.5), at(3.5, 0.0), at(-2.5, 4.5)],
            colour,
        ),
        Symbol::Play => triangle(
            painter,
            [at(-3.5, -5.5), at(5.5, 0.0), at(-3.5, 5.5)],
            colour,
        ),
        Symbol::Pause => {
            for x in [-3.0, 3.0] {
                painter.rect_filled(
                    Rect::from_center_size(at(x, 0.0), vec2(3.0, 11.0)),
                    0.0,
                    colour,
                );
            }
        }
        Symbol::Unfolded => triangle(
            painter,
            [at(-4.5, -2.5), at(4.5, -2.5), at(0.0, 3.5)],
            colour,
        ),
    }
}

/// A filled triangle.
fn triangle(painter: &Painter, corners: [Pos2; 3], colour: Color32) {
    painter.add(Shape::convex_polygon(
        corners.to_vec(),
        colour,
        Stroke::NONE,
    ));
}

/// Shows a symbol that is not a button.
pub fn show(ui: &mut Ui, symbol: Symbol, colour: Color32) -> Response {
    let (rect, response) = ui.allocate_exact_size(vec2(16.0, 16.0), Sense::hover());
    paint(ui.painter(), symbol, rect, colour);
    response
}

/// A button with a symbol. `name` is its accessible name.
pub fn button(ui: &mut Ui, symbol: Symbol, name: &str, colour: Color32) -> Response {
    let (rect, response) = ui.allocate_exact_size(theme::SYMBOL, Sense::click());
    response.widget_info(|| WidgetInfo::labeled(Role::Button, ui.is_enabled(), name));
    paint_button(ui, &response, rect, symbol, colour);
    response
}

/// A button with a symbol that is on or off. `colour` is that of the on state.
pub fn toggle(ui: &mut Ui, symbol: Symbol, name: &str, on: bool, colour: Color32) -> Response {
    let (rect, response) = ui.allocate_exact_size(theme::SYMBOL, Sense::click());
    response.widget_info(|| WidgetInfo::selected(Role::Button, ui.is_enabled(), on, name));
    paint_button(
        ui,
        &response,
        rect,
        symbol,
        if on {
            colour
        } else {
            ui.palette().hovered_line
        },
    );
    response
}

/// Draws the symbol of a button, brighter with a ground under the pointer or with the focus.
fn paint_button(ui: &Ui, response: &Response, rect: Rect, symbol: Symbol, colour: Color32) {
    if ui.is_rect_visible(rect) {
        let painter = ui.painter();
        // The focus looks like the pointer, so that keyboard users see where they are.
        let lit = response.hovered() || response.has_focus();
        if lit {
            painter.rect_filled(rect, 4.0, ui.visuals().widgets.hovered.weak_bg_fill);
        }
        paint(
            painter,
            symbol,
            rect,
            if lit { ui.palette().strong } else { colour },
        );
    }
}
