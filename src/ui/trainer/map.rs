//! Where references look, over pan and tilt.

use crate::app::where_to_label::whole_degrees;
use crate::camera::PtzCamera;
use crate::geometry::ImageSize;
use crate::proposals::{Coverage, LeftOut, Quality, WRONG_PX};
use crate::ui::{Panel, theme};
use egui::{Color32, Label, Painter, Pos2, Rect, Role, Sense, Shape, Stroke, Ui, WidgetInfo, pos2, vec2};

/// The map's height, points.
const HEIGHT: f32 = 84.0;
/// So many references at a place are plenty.
const PLENTY: f32 = 4.0;
/// The field where no reference looks.
const MISSING: Color32 = Color32::from_rgb(96, 46, 40);
/// What is not the field and no reference sees.
const OUTSIDE: Color32 = Color32::from_rgb(20, 22, 25);

/// The map of the shown frame's camera; none where it has no reference.
pub fn of_shown<'a>(panel: &Panel<'_>, maps: &'a [Coverage]) -> Option<&'a Coverage> {
    let frame = panel.app.frame()?;
    maps.iter().find(|map| map.camera == frame.camera)
}

/// Shows the map: the more references see a place, the brighter; the field where none looks in red; the references that were
/// left out and asked for as dots; the shown frame as an outline; where a label helps most as a pointer from above.
pub fn show(panel: &Panel<'_>, ui: &mut Ui, coverage: &Coverage, quality: Option<&Quality>) {
    let missing = coverage
        .missing_pan_deg
        .map(|pan_deg| format!("No reference sees the field near pan\u{a0}{}.", whole_degrees(pan_deg)));
    let (rect, response) = ui.allocate_exact_size(vec2(ui.available_width(), HEIGHT), Sense::hover());
    let told = missing.clone().unwrap_or_else(|| "References see all of the field.".to_owned());
    response.widget_info(|| WidgetInfo::labeled(Role::Image, true, format!("Map of pan and tilt. {told}")));
    let painter = ui.painter_at(rect);
    let chart = Chart { rect, coverage };
    chart.cells(&painter);
    let app = panel.app;
    if let (Some(camera), Some(frame)) = (&app.current().camera, app.frame()) {
        chart.outline(&painter, camera, frame.image_size);
    }
    for asked in quality.into_iter().flat_map(|quality| &quality.asked) {
        chart.dot(&painter, asked);
    }
    if let Some(pan_deg) = label_next(panel, coverage) {
        chart.pointer(&painter, pan_deg);
    }
    let tip = "Pan to the right, tilt upwards. Blue: seen by references, the brighter the more. Red: field that none sees. \
               Dots: references that were left out and found again (green), found wrong (red) or not found (ring). Outline: \
               the shown frame. Pointer from above: where a label helps most.";
    response.on_hover_text(tip);
    ui.horizontal(|ui| {
        let border = |degrees: f64| egui::RichText::new(whole_degrees(degrees)).small().color(theme::WEAK);
        ui.label(border(*coverage.pan_deg.start()));
        ui.with_layout(egui::Layout::right_to_left(egui::Align::Center), |ui| {
            ui.label(border(*coverage.pan_deg.end()));
        });
    });
    ui.add(Label::new(told).wrap());
}

/// Where a label of this camera helps most, degrees of pan.
fn label_next(panel: &Panel<'_>, coverage: &Coverage) -> Option<f64> {
    let next = panel.app.review().advice.next?;
    let frame = panel.app.open()?.frame(next.frame)?;
    next.pan_deg.filter(|_| frame.camera == coverage.camera)
}

struct Chart<'a> {
    rect: Rect,
    coverage: &'a Coverage,
}

impl Chart<'_> {
    fn at(&self, pan_deg: f64, tilt_deg: f64) -> Pos2 {
        let share = |range: &std::ops::RangeInclusive<f64>, value: f64| {
            ((value - range.start()) / (range.end() - range.start())) as f32
        };
        let x = share(&self.coverage.pan_deg, pan_deg);
        let y = 1.0 - share(&self.coverage.tilt_deg, tilt_deg);
        pos2(self.rect.left() + x * self.rect.width(), self.rect.top() + y * self.rect.height())
    }

    fn cells(&self, painter: &Painter) {
        let columns = self.coverage.columns.max(1);
        let rows = self.coverage.cells.len() / columns;
        let size = vec2(self.rect.width() / columns as f32, self.rect.height() / rows.max(1) as f32);
        for (index, cell) in self.coverage.cells.iter().enumerate() {
            let (column, row) = ((index % columns) as f32, (index / columns) as f32);
            let place = Rect::from_min_size(self.rect.min + vec2(column * size.x, row * size.y), size);
            let colour = match cell.references {
                0 if cell.field => MISSING,
                0 => OUTSIDE,
                references => {
                    let share = (references as f32 / PLENTY).min(1.0);
                    theme::ACCENT_GROUND.lerp_to_gamma(theme::ACCENT, 0.15 + 0.55 * share)
                }
            };
            // A seam between cells, so that they read as counted and not as measured.
            painter.rect_filled(place.shrink(0.5), 0.0, colour);
        }
    }

    fn outline(&self, painter: &Painter, camera: &PtzCamera, size: ImageSize) {
        let corners = size.corners().into_iter().filter_map(|corner| camera.ray_from_image(corner).ok());
        let points: Vec<Pos2> = corners.map(|ray| self.at(ray.pan.degrees(), ray.tilt.degrees())).collect();
        if points.len() == 4 {
            painter.add(Shape::closed_line(points, Stroke::new(1.5, theme::STRONG)));
        }
    }

    fn pointer(&self, painter: &Painter, pan_deg: f64) {
        let x = self.at(pan_deg, 0.0).x.clamp(self.rect.left() + 6.0, self.rect.right() - 6.0);
        let tip = pos2(x, self.rect.top() + 9.0);
        let corners = vec![tip, tip + vec2(-5.0, -8.0), tip + vec2(5.0, -8.0)];
        painter.add(Shape::convex_polygon(corners, theme::STRONG, Stroke::new(1.0, theme::BACKDROP)));
    }

    fn dot(&self, painter: &Painter, asked: &LeftOut) {
        let at = self.at(asked.pan_deg, asked.tilt_deg);
        match asked.found {
            Some(found) if found.error_px <= WRONG_PX => painter.circle_filled(at, 3.0, theme::GOOD),
            Some(_) => painter.circle_filled(at, 3.5, theme::BAD),
            None => painter.circle_stroke(at, 3.0, Stroke::new(1.5, theme::CAUTION)),
        };
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::proposals::Cell;

    #[test]
    fn pan_runs_to_the_right_and_tilt_upwards() {
        let coverage = Coverage {
            camera: "main".into(),
            pan_deg: -50.0..=50.0,
            tilt_deg: -20.0..=0.0,
            columns: 2,
            cells: vec![Cell::default(); 4],
            missing_pan_deg: None,
        };
        let rect = Rect::from_min_size(Pos2::ZERO, vec2(200.0, 100.0));
        let chart = Chart { rect, coverage: &coverage };
        assert_eq!(chart.at(-50.0, 0.0), pos2(0.0, 0.0));
        assert_eq!(chart.at(25.0, -15.0), pos2(150.0, 75.0));
    }
}
