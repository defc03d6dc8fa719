//! Frames are gone to, rejected and filtered, by keys and in the filmstrip.

use super::harness::Window;
use super::solved_frame::{SIZE, chord};
use crate::parts::{Test, tests};
use egui::{Key, Modifiers};
use egui_kittest::kittest::Queryable as _;
use touchline::app::session::Filter;
use touchline::document::{FrameStatus, RejectReason};

pub const TESTS: &[Test] = tests![
    [Adapter] frames_are_gone_to_and_rejected_by_keys;
    [Adapter] the_filmstrip_goes_to_frames_and_filters_them;
    [Adapter] the_shown_frame_stays_in_the_filmstrip_however_it_came_there;
];

fn frames_are_gone_to_and_rejected_by_keys() {
    let mut window = Window::open(12, SIZE, 1.0);
    window.key(Key::Period);
    assert_eq!(window.app().session.frame, 1);
    chord(&mut window, Modifiers::SHIFT, Key::Period);
    assert_eq!(window.app().session.frame, 11);
    window.key(Key::Comma);
    window.key(Key::X);
    window.type_text("5");
    assert_eq!(
        window.app().open().unwrap().frame(10).unwrap().reason,
        Some(RejectReason::Blur)
    );
    assert_eq!(
        window.app().session.frame,
        11,
        "the next one that needs somebody"
    );
    // Undo goes there first and says so.
    chord(&mut window, Modifiers::COMMAND, Key::Z);
    assert_eq!(window.app().session.frame, 10);
    assert_eq!(window.app().open().unwrap().count(FrameStatus::Rejected), 1);
    chord(&mut window, Modifiers::COMMAND, Key::Z);
    assert_eq!(window.app().open().unwrap().count(FrameStatus::Rejected), 0);
}

fn the_filmstrip_goes_to_frames_and_filters_them() {
    let mut window = Window::open(30, SIZE, 1.0);
    window.press_label("Frame 2, 0002.png, New");
    window.harness.run_steps(2);
    assert_eq!(window.app().session.frame, 2);
    let laid_out = window
        .harness
        .query_all_by_label_contains(".png, New")
        .count();
    assert!(
        (5..=14).contains(&laid_out),
        "{laid_out} of 30 frames are laid out"
    );
    // The shown frame comes into view.
    chord(&mut window, Modifiers::SHIFT, Key::Period);
    chord(&mut window, Modifiers::SHIFT, Key::Period);
    window.harness.run_steps(3);
    window.harness.get_by_label("Frame 22, 0022.png, New");
    window.key(Key::X);
    window.type_text("1");
    window.press_label("Frames shown");
    window.harness.run_steps(3);
    window.harness.get_by_label_contains("Rejected 1").click();
    window.harness.run_steps(3);
    assert_eq!(
        window.app().session.filter,
        Filter::Status(FrameStatus::Rejected)
    );
    assert_eq!(
        window.harness.query_all_by_label_contains(".png, ").count(),
        1
    );
}

fn the_shown_frame_stays_in_the_filmstrip_however_it_came_there() {
    let mut window = Window::open(80, SIZE, 1.0);
    let in_view = |window: &Window, frame: usize| {
        let label = format!("Frame {frame}, {frame:04}.png, New");
        let found = window
            .harness
            .query_by_label(&label)
            .map(|node| node.rect());
        found.is_some_and(|rect| rect.left() >= 116.0 && rect.right() <= 980.0)
    };
    // Several jumps come between two pictures of the window where it is busy.
    for jumps in [1, 3, 2] {
        for _ in 0..jumps {
            window
                .harness
                .key_press_modifiers(Modifiers::SHIFT, Key::Period);
        }
        window.harness.run_steps(2);
        let frame = window.app().session.frame;
        assert!(in_view(&window, frame), "frame {frame} after {jumps} jumps");
    }
    assert_eq!(window.app().session.frame, 60);
    // All frames again after a filter that showed none.
    for (shown, wanted) in [("Rejected 0", 0), ("All frames 80", 1)] {
        window.press_label("Frames shown");
        window.harness.run_steps(3);
        window.harness.get_by_label_contains(shown).click();
        window.harness.run_steps(3);
        assert_eq!(usize::from(in_view(&window, 60)), wanted, "{shown}");
    }
}
