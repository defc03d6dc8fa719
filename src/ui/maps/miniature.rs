//! A thumbnail of a frame with the field's lines, large enough to see whether a proposal is right.

use crate::ui::Panel;
use crate::ui::controls::theme::Themed as _;
use crate::ui::drawing::pictures::WHOLE;
use egui::{Color32, CornerRadius, Painter, Pos2, Rect, Shape, Stroke};
use touchline_application::app::OpenProject;
use touchline_core::markings::{MarkingOptions, project_lines};
use touchline_documents::document::FrameStatus;

/// Maximum distance of a drawn line from its curve, px of the picture. It is not visible at this
/// size.
const TOLERANCE_PX: f64 = 4.0;

/// Draws a frame's thumbnail into a box, with the field's lines as its camera projects them; dashed
/// if the camera is a proposal. Returns whether the picture was there.
pub fn paint(
    panel: &mut Panel<'_>,
    painter: &Painter,
    open: &OpenProject,
    index: usize,
    within: Rect,
) -> bool {
    painter.rect_filled(within, CornerRadius::same(2), painter.palette().raised);
    let Some(frame) = open.frame(index) else {
        return false;
    };
    // The size of the frame, not of the thumbnail: lines are projected in px of the frame. At least
    // one px, so that the scale is finite.
    let size = egui::vec2(
        frame.image_size.width as f32,
        frame.image_size.height as f32,
    )
    .max(egui::Vec2::splat(1.0));
    let scale = (within.width() / size.x).min(within.height() / size.y);
    // The picture in its own shape, in the middle of the box.
    let picture = Rect::from_center_size(within.center(), size * scale);
    let texture = panel.pictures.thumbnail(open, index);
    let has_picture = texture.is_some() || panel.pictures.has_no_thumbnail(open, index);
    if let Some(texture) = texture {
        painter.image(texture.id(), picture, WHOLE, Color32::WHITE);
    }
    // Only the shown frame's field is at hand. Other frames get lines if they share it.
    let Some(field) = panel.app.current().field() else {
        return has_picture;
    };
    let shares_field = panel
        .app
        .frame()
        .is_some_and(|shown| open.document.field_of(shown) == open.document.field_of(frame));
    let Some(camera) = open.document.ptz_camera(frame).filter(|_| shares_field) else {
        return has_picture;
    };
    let options = MarkingOptions {
        tolerance_px: TOLERANCE_PX,
        margin_px: 0.0,
        dashes: true,
    };
    let [red, green, blue] = panel.app.overlay_style().colour;
    // The lines, cut at the border of the picture.
    let stroke = Stroke::new(1.0, Color32::from_rgb(red, green, blue));
    let clipped = painter.with_clip_rect(painter.clip_rect().intersect(picture));
    for line in project_lines(field, &camera, frame.image_size, &options) {
        let points: Vec<Pos2> = line
            .points
            .iter()
            .map(|point| picture.min + egui::vec2(point.x as f32, point.y as f32) * scale)
            .collect();
        if frame.status == FrameStatus::Suggested {
            clipped.extend(Shape::dashed_line(&points, stroke, 3.0, 1.5));
        } else {
            clipped.add(Shape::line(points, stroke));
        }
    }
    has_picture
}
