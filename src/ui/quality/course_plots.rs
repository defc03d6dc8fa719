//! The plots of pan, tilt and focal length, one above the other.
//!
//! They share one time axis, of frame numbers or of the video's time in s, and one visible part of
//! it (the span). All horizontal coordinates are in the unit of this axis; pan and tilt are in
//! degrees, focal lengths in px. A click on a point shows its frame, the wheel zooms the axis, and
//! the shown frame's points can be dragged (`course_drag.rs`).

use super::legend;
use crate::ui::Panel;
use crate::ui::controls::theme::Themed as _;
use crate::ui::maps::plot::Plot;
use egui::{
    CornerRadius, CursorIcon, Painter, Pos2, Rect, Response, Role, Sense, Shape, Stroke, Ui,
    WidgetInfo, pos2, vec2,
};
use touchline_application::app::ViewAction;
use touchline_application::app::quality::{
    Course, CoursePoint, PointKind, Quantity, SpanMarks, TimeAxis, thin_points, within_whole,
    zoom_span,
};
use touchline_core::geometry::Angle;
use touchline_documents::report::figure::Ruler;

/// Height of one plot: the minimum in points, and the share of the page's width above it.
const HEIGHT: f32 = 76.0;
const HEIGHT_SHARE: f32 = 0.058;
/// Room for the numbers to the left of the plots and below the last one, points.
const NUMBERS: f32 = 44.0;
const BELOW: f32 = 16.0;
/// Room to the right of the plots for half of the last number below them, points.
const NUMBERS_END: f32 = 18.0;
/// Room above each plot for half a number, points.
const BETWEEN: f32 = 10.0;
/// Width of a column in a plot with many points, points of the screen.
const COLUMN: f32 = 2.0;
/// Distance within which the pointer picks a point, points of the screen.
const REACH: f32 = 14.0;
/// Maximum number of frames that are ringed.
const RINGED: usize = 300;
/// Average width of shots below which no lines are drawn between them, points.
const NARROW: f32 = 5.0;
/// Outliers stretch a scale to at most this multiple of the range of all other frames.
const STRETCH: f64 = 2.5;

/// The three plots, one above the other, over the same span of the time axis.
pub(super) struct CoursePlots {
    pub(super) plots: [Plot; 3],
    rulers: [Ruler; 3],
    rect: Rect,
    pub(super) response: Response,
    pub(super) span: [f64; 2],
}

impl CoursePlots {
    /// The plots on the page, higher in a wider window.
    pub(super) fn on_page(ui: &mut Ui, course: &Course, span: [f64; 2]) -> Self {
        let height = HEIGHT.max(HEIGHT_SHARE * ui.available_width());
        Self::new(ui, course, span, height)
    }

    /// Allocates the space and chooses the scales. The vertical scales fit what is visible, not the
    /// whole. `height` is that of one plot, points.
    pub(super) fn new(ui: &mut Ui, course: &Course, span: [f64; 2], height: f32) -> Self {
        let size = vec2(ui.available_width(), 3.0 * (height + BETWEEN) + BELOW);
        let (rect, response) = ui.allocate_exact_size(size, Sense::click_and_drag());
        // About one tick for each 26 points of height.
        let mut rulers = Quantity::ALL
            .map(|quantity| Ruler::around(scale(course, quantity, span), f64::from(height / 26.0)));
        name_directions(&mut rulers[Quantity::Pan as usize]);
        let plots = [0, 1, 2].map(|place| {
            let top = rect.top() + BETWEEN + place as f32 * (height + BETWEEN);
            let area = Rect::from_min_max(
                pos2(rect.left() + NUMBERS, top),
                pos2(rect.right() - NUMBERS_END, top + height),
            );
            Plot {
                area,
                x: span,
                y: rulers[place].range(),
            }
        });
        Self {
            plots,
            rulers,
            rect,
            response,
            span,
        }
    }

    /// Draws the plots, reads the pointer and returns the point under it.
    pub(super) fn show<'a>(
        &self,
        panel: &mut Panel<'_>,
        ui: &Ui,
        course: &'a Course,
        whole: [f64; 2],
    ) -> Option<&'a CoursePoint> {
        let description = describe(course);
        self.response
            .widget_info(|| WidgetInfo::labeled(Role::Canvas, true, &description));
        let under = self
            .response
            .hover_pos()
            .and_then(|pointer| self.nearest(course, pointer));
        if ui.is_rect_visible(self.rect) {
            self.paint(panel, ui, course, under);
        }
        if !self.drag_point(panel, ui, course) {
            self.read_pointer(panel, ui, under, whole);
        }
        under
    }

    /// Draws the plots from back to front: levels, ends of shots, the shown frame, ±1 σ, the
    /// curve, rings, the shown frame's point, the point under the pointer.
    fn paint(&self, panel: &Panel<'_>, ui: &Ui, course: &Course, under: Option<&CoursePoint>) {
        let painter = ui.painter_at(self.rect);
        let shown = course
            .at_of(panel.app.session.frame)
            .filter(|at| (self.span[0]..=self.span[1]).contains(at));
        // Each plot by itself; the vertical lines go through all three.
        for ((plot, ruler), quantity) in self.plots.iter().zip(&self.rulers).zip(Quantity::ALL) {
            painter.rect_filled(plot.area, CornerRadius::same(3), ui.palette().backdrop);
            plot.levels(&painter, ruler);
            cuts(&painter, plot, course);
            if let Some(at) = shown {
                painter.vline(
                    plot.x_of(at),
                    plot.area.y_range(),
                    Stroke::new(1.0, ui.palette().accent),
                );
            }
            if let Some(point) = under {
                painter.vline(
                    plot.x_of(point.at),
                    plot.area.y_range(),
                    Stroke::new(1.0, ui.palette().weak),
                );
            }
            sigma_band(&painter, plot, course.within(self.span), quantity);
            imported_curve(&painter, plot, course.within(self.span), quantity);
            curve(&painter, plot, course.within(self.span), quantity);
            let out = course
                .standing_out
                .iter()
                .map(|&place| &course.points[place])
                .filter(|point| (self.span[0]..=self.span[1]).contains(&point.at));
            for point in out.take(RINGED) {
                let at = plot.at(point.at, point.value(quantity));
                legend::mark(&painter, at, point.kind);
                legend::ring(&painter, at);
            }
            if let Some(point) = self.handles(panel.app, course) {
                let at = plot.at(point.at, point.value(quantity));
                painter.circle_stroke(at, 5.0, Stroke::new(2.0, ui.palette().accent));
            }
            if let Some(point) = under {
                let at = plot.at(point.at, point.value(quantity));
                painter.circle_stroke(at, 5.0, Stroke::new(1.5, ui.palette().strong));
            }
            plot.caption(&painter, quantity.label());
        }
        // The numbers of the time axis, below the last plot only.
        let ticks = time_ticks(course.axis, self.span, f64::from(self.rect.width() / 110.0));
        self.plots[2].steps(
            &painter,
            ticks.iter().map(|(at, words)| (*at, words.as_str())),
        );
    }

    /// The point nearest to the pointer on the screen, in the plot that the pointer is in. Only
    /// points within [`REACH`] in time are candidates.
    fn nearest<'a>(&self, course: &'a Course, pointer: Pos2) -> Option<&'a CoursePoint> {
        // The gap below a plot belongs to it. Points are sorted by time, so the candidates are a
        // slice.
        let place = self
            .plots
            .iter()
            .position(|plot| pointer.y <= plot.area.bottom() + BETWEEN)?;
        let (plot, quantity) = (&self.plots[place], Quantity::ALL[place]);
        let near = course.within([plot.x_at(pointer.x - REACH), plot.x_at(pointer.x + REACH)]);
        let distance = |point: &CoursePoint| {
            plot.at(point.at, point.value(quantity))
                .distance_sq(pointer)
        };
        near.iter()
            .min_by(|a, b| distance(a).total_cmp(&distance(b)))
    }

    /// A click shows the frame. Ctrl with the wheel, or pinching, zooms the time axis around the
    /// pointer; dragging, or Shift with the wheel, moves it.
    fn read_pointer(
        &self,
        panel: &mut Panel<'_>,
        ui: &Ui,
        under: Option<&CoursePoint>,
        whole: [f64; 2],
    ) {
        let is_part = self.span != whole;
        if let Some(point) = under.filter(|_| self.response.clicked()) {
            panel.look_at(point.frame, None);
        }
        // Units of the axis for one point of the screen.
        let per_point =
            (self.span[1] - self.span[0]) / f64::from(self.plots[0].area.width().max(1.0));
        let (mut moved, mut factor) = (f64::from(self.response.drag_delta().x), 1.0);
        if let Some(pointer) = self.response.hover_pos() {
            let (zoom, scrolled) =
                ui.input(|input| (input.zoom_delta(), input.smooth_scroll_delta().x));
            (factor, moved) = (f64::from(zoom), moved + f64::from(scrolled));
            if factor != 1.0 {
                let around = self.plots[0].x_at(pointer.x);
                panel.view(ViewAction::ShowSpan(zoom_span(
                    self.span, whole, around, factor,
                )));
            }
            let icon = match under {
                _ if self.response.dragged() && is_part => CursorIcon::Grabbing,
                Some(_) => CursorIcon::PointingHand,
                None => CursorIcon::Default,
            };
            ui.ctx().set_cursor_icon(icon);
        }
        // If one frame of the window brings both, only the zoom counts.
        if moved != 0.0 && factor == 1.0 && is_part {
            let by = moved * per_point;
            let span = within_whole([self.span[0] - by, self.span[1] - by], whole);
            panel.view(ViewAction::ShowSpan(span));
        }
    }
}

/// The description for a screen reader.
fn describe(course: &Course) -> String {
    let counts = PointKind::ALL
        .map(|kind| (kind, course.count(kind)))
        .into_iter()
        .rev()
        .filter(|(_, count)| *count > 0);
    let counts: Vec<String> = counts
        .map(|(kind, count)| legend::describe_count(kind, count))
        .collect();
    format!(
        "Pan, tilt and focal length over time: {}",
        counts.join(", ")
    )
}

/// Wraps the labels of pans beyond ±180° to directions. The curve itself is unwrapped, so that it
/// has no jump there.
fn name_directions(ruler: &mut Ruler) {
    for (pan_deg, words) in ruler
        .ticks
        .iter_mut()
        .filter(|(pan_deg, _)| pan_deg.abs() > 180.0)
    {
        // As many decimals as the ruler gave the label, which depend on the distance of the ticks.
        let decimals = words
            .split_once('.')
            .map_or(0, |(_, decimals)| decimals.len());
        *words = format!(
            "{:.decimals$}",
            Angle::from_degrees(*pan_deg).wrap().degrees()
        );
    }
}

/// The range of values within a span, `[min, max]`. Outliers are included only as far as the other
/// frames remain distinguishable.
fn scale(course: &Course, quantity: Quantity, span: [f64; 2]) -> [f64; 2] {
    let none = [f64::INFINITY, f64::NEG_INFINITY];
    let points = course.within(span);
    let all = points
        .iter()
        .map(|point| point.value(quantity))
        .fold(none, extend_range);
    let usual = points
        .iter()
        .filter(|point| !point.stands_out)
        .map(|point| point.value(quantity))
        .fold(none, extend_range);
    // An empty range is infinitely negative: then `length` is not finite. The room for outliers is
    // the same on both sides, so that the scale is at most STRETCH times what the others need.
    let (needed, length) = (usual[1] - usual[0], all[1] - all[0]);
    match () {
        () if !length.is_finite() => [0.0, 1.0],
        () if needed > 0.0 && length > STRETCH * needed => {
            let room = 0.5 * (STRETCH - 1.0) * needed;
            [all[0].max(usual[0] - room), all[1].min(usual[1] + room)]
        }
        () => all,
    }
}

/// The smallest range, `[min, max]`, that contains a range and a value.
fn extend_range(range: [f64; 2], value: f64) -> [f64; 2] {
    [range[0].min(value), range[1].max(value)]
}

/// Draws a dashed line where a shot ends, unless the shots are too narrow.
fn cuts(painter: &Painter, plot: &Plot, course: &Course) {
    // Cuts are sorted, so those in view are found by binary search.
    let from = course.cuts.partition_point(|at| *at < plot.x[0]);
    let upto = course.cuts.partition_point(|at| *at <= plot.x[1]);
    let inside = &course.cuts[from..upto.max(from)];
    if inside.len() as f32 * NARROW > plot.area.width() {
        return;
    }
    for at in inside {
        let [top, bottom] = [plot.area.top(), plot.area.bottom()].map(|y| pos2(plot.x_of(*at), y));
        painter.extend(Shape::dashed_line(
            &[top, bottom],
            Stroke::new(1.0, painter.palette().weak),
            2.0,
            3.0,
        ));
    }
}

/// Draws ±1 σ around the curve, where the frames state it and are not too many to be distinguished.
fn sigma_band(painter: &Painter, plot: &Plot, points: &[CoursePoint], quantity: Quantity) {
    if points.len() > (plot.area.width() / COLUMN) as usize {
        return;
    }
    let colour = painter.palette().weak.gamma_multiply(0.25);
    for pair in points
        .windows(2)
        .filter(|pair| pair[0].shot == pair[1].shot)
    {
        let ends = [&pair[0], &pair[1]].map(|point| {
            let (value, sigma) = (point.value(quantity), point.sigma?[quantity as usize]);
            Some([value + sigma, value - sigma].map(|value| plot.at(point.at, value)))
        });
        if let [Some([above, below]), Some([next_above, next_below])] = ends {
            let corners = vec![above, next_above, next_below, below];
            painter.add(Shape::convex_polygon(corners, colour, Stroke::NONE));
        }
    }
}

/// Draws the cameras that mended frames were imported with, as a thin line below the curve. Of very
/// many, as many are drawn as the plot has columns.
fn imported_curve(painter: &Painter, plot: &Plot, points: &[CoursePoint], quantity: Quantity) {
    let columns = (plot.area.width() / COLUMN).max(1.0) as usize;
    let stride = points.len().div_ceil(columns).max(1);
    let colour = painter.palette().weak.gamma_multiply(0.55);
    for shot in
        points.chunk_by(|a, b| a.shot == b.shot && a.imported.is_some() == b.imported.is_some())
    {
        let line = shot.iter().step_by(stride).filter_map(|point| {
            let at = plot.at(point.at, point.imported?[quantity as usize]);
            // A camera that was impossible is far outside of the plot.
            Some(at.clamp(plot.area.min, plot.area.max))
        });
        painter.line(line.collect(), Stroke::new(1.0, colour));
    }
}

/// Draws the points of a span: single points, joined within a shot, or columns from minimum to
/// maximum where there are many.
fn curve(painter: &Painter, plot: &Plot, points: &[CoursePoint], quantity: Quantity) {
    let at = |point: &CoursePoint| plot.at(point.at, point.value(quantity));
    // The application decides between points and columns by the number of points in view.
    match thin_points(
        points,
        quantity,
        plot.x,
        (plot.area.width() / COLUMN) as usize,
    ) {
        SpanMarks::Points(points) => {
            for shot in points.chunk_by(|a, b| a.shot == b.shot) {
                painter.line(
                    shot.iter().map(at).collect(),
                    Stroke::new(1.0, painter.palette().weak.gamma_multiply(0.6)),
                );
            }
            // One kind after the other, so that references lie above the many suggestions.
            for kind in PointKind::ALL {
                for point in points.iter().filter(|point| point.kind == kind) {
                    legend::mark(painter, at(point), kind);
                }
            }
        }
        SpanMarks::Columns(columns) => {
            for column in columns {
                let left = plot.area.left() + column.column as f32 * COLUMN;
                let (top, bottom) = (plot.y_of(column.high) - 1.0, plot.y_of(column.low) + 1.0);
                let bar = Rect::from_min_max(pos2(left, top), pos2(left + COLUMN, bottom));
                painter.rect_filled(bar, 0.0, legend::colour(painter.palette(), column.kind));
            }
        }
    }
}

/// About `wanted` tick marks within `span`, each with its label. Positions are in the unit of the
/// axis: frame numbers or s.
pub fn time_ticks(axis: TimeAxis, span: [f64; 2], wanted: f64) -> Vec<(f64, String)> {
    /// Steps of a clock, s.
    const CLOCK_S: [f64; 13] = [
        1.0, 2.0, 5.0, 10.0, 15.0, 30.0, 60.0, 120.0, 300.0, 600.0, 900.0, 1800.0, 3600.0,
    ];
    let ruler = || Ruler::within(span, wanted).ticks;
    match axis {
        TimeAxis::Frame => {
            let whole = ruler()
                .into_iter()
                .map(|(at, _)| at)
                .filter(|at| (at - at.round()).abs() < 1e-9);
            whole.map(|at| (at, format!("{at:.0}"))).collect()
        }
        // Less than a second for each tick: decimal steps, labelled in seconds.
        TimeAxis::Video if (span[1] - span[0]) / wanted < 1.0 => ruler()
            .into_iter()
            .map(|(at, words)| (at, format!("{words} s")))
            .collect(),
        // The smallest step of a clock, or multiple of an hour, that gives at most `wanted` ticks.
        TimeAxis::Video => {
            let rough = (span[1] - span[0]) / wanted;
            let step = CLOCK_S
                .into_iter()
                .find(|step| *step >= rough)
                .unwrap_or(3600.0 * (rough / 3600.0).ceil());
            let from = (span[0] / step).ceil() as i64;
            let upto = (span[1] / step).floor() as i64;
            (from..=upto)
                .map(|count| count as f64 * step)
                .map(|at| (at, clock(at)))
                .collect()
        }
    }
}

/// Seconds as minutes and seconds, `m:ss`.
fn clock(at_s: f64) -> String {
    let whole = at_s.round() as i64;
    format!("{}:{:02}", whole / 60, whole % 60)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn pans_beyond_the_seam_are_named_as_directions() {
        let mut ruler = Ruler::around([171.0, 189.0], 4.0);
        name_directions(&mut ruler);
        let words: Vec<&str> = ruler
            .ticks
            .iter()
            .map(|(_, words)| words.as_str())
            .collect();
        assert_eq!(words, ["170", "175", "180", "-175", "-170"]);
    }

    #[test]
    fn a_frame_far_off_stretches_a_scale_only_so_far() {
        let point = |at: f64, pan: f64, stands_out| CoursePoint {
            frame: at as usize,
            at,
            values: [pan, 0.0, 1000.0],
            sigma: None,
            imported: None,
            kind: PointKind::Suggested,
            shot: 0,
            apart_px: None,
            stands_out,
        };
        let points = vec![
            point(1.0, 0.0, false),
            point(2.0, 170.0, true),
            point(3.0, 4.0, false),
        ];
        let mut course = Course {
            points,
            ..Course::default()
        };
        assert_eq!(scale(&course, Quantity::Pan, [1.0, 3.0]), [0.0, 7.0]);
        course.points[1].values[0] = 6.0;
        assert_eq!(scale(&course, Quantity::Pan, [1.0, 3.0]), [0.0, 6.0]);
        assert_eq!(
            scale(&course, Quantity::Focal, [1.0, 3.0]),
            [1000.0, 1000.0]
        );
        assert_eq!(
            scale(&course, Quantity::Pan, [5.0, 6.0]),
            [0.0, 1.0],
            "nothing is there"
        );
    }

    fn describe(axis: TimeAxis, span: [f64; 2]) -> Vec<String> {
        time_ticks(axis, span, 4.0)
            .into_iter()
            .map(|(_, words)| words)
            .collect()
    }

    #[test]
    fn time_has_numbers_that_a_person_counts_in() {
        assert_eq!(
            describe(TimeAxis::Frame, [1.0, 812.0]),
            ["200", "400", "600", "800"]
        );
        assert_eq!(describe(TimeAxis::Frame, [3.0, 4.0]), ["3", "4"]);
        assert_eq!(
            describe(TimeAxis::Video, [0.0, 100.0]),
            ["0:00", "0:30", "1:00", "1:30"]
        );
        assert_eq!(
            describe(TimeAxis::Video, [3599.0, 9000.0]),
            ["60:00", "90:00", "120:00", "150:00"]
        );
        assert_eq!(
            describe(TimeAxis::Video, [1.0, 2.0]),
            ["1.0 s", "1.2 s", "1.4 s", "1.6 s", "1.8 s", "2.0 s"]
        );
    }
}
