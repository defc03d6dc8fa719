//! The panorama of a camera that autocalibration found or searches: persistent paint, and the
//! field's lines as this camera sees them. For a found camera, a click shows the frame that looks
//! there.
//!
//! Where paint and lines coincide, the camera is right. This is the user's check of a camera for
//! which nothing was clicked.

use crate::ui::Panel;
use crate::ui::controls::theme::Themed as _;
use egui::{Color32, Pos2, Rect, Role, Sense, Shape, Stroke, Ui, Vec2, WidgetInfo, vec2};
use touchline_application::app::Navigation;
use touchline_application::scene::paint_map::{PaintMapFrame, PaintMapScene, line_pieces};
use touchline_calibration::autocalibrate::SearchedPanorama;
use touchline_calibration::calibrate::FoundCamera;
use touchline_core::geometry::{ImagePoint, subsample};

/// Maximum number of paint points that are drawn.
const PLACES: usize = 4000;

/// Shows the panorama of a found camera, as large as it fits into a size. Nothing if the document
/// has no frame of it any more. Returns whether the user goes to a frame.
pub fn show(panel: &mut Panel<'_>, ui: &mut Ui, found: &FoundCamera, within: Vec2) -> bool {
    let Some(open) = panel.app.open() else {
        return false;
    };
    let frames: Vec<_> = found.looks(&open.document).collect();
    let looks: Vec<_> = frames.iter().map(|(_, look)| *look).collect();
    let scene = PaintMapScene {
        base: &found.found.base,
        field: Some(&found.found.field),
        frames: &looks,
        paint: &found.found.paint,
    };
    let Some(map) = PaintMapFrame::from_scene(&scene) else {
        return false;
    };
    let scale = scale_within(&map, within);
    let size = vec2(within.x, map.size.height as f32 * scale);
    let (rect, response) = ui.allocate_exact_size(size, Sense::click());
    response.widget_info(|| WidgetInfo::labeled(Role::Image, true, describe(found)));
    let corner = draw(ui, rect, &scene, &map, scale);
    // A click: from the screen to the map, and from there to a frame. Where no frame looks, nothing
    // happens.
    let clicked = response
        .clicked()
        .then(|| response.interact_pointer_pos())
        .flatten();
    let place = clicked.and_then(|pointer| {
        let offset = (pointer - corner) / scale;
        let in_map = ImagePoint::new(f64::from(offset.x), f64::from(offset.y));
        map.frame_at(&scene, in_map)
    });
    if let Some(place) = place {
        let goal = Navigation::GoTo(frames[place].0);
        panel.navigate(goal);
    }
    let tip = "White: paint that stays in place while the camera pans. Orange: the field's lines with this camera. Where the two coincide, the camera is right. Click to go to the frame that shows that place.";
    response.on_hover_text(tip);
    place.is_some()
}

/// Shows the panorama of a camera that is being searched, in the middle of an area of a size.
pub fn show_searched(ui: &mut Ui, searched: &SearchedPanorama, size: Vec2) {
    let (rect, response) = ui.allocate_exact_size(size, Sense::hover());
    let scene = PaintMapScene {
        base: &searched.base,
        field: searched.field.as_ref(),
        frames: &searched.frames,
        paint: &searched.paint,
    };
    if let Some(map) = PaintMapFrame::from_scene(&scene) {
        draw(ui, rect, &scene, &map, scale_within(&map, size));
    }
    let says = "Map of the paint that is found, with the lines of the best position so far";
    response.widget_info(|| WidgetInfo::labeled(Role::Image, true, says));
    response.on_hover_text(
        "White: paint that stays in place while the camera pans. Orange: the field's lines where \
         the best position so far puts them. They come to lie on the paint as the search goes on.",
    );
}

/// Points of the screen for one px of a map that fits into a size. One scale for both axes: a
/// panorama has true angles.
fn scale_within(map: &PaintMapFrame, size: Vec2) -> f32 {
    (size.x / map.size.width as f32).min(size.y / map.size.height as f32)
}

/// The evidence in words, for a screen reader.
fn describe(found: &FoundCamera) -> String {
    let evidence = &found.found.evidence;
    if evidence.lines.is_empty() {
        return "Map of paint and lines".to_owned();
    }
    format!(
        "Map of paint and lines: {:.0} % of the paint lies on lines, {:.0} % of the lines are seen",
        100.0 * evidence.explained,
        100.0 * evidence.visible
    )
}

/// Draws in the middle of an area, from back to front: the views of the frames, paint, the field's
/// lines. Returns the upper left corner of the map.
fn draw(ui: &Ui, rect: Rect, scene: &PaintMapScene<'_>, map: &PaintMapFrame, scale: f32) -> Pos2 {
    let size = vec2(map.size.width as f32, map.size.height as f32) * scale;
    let corner = rect.center() - size / 2.0;
    let at = |point: ImagePoint| corner + vec2(point.x as f32, point.y as f32) * scale;
    // Views overlap, so each is nearly transparent: where many frames look, the ground is lighter.
    let painter = ui.painter_at(rect);
    painter.rect_filled(rect, 4.0, ui.palette().backdrop);
    for outline in map.outlines(scene) {
        let corners: Vec<Pos2> = outline.into_iter().map(&at).collect();
        painter.add(Shape::convex_polygon(
            corners,
            Color32::from_rgba_unmultiplied(70, 120, 82, 14),
            Stroke::NONE,
        ));
    }
    for ray in subsample(scene.paint, PLACES) {
        let dot = Rect::from_center_size(at(map.map_from_ray(*ray)), vec2(1.3, 1.3));
        painter.rect_filled(dot, 0.0, Color32::from_gray(225));
    }
    for piece in line_pieces(scene, map) {
        let points: Vec<Pos2> = piece.into_iter().map(&at).collect();
        painter.add(Shape::line(
            points,
            Stroke::new(1.0, Color32::from_rgb(255, 138, 36)),
        ));
    }
    corner
}
