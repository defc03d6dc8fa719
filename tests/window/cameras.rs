//! Frames selected on the filmstrip and assigned to a camera, and the venue in the camera panel.

use super::harness::Window;
use crate::parts::{Test, tests};
use egui::accesskit::Role;
use egui::{Key, Modifiers};
use egui_kittest::kittest::Queryable as _;
use touchline::app::Command;
use touchline::app::session::{Dialog, SidePanel};

pub const TESTS: &[Test] = tests![
    [Adapter] frames_selected_on_the_filmstrip_are_given_to_a_new_camera;
    [Adapter] the_size_of_the_field_is_confirmed_in_the_panel;
];

const SIZE: [f32; 2] = [1280.0, 720.0];

/// Opens the camera panel with its key.
fn camera_panel(window: &mut Window) {
    window.key(Key::F2);
    window.harness.run_steps(3);
    assert_eq!(window.app().session.panel, SidePanel::Camera);
}

fn select(window: &mut Window, frame: usize, modifiers: Modifiers) {
    window
        .harness
        .get_by_label_contains(&format!("Frame {frame}, "))
        .click_modifiers(modifiers);
    window.harness.run_steps(3);
}

fn frames_selected_on_the_filmstrip_are_given_to_a_new_camera() {
    let mut window = Window::open(5, SIZE, 1.0);
    select(&mut window, 2, Modifiers::SHIFT);
    select(&mut window, 4, Modifiers::COMMAND);
    let selected: Vec<usize> = window
        .app()
        .session
        .frames_selected
        .iter()
        .copied()
        .collect();
    assert_eq!(
        (selected, window.app().session.frame),
        (vec![0, 1, 2, 4], 0)
    );
    camera_panel(&mut window);
    window.harness.get_by_label("4 frames selected");
    window.press_label("Assign to camera…");
    window.harness.run_steps(3);
    assert!(matches!(
        window.app().session.dialog,
        Some(Dialog::AssignToCamera(_))
    ));
    window.harness.get_by_label("Selected frames (4)");
    window
        .harness
        .get_by_role_and_label(Role::TextInput, "Name of the new camera")
        .focus();
    window.harness.run_steps(2);
    window
        .harness
        .key_press_modifiers(Modifiers::COMMAND, Key::A);
    window.harness.run_steps(2);
    window.type_text("high behind");
    window.press_label("Create and assign");
    window.harness.run_steps(3);
    let open = window.app().open().unwrap();
    let cameras: Vec<&str> = open
        .document
        .frames
        .iter()
        .map(|frame| frame.camera.as_str())
        .collect();
    assert_eq!(
        cameras,
        [
            "high behind",
            "high behind",
            "high behind",
            "main",
            "high behind"
        ]
    );
    assert!(
        window.app().session.dialog.is_none() && window.app().session.frames_selected.is_empty()
    );
    select(&mut window, 3, Modifiers::NONE);
    assert_eq!(
        window.app().session.frame,
        3,
        "a plain click goes there and selects nothing"
    );
}

fn the_size_of_the_field_is_confirmed_in_the_panel() {
    let mut window = Window::open(1, [1280.0, 1600.0], 1.0);
    camera_panel(&mut window);
    window
        .harness
        .get_by_label("Field size 105 × 68 m is assumed.");
    window.harness.get_by_role_and_label(
        Role::Image,
        "Length and width are measured to the outer edge of the lines.",
    );
    window.harness.get_by_label("90 to 120 m. IFAB Law 1.3");
    window.press_label("Confirm");
    window.harness.run_steps(3);
    window.harness.get_by_label("Size confirmed");
    assert!(window.app().why_not(Command::ConfirmFieldSize).is_some());
    window.press_label("Not sure");
    window.harness.run_steps(3);
    window
        .harness
        .get_by_label("Field size 105 × 68 m is assumed.");
}
