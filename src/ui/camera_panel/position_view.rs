//! The stadium from above and from the side: the estimated position of the camera with its
//! uncertainty, and where its frames look.

use super::section;
use crate::ui::Panel;
use crate::ui::controls::theme::{self, Themed as _};
use egui::{
    Align2, Color32, FontId, Painter, Pos2, Rect, Role, Sense, Shape, Stroke, Ui, WidgetInfo, pos2,
    vec2,
};
use touchline_calibration::calibrate::EstimatedBase;
use touchline_core::field::FieldModel;
use touchline_core::geometry::{Vec2, Vec3, covariance_ellipse};

/// Height of both views, points.
const HEIGHT: f32 = 176.0;
/// Width of the side view, points. It is to the right of the view from above.
const SIDE: f32 = 64.0;
/// Minimum radius of the drawn ellipse, points. A smaller one is enlarged by a round factor, which
/// is shown.
const VISIBLE: f64 = 14.0;
/// Number of corners of the polygon that is drawn for the ellipse.
const CORNERS: u32 = 48;
/// Minimum length of the lines that show where frames look, m.
const LOOK_M: f64 = 45.0;

/// Shows both views.
pub fn show(panel: &Panel<'_>, ui: &mut Ui, found: &EstimatedBase) {
    let Some(field) = panel.app.current().field().cloned() else {
        return;
    };
    section(ui, "CAMERA POSITION");
    let (rect, response) =
        ui.allocate_exact_size(vec2(ui.available_width(), HEIGHT), Sense::hover());
    let position = found.estimate.base.position_m;
    let description = format!(
        "From above: the camera at x {:.1}, y {:.1}, height {:.1} m",
        position.x, position.y, position.z
    );
    response.widget_info(|| WidgetInfo::labeled(Role::Image, true, &description));
    let painter = ui.painter_at(rect);
    painter.rect_filled(rect, 4.0, ui.palette().backdrop);
    let top = Rect::from_min_max(rect.min, pos2(rect.right() - SIDE, rect.bottom()));
    let side = Rect::from_min_max(pos2(rect.right() - SIDE, rect.top()), rect.max);
    from_above(
        &painter,
        top.shrink(8.0),
        &field,
        found,
        panel.app.session.frame,
    );
    from_the_side(&painter, side.shrink2(vec2(6.0, 8.0)), found);
    let tip = "The position with its 1-σ ellipse, and where each frame looks. The shown frame is bright. Frames that look in many directions constrain the position best.";
    response.on_hover_text(tip);
}

/// Draws the field, the camera, and where its frames look, from above: x to the right, y upwards.
fn from_above(
    painter: &Painter,
    rect: Rect,
    field: &FieldModel,
    found: &EstimatedBase,
    shown: usize,
) {
    let estimate = &found.estimate;
    let position = estimate.base.position_m;
    let (half_length, half_width) = (field.length_m / 2.0, field.width_m / 2.0);
    let (left, right) = (position.x.min(-half_length), position.x.max(half_length));
    // The view contains field and camera, with room for twice the 1-σ across the field.
    let room_m = 8.0 + 2.0 * estimate.position_covariance[(1, 1)].max(0.0).sqrt();
    let (near, far) = (
        (position.y - room_m).min(-half_width),
        (position.y + room_m).max(half_width),
    );
    // One scale in points per m for both axes, so that angles are true.
    let scale =
        (f64::from(rect.width()) / (right - left)).min(f64::from(rect.height()) / (far - near));
    let middle = (f64::midpoint(left, right), f64::midpoint(near, far));
    let at = |point: Vec3| -> Pos2 {
        rect.center()
            + vec2(
                ((point.x - middle.0) * scale) as f32,
                (-(point.y - middle.1) * scale) as f32,
            )
    };
    for line in &field.lines {
        let points: Vec<Pos2> = (0..=24)
            .map(|step| at(line.curve.point_at(f64::from(step) / 24.0)))
            .collect();
        painter.add(Shape::line(
            points,
            Stroke::new(1.0, Color32::from_rgb(70, 92, 76)),
        ));
    }
    let heading = estimate.base.angles().heading;
    // The line of each frame begins at the camera; its direction is heading plus pan, from the y
    // axis to the right.
    for (index, fit) in found.frames.iter().zip(&estimate.frames) {
        let Some(fit) = fit else { continue };
        let direction = (heading + fit.ptz.pan).radians();
        // It ends at the field's long axis. A frame that looks along the field never reaches it,
        // hence the limit 0.2 for the cosine.
        let reach_m = (position.y.abs() / direction.cos().abs().max(0.2)).max(LOOK_M);
        let end = position + Vec3::new(direction.sin(), direction.cos(), 0.0) * reach_m;
        let (width, colour) = if *index == shown {
            (1.5, painter.palette().strong)
        } else {
            (1.0, Color32::from_rgba_unmultiplied(64, 146, 255, 90))
        };
        painter.line_segment([at(position), at(end)], Stroke::new(width, colour));
    }
    // The 1-σ ellipse of the horizontal position, which is enlarged where it would be a speck.
    let covariance = estimate
        .position_covariance
        .fixed_view::<2, 2>(0, 0)
        .into_owned();
    let ellipse = covariance_ellipse(covariance, CORNERS);
    let times = enlargement(&ellipse, scale);
    let outline = ellipse.into_iter().map(|offset| {
        let grown = offset * times;
        at(position + Vec3::new(grown.x, grown.y, 0.0))
    });
    painter.add(Shape::closed_line(
        outline.collect(),
        Stroke::new(1.5, painter.palette().caution),
    ));
    painter.circle_filled(at(position), 3.0, painter.palette().strong);
    let text = if times > 1.0 {
        format!("1-σ × {times:.0}")
    } else {
        "1-σ".to_owned()
    };
    painter.text(
        rect.left_bottom(),
        Align2::LEFT_BOTTOM,
        text,
        FontId::proportional(theme::SMALL),
        painter.palette().caution,
    );
}

/// Draws the camera's height above the ground, with its 1-σ as a thick line.
fn from_the_side(painter: &Painter, rect: Rect, found: &EstimatedBase) {
    let (height, sigma) = (
        found.estimate.base.position_m.z,
        found.estimate.base.sigma.position_m.z,
    );
    // The scale leaves room for the text below and for the upper end of the interval.
    let ground = rect.bottom() - 14.0;
    let scale = f64::from(ground - rect.top() - 16.0) / (height + sigma).max(1.0);
    let x = rect.center().x;
    let at = |z: f64| ground - (z * scale) as f32;
    painter.line_segment(
        [pos2(rect.left(), ground), pos2(rect.right(), ground)],
        Stroke::new(1.0, painter.palette().line),
    );
    painter.line_segment(
        [pos2(x, ground), pos2(x, at(height))],
        Stroke::new(1.0, painter.palette().weak),
    );
    painter.line_segment(
        [pos2(x, at(height - sigma)), pos2(x, at(height + sigma))],
        Stroke::new(3.0, painter.palette().caution),
    );
    painter.circle_filled(pos2(x, at(height)), 3.0, painter.palette().strong);
    let text = format!("{height:.1} m");
    painter.text(
        pos2(x, rect.bottom()),
        Align2::CENTER_BOTTOM,
        text,
        FontId::proportional(theme::SMALL),
        painter.palette().text,
    );
}

/// The round factor that enlarges the ellipse to at least [`VISIBLE`] at a scale in points per m.
fn enlargement(ellipse: &[Vec2], scale: f64) -> f64 {
    let radius_m = ellipse.iter().map(Vec2::norm).fold(0.0, f64::max);
    [1.0, 2.0, 3.0, 5.0, 10.0, 20.0, 50.0]
        .iter()
        .find(|times| radius_m * scale * **times >= VISIBLE)
        .copied()
        .unwrap_or(100.0)
}
