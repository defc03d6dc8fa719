//! The panels around the picture as a whole: sizes, places, names of controls, messages.

use super::harness::Window;
use super::solved_frame::{SIZE, solved_window};
use crate::parts::{Test, tests};
use egui::accesskit::Role;
use egui::{Key, vec2};
use egui_kittest::kittest::{NodeT as _, Queryable as _};
use touchline::app::session::{Dialog, Level};
use touchline::app::{Action, Command, SettingsAction, ViewAction};
use touchline::document::RejectReason;
use touchline::ui::Shell;

pub const TESTS: &[Test] = tests![
    [Adapter] good_news_fade_and_bad_news_stay_until_they_are_closed;
    [Adapter] every_control_has_a_name;
    [Adapter] panels_are_dragged_to_another_size_which_is_remembered;
    [Adapter] in_the_smallest_window_verdict_and_reasons_are_in_sight;
    [Adapter] every_side_panel_begins_at_the_same_place;
    [Adapter] the_picture_is_made_brighter_and_stays_so_between_frames;
];

fn good_news_fade_and_bad_news_stay_until_they_are_closed() {
    let mut window = Window::open(1, SIZE, 1.0);
    let picture = window.harness.get_by_label("Picture").rect();
    let told = |window: &mut Window, level: Level, text: &str| {
        window.apply(Action::View(ViewAction::Notify(level, text.to_owned())));
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
    window.press_label("Messages");
    window.harness.run_steps(3);
    assert!(window.harness.query_by_label("Dataset written.").is_some());
    window.press_label("Dismiss all messages");
    window.harness.run_steps(3);
    assert!(
        window.app().session.messages.notices.is_empty()
            && window.app().session.messages.log.len() >= 2
    );
}

fn every_control_has_a_name() {
    let mut window = solved_window();
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
        window.apply(Action::Command(dialog));
        window.harness.run_steps(3);
        nameless(&window, dialog.name());
        window.apply(Action::View(ViewAction::CloseDialog));
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

fn in_the_smallest_window_verdict_and_reasons_are_in_sight() {
    let mut window = Window::open(4, touchline::app::WindowPlace::MIN_SIZE, 1.0);
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
    let judgement = window.app().shown_values().judgement.unwrap();
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
    for (index, &reason) in RejectReason::ALL.iter().enumerate() {
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
    let mut window = solved_window();
    let panels = [
        (Command::CameraPanel, "POSITION"),
        (Command::TrainerPanel, "TRAINED ON"),
        (Command::CameraPanel, "LENS"),
    ];
    let lefts = panels.map(|(command, title)| {
        window.apply(Action::Command(command));
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
    window.apply(Action::Settings(SettingsAction::PictureLook(look)));
    window.apply(Action::View(ViewAction::CloseDialog));
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
