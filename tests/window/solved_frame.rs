//! A window whose frame two points have solved, and what many tests do with it.

use super::harness::Window;
use egui::{Key, Modifiers, pos2};

/// The size of the window in most tests.
pub const SIZE: [f32; 2] = [1280.0, 720.0];

/// A frame with two points, solved.
pub fn solved_window() -> Window {
    let mut window = Window::open(4, SIZE, 1.0);
    for (landmark, code) in [
        ("penalty_area_far_left_front", "pflf"),
        ("centre_circle_halfway_near", "chn"),
    ] {
        window.click(window.image_of(landmark));
        window.type_text(code);
        window.key(Key::Enter);
    }
    assert!(window.app().current().click_solution().is_some());
    window.harness.hover_at(pos2(1100.0, 640.0));
    window.harness.run_steps(2);
    window
}

/// Presses a key with modifiers.
pub fn chord(window: &mut Window, modifiers: Modifiers, key: Key) {
    window.harness.key_press_modifiers(modifiers, key);
    window.harness.run_steps(3);
}
