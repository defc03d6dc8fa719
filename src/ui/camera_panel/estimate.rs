//! Estimating the camera's base from clicks: what is needed, the progress, the result.

use super::{evidence, section};
use crate::ui::Panel;
use crate::ui::controls::theme::{self, Themed as _};
use egui::{Button, Frame, Grid, Margin, RichText, Ui};
use touchline_application::app::{Command, Keymap};
use touchline_calibration::calibrate::{BaseReadiness, EstimatedBase};
use touchline_core::geometry::{pluralise, thousands};
use touchline_documents::document::Camera;

/// Shows the state of the estimation: proposed, applied, or what there is to estimate from.
pub fn show(panel: &mut Panel<'_>, ui: &mut Ui, camera: &Camera) {
    let state = &panel.app.operations.base_estimate;
    // While an estimation runs, its card says how far it is.
    if state.running().is_some() {
        return;
    }
    section(ui, "BASE FROM THE FRAMES");
    // A proposal waits for a decision, so it is shown in the frames of other cameras as well. An
    // applied estimate is history and belongs to its own camera.
    if let Some(found) = state.proposed_base() {
        show_proposal(panel, ui, found);
        evidence::show(panel, ui, found);
    } else if let Some(found) = state
        .applied_base()
        .filter(|found| found.camera == camera.id)
    {
        summary(ui, found);
        start(panel, ui, camera);
        evidence::show(panel, ui, found);
    } else {
        start(panel, ui, camera);
    }
}

/// Shows the choice to use painted lines, and the button that estimates again. What a first
/// estimate needs, and its button, are on the card above the panel.
fn start(panel: &mut Panel<'_>, ui: &mut Ui, camera: &Camera) {
    let ready = panel.app.base_readiness();
    let mut on_paint = panel.app.settings.base_on_paint;
    let tick = ui.checkbox(&mut on_paint, "Use the painted lines too");
    if tick.on_hover_text(Command::BaseOnPaint.about()).changed() {
        panel.run(Command::BaseOnPaint);
    }
    ui.horizontal(|ui| {
        if camera.base().is_some() {
            let again = Button::new(RichText::new("Estimate again").strong());
            let button = ui.add_enabled(ready.frames > 0, again);
            let button = button.on_disabled_hover_text(ready.describe());
            panel.run_on_click(button, Command::EstimateBase);
        }
        theme::weak(ui, describe_readiness(&ready));
    });
}

/// The number of frames and points that an estimate would use.
fn describe_readiness(ready: &BaseReadiness) -> String {
    let left_out = if ready.left_out > 0 {
        format!(", {} left out", thousands(ready.left_out))
    } else {
        String::new()
    };
    format!(
        "{}, {}{left_out}",
        pluralise(ready.frames, "frame"),
        pluralise(ready.clicks, "point")
    )
}

/// Shows a result that is not applied yet. The main button of the panel decides about it.
fn show_proposal(panel: &mut Panel<'_>, ui: &mut Ui, found: &EstimatedBase) {
    let card = Frame::new()
        .fill(ui.palette().raised)
        .corner_radius(6)
        .inner_margin(Margin::same(8));
    card.show(ui, |ui| {
        ui.set_width(ui.available_width());
        summary(ui, found);
        ui.add_space(theme::SPACE);
        if panel.app.current().base.is_some() {
            theme::weak_text(ui, describe_shown_base(&panel.app.settings.keys));
        }
    });
}

/// Says which base is shown, and how to see the current one.
fn describe_shown_base(keys: &Keymap) -> String {
    let hint = keys.with_key(Command::Compare, |key| {
        format!(" Hold {key} for the current one.")
    });
    format!("Picture and numbers show this base.{hint}")
}

/// The median and the 90 % quantile of errors, px. The quantile is infinite where a tenth of the
/// points has no projection.
fn describe_fit(median_px: f64, p90_px: f64) -> String {
    if p90_px.is_finite() {
        format!("{median_px:.1} px median, {p90_px:.1} px 90 %")
    } else {
        format!("{median_px:.1} px median, 10 % or more out of view")
    }
}

/// Shows the numbers of an estimate with their 1-σ. Lengths are m in the field's frame, fits are
/// px.
fn summary(ui: &mut Ui, found: &EstimatedBase) {
    let estimate = &found.estimate;
    let (position, sigma) = (estimate.base.position_m, estimate.base.sigma.position_m);
    Grid::new("estimate").num_columns(2).min_col_width(84.0).spacing([8.0, 2.0]).show(ui, |ui| {
        let mut row = |name: &str, value: String, tip: &str| {
            theme::weak(ui, name).on_hover_text(tip);
            theme::strong(ui, value).on_hover_text(tip);
            ui.end_row();
        };
        let fit = describe_fit(estimate.median_px, estimate.p90_px);
        row("Points fit", fit, "The distances of all points from their projections with this base.");
        // The median is infinite where the current base gives no frame a camera.
        if let Some(before) = estimate.previous_median_px.filter(|px| px.is_finite()) {
            row("Before", format!("{before:.1} px median"), "The same points with the current base.");
        }
        // With painted lines: how much paint was seen, and how well it fits with this base and with
        // the base of the points alone. Both are measured at paint that no fit has used.
        if let Some(on_paint) = &found.on_paint {
            let seen = &on_paint.seen;
            let counts = [(seen.places, "place"), (seen.lines, "line"), (seen.frames, "frame")];
            let seen_in = counts.map(|(count, noun)| pluralise(count, noun)).join(", ");
            row("Paint seen", seen_in, "Where painted lines were used.");
            for (name, errors, tip) in [
                (
                    "Paint fits",
                    seen.after.paint,
                    "Errors at painted lines that were held out: each frame's camera is fitted to \
                    half of its paint and measured at the other half, with a base estimated without that frame.",
                ),
                ("Before", seen.before.paint, "The same paint with the base that the points alone give."),
            ] {
                let shown =
                    errors.map(|errors| format!("{:.2} px median, {:.2} px 90 %", errors.median_px, errors.p90_px));
                row(name, shown.unwrap_or_else(|| "too little paint to tell".to_owned()), tip);
            }
        }
        let metres = |value: f64, sigma: f64| format!("{value:.2} ± {sigma:.2} m");
        row("x along", metres(position.x, sigma.x), "Along the field's length from its centre, with its 1-σ.");
        row("y across", metres(position.y, sigma.y), "Across the field from its centre, with its 1-σ.");
        row("Height", metres(position.z, sigma.z), "Above the field's centre, with its 1-σ.");
        row(
            "Crown",
            format!("{:.2} m", estimate.crown_m),
            "How much higher the middle of the field is than the touchlines.",
        );
    });
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_of_frames_and_points_have_thousands_separators() {
        let ready = BaseReadiness {
            frames: 1,
            clicks: 12345,
            left_out: 1000,
            ..BaseReadiness::default()
        };
        assert_eq!(
            describe_readiness(&ready),
            "1 frame, 12,345 points, 1,000 left out"
        );
    }

    #[test]
    fn points_without_a_projection_are_said_to_be_out_of_view() {
        assert_eq!(describe_fit(1.5, 3.0), "1.5 px median, 3.0 px 90 %");
        let text = "1.5 px median, 10 % or more out of view";
        assert_eq!(describe_fit(1.5, f64::INFINITY), text);
    }

    #[test]
    fn the_current_base_is_mentioned_only_with_a_key_that_shows_it() {
        let mut keys = Keymap::default();
        let text = "Picture and numbers show this base. Hold B for the current one.";
        assert_eq!(describe_shown_base(&keys), text);
        keys.assign(Command::ZoomToFit, "B".parse().unwrap());
        let text = "Picture and numbers show this base.";
        assert_eq!(describe_shown_base(&keys), text);
    }
}
