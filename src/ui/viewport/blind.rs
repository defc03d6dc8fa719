//! The picture during a blind round: it shows only the dragged click and the name of the landmark
//! to click.

use super::hints::{PLATE, beside};
use super::pointer::Hold;
use crate::ui::labels::{self, PlateStyle, plate};
use crate::ui::overlay::Overlay;
use crate::ui::placement::Placement;
use crate::ui::{Panel, canvas, loupe};
use egui::{Align2, Color32, CursorIcon, FontId, Painter, Stroke, vec2};
use touchline_application::render::Layer;
use touchline_application::scene::overlay::CLICK;
use touchline_core::geometry::ImagePoint;
use touchline_documents::document::Target;

/// The crosshair of the dragged click: the length of its arms and the gap in its middle, points.
const ARM: [f32; 2] = [4.0, 11.0];

/// Shows the picture.
pub fn show(panel: &Panel<'_>, ui: &egui::Ui, placement: &Placement, hold: &Hold, picture: &Layer) {
    let Some(round) = panel.app.round() else {
        return;
    };
    let rect = placement.rect;
    let painter = ui.painter_at(rect);
    canvas::paint(
        &painter,
        canvas::VIEWPORT,
        rect,
        placement.render_view(),
        vec![picture.clone()],
    );
    let Some(asked) = round.asked() else { return };
    let label = panel.app.label(&Target::Landmark(asked.landmark.clone()));
    let text = format!("Click: {label}");
    let at = rect.center_top() + vec2(0.0, 18.0);
    plate(
        &painter,
        at,
        Align2::CENTER_CENTER,
        &text,
        PlateStyle::new(FontId::proportional(15.0), labels::colour(CLICK), PLATE),
    );
    if let Some(held) = round.held {
        cross(&painter, placement, held);
        loupe::show(
            ui,
            panel.app.settings.loupe,
            placement,
            held,
            picture,
            |_| Overlay::default(),
        );
    } else {
        loupe::rest(ui);
        let pointer = ui
            .input(|input| input.pointer.hover_pos())
            .filter(|at| rect.contains(*at));
        if let Some(pointer) = pointer {
            beside(&painter, rect, pointer, &label, "");
        }
    }
    let icon = match hold {
        Hold::Picture(_) => CursorIcon::Grabbing,
        Hold::Click { moving: true, .. } => CursorIcon::None,
        _ => CursorIcon::Crosshair,
    };
    let free = |at: &egui::Pos2| {
        rect.contains(*at)
            && ui
                .ctx()
                .layer_id_at(*at)
                .is_none_or(|top| top == ui.layer_id())
    };
    if ui
        .input(|input| input.pointer.hover_pos())
        .as_ref()
        .is_some_and(free)
    {
        ui.ctx().set_cursor_icon(icon);
    }
}

fn cross(painter: &Painter, placement: &Placement, at: ImagePoint) {
    let centre = placement.screen_from_image(at);
    for (width, colour) in [
        (3.0, Color32::from_black_alpha(160)),
        (1.5, labels::colour(CLICK)),
    ] {
        for way in [
            vec2(1.0, 0.0),
            vec2(-1.0, 0.0),
            vec2(0.0, 1.0),
            vec2(0.0, -1.0),
        ] {
            painter.line_segment(
                [centre + way * ARM[0], centre + way * ARM[1]],
                Stroke::new(width, colour),
            );
        }
    }
}
