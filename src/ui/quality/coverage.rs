//! A map over pan and tilt of where references and suggestions look. A click shows the nearest
//! frame.

use super::{card, legend};
use crate::ui::Panel;
use crate::ui::controls::theme::{self, Themed as _};
use crate::ui::maps::coverage_map::{CoverageMap, coverage_colour, label_next, missing};
use crate::ui::rows::menu::file_name;
use egui::{Color32, CursorIcon, Label, Painter, Pos2, Rect, Sense, Stroke, Ui, vec2};
use touchline_application::app::quality::{CoursePoint, CoverageComparison, PointKind};
use touchline_application::app::where_to_label::whole_degrees;
use touchline_calibration::proposals::Coverage;

/// Height of the map: the minimum in points, and the share of its width above it.
const HEIGHT: f32 = 120.0;
const HEIGHT_SHARE: f32 = 0.3;

/// The text while there is no base.
const NOTHING: &str = "This map of pan and tilt shows where references look, once the camera's base is known and a frame is accepted.";

/// Shows the card: the map, what is missing in words, the legend.
pub fn show(panel: &mut Panel<'_>, ui: &mut Ui) {
    let seen = panel.app.quality().seen.as_ref();
    card(
        panel,
        ui,
        "WHERE FRAMES LOOK",
        |_, _| {},
        |panel, ui| {
            let Some(seen) = seen else {
                theme::weak_text(ui, NOTHING);
                return;
            };
            let height = HEIGHT.max(HEIGHT_SHARE * ui.available_width());
            let map = CoverageMap::show(ui, &seen.references, height, Sense::click());
            map.dots(&seen.suggestions, ui.palette().caution);
            // The map is of one camera: the shown frame is outlined only if it belongs to it.
            if let (Some(camera), Some(frame)) = (&panel.app.current().camera, panel.app.frame())
                && panel.app.quality().camera.as_ref() == Some(&frame.camera)
            {
                map.outline(camera, frame.image_size);
            }
            // Where a label helps most.
            if let Some(pan_deg) = label_next(panel, &seen.references) {
                map.pointer(pan_deg);
            }
            if let Some(pointer) = map.response.hover_pos() {
                read_pointer(panel, ui, &map, seen, pointer);
            }
            map.borders(ui);
            let words = if is_empty(&seen.references) {
                NOTHING_ACCEPTED.to_owned()
            } else {
                missing(&seen.references)
            };
            ui.add(Label::new(words).wrap());
            keys(ui, seen);
        },
    );
}

/// The text while nothing is accepted: then all of the field is missing.
const NOTHING_ACCEPTED: &str = "No frame of this camera is accepted yet.";

/// Whether no frame sees any direction.
fn is_empty(coverage: &Coverage) -> bool {
    coverage.cells.iter().all(|cell| cell.references == 0)
}

/// Shows the legend of the colours.
fn keys(ui: &mut Ui, seen: &CoverageComparison) {
    let palette = ui.palette();
    ui.horizontal_wrapped(|ui| {
        legend::entry(
            ui,
            "seen by 1 reference",
            square(coverage_colour(palette, 1), 9.0),
        );
        legend::entry(ui, "by 4 or more", square(coverage_colour(palette, 4), 9.0));
        legend::entry(ui, "field not seen by any", square(palette.missing, 9.0));
        if !is_empty(&seen.suggestions) {
            legend::entry(ui, "seen by a suggestion", square(palette.caution, 4.0));
        }
    });
}

/// Draws the mark of a colour in the legend.
fn square(colour: Color32, side: f32) -> impl Fn(&Painter, Pos2) {
    move |painter: &Painter, at: Pos2| {
        painter.rect_filled(Rect::from_center_size(at, vec2(side, side)), 0.0, colour);
    }
}

/// Describes the direction under the pointer, and which frame a click shows: the one that looks
/// nearest to it. References and suggestions count, drafts do not.
fn read_pointer(
    panel: &mut Panel<'_>,
    ui: &Ui,
    map: &CoverageMap<'_>,
    looks: &CoverageComparison,
    pointer: Pos2,
) {
    let Some((cell, [pan_deg, tilt_deg])) = map.under(pointer) else {
        return;
    };
    let app = panel.app;
    let on_map = |point: &CoursePoint| map.at(point.values[0], point.values[1]);
    // The nearest reference or suggestion on the map; drafts do not count.
    let looking = app
        .quality()
        .course
        .points
        .iter()
        .filter(|point| point.kind != PointKind::Draft);
    let nearest = looking.min_by(|a, b| {
        let [a, b] = [a, b].map(|point| on_map(point).distance_sq(pointer));
        a.total_cmp(&b)
    });
    // How many frames see this direction, and which one a click shows.
    let seen = format!(
        "Pan {}, tilt {}: seen in {} and {}.",
        whole_degrees(pan_deg),
        whole_degrees(tilt_deg),
        legend::describe_count(
            PointKind::Reference,
            frames_that_see(&looks.references, cell)
        ),
        legend::describe_count(
            PointKind::Suggested,
            frames_that_see(&looks.suggestions, cell)
        )
    );
    let Some((point, frame)) =
        nearest.and_then(|point| Some((point, app.open()?.frame(point.frame)?)))
    else {
        map.response.clone().on_hover_text_at_pointer(seen);
        return;
    };
    map.painter
        .circle_stroke(on_map(point), 4.0, Stroke::new(1.5, ui.palette().strong));
    ui.ctx().set_cursor_icon(CursorIcon::PointingHand);
    let name = file_name(&frame.name());
    let text = format!("{seen} Click to go to {name}, whose centre is nearest.");
    map.response.clone().on_hover_text_at_pointer(text);
    if map.response.clicked() {
        panel.look_at(point.frame, None);
    }
}

/// The number of frames that see a cell of the map.
fn frames_that_see(coverage: &Coverage, cell: usize) -> usize {
    coverage
        .cells
        .get(cell)
        .map_or(0, |cell| cell.references as usize)
}
