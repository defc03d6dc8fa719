//! Pan, tilt, focal length and field of view of the shown frame. They can be dragged or typed.

use crate::ui::Panel;
use crate::ui::controls::number::Number;
use crate::ui::controls::show_button;
use crate::ui::controls::theme::{self};
use egui::{Align, Button, Layout, Ui};
use std::ops::RangeInclusive;
use touchline_application::app::quality::Quantity;
use touchline_application::app::{Action, App, EditAction};
use touchline_core::camera::Ptz;
use touchline_core::geometry::{Angle, pluralise};
use touchline_documents::document::{Frame, FramePtz, SolutionSource};

/// Width of a label, points.
const LABEL: f32 = 34.0;
/// Gap between two columns, points.
const GAP: f32 = 8.0;
/// Initial tilt when numbers are set by hand.
const START_TILT_DEG: f64 = -10.0;
/// Initial focal length when numbers are set by hand, in widths of the picture.
const START_FOCAL_WIDTHS: f64 = 1.2;

/// The smallest and the largest horizontal field of view that is accepted, degrees.
const NARROWEST_DEG: f64 = 0.5;
const WIDEST_DEG: f64 = 150.0;
/// The reason that a user sees for a value outside that range.
const VIEWS: &str = "lenses show between 0.5° and 150°";

/// Shows the numbers with their source; without a camera, how to get one.
pub fn show(panel: &mut Panel<'_>, ui: &mut Ui) {
    let app = panel.app;
    let Some(frame) = app.frame() else { return };
    ui.horizontal(|ui| {
        theme::title(ui, "CAMERA");
        ui.with_layout(Layout::right_to_left(Align::Center), |ui| {
            theme::small_weak(ui, source(app, frame));
        });
    });
    let shown = app.shown_values();
    // A frame without a base may still have recorded numbers.
    let recorded = frame
        .ptz
        .as_ref()
        .filter(|_| !shown.is_estimated)
        .map(FramePtz::ptz);
    match shown.camera.map(|camera| camera.ptz()).or(recorded) {
        Some(ptz) => {
            numbers(panel, ui, ptz, f64::from(frame.image_size.width));
            below(panel, ui, frame);
        }
        None => show_unsolved(panel, ui, frame),
    }
}

/// Says where the numbers come from.
fn source(app: &App, frame: &Frame) -> String {
    let shown = app.shown_values();
    if shown.is_estimated {
        return "with the estimated base".to_owned();
    }
    if shown.camera.is_none() && frame.ptz.is_none() {
        return String::new();
    }
    // A proposal that a point has corrected keeps its source, so the specific cases come first.
    match frame.source() {
        Some(SolutionSource::Clicks) => from_points(frame),
        Some(SolutionSource::Points) => "from points of a model".to_owned(),
        Some(SolutionSource::Manual) => "set manually".to_owned(),
        Some(SolutionSource::Forest) if frame.clicks.iter().any(|click| click.target.is_some()) => {
            "proposed, corrected with a point".to_owned()
        }
        Some(SolutionSource::Forest) if frame.is_snapped_proposal() => {
            "proposed, aligned to the paint".to_owned()
        }
        Some(SolutionSource::Forest) => "proposed".to_owned(),
        Some(SolutionSource::Tracking) => "tracked".to_owned(),
        Some(SolutionSource::Interpolated) => "between its neighbours".to_owned(),
        Some(SolutionSource::Markings) => "aligned to the paint".to_owned(),
        Some(SolutionSource::Import) => "imported".to_owned(),
        None if frame.ptz.is_none() => from_points(frame),
        None => "from the document".to_owned(),
    }
}

/// "from n points": those with a name, without check points.
fn from_points(frame: &Frame) -> String {
    let used = frame
        .clicks
        .iter()
        .filter(|click| !click.check && click.target.is_some())
        .count();
    format!("from {}", pluralise(used, "point"))
}

/// Shows the four numbers in two columns. Field of view and focal length are one quantity, so
/// changing one changes the other.
fn numbers(panel: &mut Panel<'_>, ui: &mut Ui, ptz: Ptz, width_px: f64) {
    let editable = panel.app.current().base.is_some() && !panel.app.shown_values().is_estimated;
    let app = panel.app;
    let actions = &mut *panel.actions;
    // Both columns of fields share the width that labels and gaps leave.
    let field = ((ui.available_width() - 2.0 * LABEL - 3.0 * GAP) / 2.0).floor();
    // Each number replaces one value of the present camera, so the others stay as they are.
    ui.add_enabled_ui(editable, |ui| {
        egui::Grid::new("solution")
            .num_columns(4)
            .min_col_width(LABEL)
            .spacing([GAP, theme::SPACE])
            .show(ui, |ui| {
                let number = Number {
                    name: "Pan",
                    step: Quantity::Pan.edit_step(),
                    tip: "Pan, degrees; positive to the right.",
                    value: ptz.pan.degrees(),
                    speed: 0.02,
                    decimals: 3,
                    range: -180.0..=180.0,
                    why: "that is a full turn",
                    suffix: "°",
                    width: field,
                };
                ui.label("Pan");
                number.show(ui, app, actions, |degrees| {
                    Action::Edit(EditAction::Ptz(Ptz {
                        pan: Angle::from_degrees(degrees),
                        ..ptz
                    }))
                });
                ui.label("Focal");
                let number = Number {
                    name: "Focal length",
                    step: Quantity::Focal.edit_step(),
                    tip: "Focal length, px of the picture.",
                    value: ptz.focal_px,
                    // In proportion to the value: a point of dragging zooms by the same factor
                    // everywhere.
                    speed: ptz.focal_px / 500.0,
                    decimals: 1,
                    range: focal_range_px(width_px),
                    why: VIEWS,
                    suffix: " px",
                    width: field,
                };
                number.show(ui, app, actions, |focal_px| {
                    Action::Edit(EditAction::Ptz(Ptz { focal_px, ..ptz }))
                });
                ui.end_row();
                ui.label("Tilt");
                let number = Number {
                    name: "Tilt",
                    step: Quantity::Tilt.edit_step(),
                    tip: "Tilt, degrees; positive upwards.",
                    value: ptz.tilt.degrees(),
                    speed: 0.02,
                    decimals: 3,
                    range: TILT_DEG,
                    why: "that is straight down to straight up",
                    suffix: "°",
                    width: field,
                };
                number.show(ui, app, actions, |degrees| {
                    Action::Edit(EditAction::Ptz(Ptz {
                        tilt: Angle::from_degrees(degrees),
                        ..ptz
                    }))
                });
                ui.label("View");
                let number = Number {
                    name: "Field of view",
                    step: "Set field of view",
                    tip: "The horizontal field of view, degrees; equivalent to the focal length.",
                    value: view_deg(ptz.focal_px, width_px),
                    speed: 0.05,
                    decimals: 2,
                    range: NARROWEST_DEG..=WIDEST_DEG,
                    why: VIEWS,
                    suffix: "°",
                    width: field,
                };
                number.show(ui, app, actions, |degrees| {
                    Action::Edit(EditAction::Ptz(Ptz {
                        focal_px: focal_px(degrees, width_px),
                        ..ptz
                    }))
                });
                ui.end_row();
            });
    });
}

const UNCERTAINTY_TIP: &str = "1-σ of the drawn lines at the worst corner of the picture, \
                               including the uncertainty of the base.";

/// Shows 1-σ at the worst corner, and the button that discards numbers set by hand.
fn below(panel: &mut Panel<'_>, ui: &mut Ui, frame: &Frame) {
    // The uncertainty that was computed here, or else the one that the document records.
    let shown = panel.app.shown_values();
    let recorded = panel.app.open().filter(|_| !shown.is_estimated);
    let recorded = recorded.and_then(|open| open.document.overlay_sigma(frame));
    let solved = shown.click_solution();
    let sigma_px = match solved {
        Some(solved) => Some(solved.worst_corner_sigma_px),
        None => recorded.map(|sigma| sigma.px),
    };
    let unused_base_px = recorded
        .filter(|_| solved.is_none())
        .and_then(|sigma| sigma.unused_base_px);
    ui.horizontal(|ui| {
        match sigma_px.filter(|sigma| sigma.is_finite()) {
            Some(sigma) => {
                ui.label("Worst corner");
                theme::strong(ui, format!("±{sigma:.1} px"));
            }
            None => {
                theme::weak(ui, "Uncertainty unknown");
            }
        }
        if panel.app.current().by_hand && !shown.is_estimated && !frame.clicks.is_empty() {
            ui.with_layout(Layout::right_to_left(Align::Center), |ui| {
                let about = "Solve from the points again and discard the numbers set manually.";
                if show_button(ui, Button::new("Solve again").small(), about) {
                    panel.edit(EditAction::SolveAgain);
                }
            });
        }
    })
    .response
    .on_hover_text(match unused_base_px {
        Some(px) => format!(
            "1-σ of the drawn lines at the worst corner of the picture, as the confidence takes \
             it. The uncertainty of the base would add ±{px:.0} px, but frames that look this way \
             confirm the base."
        ),
        None => UNCERTAINTY_TIP.to_owned(),
    });
}

/// Says why there are no numbers yet, and offers to set them by hand.
fn show_unsolved(panel: &mut Panel<'_>, ui: &mut Ui, frame: &Frame) {
    // From what stands in the way to what the user can do: an estimated base is shown, there is no
    // base, or nothing has been solved yet.
    if panel.app.shown_values().is_estimated {
        theme::weak(ui, "No points here to solve with the estimated base.");
        return;
    }
    if panel.app.current().base.is_none() {
        theme::weak(ui, "The camera's position is not known yet.");
        return;
    }
    theme::weak(ui, "Not solved yet.");
    let by_hand = ui
        .button("Set manually")
        .on_hover_text("Start from a typical view and drag pan, tilt and focal length.");
    if by_hand.clicked() {
        let focal_px = START_FOCAL_WIDTHS * f64::from(frame.image_size.width);
        panel.edit(EditAction::Ptz(Ptz::from_degrees(
            0.0,
            START_TILT_DEG,
            focal_px,
        )));
    }
}

/// The horizontal field of view of a focal length, degrees. Without distortion.
fn view_deg(focal_px: f64, width_px: f64) -> f64 {
    2.0 * (width_px / 2.0 / focal_px).atan().to_degrees()
}

/// The tilts that are accepted, degrees: straight down to straight up.
pub const TILT_DEG: RangeInclusive<f64> = -90.0..=90.0;

/// The focal lengths that are accepted, px.
pub fn focal_range_px(width_px: f64) -> RangeInclusive<f64> {
    focal_px(WIDEST_DEG, width_px)..=focal_px(NARROWEST_DEG, width_px)
}

/// The focal length of a horizontal field of view in degrees, px. The inverse of [`view_deg`].
fn focal_px(view_deg: f64, width_px: f64) -> f64 {
    width_px / 2.0 / (view_deg.to_radians() / 2.0).tan()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_field_of_view_is_a_focal_length() {
        assert!((view_deg(640.0, 1280.0) - 90.0).abs() < 1e-12);
        for view in [2.0, 43.4, 120.0] {
            assert!((view_deg(focal_px(view, 1920.0), 1920.0) - view).abs() < 1e-9);
        }
    }
}
