//! The camera panel: everything that the frames of one camera share.
//!
//! Sections: estimation of the base from clicks with its evidence, position and
//! rotation, lens, uncertainty, the field, masks. The overlay follows while a number is dragged, so
//! that a base can also be fitted by eye.

mod estimate;
mod evidence;
mod field;
mod masks;
mod numbers;
mod over_time;
mod position_view;

use super::{Panel, inspector};
use crate::ui::controls::symbol::Symbol;
use crate::ui::controls::theme::{Themed as _, section};
use crate::ui::controls::{Heading, symbol, theme};
use crate::ui::maps::paint_map;
use egui::{Button, Frame, Label, Margin, RichText, ScrollArea, Ui, vec2};
use touchline_application::app::{Command, EditAction};
use touchline_core::camera::BaseAngles;
use touchline_core::geometry::{Angle, Vec3, pluralise, thousands};
use touchline_documents::document::Camera;

/// Where fitting by eye begins, behind the near touchline at the halfway line: distance from the
/// touchline, m,
const START_BEHIND_M: f64 = 30.0;
/// and height, m. Typical of a main camera.
const START_HEIGHT_M: f64 = 15.0;
/// Half the width of a soccer field of the default size, m. It stands in where the field is not
/// known.
const USUAL_HALF_WIDTH_M: f64 = 34.0;
/// Maximum height of the map of paint as a share of its width.
const MOST_HIGH: f32 = 0.6;

/// Shows the panel for the camera of the shown frame.
pub fn show(panel: &mut Panel<'_>, ui: &mut Ui) {
    heading(panel, ui);
    let Some(camera) = camera_of(panel) else {
        Frame::new()
            .inner_margin(Margin::symmetric(8, 4))
            .show(ui, |ui| {
                theme::weak(ui, "This frame's camera is not in the document.");
            });
        return;
    };
    // The decision about an estimated base is at the bottom, always in view.
    if panel.app.decides_about_base() {
        inspector::decide(panel, ui);
    }
    ScrollArea::vertical()
        .id_salt("camera panel")
        .auto_shrink(false)
        .show(ui, |ui| {
            Frame::new()
                .inner_margin(Margin {
                    left: 8,
                    right: 12,
                    top: 4,
                    bottom: 12,
                })
                .show(ui, |ui| {
                    ui.set_width(ui.available_width());
                    show_frame_count(panel, ui, &camera);
                    // The sport must be chosen before the first click, so the field comes first;
                    // once the base is known, it comes last.
                    let estimated = has_estimate(panel, &camera);
                    let settled = camera.base().is_some() || estimated;
                    if !settled {
                        field::show(panel, ui);
                    }
                    paint(panel, ui, &camera);
                    estimate::show(panel, ui, &camera);
                    over_time::show(panel, ui, &camera);
                    if camera.base().is_some() {
                        numbers::position(panel, ui, &camera);
                        numbers::rotation(panel, ui, &camera);
                    } else if !settled {
                        no_base(panel, ui, &camera);
                    }
                    numbers::lens(panel, ui, &camera);
                    numbers::sigma(panel, ui, &camera);
                    // The evidence of an estimate has a list of frames of its own.
                    if !estimated {
                        evidence::frames_of_document(panel, ui, &camera);
                    }
                    if settled {
                        field::show(panel, ui);
                    }
                    masks::show(panel, ui, &camera);
                });
        });
}

/// Whether the panel shows an estimated base: one that waits for a decision, or the applied one of
/// this camera.
fn has_estimate(panel: &Panel<'_>, camera: &Camera) -> bool {
    let state = &panel.app.operations.base_estimate;
    let is_of_camera = state
        .applied_base()
        .is_some_and(|found| found.camera == camera.id);
    state.proposed_base().is_some() || is_of_camera
}

/// A copy of the shown frame's camera; of the first camera if there is no frame. The panel shows a
/// copy, because its parts need the panel mutably.
fn camera_of(panel: &Panel<'_>) -> Option<Camera> {
    let open = panel.app.open()?;
    match panel.app.frame() {
        Some(frame) => open.document.camera_of(frame).cloned(),
        None => open
            .document
            .cameras
            .first()
            .map(|camera| (**camera).clone()),
    }
}

/// Shows the title, the name of the camera, and the buttons that load a camera and close the panel.
fn heading(panel: &mut Panel<'_>, ui: &mut Ui) {
    let heading = Heading {
        title: "Camera",
        command: Command::CameraPanel,
        closes: "camera panel",
        behind: "frame",
    };
    heading.show(panel, ui, name, load);
}

/// Shows the name of the camera.
fn name(panel: &mut Panel<'_>, ui: &mut Ui) {
    let name = camera_of(panel)
        .map(|camera| camera.id.as_str().to_owned())
        .unwrap_or_default();
    ui.add(Label::new(RichText::new(name).color(ui.palette().weak)).truncate());
}

/// Shows the button that loads a camera.
fn load(panel: &mut Panel<'_>, ui: &mut Ui) {
    let load = ui.add(Button::new("Load a camera…").small());
    panel.run_on_click(load, Command::LoadCamera);
}

/// Shows how many frames the camera has, or how many are selected, and the button that assigns some
/// to another camera.
fn show_frame_count(panel: &mut Panel<'_>, ui: &mut Ui, camera: &Camera) {
    let Some(open) = panel.app.open() else { return };
    let frames = open.counts().count_of_camera(&camera.id);
    let selected = panel.app.session.frames_selected.len();
    let (all, cameras) = (open.document.frames.len(), open.document.cameras.len());
    let description = match selected {
        0 if cameras == 1 => format!("All {}", pluralise(all, "frame")),
        0 => format!("{} of {}", thousands(frames), pluralise(all, "frame")),
        selected => format!("{} selected", pluralise(selected, "frame")),
    };
    numbers::line(
        ui,
        &description,
        "The frames of this camera. Shift-click or Ctrl-click on the filmstrip selects some.",
        |ui| {
            let give = Button::new("Assign to camera…").small();
            panel.command_button(ui, give, Command::AssignToCamera);
        },
    );
}

/// Shows what to do while the base is unknown.
fn no_base(panel: &mut Panel<'_>, ui: &mut Ui, camera: &Camera) {
    section(ui, "POSITION AND ROTATION");
    ui.add(
        Label::new(
            "Not known yet. It can also be fitted by eye: start from a typical position and drag \
             the numbers until the lines fit.",
        )
        .wrap(),
    );
    ui.add_space(theme::SPACE);
    let start = ui.button("Start from a typical position").on_hover_text(format!(
        "{START_BEHIND_M:.0} m behind the near touchline, at the halfway line, {START_HEIGHT_M:.0} m up, level."
    ));
    if start.clicked() {
        // World y points away from the main camera, so the near touchline is at negative y.
        let half_width_m = panel
            .app
            .current()
            .field()
            .map_or(USUAL_HALF_WIDTH_M, |field| field.width_m / 2.0);
        let mut started = camera.clone();
        started.position_m = Some(Vec3::new(
            0.0,
            -half_width_m - START_BEHIND_M,
            START_HEIGHT_M,
        ));
        started.base_from_world = Some(
            BaseAngles {
                pitch: Angle::ZERO,
                ..BaseAngles::default()
            }
            .base_from_world(),
        );
        panel.edit(EditAction::Camera(Box::new(started)));
    }
}

/// A warning with the buttons that settle it.
fn remark(ui: &mut Ui, text: &str, ways_out: impl FnOnce(&mut Ui)) {
    ui.horizontal_top(|ui| {
        let palette = ui.palette();
        symbol::show(ui, Symbol::Warning, palette.caution);
        ui.vertical(|ui| {
            ui.add(Label::new(text).wrap());
            ui.horizontal(ways_out);
        });
    });
}

/// Shows the map of paint of a camera that was found without a click since the project was opened,
/// and has not been moved since.
fn paint(panel: &mut Panel<'_>, ui: &mut Ui, camera: &Camera) {
    let Some(found) = panel.app.found_camera() else {
        return;
    };
    let has_moved = camera
        .base()
        .is_some_and(|base| base.position_m != found.found.base.position_m);
    if found.camera != camera.id || has_moved {
        return;
    }
    section(ui, "PAINT AND LINES");
    let width = ui.available_width();
    paint_map::show(panel, ui, &found, vec2(width, MOST_HIGH * width));
}
