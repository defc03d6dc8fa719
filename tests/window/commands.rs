//! Commands by palette, keys and menus, and the dialogs that they open.

use super::harness::Window;
use super::solved_frame::{SIZE, chord, solved_window};
use crate::parts::{Test, tests};
use egui::{Key, Modifiers, pos2, vec2};
use egui_kittest::kittest::{NodeT as _, Queryable as _};
use touchline::app::session::{Dialog, SidePanel};
use touchline::app::{Action, Command, Question, ViewAction};
use touchline::exchange::Format;
use touchline::ui::Shell;

pub const TESTS: &[Test] = tests![
    [Adapter] the_palette_finds_a_command_by_typing;
    [Adapter] a_key_conflict_is_reported_when_a_key_is_changed;
    [Adapter] menus_say_what_cannot_be_done_and_the_rows_what_can;
    [Adapter] f10_and_a_tap_on_alt_open_the_menus;
    [Adapter] a_comment_is_written_and_an_overlay_colour_chosen;
    [] nothing_open_invites_and_takes_a_typed_path;
    [Adapter] the_sport_is_a_button_under_the_map_and_free_to_change_before_anything_is_named;
    [Adapter] without_a_file_dialog_the_path_is_typed;
    [Adapter] a_court_that_is_drawn_in_the_field_editor_becomes_the_field;
];

fn the_palette_finds_a_command_by_typing() {
    let mut window = Window::open(1, SIZE, 1.0);
    chord(&mut window, Modifiers::COMMAND, Key::K);
    assert_eq!(window.app().session.dialog, Some(Dialog::Palette));
    window.type_text("fra");
    window.harness.run_steps(2);
    window.snapshot_of(
        "palette",
        egui::Rect::from_min_size(pos2(370.0, 95.0), vec2(540.0, 240.0)),
    );
    for _ in 0..3 {
        window.key(Key::Backspace);
    }
    window.type_text("camera");
    window.key(Key::Enter);
    assert_eq!(
        (
            window.app().session.dialog.clone(),
            window.app().session.panel
        ),
        (None, SidePanel::Camera)
    );
    chord(&mut window, Modifiers::COMMAND, Key::K);
    window.key(Key::Escape);
    assert_eq!(window.app().session.dialog, None);
    // The focus is back: plain keys work again.
    window.key(Key::F2);
    assert_eq!(window.app().session.panel, SidePanel::Frame);
}

fn a_key_conflict_is_reported_when_a_key_is_changed() {
    let mut window = Window::open(2, SIZE, 1.0);
    chord(&mut window, Modifiers::SHIFT, Key::Slash);
    assert_eq!(window.app().session.dialog, Some(Dialog::Keys));
    window.snapshot_of(
        "keys",
        egui::Rect::from_min_size(pos2(200.0, 60.0), vec2(880.0, 600.0)),
    );
    window.press_label("Key of Next frame to do: N");
    window.harness.run_steps(2);
    window.key(Key::Period);
    assert_eq!(
        window.app().settings.keys.key_label(Command::NextNeedsMe),
        "."
    );
    assert_eq!(window.app().settings.keys.key_label(Command::NextFrame), "");
    let told = &window.app().session.messages.notices.last().unwrap().text;
    assert!(told.contains("“Next frame” no longer has a key"), "{told}");
    window.press_label("Reset to defaults");
    window.harness.run_steps(2);
    assert!(!window.app().settings.keys.is_changed());
    window.key(Key::Escape);
    window.key(Key::Period);
    assert_eq!(window.app().session.frame, 1);
}

fn menus_say_what_cannot_be_done_and_the_rows_what_can() {
    let mut window = solved_window();
    window.snapshot_of(
        "status",
        egui::Rect::from_min_size(pos2(0.0, 696.0), vec2(1280.0, 24.0)),
    );
    window.press_label("Edit");
    window.harness.run_steps(3);
    window.snapshot_of(
        "menu",
        egui::Rect::from_min_size(pos2(30.0, 24.0), vec2(260.0, 250.0)),
    );
    assert!(
        window
            .harness
            .get_by_label_contains("Redo")
            .accesskit_node()
            .is_disabled()
    );
    window.harness.get_by_label_contains("Undo Ctrl+Z").click();
    window.harness.run_steps(3);
    assert!(window.app().open().unwrap().history.next_redo().is_some());
}

fn f10_and_a_tap_on_alt_open_the_menus() {
    let mut window = Window::open(1, SIZE, 1.0);
    window.key(Key::F10);
    window.harness.run_steps(2);
    assert!(
        window
            .harness
            .query_by_label_contains("Open project…")
            .is_some()
    );
    // The arrows go from menu to menu, round the ends as well.
    window.key(Key::ArrowRight);
    window.harness.run_steps(3);
    assert!(
        window
            .harness
            .query_by_label_contains("Preferences…")
            .is_some()
    );
    assert!(
        window
            .harness
            .query_by_label_contains("Open project…")
            .is_none()
    );
    for _ in 0..2 {
        window.key(Key::ArrowLeft);
        window.harness.run_steps(3);
    }
    assert!(
        window
            .harness
            .query_by_label_contains("User guide")
            .is_some()
    );
    window.key(Key::Escape);
    window.harness.run_steps(3);
    assert!(
        window
            .harness
            .query_by_label_contains("User guide")
            .is_none()
    );
}

fn a_comment_is_written_and_an_overlay_colour_chosen() {
    let mut window = Window::open(1, SIZE, 1.0);
    chord(&mut window, Modifiers::COMMAND, Key::M);
    window.type_text("n is no command here");
    chord(&mut window, Modifiers::COMMAND, Key::Enter);
    assert_eq!(
        window.app().frame().unwrap().comment.as_deref(),
        Some("n is no command here")
    );
    window.key(Key::O);
    window.press_label("Cyan");
    window.harness.run_steps(2);
    assert_eq!(window.app().overlay_style().colour, [90, 225, 255]);
    window.key(Key::Escape);
    assert_eq!(window.app().session.dialog, None);
}

fn nothing_open_invites_and_takes_a_typed_path() {
    let mut harness = egui_kittest::Harness::builder()
        .with_size(SIZE)
        .build_eframe(|creation| Shell::new(creation, None, Vec::new()).unwrap());
    harness.run_steps(3);
    harness.get_by_label("How two clicks solve a frame");
    harness.get_by_label_contains("Video…");
    harness.get_by_label_contains("Take the tour");
    harness.get_by_label_contains("Or drop on this window a video, frames, a project");
    harness.get_by_label("Path to open").focus();
    harness.run_steps(2);
    harness
        .get_by_label("Path to open")
        .type_text("/no/such/place");
    harness.run_steps(2);
    harness.get_by_label("Open").click();
    let start = std::time::Instant::now();
    while harness.state().app().session.messages.notices.is_empty() {
        assert!(
            start.elapsed().as_secs() < 60,
            "nobody says that there is no such place"
        );
        std::thread::sleep(std::time::Duration::from_millis(5));
        harness.step();
    }
    assert!(
        harness.state().app().session.messages.notices[0]
            .text
            .contains("/no/such/place")
    );
}

fn the_sport_is_a_button_under_the_map_and_free_to_change_before_anything_is_named() {
    let mut window = Window::open(1, SIZE, 1.0);
    window.press_label("Soccer (IFAB Laws of the Game)");
    window.harness.run_steps(3);
    assert_eq!(window.app().session.dialog, Some(Dialog::Sport));
    assert_eq!(window.app().points_of_field(), 0);
    window.press_label("Basketball (NBA)");
    window.harness.run_steps(3);
    assert_eq!(
        window.app().shown_field_spec().unwrap().template,
        "basketball_nba"
    );
    window.harness.get_by_label("Basketball (NBA)");
    chord(&mut window, Modifiers::COMMAND, Key::Z);
    assert_eq!(window.app().shown_field_spec().unwrap().template, "soccer");
}

fn a_court_that_is_drawn_in_the_field_editor_becomes_the_field() {
    let mut window = Window::open(1, SIZE, 1.0);
    window.apply(Action::View(ViewAction::EditFieldTemplate(None)));
    window.harness.run_steps(3);
    let drawing = window.harness.get_by_label("Drawing of the field").rect();
    window.press_label("at both ends");
    // From the far sideline to the near one, a quarter of the length from the middle.
    let [from, to] = [-0.2, 0.2]
        .map(|down| drawing.center() + vec2(0.2 * drawing.width(), down * drawing.width()));
    window.press(from);
    window.drag(from + vec2(0.0, 20.0));
    window.drag(to);
    window.release(to);
    window.harness.run_steps(3);
    let lines = |window: &Window| {
        let draft = window.app().session.field_draft.clone().unwrap();
        draft.field().unwrap().1.lines.len()
    };
    assert_eq!(lines(&window), 6, "the boundary, and one at each end");
    window.press_label("Take back");
    window.harness.run_steps(2);
    assert_eq!(lines(&window), 4);
    window.press_label("Save and use");
    window.wait_for(|window| {
        let spec = window.app().shown_field_spec();
        spec.is_some_and(|spec| spec.template == "my_court.json")
    });
    assert!(window.folder.path().join("my_court.json").exists());
    assert_eq!(window.app().session.dialog, None);
    assert_eq!(window.app().current().field().unwrap().lines.len(), 4);
    chord(&mut window, Modifiers::COMMAND, Key::Z);
    assert_eq!(window.app().shown_field_spec().unwrap().template, "soccer");
}

fn without_a_file_dialog_the_path_is_typed() {
    let mut window = Window::open(1, SIZE, 1.0);
    let file = window.folder.path().join("out.json");
    window.apply(Action::View(ViewAction::TypePath(Question::ExportAs(
        Format::Json,
    ))));
    window.harness.run_steps(3);
    window.type_text(&file.display().to_string());
    window.key(Key::Enter);
    window.wait_for(|_| file.exists());
    window.wait_for(|window| window.app().session.dialog.is_none());
}
