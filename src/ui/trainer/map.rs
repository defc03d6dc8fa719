//! A map over pan and tilt: where references look, which of them the forest finds again, and where
//! a label helps most.

use crate::ui::Panel;
use crate::ui::controls::theme::Themed as _;
use crate::ui::maps::coverage_map::{CoverageMap, label_next, missing};
use egui::{Label, Sense, Stroke, Ui};
use touchline_calibration::proposals::{Coverage, LeftOut, Quality, WRONG_PX};

/// Height of the map, points.
const HEIGHT: f32 = 84.0;

/// The map of the shown frame's camera; `None` if that camera has no reference.
pub fn find_coverage<'a>(panel: &Panel<'_>, maps: &'a [Coverage]) -> Option<&'a Coverage> {
    let frame = panel.app.frame()?;
    maps.iter().find(|map| map.camera == frame.camera)
}

/// Shows the map. Dots are references that were left out of the training; an outline is the shown
/// frame; a pointer at the top shows where a label helps most.
pub fn show(panel: &Panel<'_>, ui: &mut Ui, coverage: &Coverage, quality: Option<&Quality>) {
    let map = CoverageMap::show(ui, coverage, HEIGHT, Sense::hover());
    let app = panel.app;
    if let (Some(camera), Some(frame)) = (&app.current().camera, app.frame()) {
        map.outline(camera, frame.image_size);
    }
    for tested in quality.into_iter().flat_map(|quality| &quality.tested) {
        dot(&map, tested);
    }
    if let Some(pan_deg) = label_next(panel, coverage) {
        map.pointer(pan_deg);
    }
    let tip = "Pan to the right, tilt upwards. Blue: seen by references, the brighter the more. Red: field not seen by any. \
               Dots: references that were left out and found again (green), found wrong (red) or not found (ring). Outline: \
               the shown frame. Pointer from above: where a label helps most.";
    map.response.clone().on_hover_text(tip);
    map.borders(ui);
    ui.add(Label::new(missing(coverage)).wrap());
}

/// Draws a reference that was left out: filled if found, in another colour if found in a wrong
/// place, a ring if not found.
fn dot(map: &CoverageMap<'_>, tested: &LeftOut) {
    let at = map.at(tested.pan_deg, tested.tilt_deg);
    match tested.found {
        Some(found) if found.error_px <= WRONG_PX => {
            map.painter
                .circle_filled(at, 3.0, map.painter.palette().good)
        }
        Some(_) => map
            .painter
            .circle_filled(at, 3.5, map.painter.palette().bad),
        None => map
            .painter
            .circle_stroke(at, 3.0, Stroke::new(1.5, map.painter.palette().caution)),
    };
}
