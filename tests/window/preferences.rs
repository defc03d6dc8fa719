//! The preferences: the theme, the colours of lines by sport, the loupe; and the order in which Tab
//! goes through a dialog.

use super::harness::Window;
use crate::parts::{Test, tests};
use egui::{Key, Modifiers, Rect, pos2};
use egui_kittest::kittest::{NodeT as _, Queryable as _};
use touchline::app::settings::ThemeChoice;
use touchline::app::{Action, Command, SettingsAction, ViewAction};

pub const TESTS: &[Test] = tests![
    [Adapter] the_light_theme_is_light_everywhere_at_once;
    [Adapter] the_colour_of_lines_is_chosen_by_sport;
    [Adapter] without_the_loupe_there_is_none;
    [Adapter] tab_goes_through_a_dialog_from_top_to_bottom;
];

const SIZE: [f32; 2] = [1280.0, 720.0];

fn preferences(window: &mut Window) {
    window.apply(Action::Command(Command::Preferences));
    window.harness.run_steps(3);
}

fn the_light_theme_is_light_everywhere_at_once() {
    let mut window = Window::open_suggested(&[Some(0.9), Some(0.4), None], SIZE);
    preferences(&mut window);
    window.press_label("Light");
    window.harness.run_steps(3);
    assert_eq!(window.app().settings.theme, ThemeChoice::Light);
    let part = Rect::from_min_max(pos2(380.0, 40.0), pos2(900.0, 330.0));
    window.snapshot_of("preferences_light", part);
    window.apply(Action::View(ViewAction::CloseDialog));
    window.harness.run_steps(3);
    let image = window.harness.render().unwrap();
    let ground = |x: u32, y: u32| {
        image.get_pixel(x, y).0[..3]
            .iter()
            .map(|value| u32::from(*value))
            .sum::<u32>()
            / 3
    };
    // Menu row, side panel, status row.
    for (x, y) in [(700, 20), (990, 690), (640, 700)] {
        assert!(ground(x, y) > 200, "{x}, {y}: {}", ground(x, y));
    }
    window.snapshot_of(
        "inspector_light",
        Rect::from_min_max(pos2(980.0, 220.0), pos2(1280.0, 696.0)),
    );
    preferences(&mut window);
    window.press_label("Dark");
    window.harness.run_steps(3);
    assert!(window.harness.ctx.theme() == egui::Theme::Dark);
}

fn the_colour_of_lines_is_chosen_by_sport() {
    let mut window = Window::open(1, SIZE, 1.0);
    let before = window.app().overlay_style().colour;
    preferences(&mut window);
    window
        .harness
        .get_by_label("Basketball: Sky blue")
        .scroll_to_me();
    window.harness.run_steps(3);
    window.press_label("Basketball: Sky blue");
    window.harness.run_steps(3);
    assert_eq!(
        window.app().overlay_style().colour,
        before,
        "the shown field is that of soccer"
    );
    assert_eq!(
        window.app().settings.overlay_of("basketball_nba").colour,
        [86, 180, 233]
    );
    window.press_label("Soccer: Magenta");
    window.harness.run_steps(3);
    assert_eq!(window.app().overlay_style().colour, [214, 40, 190]);
}

fn without_the_loupe_there_is_none() {
    let mut window = Window::open(1, SIZE, 1.0);
    let at = window.on_screen(window.image_of("penalty_area_far_left_front"));
    window.press(at);
    assert!(window.harness.query_by_label("Loupe").is_some());
    window.release(at);
    window.key(Key::Escape);
    let look = touchline::app::settings::Loupe {
        shown: false,
        ..Default::default()
    };
    window.apply(Action::Settings(SettingsAction::Loupe(look)));
    window.press(at);
    assert!(window.harness.query_by_label("Loupe").is_none());
    window.release(at);
}

/// The control with the focus: its name and its place.
fn focused_control(window: &Window) -> Option<(String, Rect)> {
    let node = window
        .harness
        .root()
        .children_recursive()
        .find(|node| node.accesskit_node().is_focused())?;
    // Without a focus the whole window has it.
    node.accesskit_node().bounding_box()?;
    let name = node
        .accesskit_node()
        .label()
        .or_else(|| node.accesskit_node().value())
        .unwrap_or_default();
    Some((name, node.rect()))
}

fn tab_goes_through_a_dialog_from_top_to_bottom() {
    let mut window = Window::open(1, SIZE, 1.0);
    for (command, title) in [
        (Command::Preferences, "Preferences"),
        (Command::ChooseSport, "Sport and field"),
        (Command::AssignToCamera, "Assign frames to a camera"),
        (Command::About, "About"),
    ] {
        window.apply(Action::Command(command));
        window.harness.run_steps(6);
        let close = format!("Close: {title}");
        window.harness.get_by_label(&close).focus();
        window.harness.run_steps(3);
        let mut places: Vec<(String, Rect)> = Vec::new();
        // After the last of the dialog comes its first again: nothing of the window behind it.
        let mut comes_back = false;
        for _ in 0..150 {
            window
                .harness
                .key_press_modifiers(Modifiers::NONE, Key::Tab);
            window.harness.run_steps(2);
            match focused_control(&window) {
                Some((name, _)) if name == close => {
                    comes_back = true;
                    break;
                }
                Some(place) => places.push(place),
                None => {}
            }
        }
        assert!(
            comes_back && (2..140).contains(&places.len()),
            "{title}: {places:?}"
        );
        assert!(
            places
                .iter()
                .all(|(name, _)| name != "File" && name != "Picture"),
            "{title}: {places:?}"
        );
        for pair in places.windows(2) {
            let (before, after) = (&pair[0], &pair[1]);
            let lower = after.1.center().y > before.1.center().y;
            let beside = (after.1.center().y - before.1.center().y).abs() <= 12.0;
            assert!(
                lower || beside,
                "{title}: {} and then {}",
                before.0,
                after.0
            );
        }
        window.apply(Action::View(ViewAction::CloseDialog));
        window.harness.run_steps(2);
    }
}
