//! The numbers of a camera: position, base rotation, lens, stage, sensor, uncertainty. Each can be
//! dragged or typed.

use super::section;
use crate::ui::Panel;
use crate::ui::controls::number::Number;
use crate::ui::controls::show_button;
use crate::ui::controls::theme::{self, Themed as _};
use egui::{Align, Button, Grid, Layout, RichText, Ui, vec2};
use touchline_application::app::{Action, EditAction};
use touchline_core::camera::{BaseAngles, BaseSigma};
use touchline_core::geometry::{Angle, Mat3, Vec3};
use touchline_documents::document::{Camera, CameraSigma, K1Curve, Stage};

/// Width of the sensor of a broadcast camera (2/3 inch), mm. Exports use it where the width is
/// unknown.
const GUESSED_SENSOR_MM: f64 = 9.6;

/// Minimum height of a camera, m.
const LOWEST_M: f64 = 0.1;

/// Width of a number field, points.
pub const FIELD: f32 = 112.0;

/// Width of the first column in the table of uncertainties, points.
const AXIS_LABEL: f32 = 56.0;

/// Shows a number of the camera. `write` puts a changed value into a copy of the camera.
fn row(
    panel: &mut Panel<'_>,
    ui: &mut Ui,
    camera: &Camera,
    label: &str,
    number: Number<'_>,
    write: impl FnOnce(&mut Camera, f64),
) {
    line(ui, label, number.tip, |ui| {
        // The camera is copied only for a change: the field is drawn in every frame of the window.
        number.show(ui, panel.app, panel.actions, |value| {
            let mut changed = camera.clone();
            write(&mut changed, value);
            Action::Edit(EditAction::Camera(Box::new(changed)))
        });
    });
}

/// A label at the left end of a row and its controls at the right end.
pub fn line(ui: &mut Ui, label: &str, tip: &str, value: impl FnOnce(&mut Ui)) {
    ui.horizontal(|ui| {
        ui.label(label).on_hover_text(tip);
        ui.with_layout(Layout::right_to_left(Align::Center), value);
    });
}

/// Shows the position in the frame of the field, m.
pub fn position(panel: &mut Panel<'_>, ui: &mut Ui, camera: &Camera) {
    let Some(position) = camera.position_m else {
        return;
    };
    section(ui, "POSITION");
    // The height has another lower limit than the horizontal coordinates.
    for (axis, label, name, tip) in [
        (
            0,
            "x  along",
            "Position x",
            "Along the field's length from its centre, to the right, m.",
        ),
        (
            1,
            "y  across",
            "Position y",
            "Across the field from its centre, away from the main camera, m.",
        ),
        (2, "z  height", "Position z", "Above the field's centre, m."),
    ] {
        let number = Number {
            name,
            step: "Move camera",
            tip,
            value: position[axis],
            speed: 0.05,
            decimals: 3,
            range: if axis == 2 {
                LOWEST_M..=500.0
            } else {
                -500.0..=500.0
            },
            why: if axis == 2 {
                "a camera stands above the field"
            } else {
                "no camera stands that far from the field"
            },
            suffix: " m",
            width: FIELD,
        };
        row(panel, ui, camera, label, number, |changed, value| {
            let mut moved = position;
            moved[axis] = value;
            changed.position_m = Some(moved);
        });
    }
}

/// The number field of an angle of the base rotation.
struct AngleField {
    name: &'static str,
    tip: &'static str,
    /// The largest angle in both directions, degrees.
    limit_deg: f64,
    of: fn(&mut BaseAngles) -> &mut Angle,
}

/// The angles that make up the base rotation.
const ANGLES: [AngleField; 3] = [
    AngleField {
        name: "Heading",
        tip: "Where pan 0 looks, seen from above: 0 is across the field, positive to the right. \
              Usually 0.",
        limit_deg: 180.0,
        of: |angles| &mut angles.heading,
    },
    AngleField {
        name: "Pitch",
        tip: "The elevation of tilt 0 above the horizon.",
        limit_deg: 89.9,
        of: |angles| &mut angles.pitch,
    },
    AngleField {
        name: "Roll",
        tip: "How far the camera is rotated to its right about the viewing direction.",
        limit_deg: 180.0,
        of: |angles| &mut angles.roll,
    },
];

/// Shows the base rotation as heading, pitch and roll in degrees, and as a matrix.
pub fn rotation(panel: &mut Panel<'_>, ui: &mut Ui, camera: &Camera) {
    let Some(base) = camera.base() else { return };
    section(ui, "BASE ROTATION");
    // The document stores the matrix alone. Each field reads the three angles from it and writes a
    // whole matrix back.
    for angle in ANGLES {
        let mut angles = base.angles();
        let number = Number {
            name: angle.name,
            step: "Rotate camera base",
            tip: angle.tip,
            value: (angle.of)(&mut angles).degrees(),
            speed: 0.02,
            decimals: 4,
            range: -angle.limit_deg..=angle.limit_deg,
            why: "larger angles repeat the same directions",
            suffix: "°",
            width: FIELD,
        };
        row(panel, ui, camera, angle.name, number, |changed, degrees| {
            // The other two angles stay as they are.
            *(angle.of)(&mut angles) = Angle::from_degrees(degrees);
            changed.base_from_world = Some(angles.base_from_world());
        });
    }
    ui.add_space(theme::SPACE);
    matrix(ui, &base.base_from_world);
}

/// Shows the matrix, with a button that copies it.
fn matrix(ui: &mut Ui, base_from_world: &Mat3) {
    // Six decimals are for reading; the copied text has all digits, so that another program gets
    // the same rotation to the bit.
    for line in base_from_world.row_iter() {
        let cells: Vec<String> = line.iter().map(|cell| format!("{cell:+.6}")).collect();
        ui.label(
            RichText::new(cells.join("  "))
                .monospace()
                .color(ui.palette().weak),
        )
        .on_hover_text(
            "base_from_world: rotates directions from world (x right, y away, z up) to base.",
        );
    }
    let copy = ui
        .add(Button::new("Copy matrix").small())
        .on_hover_text("Copy base_from_world as JSON with all digits.");
    if copy.clicked() {
        ui.ctx().copy_text(as_json(base_from_world));
    }
}

/// A matrix as a JSON array of rows, with all digits.
fn as_json(matrix: &Mat3) -> String {
    let rows: Vec<[f64; 3]> = matrix
        .row_iter()
        .map(|row| [row[0], row[1], row[2]])
        .collect();
    serde_json::to_string(&rows).unwrap_or_default()
}

/// Shows principal point, distortion, sensor and stage.
pub fn lens(panel: &mut Panel<'_>, ui: &mut Ui, camera: &Camera) {
    section(ui, "LENS");
    let size = camera.image_size;
    line(ui, "Picture", "The size of this camera's pictures.", |ui| {
        theme::weak(ui, format!("{} × {} px", size.width, size.height));
    });
    // The principal point may be outside the picture, if the picture was cropped.
    let point = |name, tip, value, limit: u32| Number {
        name,
        step: "Move principal point",
        tip,
        value,
        speed: 0.2,
        decimals: 2,
        range: -f64::from(limit)..=2.0 * f64::from(limit),
        why: "the optical axis is not farther from the picture than its own size",
        suffix: " px",
        width: FIELD,
    };
    let centre = camera.principal_point;
    let tip = "Where the optical axis meets the picture, px from its left edge.";
    let x = point("Principal point x", tip, centre.x, size.width);
    row(panel, ui, camera, "Centre x", x, |changed, x| {
        changed.principal_point.x = x;
    });
    let tip = "Where the optical axis meets the picture, px from its top edge.";
    let y = point("Principal point y", tip, centre.y, size.height);
    row(panel, ui, camera, "Centre y", y, |changed, y| {
        changed.principal_point.y = y;
    });
    distortion(panel, ui, camera);
    sensor(panel, ui, camera);
    stage(panel, ui, camera);
}

/// Shows the stage, the coordinate system of exported tracks. Without one, tracks are in the
/// field's coordinates.
fn stage(panel: &mut Panel<'_>, ui: &mut Ui, camera: &Camera) {
    section(ui, "STAGE");
    // Without a stage the numbers show the field's axes; the first change creates one.
    let known = camera
        .stage
        .clone()
        .unwrap_or_else(|| Stage::at(Vec3::zeros()));
    let number = |name, tip, value, limit: f64, suffix| Number {
        name,
        step: "Move stage",
        tip,
        value,
        speed: 0.05,
        decimals: 3,
        range: -limit..=limit,
        why: "a stage is near its field, and a heading is within a full turn",
        suffix,
        width: FIELD,
    };
    for (axis, label, tip) in [
        (
            0,
            "Stage x",
            "The stage's origin along the field's length from its centre, for tracks (OpenTrackIO, FreeD, USD, chan), m.",
        ),
        (
            1,
            "Stage y",
            "The stage's origin across the field from its centre, m.",
        ),
        (
            2,
            "Stage z",
            "The stage's origin above the field's centre, m.",
        ),
    ] {
        let number = number(label, tip, known.origin_m[axis], 500.0, " m");
        row(panel, ui, camera, label, number, |changed, value| {
            let mut origin_m = known.origin_m;
            origin_m[axis] = value;
            changed.stage = Some(Stage {
                origin_m,
                ..known.clone()
            });
        });
    }
    let tip = "Where the stage's y axis looks, seen from above: 0 is across the field, positive to the right.";
    let number = number("Stage heading", tip, known.heading_deg, 180.0, "°");
    row(
        panel,
        ui,
        camera,
        "Stage heading",
        number,
        |changed, heading_deg| {
            changed.stage = Some(Stage {
                heading_deg,
                ..known.clone()
            });
        },
    );
}

/// Shows the width of the sensor: assumed until the user sets or confirms it.
fn sensor(panel: &mut Panel<'_>, ui: &mut Ui, camera: &Camera) {
    let known = camera.sensor_width_mm;
    let number = Number {
        name: "Sensor width",
        step: "Set sensor width",
        tip: "The width of the camera's sensor, for formats in mm (OpenTrackIO, USD, FreeD). Any width gives the same picture.",
        value: known.unwrap_or(GUESSED_SENSOR_MM),
        speed: 0.05,
        decimals: 2,
        range: 1.0..=100.0,
        why: "sensors are between those of phones and of large format",
        suffix: " mm",
        width: FIELD,
    };
    let label = if known.is_some() {
        "Sensor width"
    } else {
        "Sensor width (assumed)"
    };
    row(panel, ui, camera, label, number, |changed, mm| {
        changed.sensor_width_mm = Some(mm);
    });
    // Confirming stores the assumed width as a known one. Begin and End make it one named step of
    // undo, as they do for a number that is dragged.
    let confirm = Button::new("Confirm sensor width").small();
    if known.is_none() && show_button(ui, confirm, "Mark this width as known. One step of undo.") {
        let confirmed = Camera {
            sensor_width_mm: Some(GUESSED_SENSOR_MM),
            ..camera.clone()
        };
        panel.actions.extend([
            Action::Edit(EditAction::Begin("Confirm sensor width")),
            Action::Edit(EditAction::Camera(Box::new(confirmed))),
            Action::Edit(EditAction::End),
        ]);
    }
}

/// Shows k₁ at a focal length, its change with the focal length, and the ratio of k₂ to k₁² if the
/// lens has one.
fn distortion(panel: &mut Panel<'_>, ui: &mut Ui, camera: &Camera) {
    let curve = camera
        .distortion
        .as_ref()
        .and_then(|lens| lens.k1.clone())
        .unwrap_or_default();
    let number = |name, tip, value, speed, decimals, range, suffix| Number {
        name,
        step: "Change distortion",
        tip,
        value,
        speed,
        decimals,
        range,
        why: "no lens of a camera is beyond that",
        suffix,
        width: FIELD,
    };
    // k₁ is linear in the focal length: a value at one focal length, and a slope.
    let tip = "Radial distortion: a point at radius r (in focal lengths) moves outwards by k1·r³. 0: none.";
    let value = number("k1", tip, curve.value, 0.0005, 5, -5.0..=5.0, "");
    row(panel, ui, camera, "k1", value, |changed, value| {
        curve_of(changed).value = value;
    });
    let tip = "The focal length for which k1 is given.";
    let at = number(
        "k1 at focal",
        tip,
        curve.at_focal_px,
        5.0,
        1,
        0.0..=1e6,
        " px",
    );
    row(
        panel,
        ui,
        camera,
        "k1 at focal length",
        at,
        |changed, px| curve_of(changed).at_focal_px = px,
    );
    let tip = "How much k1 changes per 1000 px of focal length.";
    let slope = number(
        "k1 per 1000 px",
        tip,
        curve.per_1000_px,
        0.0005,
        5,
        -5.0..=5.0,
        "",
    );
    row(
        panel,
        ui,
        camera,
        "k1 per 1000 px",
        slope,
        |changed, value| curve_of(changed).per_1000_px = value,
    );
    // Only a lens that has this ratio shows it. With k₂ = s k₁² the radius r (1 + k₁ r² + k₂ r⁴)
    // grows at the rate 1 + 3 k₁ r² + 5 s k₁² r⁴, which has no zero in r² if 9 − 20 s < 0: hence
    // 0.45 in the tooltip.
    if let Some(share) = camera
        .distortion
        .as_ref()
        .and_then(|lens| lens.k2_per_k1_squared)
    {
        let tip = "k2 is this times k1², at every focal length. From 0.45 on the distortion is monotonic: the picture never folds over.";
        let share = number("k2 per k1²", tip, share, 0.005, 3, -10.0..=10.0, "");
        row(panel, ui, camera, "k2 per k1²", share, |changed, value| {
            changed.distortion.get_or_insert_default().k2_per_k1_squared = Some(value);
        });
    }
}

/// The k₁ curve of a camera; a new one if it has none.
fn curve_of(camera: &mut Camera) -> &mut K1Curve {
    camera
        .distortion
        .get_or_insert_default()
        .k1
        .get_or_insert_default()
}

/// Shows 1-σ of the position, m, and of the base rotation about the world's axes, degrees.
pub fn sigma(panel: &mut Panel<'_>, ui: &mut Ui, camera: &Camera) {
    section(ui, "UNCERTAINTY (1-σ)");
    // A camera without a stored σ counts as exactly known (`Camera::base`), so zeros are shown.
    let known = camera.sigma.as_ref();
    let position = known.map_or(Vec3::zeros(), |sigma| sigma.position_m);
    let rotation = known.map_or(Vec3::zeros(), |sigma| sigma.rotation_deg);
    let spacing = [2.0 * theme::SPACE, theme::SPACE];
    let field = ((ui.available_width() - AXIS_LABEL - 3.0 * spacing[0]) / 3.0).floor();
    Grid::new("sigma").num_columns(4).min_col_width(field.min(AXIS_LABEL)).spacing(spacing).show(ui, |ui| {
        ui.allocate_space(vec2(AXIS_LABEL, 0.0));
        for axis in ["x", "y", "z"] {
            theme::small_weak(ui, axis);
        }
        ui.end_row();
        for (label, unit, values, of_position, decimals, limit) in
            [("Position", " m", position, true, 2, 50.0), ("Rotation", "°", rotation, false, 3, 45.0)]
        {
            ui.label(label);
            for (axis, letter) in ["x", "y", "z"].into_iter().enumerate() {
                let what = if of_position { "position" } else { "rotation" };
                let number = Number {
                    name: &format!("Sigma of {what} {letter}"),
                    step: "Change camera sigma",
                    tip: if of_position {
                        "1-σ of the position along this axis, m; 0: exactly known."
                    } else {
                        "1-σ of the base rotation about this axis of the world, degrees; 0: exactly known."
                    },
                    value: values[axis],
                    speed: 0.005,
                    decimals,
                    range: 0.0..=limit,
                    why: "a 1-σ is not negative, and a larger one means that nothing is known",
                    suffix: unit,
                    width: field,
                };
                number.show(ui, panel.app, panel.actions, |value| {
                    let mut changed = camera.clone();
                    // The first change of a camera without a stored σ starts from the default.
                    let sigma = changed
                        .sigma
                        .get_or_insert_with(|| CameraSigma::from(&BaseSigma::default()));
                    if of_position {
                        sigma.position_m[axis] = value;
                    } else {
                        sigma.rotation_deg[axis] = value;
                    }
                    Action::Edit(EditAction::Camera(Box::new(changed)))
                });
            }
            ui.end_row();
        }
    });
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_copied_matrix_reads_back_digit_for_digit() {
        let turned = BaseAngles {
            heading: Angle::from_degrees(12.3),
            ..BaseAngles::default()
        }
        .base_from_world();
        let rows: Vec<[f64; 3]> = serde_json::from_str(&as_json(&turned)).unwrap();
        assert_eq!(Mat3::from_fn(|row, column| rows[row][column]), turned);
    }
}
