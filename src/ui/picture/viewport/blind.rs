//! The picture during a blind round, in which the annotator clicks the landmarks of a gold frame
//! again.
//!
//! It shows the picture, the name of the landmark to click and the dragged click. Labels and the
//! field's lines stay hidden, because they would show where the first click was.

use super::super::loupe;
use super::hints::{PLATE, beside};
use super::pointer::DragTarget;
use crate::ui::Panel;
use crate::ui::controls::theme;
use crate::ui::drawing::canvas::Overlay;
use crate::ui::drawing::labels::{PlateStyle, plate};
use crate::ui::drawing::placement::Placement;
use crate::ui::drawing::{canvas, labels};
use egui::{Align2, Color32, CursorIcon, FontId, Painter, Stroke, vec2};
use touchline_application::render::Layer;
use touchline_application::scene::overlay::CLICK;
use touchline_core::geometry::ImagePoint;
use touchline_documents::document::Target;

/// The crosshair of the dragged click: inner and outer end of its arms, points from the centre.
const ARM: [f32; 2] = [4.0, 11.0];

/// Shows the picture, the instruction, the crosshair with the loupe, and sets the shape of the
/// pointer.
pub fn show(
    panel: &Panel<'_>,
    ui: &egui::Ui,
    placement: &Placement,
    hold: &DragTarget,
    picture: &Layer,
) {
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
    let Some(target) = round.target() else { return };
    let label = panel.app.label(&Target::Landmark(target.landmark.clone()));
    let text = format!("Click: {label}");
    let at = rect.center_top() + vec2(0.0, 18.0);
    plate(
        &painter,
        at,
        Align2::CENTER_CENTER,
        &text,
        PlateStyle::new(
            FontId::proportional(theme::BODY),
            labels::colour(CLICK),
            PLATE,
        ),
    );
    // While a click is dragged: crosshair and loupe. Otherwise the landmark's name follows the
    // pointer.
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
    // The shape of the pointer. A dragged click has the crosshair, so the pointer is hidden.
    let icon = match hold {
        DragTarget::Picture(_) => CursorIcon::Grabbing,
        DragTarget::Click { moving: true, .. } => CursorIcon::None,
        _ => CursorIcon::Crosshair,
    };
    // Only over the picture: a menu or a dialog on top sets its own pointer shape.
    let pointer = ui.input(|input| input.pointer.hover_pos());
    if pointer.is_some_and(|at| super::is_uncovered(ui, rect, at)) {
        ui.ctx().set_cursor_icon(icon);
    }
}

/// Draws a crosshair with an open centre: bright arms on wider dark ones, visible on any ground.
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
