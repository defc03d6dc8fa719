//! The field map: the field from above with the camera's view and the clicks. A landmark or line
//! can be picked on it, as the name of the current point or of the next click.
//!
//! The map is rotated by 180° if the camera is on the side of positive y, so that the camera's side
//! is at the bottom. The names of landmarks do not depend on this.

mod pick;

use crate::ui::Panel;
use crate::ui::controls::theme;
use crate::ui::drawing::labels::{PlateStyle, plate, text_width};
use crate::ui::drawing::placement::Placement;
use crate::ui::drawing::{canvas, labels};
use crate::ui::picture::viewport::Gesture;
use crate::ui::rows::menu;
use egui::{
    Align2, Button, Color32, FontId, Id, LayerId, Order, Painter, PointerButton, Pos2, Rect,
    RichText, Role, Sense, Shape, Stroke, WidgetInfo, pos2, vec2,
};
use std::sync::Arc;
use touchline_application::app::session::{Mode, PictureView};
use touchline_application::app::{App, Command, EditAction};
use touchline_application::render::Layer;
use touchline_application::scene::drawing::{Colour, Drawing, Marker, MarkerShape, Outline};
use touchline_application::scene::field_map::{FieldMap, SURROUND, field_map};
use touchline_application::scene::overlay::{CameraStatus, OverlayScene, SELECTED};
use touchline_core::field::{FieldModel, builtin};
use touchline_core::geometry::{ImagePoint, Vec3};
use touchline_documents::document::Target;

/// Margin around the field, m.
const MARGIN_M: f64 = 6.0;
/// Resolution of the map's own pixels.
const PX_PER_M: f64 = 10.0;
/// Height of the map divided by its width.
const SHAPE: f32 = 0.65;
/// Colour of a landmark without a click.
const UNCLICKED: Colour = Colour {
    r: 214,
    g: 226,
    b: 218,
    a: 150,
};
/// Colour of the ring around the landmark that is chosen or pointed at.
const POINTED: Color32 = Color32::from_rgb(255, 221, 64);

/// The title of a built-in template; the name of any other, which is a path.
pub fn sport_title(template: &str) -> String {
    builtin(template).map_or_else(|_| template.to_owned(), |known| known.title.clone())
}

/// Shows the map over the available width, at most `most_height` points high.
pub fn show(panel: &mut Panel<'_>, ui: &mut egui::Ui, most_height: f32) {
    let Some(field) = panel.app.current().field().cloned() else {
        return;
    };
    let width = ui.available_width();
    let size = vec2(width, (width * SHAPE).min(most_height).round());
    let (rect, response) = ui.allocate_exact_size(size, Sense::CLICK | Sense::DRAG);
    response.widget_info(|| WidgetInfo::labeled(Role::Canvas, true, "Field map"));
    let pixels_per_point = ui.pixels_per_point();
    let rect = egui::emath::GuiRounding::round_to_pixels(rect, pixels_per_point);
    // The map is rotated if the camera is on the side of positive y.
    let turned = panel
        .app
        .current()
        .base
        .is_some_and(|base| base.position_m.y > 0.0);
    let map = FieldMap {
        turned,
        ..FieldMap::new(&field, MARGIN_M, PX_PER_M)
    };

    // The map's own zoom and pan. Nothing outside the map depends on them, so they stay in egui's
    // memory and are no state of the application.
    let view_id = Id::NULL.with("field map's view");
    let mut view = ui
        .data(|data| data.get_temp::<PictureView>(view_id))
        .unwrap_or_default();
    view = apply_gestures(
        ui,
        &response,
        Placement::new(rect, pixels_per_point, map.size_px(), view),
        view,
    );
    ui.data_mut(|data| data.insert_temp(view_id, view));
    // Gestures come before the drawing, so that the map follows them without a delay of one frame.
    let placement = Placement::new(rect, pixels_per_point, map.size_px(), view);

    // The target under the pointer. Lines only, while a line is to be named or placed.
    let spots = pick::spots(&field, &map, &placement);
    let lines = match &panel.app.session.mode {
        Mode::Naming(naming) => naming.lines,
        _ => panel.app.session.is_next_on_line(),
    };
    let pointed = response
        .hover_pos()
        .and_then(|at| pick::under(&field, &map, &placement, &spots, at, lines).zip(Some(at)));
    paint(panel.app, ui, &field, &map, &placement, &spots);
    let painter = ui.painter_at(rect);
    let on_map = MapLayout {
        field: &field,
        map: &map,
        placement: &placement,
        spots: &spots,
    };
    camera_icon(panel.app, &painter, &on_map);
    if let Some(target) = chosen(panel.app) {
        ring(&painter, &on_map, &target);
    }
    let map_menu = [
        Command::ChooseSport,
        Command::ConfirmFieldSize,
        Command::FitFieldSize,
        Command::CameraPanel,
        Command::ShowFieldMap,
    ];
    response.context_menu(|ui| menu::entries(panel, ui, &map_menu));
    sport(panel, ui);
    // In a blind round the map shows what to click and cannot be used to choose.
    let pointed = pointed.filter(|_| panel.app.round().is_none());
    if let Some((target, at)) = pointed {
        ring(&painter, &on_map, &target);
        name(
            ui,
            at,
            &format!("{} · {}", panel.app.label(&target), code(&field, &target)),
        );
        ui.ctx().set_cursor_icon(egui::CursorIcon::PointingHand);
        if response.clicked() {
            panel.edit(EditAction::Pick(target));
        }
    }
}

/// Shows the sport as a button below the map.
fn sport(panel: &mut Panel<'_>, ui: &mut egui::Ui) {
    let Some(spec) = panel.app.shown_field_spec() else {
        return;
    };
    let title = sport_title(&spec.template);
    ui.horizontal(|ui| {
        ui.add_space(8.0);
        let button = Button::new(RichText::new(title).small()).small();
        panel.command_button(ui, button, Command::ChooseSport);
    });
}

/// Field and map, and where they are on the screen. `spots` are the landmarks in the field's order.
struct MapLayout<'a> {
    field: &'a FieldModel,
    map: &'a FieldMap,
    placement: &'a Placement,
    spots: &'a [Pos2],
}

/// The view after the gestures of this frame of the window: the wheel zooms, dragging moves.
fn apply_gestures(
    ui: &egui::Ui,
    response: &egui::Response,
    placement: Placement,
    mut view: PictureView,
) -> PictureView {
    let mut placement = placement;
    if let Some(at) = response.hover_pos() {
        // Several gestures in one frame of the window are applied one after the other.
        for gesture in ui.input(|input| {
            input
                .events
                .iter()
                .filter_map(Gesture::from_event)
                .collect::<Vec<_>>()
        }) {
            view = match gesture {
                Gesture::Zoom(factor) => placement.zoom_at(factor, at),
                Gesture::Pan(along) => placement.pan_by(along),
            };
            placement = placement.showing(view);
        }
    }
    if response.dragged_by(PointerButton::Primary) || response.dragged_by(PointerButton::Middle) {
        view = placement.pan_by(response.drag_delta());
    }
    view
}

/// Draws ground, landmarks, the camera's view and the clicks with their numbers.
fn paint(
    app: &App,
    ui: &egui::Ui,
    field: &FieldModel,
    map: &FieldMap,
    placement: &Placement,
    spots: &[Pos2],
) {
    let rect = placement.rect;
    let painter = ui.painter_at(rect);
    painter.rect_filled(rect, 0.0, labels::colour(SURROUND));
    // A blind round hides the label: clicks and the camera that follows from them.
    let hidden = app.round().is_some();
    let clicks = app
        .frame()
        .filter(|_| !hidden)
        .map(|frame| frame.clicks.as_slice())
        .unwrap_or_default();
    let shown = app.shown_values();
    // The camera that a highlighted name would give takes the place of the frame's own, unless an
    // estimated base is shown, with which it was not computed.
    let preview = app
        .current()
        .preview
        .as_ref()
        .filter(|_| !shown.is_estimated);
    let scene = OverlayScene {
        field,
        camera: preview.or(shown.camera.as_ref()).filter(|_| !hidden),
        standing: CameraStatus::Solved,
        image_size: app
            .frame()
            .map_or_else(|| map.size_px(), |frame| frame.image_size),
        clicks,
        selected: app.session.points.selected,
        disputed: shown.disputed,
        style: &app.overlay_style(),
        zoom: placement.scale,
    };
    let drawn = field_map(&scene, map);
    let dots = dots(
        field,
        placement,
        spots,
        clicks.iter().filter_map(|click| click.target.as_ref()),
    );
    // The dots lie on the ground and below the clicks.
    let layers = [drawn.ground, dots, drawn.over].map(|drawing| Layer::Drawing(Arc::new(drawing)));
    canvas::paint(
        &painter,
        canvas::FIELD_MAP,
        rect,
        placement.render_view(),
        layers.into(),
    );
    // The numbers of the clicks, beside their landmarks.
    for (index, click) in clicks.iter().enumerate() {
        let Some(Target::Landmark(id)) = &click.target else {
            continue;
        };
        let spot = field
            .landmarks
            .iter()
            .zip(spots)
            .find(|(landmark, _)| landmark.id == *id)
            .map(|(_, spot)| *spot);
        if let Some(spot) = spot.filter(|spot| rect.contains(*spot)) {
            let behind = Color32::from_black_alpha(150);
            let font = FontId::proportional(theme::SMALL);
            let letters = labels::colour(SELECTED);
            plate(
                &painter,
                spot + vec2(8.0, -8.0),
                Align2::LEFT_CENTER,
                &(index + 1).to_string(),
                PlateStyle::new(font, letters, behind),
            );
        }
    }
}

/// The landmarks without a click: dots for those on the ground, small rings for those above it.
fn dots<'a>(
    field: &FieldModel,
    placement: &Placement,
    spots: &[Pos2],
    clicked: impl Iterator<Item = &'a Target>,
) -> Drawing {
    let clicked: Vec<&str> = clicked.map(Target::as_str).collect();
    // Clicked landmarks are drawn with the clicks.
    let unclicked = field
        .landmarks
        .iter()
        .zip(spots)
        .filter(|(landmark, _)| !clicked.contains(&landmark.id.as_str()));
    let markers = unclicked.map(|(landmark, spot)| {
        let on_ground = landmark.nominal_m.z <= 0.0;
        // A drawing is in the map's px. The spots are in points of the screen, because a landmark
        // above another one is moved by a distance on the screen.
        let ImagePoint { x, y } = placement.image_from_screen(*spot);
        Marker {
            at: [x as f32, y as f32],
            shape: if on_ground {
                MarkerShape::Dot
            } else {
                MarkerShape::Ring
            },
            colour: UNCLICKED,
            radius_pt: 2.25,
            line_pt: 1.0,
            outline: Some(Outline {
                colour: Colour {
                    r: 10,
                    g: 14,
                    b: 12,
                    a: 120,
                },
                width_pt: 0.5,
            }),
        }
    });
    Drawing {
        markers: markers.collect(),
        ..Drawing::default()
    }
}

/// The landmark or line that is chosen and about to be placed.
fn chosen(app: &App) -> Option<Target> {
    match &app.session.mode {
        Mode::Naming(naming) => naming.chosen().map(|candidate| candidate.target.clone()),
        Mode::Placing(target) => Some(target.clone()),
        Mode::ClickingAgain(round) => round
            .target()
            .map(|target| Target::Landmark(target.landmark.clone())),
        _ => None,
    }
}

/// Draws a ring around a landmark, or draws over a line.
fn ring(painter: &Painter, place: &MapLayout<'_>, target: &Target) {
    // Bright on a wider dark line, so that it is visible on lines and on grass.
    let rim = Color32::from_black_alpha(160);
    match target {
        Target::Landmark(id) => {
            let found = place
                .field
                .landmarks
                .iter()
                .zip(place.spots)
                .find(|(landmark, _)| landmark.id == *id);
            if let Some((_, spot)) = found {
                painter.circle_stroke(*spot, 6.0, Stroke::new(3.5, rim));
                painter.circle_stroke(*spot, 6.0, Stroke::new(1.75, POINTED));
            }
        }
        Target::Line(id) => {
            if let Some(line) = place.field.line(id.as_str()) {
                let points = pick::on_screen(&line.curve, place.map, place.placement);
                painter.add(Shape::line(points.clone(), Stroke::new(4.5, rim)));
                painter.add(Shape::line(points, Stroke::new(2.25, POINTED)));
            }
        }
    }
}

/// Writes a name below the pointer. The text may leave the map but not the window.
fn name(ui: &egui::Ui, at: Pos2, text: &str) {
    let painter = ui.ctx().layer_painter(LayerId::new(
        Order::Tooltip,
        Id::NULL.with("field map's name"),
    ));
    let font = FontId::proportional(theme::SMALL);
    let width = text_width(&painter, text, font.clone());
    let middle = middle_within(ui.ctx().content_rect(), width, at.x);
    plate(
        &painter,
        pos2(middle, at.y + 26.0),
        Align2::CENTER_CENTER,
        text,
        PlateStyle::new(font, Color32::WHITE, Color32::from_black_alpha(225)),
    );
}

/// The x nearest to a wanted one at which the middle of a text of this width leaves none of it
/// outside the window. A text that is wider than the window begins at its left border.
fn middle_within(window: Rect, width: f32, wanted: f32) -> f32 {
    let room = width / 2.0 + 8.0;
    let leftmost = window.left() + room;
    wanted.clamp(leftmost, (window.right() - room).max(leftmost))
}

/// Draws the camera in its position, looking at the field's centre. If it is outside the map, it is
/// drawn at the border.
fn camera_icon(app: &App, painter: &Painter, place: &MapLayout<'_>) {
    let Some(base) = app.shown_values().base else {
        return;
    };
    let position = Vec3::new(base.position_m.x, base.position_m.y, 0.0);
    let stands = place
        .placement
        .screen_from_image(place.map.map_from_world(position));
    let bounds = place.placement.rect.shrink(10.0);
    let at = stands.clamp(bounds.min, bounds.max);
    let field_centre = place
        .placement
        .screen_from_image(place.map.map_from_world(Vec3::zeros()));
    // The icon points to the field's centre; its axes on the screen are `ahead` and `aside`.
    let ahead = (field_centre - stands).normalized();
    let aside = ahead.rot90();
    let corner = |along: f32, across: f32| at + ahead * along + aside * across;
    let body = vec![
        corner(-6.0, -4.0),
        corner(2.0, -4.0),
        corner(2.0, 4.0),
        corner(-6.0, 4.0),
    ];
    let lens = vec![
        corner(3.5, -2.0),
        corner(8.0, -5.0),
        corner(8.0, 5.0),
        corner(3.5, 2.0),
    ];
    for outline in [body.clone(), lens.clone()] {
        painter.add(Shape::closed_line(
            outline,
            Stroke::new(3.0, Color32::from_black_alpha(170)),
        ));
    }
    for part in [body, lens] {
        painter.add(Shape::convex_polygon(part, Color32::WHITE, Stroke::NONE));
    }
}

/// The code by which a landmark or line is typed; empty if it has none.
fn code<'a>(field: &'a FieldModel, target: &Target) -> &'a str {
    target
        .element(field)
        .and_then(|element| element.code(field))
        .unwrap_or_default()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_name_stays_in_the_window_and_one_that_is_too_wide_begins_at_its_border() {
        let window = Rect::from_min_max(pos2(0.0, 0.0), pos2(300.0, 200.0));
        assert_eq!(middle_within(window, 100.0, 150.0), 150.0);
        assert_eq!(middle_within(window, 100.0, 5.0), 58.0);
        assert_eq!(middle_within(window, 100.0, 295.0), 242.0);
        assert_eq!(middle_within(window, 400.0, 150.0), 208.0);
    }
}
