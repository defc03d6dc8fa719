//! The loupe: a magnified view of the picture, with the overlay, around a point that is placed or
//! dragged.
//!
//! It stands beside the point, on the side where it hides least of the lines that the user aims at.

use crate::ui::controls::theme;
use crate::ui::drawing::canvas::{self, Overlay};
use crate::ui::drawing::labels::{PlateStyle, plate};
use crate::ui::drawing::placement::Placement;
use egui::{
    Align2, Color32, FontId, Id, LayerId, Order, Pos2, Rect, Role, Sense, Stroke, StrokeKind, Vec2,
    WidgetInfo,
};
use touchline_application::app::settings::Loupe;
use touchline_application::render::{Layer, View};
use touchline_core::geometry::ImagePoint;

/// The loupe is not shown if the picture itself is enlarged by at least this share of the loupe's
/// magnification.
const NOT_NEEDED_FROM: f64 = 0.625;
/// Distance from the point to the nearest border of the loupe, points.
const GAP: f32 = 36.0;
/// Cost of changing sides, in points of hidden line. It keeps the loupe from jumping to and fro.
const STAY: f32 = 80.0;
/// Free radius of the crosshair around the point, points.
const OPEN: f32 = 9.0;

/// The sides of a point on which the loupe can stand, as directions on the screen (y down). The
/// first are preferred where the costs are equal.
const SIDES: [Vec2; 8] = [
    egui::vec2(1.0, -1.0),
    egui::vec2(-1.0, -1.0),
    egui::vec2(1.0, 1.0),
    egui::vec2(-1.0, 1.0),
    egui::vec2(0.0, -1.0),
    egui::vec2(0.0, 1.0),
    egui::vec2(1.0, 0.0),
    egui::vec2(-1.0, 0.0),
];

/// Shows the loupe around `at`, px of the picture. `overlay` gives what is drawn over the picture
/// at a zoom in physical px per px of the picture.
pub fn show(
    ui: &egui::Ui,
    look: Loupe,
    placement: &Placement,
    at: ImagePoint,
    picture: &Layer,
    overlay: impl FnOnce(f64) -> Overlay,
) {
    let magnification = f64::from(look.magnification);
    if !look.shown || placement.points_per_px() >= NOT_NEEDED_FROM * magnification {
        return;
    }
    // Lines of the overlay keep their width on the screen, so the overlay is made anew for the
    // loupe's zoom and not magnified with the picture.
    let pixels_per_point = ui.pixels_per_point();
    let overlay = overlay(magnification * f64::from(pixels_per_point));
    let point = placement.screen_from_image(at);
    // The side is remembered from the previous frame of the window while a point is dragged.
    let side_id = side_id();
    let before = ui.data(|data| data.get_temp::<usize>(side_id));
    let side = free_side(
        point,
        look.side,
        placement.rect,
        &lines(&overlay, placement),
        before,
    );
    ui.data_mut(|data| data.insert_temp(side_id, side));
    let rect = egui::emath::GuiRounding::round_to_pixels(
        on_side(point, look.side, side),
        pixels_per_point,
    );

    let response = ui.interact(rect, side_id, Sense::hover());
    response.widget_info(|| WidgetInfo::labeled(Role::Canvas, true, "Loupe"));
    // Above all panels: the loupe may extend beyond the picture.
    let painter = ui
        .ctx()
        .layer_painter(LayerId::new(Order::Tooltip, side_id));
    let layers = std::iter::once(picture.clone())
        .chain(overlay.layers())
        .collect();
    canvas::paint(
        &painter,
        canvas::LOUPE,
        rect,
        view(at, rect, magnification, pixels_per_point),
        layers,
    );
    crosshair(&painter, rect);
    // The position, px of the picture, at the lower border; then a border that is visible on any
    // picture.
    let text = format!("{:.2}, {:.2}", at.x, at.y);
    let corner = rect.center_bottom() - egui::vec2(0.0, 12.0);
    let behind = Color32::from_black_alpha(150);
    plate(
        &painter,
        corner,
        Align2::CENTER_CENTER,
        &text,
        PlateStyle::new(
            FontId::monospace(theme::SMALL),
            Color32::from_gray(230),
            behind,
        ),
    );
    painter.rect_stroke(
        rect,
        2.0,
        Stroke::new(3.0, Color32::from_black_alpha(160)),
        StrokeKind::Outside,
    );
    painter.rect_stroke(
        rect,
        2.0,
        Stroke::new(1.5, Color32::from_gray(220)),
        StrokeKind::Outside,
    );
}

/// Forgets the side when no point is dragged, so that the next drag chooses freely.
pub fn rest(ui: &egui::Ui) {
    ui.data_mut(|data| data.remove_temp::<usize>(side_id()));
}

/// Where the index of the side is stored.
fn side_id() -> Id {
    Id::NULL.with("loupe's side")
}

/// The view that has the point `at` exactly in the middle of `rect`.
fn view(at: ImagePoint, rect: Rect, magnification: f64, pixels_per_point: f32) -> View {
    // screen px = picture px · scale + offset. The offset is not rounded, unlike that of the
    // picture itself: the point must be in the middle to a fraction of a pixel.
    let scale = magnification * f64::from(pixels_per_point);
    let size_px = canvas::size_px(rect, pixels_per_point);
    let [width, height] = size_px.map(f64::from);
    let offset_px = [
        (width / 2.0 - at.x * scale) as f32,
        (height / 2.0 - at.y * scale) as f32,
    ];
    View {
        scale: scale as f32,
        offset_px,
        size_px,
        pixels_per_point,
    }
}

/// Draws a crosshair with an open centre and a dot on the point, bright on dark.
fn crosshair(painter: &egui::Painter, rect: Rect) {
    let centre = rect.center();
    let reach = rect.width() / 2.0 - 24.0;
    for (width, colour) in [(3.0, Color32::from_black_alpha(110)), (1.0, Color32::WHITE)] {
        for way in [Vec2::RIGHT, Vec2::LEFT, Vec2::UP, Vec2::DOWN] {
            painter.line_segment(
                [centre + way * OPEN, centre + way * reach],
                Stroke::new(width, colour),
            );
        }
    }
    painter.circle_filled(centre, 1.75, Color32::from_black_alpha(140));
    painter.circle_filled(centre, 1.0, Color32::WHITE);
}

/// The rectangle of the loupe on a side of the point. `length` is its side, points.
fn on_side(point: Pos2, length: f32, side: usize) -> Rect {
    Rect::from_center_size(
        point + SIDES[side % SIDES.len()] * (GAP + length / 2.0),
        Vec2::splat(length),
    )
}

/// The index of the side with the least cost.
///
/// The cost is the length of the overlay's lines below the loupe, plus [`STAY`] for a change of
/// sides, plus the loupe's area outside the bounds. The area, in square points, outweighs the
/// lengths as soon as the loupe is outside by more than a narrow strip.
fn free_side(
    point: Pos2,
    length: f32,
    bounds: Rect,
    lines: &[[Pos2; 2]],
    before: Option<usize>,
) -> usize {
    // Eight sides times all segments of the overlay, in every frame of a drag: some thousand
    // clippings. The first of equal sides wins, hence the order of SIDES.
    let sides = (0..SIDES.len()).map(|side| {
        let rect = on_side(point, length, side);
        let outside = (rect.area() - rect.intersect(bounds).area().max(0.0)).max(0.0);
        let hidden: f32 = lines.iter().map(|line| length_within(*line, rect)).sum();
        let change = if before.is_some_and(|before| before != side) {
            STAY
        } else {
            0.0
        };
        (side, outside + hidden + change)
    });
    sides
        .min_by(|a, b| a.1.total_cmp(&b.1))
        .map_or(0, |(side, _)| side)
}

/// The lines of the overlay as segments on the screen.
fn lines(overlay: &Overlay, placement: &Placement) -> Vec<[Pos2; 2]> {
    let on_screen =
        |[x, y]: [f32; 2]| placement.screen_from_image(ImagePoint::new(f64::from(x), f64::from(y)));
    let strokes = overlay
        .drawings
        .iter()
        .flat_map(|drawing| &drawing.strokes)
        .flat_map(|group| &group.strokes);
    strokes
        .flat_map(|stroke| stroke.points.windows(2))
        .map(|ends| [on_screen(ends[0]), on_screen(ends[1])])
        .collect()
}

/// Length of the part of a segment within a box (Liang and Barsky 1984).
///
/// The segment is a + t·(b − a) with t in 0..1. Each border of the box raises the lower or lowers
/// the upper limit of t; a segment parallel to a border is inside or outside as a whole.
fn length_within([a, b]: [Pos2; 2], rect: Rect) -> f32 {
    let along = b - a;
    let (mut from, mut to) = (0.0_f32, 1.0_f32);
    let limits = [
        (-along.x, a.x - rect.left()),
        (along.x, rect.right() - a.x),
        (-along.y, a.y - rect.top()),
        (along.y, rect.bottom() - a.y),
    ];
    // Each border demands rate · t <= room: a negative rate means that the segment comes in
    // through it, a positive one that it leaves.
    for (rate, room) in limits {
        if rate < 0.0 {
            from = from.max(room / rate);
        } else if rate > 0.0 {
            to = to.min(room / rate);
        } else if room < 0.0 {
            return 0.0;
        }
    }
    along.length() * (to - from).max(0.0)
}

#[cfg(test)]
mod tests {
    use super::*;
    use egui::pos2;

    const SIDE: f32 = 160.0;
    const BOUNDS: Rect = Rect {
        min: pos2(0.0, 0.0),
        max: pos2(980.0, 580.0),
    };

    #[test]
    fn the_loupe_keeps_off_the_point_the_lines_and_the_border() {
        for point in [
            pos2(500.0, 300.0),
            pos2(2.0, 3.0),
            pos2(978.0, 4.0),
            pos2(976.0, 575.0),
            pos2(5.0, 570.0),
        ] {
            let rect = on_side(point, SIDE, free_side(point, SIDE, BOUNDS, &[], None));
            assert!(
                BOUNDS.contains_rect(rect) && !rect.contains(point),
                "{point:?} {rect:?}"
            );
        }
        let point = pos2(500.0, 300.0);
        let line = [pos2(400.0, 400.0), pos2(900.0, -100.0)];
        let side = free_side(point, SIDE, BOUNDS, &[line], None);
        assert_eq!(length_within(line, on_side(point, SIDE, side)), 0.0);
    }

    #[test]
    fn the_loupe_stays_where_it_is_without_a_reason() {
        let point = pos2(500.0, 300.0);
        for side in 0..SIDES.len() {
            assert_eq!(free_side(point, SIDE, BOUNDS, &[], Some(side)), side);
        }
    }

    #[test]
    fn the_length_within_a_box_is_that_of_the_clipped_line() {
        let rect = Rect::from_min_max(pos2(0.0, 0.0), pos2(10.0, 10.0));
        assert_eq!(
            length_within([pos2(-5.0, 5.0), pos2(15.0, 5.0)], rect),
            10.0
        );
        assert_eq!(length_within([pos2(2.0, 2.0), pos2(2.0, 6.0)], rect), 4.0);
        assert_eq!(
            length_within([pos2(-5.0, 20.0), pos2(15.0, 20.0)], rect),
            0.0
        );
        assert_eq!(
            length_within([pos2(12.0, -5.0), pos2(12.0, 5.0)], rect),
            0.0
        );
    }
}
