//! The residuals of a camera's frames in the order of the frames, with a mark where the camera
//! stops fitting, for example because it was moved. A click shows the nearest frame.

use super::{remark, section};
use crate::ui::Panel;
use crate::ui::controls::theme::{self, Themed as _};
use crate::ui::maps::plot::{Plot, small};
use egui::{Align2, Button, CornerRadius, Rect, Role, Sense, Stroke, Ui, WidgetInfo, pos2, vec2};
use touchline_application::app::Command;
use touchline_documents::document::{Camera, Frame};

/// Height of the plot, points.
const HEIGHT: f32 = 72.0;
/// Minimum upper end of the scale, px at 1920 px width.
const SCALE_PX: f64 = 8.0;
/// Minimum number of frames for a plot.
const MIN_FRAMES: usize = 3;

/// A frame of the camera: its position in the document, and the rms of its residuals, px.
struct Point {
    frame: usize,
    rms_px: f64,
}

/// Shows the residuals of a camera's frames. If they jump, a button makes a new camera from there
/// on.
pub fn show(panel: &mut Panel<'_>, ui: &mut Ui, camera: &Camera) {
    let points = points(panel, camera);
    if points.len() < MIN_FRAMES {
        return;
    }
    section(ui, "FIT OVER TIME");
    plot(panel, ui, camera, &points);
    // The remedy, if the residuals jump.
    let Some(change) = panel
        .app
        .camera_change()
        .filter(|change| change.camera == camera.id)
        .cloned()
    else {
        return;
    };
    let open = panel.app.open();
    let text = open.map_or_else(String::new, |open| change.describe(&open.document));
    ui.add_space(theme::SPACE);
    remark(ui, &text, |ui| {
        let split = Button::new("New camera from here").small();
        panel.command_button(ui, split, Command::NewCameraFromChange);
        if ui.add(Button::new("Go there").small()).clicked() {
            panel.go_to(change.frame);
        }
    });
}

/// The frames of the camera with a finite rms.
fn points(panel: &Panel<'_>, camera: &Camera) -> Vec<Point> {
    let Some(open) = panel.app.open() else {
        return Vec::new();
    };
    // A rms that is not finite has no place on the scale.
    let of_camera = open
        .document
        .frames
        .iter()
        .enumerate()
        .filter(|(_, frame)| frame.camera == camera.id);
    of_camera
        .filter_map(|(index, frame)| {
            let rms_px = frame
                .solution
                .as_ref()?
                .rms_px
                .filter(|px| px.is_finite())?;
            Some(Point {
                frame: index,
                rms_px,
            })
        })
        .collect()
}

/// Draws the plot and reads the pointer.
fn plot(panel: &mut Panel<'_>, ui: &mut Ui, camera: &Camera, points: &[Point]) {
    let (rect, response) =
        ui.allocate_exact_size(vec2(ui.available_width(), HEIGHT), Sense::click());
    let (Some(first), Some(last)) = (points.first(), points.last()) else {
        return;
    };
    let [from, to] = [first.frame, last.frame].map(|frame| {
        let open = panel.app.open();
        open.map_or(frame as u64, |open| open.frame_number(frame))
    });
    let description = format!("Fit of {} frames over time, {from} to {to}", points.len());
    response.widget_info(|| WidgetInfo::labeled(Role::Button, true, &description));
    // Scales and their numbers. Positions in the document run to the right, so frames of other
    // cameras leave gaps.
    let painter = ui.painter_at(rect);
    painter.rect_filled(rect, CornerRadius::same(4), ui.palette().backdrop);
    let highest = scale_px(points, SCALE_PX * camera.image_size.scale_from_1920());
    let plot = Plot {
        area: Rect::from_min_max(rect.min + vec2(6.0, 14.0), rect.max - vec2(6.0, 14.0)),
        x: [first.frame as f64, last.frame as f64],
        y: [0.0, highest.sqrt()],
    };
    let area = plot.area;
    let x_of = |frame: usize| plot.x_of(frame as f64);
    // The vertical axis has a square-root scale, on which a few px remain distinguishable beside
    // fifty.
    let at = |point: &Point| plot.at(point.frame as f64, point.rms_px.sqrt());
    painter.hline(
        area.x_range(),
        area.bottom(),
        Stroke::new(1.0, ui.palette().line),
    );
    painter.text(
        rect.left_top() + vec2(6.0, 1.0),
        Align2::LEFT_TOP,
        format!("{highest:.0} px"),
        small(),
        ui.palette().weak,
    );
    // Vertical lines: the shown frame, and where the camera stops fitting.
    let change = panel
        .app
        .camera_change()
        .filter(|change| change.camera == camera.id)
        .map(|change| change.frame);
    let shown = panel.app.session.frame;
    if (first.frame..=last.frame).contains(&shown) {
        painter.vline(
            x_of(shown),
            area.y_range(),
            Stroke::new(1.0, ui.palette().weak),
        );
    }
    if let Some(frame) = change {
        painter.vline(
            x_of(frame),
            area.y_range(),
            Stroke::new(2.0, ui.palette().caution),
        );
    }
    // Frames from the change on have another colour; the shown frame is larger.
    for point in points {
        let after = change.is_some_and(|change| point.frame >= change);
        let colour = if after {
            ui.palette().caution
        } else {
            ui.palette().accent
        };
        let radius = if point.frame == shown { 3.5 } else { 2.0 };
        painter.circle_filled(at(point), radius, colour);
    }
    // The first and the last frame's number below the plot.
    let below = rect.bottom() - 1.0;
    painter.text(
        pos2(area.left(), below),
        Align2::LEFT_BOTTOM,
        from,
        small(),
        ui.palette().weak,
    );
    painter.text(
        pos2(area.right(), below),
        Align2::RIGHT_BOTTOM,
        to,
        small(),
        ui.palette().weak,
    );

    // The pointer picks the point that is nearest on the screen.
    let under = response.hover_pos().and_then(|pointer| {
        points.iter().min_by(|a, b| {
            let [a, b] = [a, b].map(|point| at(point).distance_sq(pointer));
            a.total_cmp(&b)
        })
    });
    if let Some(point) = under {
        if response.clicked() {
            panel.go_to(point.frame);
        }
        painter.circle_stroke(at(point), 5.0, Stroke::new(1.0, ui.palette().strong));
        let name = panel
            .app
            .open()
            .and_then(|open| open.frame(point.frame))
            .map(Frame::name);
        let text = format!(
            "{}: {:.1} px. Click to go there.",
            name.unwrap_or_default(),
            point.rms_px
        );
        response.on_hover_text_at_pointer(text);
    }
}

/// The upper end of the scale, px: 1.2 times the 95 % quantile, so that single outliers do not
/// flatten the others.
fn scale_px(points: &[Point], least_px: f64) -> f64 {
    let mut sorted: Vec<f64> = points.iter().map(|point| point.rms_px).collect();
    sorted.sort_by(f64::total_cmp);
    // There are at least MIN_FRAMES points.
    let high = sorted[(sorted.len() - 1) * 19 / 20];
    least_px.max(1.2 * high).ceil()
}
