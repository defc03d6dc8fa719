//! A map over pan and tilt that shows how many references see each direction, and where one is
//! missing.
//!
//! Pan runs to the right and tilt upwards. The map may cross ±180° of pan.

use crate::ui::Panel;
use crate::ui::controls::theme::{Palette, Themed as _};
use egui::{
    Align, Color32, Layout, Painter, Pos2, Rect, Response, RichText, Role, Sense, Shape, Stroke,
    Ui, WidgetInfo, pos2, vec2,
};
use touchline_application::app::where_to_label::whole_degrees;
use touchline_calibration::proposals::Coverage;
use touchline_core::camera::PtzCamera;
use touchline_core::geometry::{Angle, ImageSize};

/// Number of references from which on the colour no longer changes.
const PLENTY: f32 = 4.0;
/// A map on the screen. The caller draws further marks on it.
pub struct CoverageMap<'a> {
    coverage: &'a Coverage,
    rect: Rect,
    /// The map as a control.
    pub response: Response,
    /// A painter that is clipped to the map.
    pub painter: Painter,
}

/// Says in one sentence where on the field no reference looks.
pub fn missing(coverage: &Coverage) -> String {
    coverage.missing_pan_deg.map_or_else(
        || "References see all of the field.".to_owned(),
        |pan_deg| {
            format!(
                "No reference sees the field near pan\u{a0}{}.",
                whole_degrees(pan_deg)
            )
        },
    )
}

/// The pan at which a label of this camera helps most, degrees, according to the review's advice.
pub fn label_next(panel: &Panel<'_>, coverage: &Coverage) -> Option<f64> {
    let next = panel.app.review().advice.next?;
    let frame = panel.app.open()?.frame(next.frame)?;
    next.pan_deg.filter(|_| frame.camera == coverage.camera)
}

impl<'a> CoverageMap<'a> {
    /// Shows a map of this height, points. The more references see a direction, the stronger its
    /// colour; directions of the field that none sees have a colour of their own.
    pub fn show(ui: &mut Ui, coverage: &'a Coverage, height: f32, sense: Sense) -> Self {
        let (rect, response) = ui.allocate_exact_size(vec2(ui.available_width(), height), sense);
        let description = format!("Map of pan and tilt. {}", missing(coverage));
        response.widget_info(|| WidgetInfo::labeled(Role::Image, true, &description));
        let map = Self {
            coverage,
            rect,
            response,
            painter: ui.painter_at(rect),
        };
        map.cells();
        map
    }

    /// Writes the pans of the left and the right border, below the map.
    pub fn borders(&self, ui: &mut Ui) {
        ui.horizontal(|ui| {
            let weak = ui.palette().weak;
            let border = |pan: Angle| {
                RichText::new(whole_degrees(pan.degrees()))
                    .small()
                    .color(weak)
            };
            ui.label(border(self.coverage.pan.start()));
            ui.with_layout(Layout::right_to_left(Align::Center), |ui| {
                ui.label(border(self.coverage.pan.end().wrap()));
            });
        });
    }

    /// Where a pan and a tilt, degrees, are on the screen.
    pub fn at(&self, pan_deg: f64, tilt_deg: f64) -> Pos2 {
        place(
            self.coverage,
            self.rect,
            self.coverage.pan.share(Angle::from_degrees(pan_deg)),
            tilt_deg,
        )
    }

    /// The index of the cell under a place on the screen, and pan and tilt there, degrees.
    pub fn under(&self, pointer: Pos2) -> Option<(usize, [f64; 2])> {
        let share = (pointer - self.rect.min) / self.rect.size();
        if !(0.0..1.0).contains(&share.x) || !(0.0..1.0).contains(&share.y) {
            return None;
        }
        // A share just below 1 may be rounded up to the number of rows; such an index has no cell.
        let (columns, rows) = self.columns_and_rows();
        let cell = (share.y * rows as f32) as usize * columns + (share.x * columns as f32) as usize;
        let Coverage { pan, tilt_deg, .. } = self.coverage;
        // Tilt decreases downwards.
        let tilt_deg = tilt_deg.end() - f64::from(share.y) * (tilt_deg.end() - tilt_deg.start());
        Some((
            cell,
            [pan.at(f64::from(share.x)).wrap().degrees(), tilt_deg],
        ))
    }

    /// Draws the outline of what a camera sees. The corners are placed relative to the middle of
    /// the view, so that the outline stays in one piece if it crosses the border of the map.
    pub fn outline(&self, camera: &PtzCamera, size: ImageSize) {
        let (middle, width) = (camera.ptz().pan, self.coverage.pan.width().radians());
        let at_middle = self.coverage.pan.share(middle);
        let corners = size
            .corners()
            .into_iter()
            .filter_map(|corner| camera.ray_from_image(corner).ok());
        let points = corners.map(|ray| {
            let share = at_middle + ray.pan.turn_from(middle).radians() / width;
            place(self.coverage, self.rect, share, ray.tilt.degrees())
        });
        let points: Vec<Pos2> = points.collect();
        // A corner beyond the largest radius of the lens model has no direction: no outline.
        if points.len() == 4 {
            self.painter.add(Shape::closed_line(
                points,
                Stroke::new(1.5, self.painter.palette().strong),
            ));
        }
    }

    /// Draws a pointer at the top of the map, at a pan in degrees.
    pub fn pointer(&self, pan_deg: f64) {
        let x = self
            .at(pan_deg, 0.0)
            .x
            .clamp(self.rect.left() + 6.0, self.rect.right() - 6.0);
        let tip = pos2(x, self.rect.top() + 9.0);
        let corners = vec![tip, tip + vec2(-5.0, -8.0), tip + vec2(5.0, -8.0)];
        let palette = self.painter.palette();
        self.painter.add(Shape::convex_polygon(
            corners,
            palette.strong,
            Stroke::new(1.0, palette.backdrop),
        ));
    }

    /// Draws a small square in each cell that another set of frames sees; more frames make a larger
    /// one.
    pub fn dots(&self, others: &Coverage, colour: Color32) {
        // Both sets have the same grid, because they are of one camera and field.
        for (index, cell) in others
            .cells
            .iter()
            .enumerate()
            .filter(|(_, cell)| cell.references > 0)
        {
            let side = 2.0 + 3.0 * (cell.references as f32 / PLENTY).min(1.0);
            self.painter.rect_filled(
                Rect::from_center_size(self.cell(index).center(), vec2(side, side)),
                0.0,
                colour,
            );
        }
    }

    /// Numbers of columns and rows of cells, at least one each.
    fn columns_and_rows(&self) -> (usize, usize) {
        let columns = self.coverage.columns.max(1);
        (columns, (self.coverage.cells.len() / columns).max(1))
    }

    /// The rectangle of a cell; cells are stored row by row from the upper left.
    fn cell(&self, index: usize) -> Rect {
        let (columns, rows) = self.columns_and_rows();
        let size = self.rect.size() / vec2(columns as f32, rows as f32);
        let place = vec2((index % columns) as f32, (index / columns) as f32);
        Rect::from_min_size(self.rect.min + place * size, size)
    }

    /// Draws the cells.
    fn cells(&self) {
        let palette = self.painter.palette();
        for (index, cell) in self.coverage.cells.iter().enumerate() {
            let colour = match cell.references {
                0 if cell.field => palette.missing,
                0 => palette.outside,
                references => coverage_colour(palette, references),
            };
            // Gaps between the cells show that they are counts in bins.
            self.painter
                .rect_filled(self.cell(index).shrink(0.5), 0.0, colour);
        }
    }
}

/// The colour of a direction that this number of references sees.
pub fn coverage_colour(palette: &Palette, references: u32) -> Color32 {
    let share = (references as f32 / PLENTY).min(1.0);
    palette
        .accent_ground
        .lerp_to_gamma(palette.accent, 0.15 + 0.55 * share)
}

/// Where a share of the map's width, 0 to 1, and a tilt, degrees, are on the screen.
fn place(coverage: &Coverage, rect: Rect, share: f64, tilt_deg: f64) -> Pos2 {
    // Tilt decreases downwards.
    let tilts = &coverage.tilt_deg;
    let down = (tilts.end() - tilt_deg) / (tilts.end() - tilts.start());
    pos2(
        rect.left() + share as f32 * rect.width(),
        rect.top() + down as f32 * rect.height(),
    )
}

#[cfg(test)]
mod tests {
    use super::*;
    use touchline_calibration::proposals::CoverageCell;
    use touchline_core::geometry::AngleRange;

    #[test]
    fn pan_runs_to_the_right_and_tilt_upwards() {
        let coverage = Coverage {
            camera: "main".into(),
            pan: AngleRange::FULL,
            tilt_deg: -20.0..=0.0,
            columns: 2,
            cells: vec![CoverageCell::default(); 4],
            missing_pan_deg: None,
        };
        let rect = Rect::from_min_size(Pos2::ZERO, vec2(200.0, 100.0));
        assert_eq!(place(&coverage, rect, 0.0, 0.0), pos2(0.0, 0.0));
        assert_eq!(place(&coverage, rect, 0.75, -15.0), pos2(150.0, 75.0));
    }
}
