//! The camera's numbers.

use super::section;
use crate::app::Action;
use crate::camera::BaseAngles;
use crate::geometry::{Angle, Mat3, Vec3};
use crate::project::{Camera, CameraSigma, K1Curve};
use crate::ui::number::Number;
use crate::ui::{Panel, theme};
use egui::{Button, Grid, RichText, Ui};

/// The width of a number field, points.
const FIELD: f32 = 96.0;

/// A number of the camera: what it is called, how it behaves, and how it is written back.
struct Row<'a> {
    label: &'a str,
    name: &'a str,
    step: &'static str,
    tip: &'a str,
    value: f64,
    speed: f64,
    decimals: usize,
    range: std::ops::RangeInclusive<f64>,
    suffix: &'a str,
}

fn row(panel: &mut Panel<'_>, ui: &mut Ui, camera: &Camera, row: Row<'_>, write: impl FnOnce(&mut Camera, f64)) {
    ui.label(row.label).on_hover_text(row.tip);
    let number = Number {
        name: row.name,
        step: row.step,
        tip: row.tip,
        value: row.value,
        speed: row.speed,
        decimals: row.decimals,
        range: row.range,
        suffix: row.suffix,
        width: FIELD,
    };
    number.show(ui, panel.app, panel.actions, |value| {
        let mut changed = camera.clone();
        write(&mut changed, value);
        Action::EditCamera(Box::new(changed))
    });
}

fn grid(ui: &mut Ui, name: &str, rows: impl FnOnce(&mut Ui)) {
    Grid::new(name).num_columns(2).min_col_width(110.0).spacing([8.0, 4.0]).show(ui, rows);
}

/// Position, m.
pub fn position(panel: &mut Panel<'_>, ui: &mut Ui, camera: &Camera) {
    let Some(position) = camera.position_m else { return };
    section(ui, "POSITION");
    grid(ui, "position", |ui| {
        for (axis, label, name, tip) in [
            (0, "x  along", "Position x", "Along the field's length from its centre, to the right, m."),
            (1, "y  across", "Position y", "Across the field from its centre, away from the main camera, m."),
            (2, "z  height", "Position z", "Above the field's centre, m."),
        ] {
            let numbers = Row {
                label,
                name,
                step: "Move camera",
                tip,
                value: position[axis],
                speed: 0.05,
                decimals: 3,
                range: -500.0..=500.0,
                suffix: " m",
            };
            row(panel, ui, camera, numbers, |changed, value| {
                let mut moved = position;
                moved[axis] = value;
                changed.position_m = Some(moved);
            });
            ui.end_row();
        }
    });
}

/// The base rotation as heading, pitch and roll, and as a matrix.
pub fn rotation(panel: &mut Panel<'_>, ui: &mut Ui, camera: &Camera) {
    let Some(base) = camera.base() else { return };
    let angles = base.angles();
    section(ui, "BASE ROTATION");
    grid(ui, "rotation", |ui| {
        let angle = |label, name, tip, angle: Angle, limit: f64| Row {
            label,
            name,
            step: "Turn camera base",
            tip,
            value: angle.degrees(),
            speed: 0.02,
            decimals: 4,
            range: -limit..=limit,
            suffix: "°",
        };
        let write = |changed: &mut Camera, angles: BaseAngles| changed.base_from_world = Some(angles.base_from_world());
        let heading = angle(
            "Heading",
            "Heading",
            "Where pan 0 looks, seen from above: 0 is across the field, positive to the right. Usually 0.",
            angles.heading,
            180.0,
        );
        row(panel, ui, camera, heading, |changed, degrees| {
            write(changed, BaseAngles { heading: Angle::from_degrees(degrees), ..angles });
        });
        ui.end_row();
        let tip = "How far tilt 0 looks above the horizon.";
        row(panel, ui, camera, angle("Pitch", "Pitch", tip, angles.pitch, 89.9), |changed, degrees| {
            write(changed, BaseAngles { pitch: Angle::from_degrees(degrees), ..angles });
        });
        ui.end_row();
        let tip = "How far the camera leans to its right.";
        row(panel, ui, camera, angle("Roll", "Roll", tip, angles.roll, 180.0), |changed, degrees| {
            write(changed, BaseAngles { roll: Angle::from_degrees(degrees), ..angles });
        });
        ui.end_row();
    });
    ui.add_space(theme::SPACE);
    matrix(ui, &base.base_from_world);
}

/// The matrix as text, to be read and copied.
fn matrix(ui: &mut Ui, base_from_world: &Mat3) {
    for line in base_from_world.row_iter() {
        let cells: Vec<String> = line.iter().map(|cell| format!("{cell:+.6}")).collect();
        ui.label(RichText::new(cells.join("  ")).monospace().color(theme::WEAK))
            .on_hover_text("base_from_world: turns a direction in the world (x right, y away, z up) into the base.");
    }
    let copy = ui.add(Button::new("Copy matrix").small()).on_hover_text("Copy base_from_world as JSON, every digit.");
    if copy.clicked() {
        ui.ctx().copy_text(as_json(base_from_world));
    }
}

fn as_json(matrix: &Mat3) -> String {
    let rows: Vec<[f64; 3]> = matrix.row_iter().map(|row| [row[0], row[1], row[2]]).collect();
    serde_json::to_string(&rows).unwrap_or_default()
}

/// Principal point and distortion.
pub fn lens(panel: &mut Panel<'_>, ui: &mut Ui, camera: &Camera) {
    section(ui, "LENS");
    let size = camera.image_size;
    grid(ui, "lens", |ui| {
        ui.label("Picture");
        ui.label(RichText::new(format!("{} × {} px", size.width, size.height)).color(theme::WEAK))
            .on_hover_text("The size of this camera's pictures.");
        ui.end_row();
        let point = |label, name, tip, value, limit: u32| Row {
            label,
            name,
            step: "Move principal point",
            tip,
            value,
            speed: 0.2,
            decimals: 2,
            range: -f64::from(limit)..=2.0 * f64::from(limit),
            suffix: " px",
        };
        let centre = camera.principal_point;
        let tip = "Where the optical axis meets the picture, px from its left edge.";
        row(panel, ui, camera, point("Centre x", "Principal point x", tip, centre.x, size.width), |changed, x| {
            changed.principal_point.x = x;
        });
        ui.end_row();
        let tip = "Where the optical axis meets the picture, px from its top edge.";
        row(panel, ui, camera, point("Centre y", "Principal point y", tip, centre.y, size.height), |changed, y| {
            changed.principal_point.y = y;
        });
        ui.end_row();
        distortion(panel, ui, camera);
    });
}

fn distortion(panel: &mut Panel<'_>, ui: &mut Ui, camera: &Camera) {
    let curve = camera.distortion.as_ref().and_then(|lens| lens.k1.clone()).unwrap_or_default();
    let numbers = |label, name, tip, value, speed, decimals, suffix| Row {
        label,
        name,
        step: "Change distortion",
        tip,
        value,
        speed,
        decimals,
        range: -1e6..=1e6,
        suffix,
    };
    let tip = "Radial distortion: a point at radius r (of the focal length) moves out by k1·r² of r. 0: none.";
    row(panel, ui, camera, numbers("k1", "k1", tip, curve.value, 0.0005, 5, ""), |changed, value| {
        curve_of(changed).value = value;
    });
    ui.end_row();
    let tip = "The focal length at which k1 is as given.";
    row(panel, ui, camera, numbers("at focal", "k1 at focal", tip, curve.at_focal_px, 5.0, 1, " px"), |changed, px| {
        curve_of(changed).at_focal_px = px;
    });
    ui.end_row();
    let tip = "How much k1 changes per 1000 px of focal length.";
    let slope = numbers("per 1000 px", "k1 per 1000 px", tip, curve.per_1000_px, 0.0005, 5, "");
    row(panel, ui, camera, slope, |changed, value| {
        curve_of(changed).per_1000_px = value;
    });
    ui.end_row();
}

/// The camera's k1 curve, made if it has none.
fn curve_of(camera: &mut Camera) -> &mut K1Curve {
    camera.distortion.get_or_insert_default().k1.get_or_insert_default()
}

/// How far position and rotation are known.
pub fn sigma(panel: &mut Panel<'_>, ui: &mut Ui, camera: &Camera) {
    section(ui, "HOW FAR THIS IS KNOWN (1-σ)");
    let known = camera.sigma.as_ref();
    let position = known.map_or(Vec3::zeros(), |sigma| sigma.position_m);
    let rotation = known.map_or(Vec3::zeros(), |sigma| sigma.rotation_deg);
    let written = |camera: &mut Camera, change: &dyn Fn(&mut CameraSigma)| {
        let none =
            CameraSigma { position_m: Vec3::zeros(), rotation_deg: Vec3::zeros(), extra: serde_json::Map::new() };
        change(camera.sigma.get_or_insert(none));
    };
    Grid::new("sigma").num_columns(4).spacing([6.0, 4.0]).show(ui, |ui| {
        ui.label("");
        for axis in ["x", "y", "z"] {
            ui.label(RichText::new(axis).small().color(theme::WEAK));
        }
        ui.end_row();
        for (label, unit, values, of_position, decimals, limit) in
            [("Place", " m", position, true, 2, 50.0), ("Turn", "°", rotation, false, 3, 45.0)]
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
                    suffix: unit,
                    width: 62.0,
                };
                number.show(ui, panel.app, panel.actions, |value| {
                    let mut changed = camera.clone();
                    written(&mut changed, &|sigma| {
                        if of_position {
                            sigma.position_m[axis] = value;
                        } else {
                            sigma.rotation_deg[axis] = value;
                        }
                    });
                    Action::EditCamera(Box::new(changed))
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
        let turned = BaseAngles { heading: Angle::from_degrees(12.3), ..BaseAngles::default() }.base_from_world();
        let rows: Vec<[f64; 3]> = serde_json::from_str(&as_json(&turned)).unwrap();
        assert_eq!(Mat3::from_fn(|row, column| rows[row][column]), turned);
    }
}
