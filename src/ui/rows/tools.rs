//! The column of tools and panels, at the left edge; and what shows the tool over the picture.

use super::menu::is_on;
use crate::ui::Panel;
use crate::ui::controls::symbol::Symbol;
use crate::ui::controls::theme::Themed as _;
use crate::ui::controls::{symbol, theme};
use egui::{
    Align, Color32, CornerRadius, Layout, Painter, Pos2, Rect, Role, Sense, Stroke, StrokeKind, Ui,
    Vec2, WidgetInfo, vec2,
};
use touchline_application::app::{Command, Tool};

/// Width of the column, points.
pub const WIDTH: f32 = 40.0;
/// Length of a button's side, points.
const SIDE: f32 = 32.0;
/// Size of a button's symbol, points.
const SYMBOL: f32 = 18.0;

/// The tools, by the commands that choose them.
const TOOLS: [(Symbol, Command); 5] = [
    (Symbol::Landmark, Command::PointTool),
    (Symbol::OnLine, Command::LineTool),
    (Symbol::Diamond, Command::CheckTool),
    (Symbol::Pointer, Command::SelectTool),
    (Symbol::Mask, Command::ShowMasks),
];

/// The panels, by the commands that open and close them.
const PANELS: [(Symbol, Command); 4] = [
    (Symbol::Camera, Command::CameraPanel),
    (Symbol::Forest, Command::TrainerPanel),
    (Symbol::List, Command::ReviewPanel),
    (Symbol::Plot, Command::QualityPage),
];

/// Shows the column.
pub fn show(panel: &mut Panel<'_>, ui: &mut Ui) {
    ui.with_layout(Layout::top_down(Align::Center), |ui| {
        ui.spacing_mut().item_spacing.y = theme::SPACE / 2.0;
        ui.add_space(theme::SPACE);
        for (symbol, command) in TOOLS {
            button(panel, ui, symbol, command);
        }
        ui.add_space(theme::SPACE);
        ui.separator();
        ui.add_space(theme::SPACE);
        for (symbol, command) in PANELS {
            button(panel, ui, symbol, command);
        }
    });
}

/// Shows the button of a command.
fn button(panel: &mut Panel<'_>, ui: &mut Ui, symbol: Symbol, command: Command) {
    // Drawn by hand: larger than the buttons of `symbol`, on a ground if the tool or panel is on.
    let refused = panel.app.why_not(command);
    let is_on = is_on(panel.app, command);
    ui.add_enabled_ui(refused.is_none(), |ui| {
        let (rect, response) = ui.allocate_exact_size(Vec2::splat(SIDE), Sense::click());
        let enabled = ui.is_enabled();
        response.widget_info(|| WidgetInfo::selected(Role::Button, enabled, is_on, command.name()));
        let (painter, palette) = (ui.painter(), ui.palette());
        let is_lit = response.hovered() || response.has_focus();
        if is_on {
            painter.rect_filled(rect, CornerRadius::same(6), palette.accent_ground);
        } else if is_lit {
            painter.rect_filled(rect, CornerRadius::same(6), palette.hovered);
        }
        let colour = if is_on || is_lit {
            palette.strong
        } else {
            palette.text
        };
        symbol::paint_sized(painter, symbol, rect, SYMBOL, colour);
        let response = response.on_disabled_hover_text(refused.unwrap_or_default());
        panel.run_on_click(response, command);
    });
}

/// Draws a border around the picture while another tool than the usual one is chosen.
pub fn paint_border(painter: &Painter, tool: Tool, picture: Rect) {
    if tool != Tool::Point {
        let stroke = Stroke::new(2.0, painter.palette().accent);
        painter.rect_stroke(picture, 0.0, stroke, StrokeKind::Inside);
    }
}

/// Draws the symbol of a tool beside the pointer, except that of the usual one.
pub fn paint_beside_pointer(painter: &Painter, tool: Tool, pointer: Pos2) {
    let symbol = match tool {
        Tool::Point | Tool::Select => return,
        Tool::Line => Symbol::OnLine,
        Tool::Check => Symbol::Diamond,
        Tool::Mask => Symbol::Mask,
    };
    let place = Rect::from_center_size(pointer + vec2(16.0, 16.0), Vec2::splat(18.0));
    painter.rect_filled(place, CornerRadius::same(4), theme::ON_PICTURE.control);
    symbol::paint(painter, symbol, place, Color32::WHITE);
}
