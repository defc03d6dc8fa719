//! The matches of a queue beside the picture.

use super::harness::Window;
use crate::parts::{Test, tests};
use egui::Key;
use egui_kittest::kittest::Queryable as _;
use touchline::app::Command;
use touchline::ui::Shell;

pub const TESTS: &[Test] = tests![
    [Adapter] the_panel_of_a_queue_looks_like_this_and_leads_from_match_to_match;
    [Adapter] in_a_small_window_the_panel_leaves_room_for_the_picture;
];

/// The name of the match that is open.
fn name(window: &Window) -> String {
    let folder = &window.app().open().unwrap().folder;
    folder.file_name().unwrap().to_string_lossy().into_owned()
}

/// Waits until this match is open and shown.
fn wait_for(window: &mut Window, wanted: &str) {
    let is_open = |shell: &Shell| {
        let open = shell.app().open();
        open.is_some_and(|open| open.folder.ends_with(wanted)) && shell.has_picture()
    };
    window.wait_for(is_open);
    window.harness.run_steps(3);
}

fn the_panel_of_a_queue_looks_like_this_and_leads_from_match_to_match() {
    let mut window = Window::open_queue([1280.0, 720.0]);
    assert_eq!(name(&window), "final");
    let is_known = |shell: &Shell| {
        let rows = shell.app().queue().unwrap().rows();
        rows.iter().all(|row| row.state.is_some()) && shell.has_thumbnails()
    };
    window.wait_for(is_known);
    let panel = egui::Rect::from_min_max(egui::pos2(40.0, 24.0), egui::pos2(272.0, 172.0));
    window.snapshot_of("queue", panel);
    window
        .harness
        .get_by_label_contains("Match final, 1 camera found, 1 doubt");
    window.harness.get_by_label_contains("Match lost, failed: ");

    window.press_label("Next match");
    wait_for(&mut window, "semifinal");
    // The one after it is missing: the window stays, and the row says why.
    window.apply(touchline::app::Action::Command(Command::NextMatch));
    window.wait_for(|shell| shell.app().queue().is_some_and(|queue| queue.at() == 2));
    window.wait_for(|shell| shell.app().session.disk.opening.is_none());
    assert_eq!(name(&window), "semifinal");
    window
        .harness
        .get_by_label_contains("Match final, ")
        .click();
    window.harness.run_steps(2);
    wait_for(&mut window, "final");
    window.key(Key::F6);
    assert!(window.harness.query_by_label("Next match").is_none());
}

fn in_a_small_window_the_panel_leaves_room_for_the_picture() {
    let window = Window::open_queue([900.0, 600.0]);
    let picture = window.harness.get_by_label("Picture").rect();
    assert!(picture.width() >= 480.0, "{picture:?}");
    let row = window.harness.get_by_label_contains("Match final, ").rect();
    assert!((90.0..=100.0).contains(&row.width()), "{row:?}");
}
