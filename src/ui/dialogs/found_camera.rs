//! What the search for a camera has found: the panorama of paint with the field's lines, which shows
//! at a glance whether the camera is right, and what comes next.

use super::{closing_button, sheet};
use crate::ui::Panel;
use crate::ui::controls::theme::{self, Themed as _};
use crate::ui::maps::paint_map;
use egui::{Button, Context, Label, vec2};
use std::time::Duration;
use touchline_application::app::operations::describe_found;
use touchline_application::app::{Command, describe_estimate};
use touchline_core::geometry::pluralise;

/// Height of the map as a share of the window's.
const MAP: f32 = 0.55;

/// The time that the forest takes for a frame, on two cores: `tests/benches/forest.md`.
const SECONDS_A_FRAME: f64 = 0.1;

/// Shows the dialog.
pub fn show(panel: &mut Panel<'_>, ctx: &Context) {
    let Some(found) = panel.app.found_camera() else {
        panel.close_dialog();
        return;
    };
    let window = ctx.content_rect().size();
    let size = vec2(0.8 * window.x, 0.85 * window.y);
    sheet(panel, ctx, "Camera found", size, |panel, ui| {
        let map = vec2(ui.available_width(), MAP * window.y);
        if paint_map::show(panel, ui, &found, map) {
            panel.close_dialog();
        }
        ui.add_space(2.0 * theme::SPACE);
        ui.add(Label::new(describe_found(&found.found)).wrap());
        theme::weak_text(ui, next(panel));
        ui.add_space(2.0 * theme::SPACE);
        ui.horizontal(|ui| {
            let review = Button::new("Review").fill(ui.palette().accent_ground);
            closing_button(panel, ui, review, Command::ReviewPanel);
            closing_button(panel, ui, Button::new("Map"), Command::CameraPanel);
            closing_button(panel, ui, Button::new("Undo"), Command::Undo);
        });
    });
}

/// What comes next, and how long it takes.
fn next(panel: &Panel<'_>) -> String {
    let left = panel.app.open().map_or(0, |open| {
        open.document
            .frames
            .iter()
            .filter(|frame| frame.ptz.is_none() && frame.is_open())
            .count()
    });
    if left == 0 {
        return "Every frame has a camera now: look at some and accept them.".to_owned();
    }
    let time = Duration::from_secs_f64(SECONDS_A_FRAME * left as f64);
    format!(
        "Next: accept those that are right. The forest learns from them and proposes the cameras \
         of {}: {}.",
        pluralise(left, "other frame"),
        describe_estimate(time)
    )
}
