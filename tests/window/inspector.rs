//! The panels of a frame and of its camera: numbers are typed and dragged, points are listed.

use super::harness::{Window, truth};
use super::solved_frame::{chord, solved_window};
use crate::parts::{Test, tests};
use egui::accesskit::Role;
use egui::{Key, Modifiers, pos2, vec2};
use egui_kittest::kittest::{NodeT as _, Queryable as _};
use touchline::app::session::SidePanel;

pub const TESTS: &[Test] = tests![
    [Adapter] a_typed_number_is_one_step_of_undo_and_escape_none;
    [Adapter] a_dragged_number_is_one_step_and_the_camera_follows;
    [Adapter] points_are_selected_held_out_and_deleted_in_their_list;
    [Adapter] details_unfold_and_say_what_two_points_cannot;
    [Adapter] the_camera_panel_changes_the_base_and_the_overlay_follows;
];

fn undo_name(window: &Window) -> Option<String> {
    window
        .app()
        .open()
        .unwrap()
        .history
        .next_undo()
        .map(|step| step.name.clone())
}

/// Clicks a number field, types and presses a key.
fn type_number(window: &mut Window, name: &str, text: &str, end: Key) {
    window
        .harness
        .get_by_role_and_label(Role::SpinButton, name)
        .click();
    window.harness.run_steps(2);
    chord(window, Modifiers::COMMAND, Key::A);
    window.harness.event(egui::Event::Text(text.to_owned()));
    window.harness.run_steps(2);
    window.key(end);
    window.harness.run_steps(2);
}

fn a_typed_number_is_one_step_of_undo_and_escape_none() {
    let mut window = solved_window();
    let before = window.app().current().camera.unwrap().ptz();
    let step = undo_name(&window);
    type_number(&mut window, "Focal length", "900", Key::Escape);
    assert_eq!(window.app().current().camera.unwrap().ptz(), before);
    // Entered and left: the rounded number in the field is no change.
    window
        .harness
        .get_by_role_and_label(Role::SpinButton, "Pan")
        .click();
    window.harness.run_steps(3);
    window.key(Key::Enter);
    assert_eq!(window.app().current().camera.unwrap().ptz(), before);
    assert_eq!(undo_name(&window), step);
    type_number(&mut window, "Focal length", "900", Key::Enter);
    assert!((window.app().current().camera.unwrap().ptz().focal_px - 900.0).abs() < 1e-9);
    assert_eq!(undo_name(&window).as_deref(), Some("Set focal length"));
    window.harness.get_by_label("Solve again");
    chord(&mut window, Modifiers::COMMAND, Key::Z);
    assert_eq!(window.app().current().camera.unwrap().ptz(), before);
}

fn a_dragged_number_is_one_step_and_the_camera_follows() {
    let mut window = solved_window();
    let before = window.app().current().camera.unwrap().ptz();
    let at = window
        .harness
        .get_by_role_and_label(Role::SpinButton, "Tilt")
        .rect()
        .center();
    window.press(at);
    for moved in 1..=6 {
        window.drag(at + vec2(8.0 * moved as f32, 0.0));
    }
    let during = window.app().current().camera.unwrap().ptz();
    assert!(during.tilt > before.tilt, "{during:?} after {before:?}");
    window.release(at + vec2(48.0, 0.0));
    assert_eq!(undo_name(&window).as_deref(), Some("Set tilt"));
    chord(&mut window, Modifiers::COMMAND, Key::Z);
    assert_eq!(window.app().current().camera.unwrap().ptz(), before);
}

fn points_are_selected_held_out_and_deleted_in_their_list() {
    let mut window = solved_window();
    // The camera is checked against the painted lines in the background, which adds a line to the
    // verdict.
    window.harness.hover_at(pos2(600.0, 400.0));
    window.wait_for(|shell| shell.app().paint_says(0).is_some());
    window.harness.hover_at(pos2(1100.0, 640.0));
    window.harness.run_steps(2);
    window.snapshot_of(
        "inspector",
        egui::Rect::from_min_max(pos2(980.0, 220.0), pos2(1280.0, 696.0)),
    );
    window.press_label("Point 1: Penalty area, far left, front corner, no evidence");
    window.harness.run_steps(2);
    assert_eq!(window.app().session.points.selected, Some(0));
    window.key(Key::ArrowRight);
    assert_eq!(
        undo_name(&window).as_deref(),
        Some("Nudge Penalty area, far left, front corner")
    );
    // A point's buttons stand in the row that is selected or pointed at.
    assert!(window.harness.query_by_label("Check point 2").is_none());
    window.press_label("Point 2: Centre circle meets halfway line, near, no evidence");
    window.harness.run_steps(2);
    window.press_label("Check point 2");
    window.harness.run_steps(2);
    assert!(window.app().frame().unwrap().clicks[1].check);
    assert!(
        window.app().current().click_solution().is_none(),
        "one point is not enough"
    );
    let accept = window.harness.get_by_label("Accept");
    assert!(accept.accesskit_node().is_disabled());
    window.press_label("Delete point 2");
    window.harness.run_steps(2);
    assert_eq!(window.app().frame().unwrap().clicks.len(), 1);
}

fn details_unfold_and_say_what_two_points_cannot() {
    let mut window = solved_window();
    window.press_label("Details");
    window.harness.run_steps(3);
    assert!(window.app().settings.details);
    window
        .harness
        .get_by_label("no evidence: two points always fit");
    window.harness.get_by_label("18.00 m");
}

fn the_camera_panel_changes_the_base_and_the_overlay_follows() {
    let mut window = solved_window();
    window.key(Key::F2);
    assert_eq!(window.app().session.panel, SidePanel::Camera);
    window.harness.hover_at(pos2(1020.0, 40.0));
    window.harness.run_steps(3);
    window.snapshot_of(
        "camera_panel",
        egui::Rect::from_min_max(pos2(980.0, 24.0), pos2(1280.0, 696.0)),
    );
    type_number(&mut window, "Position z", "20", Key::Enter);
    let base = window.app().current().base.unwrap();
    assert!((base.position_m.z - 20.0).abs() < 1e-12);
    assert_eq!(
        window.app().current().camera.unwrap().base().position_m,
        base.position_m
    );
    assert_eq!(undo_name(&window).as_deref(), Some("Move camera"));
    type_number(&mut window, "Roll", "1.5", Key::Enter);
    assert!((window.app().current().base.unwrap().angles().roll.degrees() - 1.5).abs() < 1e-9);
    for _ in 0..2 {
        chord(&mut window, Modifiers::COMMAND, Key::Z);
    }
    assert_eq!(
        window.app().current().base.unwrap().position_m,
        truth(0).base().position_m
    );
}
