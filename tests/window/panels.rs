//! The panels around the picture, driven by keyboard and pointer through their accessibility nodes.

use super::harness::{Window, truth};
use crate::parts::{Test, tests};
use egui::accesskit::Role;
use egui::{Key, Modifiers, pos2, vec2};
use egui_kittest::kittest::{NodeT as _, Queryable as _};
use touchline::app::session::{Dialog, Filter, Level, SidePanel};
use touchline::app::{Action, Command, Question, SettingsAction, ViewAction};
use touchline::document::{FrameStatus, RejectReason};
use touchline::exchange::Format;
use touchline::ui::Shell;

pub const TESTS: &[Test] = tests![
    [Adapter] a_typed_number_is_one_step_of_undo_and_escape_none;
    [Adapter] a_dragged_number_is_one_step_and_the_camera_follows;
    [Adapter] points_are_selected_held_out_and_deleted_in_their_list;
    [Adapter] details_unfold_and_say_what_two_points_cannot;
    [Adapter] the_camera_panel_changes_the_base_and_the_overlay_follows;
    [Adapter] frames_are_gone_to_and_rejected_by_keys;
    [Adapter] the_filmstrip_goes_to_frames_and_filters_them;
    [Adapter] the_shown_frame_stays_in_the_filmstrip_however_it_came_there;
    [Adapter] the_palette_finds_a_command_by_typing;
    [Adapter] a_key_conflict_is_reported_when_a_key_is_changed;
    [Adapter] menus_say_what_cannot_be_done_and_the_rows_what_can;
    [Adapter] good_news_fade_and_bad_news_stay_until_they_are_closed;
    [Adapter] a_comment_is_written_and_an_overlay_colour_chosen;
    [] nothing_open_invites_and_takes_a_typed_path;
    [Adapter] every_control_has_a_name;
    [Adapter] panels_are_dragged_to_another_size_which_is_remembered;
    [Adapter] the_sport_is_a_button_under_the_map_and_free_to_change_before_anything_is_named;
    [Adapter] f10_and_a_tap_on_alt_open_the_menus;
    [Adapter] in_the_smallest_window_verdict_and_reasons_are_in_sight;
    [Adapter] every_side_panel_begins_at_the_same_place;
    [Adapter] the_picture_is_made_brighter_and_stays_so_between_frames;
    [Adapter] without_a_file_dialog_the_path_is_typed;
];

const SIZE: [f32; 2] = [1280.0, 720.0];

/// A frame with two points, solved.
fn solved() -> Window {
    let mut window = Window::open(4, SIZE, 1.0);
    for (landmark, code) in [
        ("penalty_area_far_left_front", "pflf"),
        ("centre_circle_halfway_near", "chn"),
    ] {
        window.click(window.image_of(landmark));
        window.type_text(code);
        window.key(Key::Enter);
    }
    assert!(window.app().current().solved().is_some());
    window.harness.hover_at(pos2(1100.0, 640.0));
    window.harness.run_steps(2);
    window
}

fn chord(window: &mut Window, modifiers: Modifiers, key: Key) {
    window.harness.key_press_modifiers(modifiers, key);
    window.harness.run_steps(3);
}

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
    let mut window = solved();
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
    let mut window = solved();
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
    let mut window = solved();
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
    window
        .harness
        .get_by_label("Point 1: Penalty area, far left, front corner, no evidence")
        .click();
    window.harness.run_steps(2);
    assert_eq!(window.app().session.points.selected, Some(0));
    window.key(Key::ArrowRight);
    assert_eq!(
        undo_name(&window).as_deref(),
        Some("Nudge Penalty area, far left, front corner")
    );
    window.harness.get_by_label("Check point 2").click();
    window.harness.run_steps(2);
    assert!(window.app().frame().unwrap().clicks[1].check);
    assert!(
        window.app().current().solved().is_none(),
        "one point is not enough"
    );
    let accept = window.harness.get_by_label("Accept");
    assert!(accept.accesskit_node().is_disabled());
    window.harness.get_by_label("Delete point 2").click();
    window.harness.run_steps(2);
    assert_eq!(window.app().frame().unwrap().clicks.len(), 1);
}

fn details_unfold_and_say_what_two_points_cannot() {
    let mut window = solved();
    window.harness.get_by_label("Details").click();
    window.harness.run_steps(3);
    assert!(window.app().settings.details);
    window
        .harness
        .get_by_label("no evidence: two points always fit");
    window.harness.get_by_label("18.00 m");
}

fn the_camera_panel_changes_the_base_and_the_overlay_follows() {
    let mut window = solved();
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
    window
        .harness
        .get_by_label("Frame 2, 0002.png, New")
        .click();
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
    window.harness.get_by_label("Frames shown").click();
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
        window.harness.get_by_label("Frames shown").click();
        window.harness.run_steps(3);
        window.harness.get_by_label_contains(shown).click();
        window.harness.run_steps(3);
        assert_eq!(usize::from(in_view(&window, 60)), wanted, "{shown}");
    }
}

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
    window
        .harness
        .get_by_label("Key of Next frame to do: N")
        .click();
    window.harness.run_steps(2);
    window.key(Key::Period);
    assert_eq!(window.app().settings.keys.shown(Command::NextNeedsMe), ".");
    assert_eq!(window.app().settings.keys.shown(Command::NextFrame), "");
    let told = &window.app().session.messages.notices.last().unwrap().text;
    assert!(told.contains("“Next frame” no longer has a key"), "{told}");
    window.harness.get_by_label("Reset to defaults").click();
    window.harness.run_steps(2);
    assert!(!window.app().settings.keys.is_changed());
    window.key(Key::Escape);
    window.key(Key::Period);
    assert_eq!(window.app().session.frame, 1);
}

fn menus_say_what_cannot_be_done_and_the_rows_what_can() {
    let mut window = solved();
    window.snapshot_of(
        "status",
        egui::Rect::from_min_size(pos2(0.0, 696.0), vec2(1280.0, 24.0)),
    );
    window.harness.get_by_label("Edit").click();
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

fn good_news_fade_and_bad_news_stay_until_they_are_closed() {
    let mut window = Window::open(1, SIZE, 1.0);
    let picture = window.harness.get_by_label("Picture").rect();
    let told = |window: &mut Window, level: Level, text: &str| {
        window
            .harness
            .state_mut()
            .apply([Action::View(ViewAction::Notify(level, text.to_owned()))]);
        window.harness.run_steps(4);
    };
    told(
        &mut window,
        Level::Warning,
        "0412.jpg changed since it was labelled.",
    );
    told(&mut window, Level::Info, "Dataset written.");
    // The latest is in the row, which is no part of the picture; the others are counted.
    let row = window.harness.get_by_label("Dataset written.").rect();
    assert_eq!(
        window.harness.get_by_label("Picture").rect(),
        picture,
        "messages do not move the picture"
    );
    assert!(
        !picture.intersects(row),
        "{row:?} lies over the picture {picture:?}"
    );
    window.harness.get_by_label("1 more");
    window.harness.run_steps(40);
    assert!(
        window.harness.query_by_label("Dataset written.").is_none(),
        "it has faded"
    );
    window
        .harness
        .get_by_label("0412.jpg changed since it was labelled.");
    // Both stay in the list of messages, which dismisses all at once.
    window.harness.get_by_label("Messages").click();
    window.harness.run_steps(3);
    assert!(window.harness.query_by_label("Dataset written.").is_some());
    window.harness.get_by_label("Dismiss all messages").click();
    window.harness.run_steps(3);
    assert!(
        window.app().session.messages.notices.is_empty()
            && window.app().session.messages.log.len() >= 2
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
    window.harness.get_by_label("Cyan").click();
    window.harness.run_steps(2);
    assert_eq!(window.app().overlay_style().colour, [90, 225, 255]);
    window.key(Key::Escape);
    assert_eq!(window.app().session.dialog, None);
}

fn nothing_open_invites_and_takes_a_typed_path() {
    let mut harness = egui_kittest::Harness::builder()
        .with_size(SIZE)
        .build_eframe(|creation| Shell::new(creation, None, None).unwrap());
    harness.run_steps(3);
    harness.get_by_label("How two clicks solve a frame");
    harness.get_by_label_contains("Video…");
    harness.get_by_label_contains("Take the tour");
    harness.get_by_label(
        "Or drop on this window a video, frames, a project, or cameras of another program with their video.",
    );
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

fn every_control_has_a_name() {
    let mut window = solved();
    let nameless = |window: &Window, place: &str| {
        assert_eq!(
            window.harness.unnamed_widgets(),
            Vec::<String>::new(),
            "{place}"
        );
        // Whatever can be clicked, dragged or typed into has a role of its own and says what it is.
        for node in window.harness.root().children_recursive() {
            let node = node.accesskit_node();
            let is_control = matches!(
                node.role(),
                Role::Button
                    | Role::Canvas
                    | Role::CheckBox
                    | Role::ComboBox
                    | Role::Link
                    | Role::MultilineTextInput
                    | Role::RadioButton
                    | Role::Slider
                    | Role::SpinButton
                    | Role::Splitter
                    | Role::TextInput
            );
            if !is_control {
                continue;
            }
            let says = node.label().or_else(|| node.value()).unwrap_or_default();
            assert!(
                !says.trim().is_empty(),
                "{place}: a {:?} has no name",
                node.role()
            );
        }
    };
    nameless(&window, "the frame");
    for key in [Key::F2, Key::F3, Key::F4, Key::F5] {
        window.key(key);
        nameless(&window, &format!("{key:?}"));
        window.key(key);
    }
    let dialogs = [
        Command::Palette,
        Command::Keys,
        Command::Messages,
        Command::Preferences,
        Command::Guide,
        Command::About,
        Command::OverlayStyle,
        Command::PictureLook,
        Command::ChooseSport,
        Command::GoToPlace,
        Command::Comment,
        Command::AssignToCamera,
        Command::AcceptAllAbove,
        Command::Export,
        Command::ExportDataset,
        Command::Import,
    ];
    for dialog in dialogs {
        window.harness.state_mut().apply([Action::Command(dialog)]);
        window.harness.run_steps(3);
        nameless(&window, dialog.name());
        window
            .harness
            .state_mut()
            .apply([Action::View(ViewAction::CloseDialog)]);
        window.harness.run_steps(2);
    }
}

fn panels_are_dragged_to_another_size_which_is_remembered() {
    let mut window = Window::open(2, SIZE, 1.0);
    let edge = window
        .harness
        .get_by_label("Width of the side panel")
        .rect();
    let (from, to) = (edge.center(), edge.center() - vec2(80.0, 0.0));
    let before = window.harness.get_by_label("Picture").rect();
    window.press(from);
    for step in 1..=8 {
        window.drag(from + (to - from) * (step as f32 / 8.0));
    }
    window.release(to);
    window.harness.run_steps(3);
    assert!(
        (before.right() - window.harness.get_by_label("Picture").rect().right() - 80.0).abs() < 4.0
    );
    assert!(
        (window.app().settings.side_width.unwrap() - 380.0).abs() < 4.0,
        "{:?}",
        window.app().settings.side_width
    );
    assert!(
        window.app().frame().unwrap().clicks.is_empty(),
        "nothing was clicked on the picture"
    );
}

fn the_sport_is_a_button_under_the_map_and_free_to_change_before_anything_is_named() {
    let mut window = Window::open(1, SIZE, 1.0);
    window
        .harness
        .get_by_label("Soccer (IFAB Laws of the Game)")
        .click();
    window.harness.run_steps(3);
    assert_eq!(window.app().session.dialog, Some(Dialog::Sport));
    assert_eq!(window.app().points_of_field(), 0);
    window.harness.get_by_label("Basketball (NBA)").click();
    window.harness.run_steps(3);
    assert_eq!(
        window.app().shown_field_spec().unwrap().template,
        "basketball_nba"
    );
    window.harness.get_by_label("Basketball (NBA)");
    chord(&mut window, Modifiers::COMMAND, Key::Z);
    assert_eq!(window.app().shown_field_spec().unwrap().template, "soccer");
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

fn in_the_smallest_window_verdict_and_reasons_are_in_sight() {
    let mut window = Window::open(4, touchline::app::WindowPlace::LEAST, 1.0);
    for (landmark, code) in [
        ("penalty_area_far_left_front", "pflf"),
        ("centre_circle_halfway_near", "chn"),
    ] {
        window.click(window.image_of(landmark));
        window.type_text(code);
        window.key(Key::Enter);
    }
    window.harness.run_steps(4);
    assert!(window.app().settings.field_map);
    let judgement = window.app().shown().judgement.unwrap();
    let accept = window
        .harness
        .get_by_role_and_label(Role::Button, "Accept")
        .rect();
    let verdict = window
        .harness
        .get_by_label(&judgement.verdict.to_string())
        .rect();
    let worst_corner = window.harness.get_by_label("Worst corner").rect();
    let map = window.harness.get_by_label("Field map").rect();
    assert!(
        verdict.bottom() < accept.top() && accept.bottom() <= 600.0,
        "{verdict:?} {accept:?}"
    );
    assert!(
        worst_corner.bottom() < verdict.top() && map.height() > 100.0,
        "{worst_corner:?} {map:?}"
    );
    window.key(Key::X);
    window.harness.run_steps(4);
    let picture = window.harness.get_by_label("Picture").rect();
    for (index, reason) in RejectReason::ALL.into_iter().enumerate() {
        let says = format!(
            "{}  {}",
            index + 1,
            touchline::app::session::reason_label(reason)
        );
        let button = window.harness.get_by_label(&says).rect();
        assert!(
            picture.contains_rect(button),
            "{says}: {button:?} in {picture:?}"
        );
    }
}

fn every_side_panel_begins_at_the_same_place() {
    let mut window = solved();
    let panels = [
        (Command::CameraPanel, "POSITION"),
        (Command::TrainerPanel, "TRAINED ON"),
        (Command::CameraPanel, "LENS"),
    ];
    let lefts = panels.map(|(command, title)| {
        window.harness.state_mut().apply([Action::Command(command)]);
        window.harness.run_steps(4);
        window.harness.get_by_label(title).rect().left()
    });
    // A side panel is 300 wide, and its text begins 8 from its edge, which is a line.
    let begins = SIZE[0] - 300.0 + 8.0;
    assert!(
        lefts
            .iter()
            .all(|left| (begins - 0.5..begins + 1.5).contains(left)),
        "{lefts:?}"
    );
    assert!(
        lefts.iter().all(|left| (left - lefts[0]).abs() < 0.5),
        "{lefts:?}"
    );
}

fn the_picture_is_made_brighter_and_stays_so_between_frames() {
    let mut window = Window::open(2, SIZE, 1.0);
    let centre = window.harness.get_by_label("Picture").rect().center() + vec2(0.0, 200.0);
    let pixel = |window: &mut Window| {
        let image = window.harness.render().unwrap();
        image.get_pixel(centre.x as u32, centre.y as u32).0
    };
    let before = pixel(&mut window);
    window.key(Key::I);
    assert_eq!(window.app().session.dialog, Some(Dialog::PictureLook));
    let look = touchline::scene::PictureLook {
        gamma: 2.0,
        ..Default::default()
    };
    window.harness.state_mut().apply([
        Action::Settings(SettingsAction::PictureLook(look)),
        Action::View(ViewAction::CloseDialog),
    ]);
    window.key(Key::Period);
    window.wait_for(Shell::has_picture);
    window.harness.run_steps(2);
    let after = pixel(&mut window);
    let expected = (f64::from(before[1]) / 255.0).sqrt() * 255.0;
    assert!(
        (f64::from(after[1]) - expected).abs() < 3.0,
        "{before:?} became {after:?}"
    );
    assert_eq!(window.app().settings.picture, look);
}

fn without_a_file_dialog_the_path_is_typed() {
    let mut window = Window::open(1, SIZE, 1.0);
    let file = window.folder.path().join("out.json");
    window
        .harness
        .state_mut()
        .apply([Action::View(ViewAction::TypePath(Question::ExportAs(
            Format::Json,
        )))]);
    window.harness.run_steps(3);
    window.type_text(&file.display().to_string());
    window.key(Key::Enter);
    window.wait_for(|_| file.exists());
    window.wait_for(|window| window.app().session.dialog.is_none());
}
